#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstddef>
#include <cstdint>

#include "forcebound/control/handle.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::ros2 {

using control::Vector;
using time::Nanoseconds;

/// What is published of a tick.
struct StateSample {
  Nanoseconds time{0};  ///< of the reading, by this machine's steady clock
  Vector position{};    ///< [m], a row for each translation; not finite: there was no reading
  Vector joint{};       ///< no rows: not known here
  Vector force_N{};     ///< on the hand
  Vector torque_N_m{};  ///< no rows: the device shows none
  control::Handle handle{};
};

/// Carries samples from the tick to the thread that publishes them: of those that wait the last ten, as DDS keeps them,
/// so that they are not old where that thread is slow. Others are dropped and counted.
///
/// Real time: `push` and `on_tick` are noexcept, allocate nothing and never wait; they wake the other thread. One
/// thread calls them, one other `wait_and_take`, any `close`.
class StateQueue final : public record::TickSink {
 public:
  StateQueue();

  void push(const StateSample& sample) noexcept;

  void on_tick(const record::TickRecord& tick) noexcept override;
  void on_force(const record::ForceRecord& /*force*/) noexcept override {}

  /// Waits for the oldest that is not dropped. False: it was closed, and all are taken.
  [[nodiscard]] bool wait_and_take(StateSample& sample) noexcept;

  /// Nobody pushes any more.
  void close() noexcept;

  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  [[nodiscard]] bool pop_newest(StateSample& sample) noexcept;

  static constexpr std::size_t kKept = 10;
  static constexpr std::size_t kCapacity = 1024;

  boost::lockfree::spsc_queue<StateSample> waiting_{kCapacity};
  std::atomic<std::uint32_t> changes_{0};
  std::atomic<bool> closed_{false};
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace forcebound::ros2
