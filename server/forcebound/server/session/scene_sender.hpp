#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "forcebound/control/vector.hpp"
#include "forcebound/handover/packed_scene.hpp"
#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/token_bucket.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::server {

using time::Nanoseconds;

/// How fast a scene is handed over to each client, beside its forces.
struct HandoverRate {
  double bytes_per_s = 500e3;
  int pieces_at_once = 32;  ///< after a pause
};

/// Hands a scene over to one client, piece by piece, as the answers to its motions leave: the manifest first, then
/// coarse levels, then what is nearest to the device and to where it will be, each again until it is acknowledged. A
/// transmission counts as lost 1.3 round trips after it was sent. Nothing can be felt before all that comes first is
/// there, so what of it is not acknowledged when its last piece has left is sent a second time at once: on a short way
/// that is little, on a long one it costs the bytes of one round trip and spares that of a loss.
///
/// Nothing is sent but in return for a motion, so that a client that is gone is sent nothing.
///
/// Real time after construction: noexcept, no allocation, O(pieces) at most once for each piece that is sent.
class SceneSender {
 public:
  struct Sending {
    std::uint64_t transmission;
    std::uint32_t number;
    bool again;
  };

  SceneSender(std::shared_ptr<const handover::PackedScene> scene, const HandoverRate& rate, Nanoseconds now);

  [[nodiscard]] const handover::PackedScene& scene() const noexcept { return *scene_; }

  /// A motion of the client's, with what it has by then. @param now when it came
  void on_motion(const wire::MotionSample& motion, Nanoseconds now) noexcept;

  /// What is to be sent now, if anything.
  [[nodiscard]] std::optional<Sending> next(Nanoseconds now) noexcept;

 private:
  enum class State : std::uint8_t { waiting, to_be_doubled, on_its_way, there };

  struct Flight {
    std::uint64_t transmission = 0;
    std::uint32_t number = 0;
    Nanoseconds sent{0};
  };

  static constexpr std::size_t kFlights = 512;  // on their way at once
  static constexpr std::size_t kChosen = 32;

  [[nodiscard]] static bool due(State state) noexcept { return state <= State::to_be_doubled; }
  void set(std::uint32_t number, State state) noexcept;
  void acknowledge(std::uint64_t transmission, Nanoseconds now) noexcept;
  void give_up_late(Nanoseconds now) noexcept;
  void choose() noexcept;
  [[nodiscard]] Flight& flight(std::uint64_t transmission) noexcept { return flights_[transmission % kFlights]; }
  [[nodiscard]] Nanoseconds patience() const noexcept;
  [[nodiscard]] double urgency(std::uint32_t number) const noexcept;

  std::shared_ptr<const handover::PackedScene> scene_;
  time::TokenBucket rate_;
  std::vector<State> states_;  // of the pieces
  std::size_t due_;            // how many are
  std::size_t there_ = 0;
  std::vector<std::uint64_t> newest_of_;  // transmission of each piece; 0: none yet
  bool wanted_ = false;
  std::array<Flight, kFlights> flights_{};
  std::uint64_t last_ = 0;   // transmission
  std::uint64_t first_ = 1;  // transmission that may still be on its way
  std::uint64_t newest_acknowledged_ = 0;
  std::optional<Nanoseconds> round_trip_{};

  // What is sent next, the nearest first.
  std::vector<std::uint32_t> chosen_;
  std::size_t next_chosen_ = 0;
  scene::Point chosen_at_m_ = scene::Point::Zero();

  scene::Point place_m_ = scene::Point::Zero();
  scene::Point velocity_m_per_s_ = scene::Point::Zero();
  scene::Point ahead_m_ = scene::Point::Zero();  // where the device will be
  std::optional<Nanoseconds> last_motion_{};     // device's time
};

}  // namespace forcebound::server
