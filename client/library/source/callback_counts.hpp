#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

#include "forcebound/time/steady_clock.hpp"

namespace forcebound::library {

/// Calls a program's callbacks as if they could do anything but end the process, and counts those that failed, threw or
/// took longer than kLate. The counts are for any thread.
class CallbackCounts {
 public:
  static constexpr time::Nanoseconds kLate = std::chrono::milliseconds{10};

  struct Called {
    bool done = false;  ///< it said so
    bool threw = false;
    bool late = false;
  };

  /// @param call gives whether the callback did what it was asked for
  template <class Call>
  Called call(Call&& call) noexcept {
    const time::Nanoseconds began = clock_.now();
    Called called;
    try {
      called.done = std::forward<Call>(call)();
    } catch (...) {
      called.threw = true;
    }
    if (!called.done) failed_.fetch_add(1, std::memory_order_relaxed);
    called.late = clock_.now() - began > kLate;
    if (called.late) late_.fetch_add(1, std::memory_order_relaxed);
    return called;
  }

  [[nodiscard]] std::uint64_t failed() const noexcept { return failed_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t late() const noexcept { return late_.load(std::memory_order_relaxed); }

 private:
  time::SteadyClock clock_;
  std::atomic<std::uint64_t> failed_{0};
  std::atomic<std::uint64_t> late_{0};
};

}  // namespace forcebound::library
