#pragma once

#include <array>
#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstddef>
#include <cstdint>

#include "forcebound/client/runtime/tick_amendment.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::ros2 {

using time::Nanoseconds;

/// How old the wrenches were that motions were answered with: counted for all, and of each for the tick that applies
/// it, whose record then has the wrench's age, from its arrival on, instead of its answer's. A tick without a wrench
/// has no force.
///
/// Real time: noexcept, no allocation, wait-free. One thread calls `add`, one other is the tick's, and only where both
/// have one clock; the rest is for any.
class AnswerAges final : public client::TickAmendment {
 public:
  struct Answered {
    Nanoseconds device_time{0};  ///< of the motion
    record::ForcePolicy policy = record::ForcePolicy::none;
    Nanoseconds arrival{0};  ///< of the wrench
    Nanoseconds age{0};      ///< then
  };
  void add(const Answered& answered) noexcept;

  void on_force(const record::ForceRecord& force) noexcept override;
  void amend(record::TickRecord& tick) noexcept override;

  using Counts = std::array<std::uint64_t, 4>;  ///< by record::ForcePolicy
  [[nodiscard]] Counts counts() const noexcept;
  /// Of the newest answer.
  [[nodiscard]] record::ForcePolicy newest() const noexcept { return newest_.load(std::memory_order_relaxed); }
  [[nodiscard]] Nanoseconds age() const noexcept { return Nanoseconds{age_.load(std::memory_order_relaxed)}; }

 private:
  static constexpr std::size_t kUnderWay = 1024;

  std::array<std::atomic<std::uint64_t>, 4> counts_{};
  std::atomic<record::ForcePolicy> newest_{record::ForcePolicy::none};
  std::atomic<Nanoseconds::rep> age_{0};
  boost::lockfree::spsc_queue<Answered> under_way_{kUnderWay};
  Answered here_{};  // from here on of the tick: the newest whose answer has arrived, and its motion's number
  std::uint64_t sequence_ = 0;
};

}  // namespace forcebound::ros2
