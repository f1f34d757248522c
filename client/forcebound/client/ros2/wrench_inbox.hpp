#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "forcebound/time/clock.hpp"
#include "forcebound/time/latest.hpp"

namespace forcebound::ros2 {

using time::Nanoseconds;

/// What a publisher asks for, on the hand at the tip, in the scene's axes.
struct Wrench {
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_N_m = Eigen::Vector3d::Zero();
  Nanoseconds arrival{0};  ///< by this machine's steady clock; stamps of publishers are not read
};

/// What became of a wrench that arrived, and how it is counted: in a summary's text, and in its JSON.
enum class Verdict : std::uint8_t { taken, not_finite, of_another_publisher, in_another_frame };
struct VerdictRow {
  const char* words;
  const char* name;
};
inline constexpr std::array<VerdictRow, 4> kVerdicts{{{"taken", "wrenches_taken"},
                                                      {"not finite", "wrenches_not_finite"},
                                                      {"of another publisher", "wrenches_of_another_publisher"},
                                                      {"in another frame", "wrenches_in_another_frame"}}};

/// Carries the newest wrench of one publisher from the thread of DDS to the one that answers.
///
/// The publisher whose wrench is taken first is the only one until none of its own was taken for the patience, when its
/// force is zero anyway; then the next one is. A wrench in another frame than ours is refused, since its axes are not
/// known here; without a frame's name it is taken.
///
/// Real time: noexcept, no allocation, wait-free. One thread calls `receive`, one other `newest`; `counts` is for any.
class WrenchInbox {
 public:
  /// @param frame name of the scene's frame
  WrenchInbox(std::string frame, Nanoseconds patience) : frame_(std::move(frame)), patience_(patience) {}

  struct Received {
    std::uint64_t publisher = 0;  ///< differs between publishers
    std::string_view frame{};
    Wrench wrench{};
  };
  Verdict receive(const Received& received) noexcept;

  /// The newest that was taken; none: there was none yet.
  [[nodiscard]] const std::optional<Wrench>& newest() noexcept;

  /// By Verdict.
  using Counts = std::array<std::uint64_t, kVerdicts.size()>;
  [[nodiscard]] Counts counts() const noexcept;

  /// Of the first wrench that was refused for it, cut where it is long; once that is counted. Any thread.
  [[nodiscard]] std::string_view other_frame() const noexcept { return {other_frame_.data(), other_frame_bytes_}; }

 private:
  [[nodiscard]] Verdict judge(const Received& received) const noexcept;
  void store_other_frame(std::string_view frame) noexcept;

  std::string frame_;
  Nanoseconds patience_;
  std::optional<std::uint64_t> publisher_{};  // of DDS's thread, with the time
  Nanoseconds taken_at_{0};
  std::array<char, 64> other_frame_{};  // written once, before the first of its wrenches is counted
  std::size_t other_frame_bytes_ = 0;
  time::Latest<Wrench> latest_{};
  std::optional<Wrench> newest_{};  // of the other thread
  std::array<std::atomic<std::uint64_t>, kVerdicts.size()> counts_{};
};

}  // namespace forcebound::ros2
