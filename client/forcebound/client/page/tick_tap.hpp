#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>

#include "forcebound/control/follower_state.hpp"
#include "forcebound/control/handle.hpp"
#include "forcebound/live/record_tap.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// x, y and z of a position [m] or force [N]; zero on axes that the device lacks.
using Axes = std::array<float, 3>;

/// What a page shows of a tick.
struct TickSample {
  time::Nanoseconds time{0};
  time::Nanoseconds interval{0};
  time::Nanoseconds latency{0};
  time::Nanoseconds age{0};
  std::uint64_t motion_sequence = 0;
  std::uint64_t force_sequence = 0;
  Axes position_m{};
  Axes place_m{};  ///< where the force asked for was computed for
  Axes asked_N{};
  Axes applied_N{};
  Axes applied_torque_N_m{};  ///< on the handle
  control::Handle::Orientation orientation{1, 0, 0, 0};
  double ledger_J = 0;
  double audit_J = 0;
  double audit_minimum_J = 0;
  record::SessionState state = record::SessionState::connecting;
  bool contact = false;
  bool has_place = false;
  bool has_orientation = false;
  bool usable = false;  ///< the device gave a reading
};

/// What a page shows of an answer of the server.
struct ForceSample {
  std::uint64_t session = 0;
  std::uint64_t sequence = 0;
  std::uint64_t motion_sequence = 0;
  std::uint64_t motions_received = 0;
  time::Nanoseconds received{0};
  time::Nanoseconds round_trip{0};
  time::Nanoseconds at_server{0};
  Axes surface_m{};  ///< a point of the surface touched
  Axes normal{};
  bool contact = false;
  control::FollowerState follower = control::FollowerState::none;
};

/// What a page shows of the ticks and answers of one client, in their order. Real time: noexcept, no allocation.
class Sampler {
 public:
  [[nodiscard]] TickSample sample(const record::TickRecord& tick) const noexcept;
  [[nodiscard]] ForceSample sample(const record::ForceRecord& record) noexcept;

 private:
  Axes place_m_{};  // of the newest answer
  bool has_place_ = false;
};

/// Carries ticks and answers to the thread of a page. A full queue drops them and counts: about 4 s fit.
///
/// Real time: the `on_` functions are noexcept, allocate nothing and never wait. One thread calls them, one other
/// thread `drain`.
class TickTap final : public record::TickSink {
 public:
  static constexpr std::size_t kCapacity = 4096;

  explicit TickTap(std::size_t capacity = kCapacity);
  ~TickTap() override;

  void on_tick(const record::TickRecord& tick) noexcept override;
  void on_force(const record::ForceRecord& force) noexcept override;

  /// Calls `forces` for the answers that wait, then `ticks` for the ticks, each in their order.
  void drain(const std::function<void(const ForceSample&)>& forces,
             const std::function<void(const TickSample&)>& ticks);

  /// All of each tick and answer, for viewers that speak Foxglove's protocol.
  [[nodiscard]] live::RecordTap& records() noexcept { return records_; }

  /// Whether the tip touched something at the newest tick. Any thread.
  [[nodiscard]] bool touches() const noexcept { return touches_.load(std::memory_order_relaxed); }

  /// Any thread.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  struct Queues;

  std::unique_ptr<Queues> queues_;
  Sampler sampler_;  // of the tick's thread
  live::RecordTap records_;
  std::atomic<bool> touches_{false};
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace forcebound::client
