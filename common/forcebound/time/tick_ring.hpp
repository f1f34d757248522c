#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "forcebound/time/clock.hpp"

namespace forcebound::time {

/// The newest ticks, each with its time. Real time.
template <class Tick, std::size_t kMost>
class TickRing {
 public:
  void push(const Tick& tick) noexcept { ticks_[count_++ % kMost] = tick; }

  [[nodiscard]] std::size_t size() const noexcept { return std::min(count_, kMost); }

  /// @param ago 0: the newest; below size()
  [[nodiscard]] const Tick& at(std::size_t ago) const noexcept { return ticks_[(count_ - 1 - ago) % kMost]; }

  /// How many of them were later: so long ago is the newest that was not, if it is below size().
  [[nodiscard]] std::size_t later_than(Nanoseconds moment) const noexcept {
    std::size_t later = 0;
    while (later < size() && at(later).time > moment) ++later;
    return later;
  }

 private:
  std::array<Tick, kMost> ticks_{};
  std::size_t count_ = 0;  // of all that there were
};

}  // namespace forcebound::time
