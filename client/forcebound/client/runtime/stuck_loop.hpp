#pragma once

#include <cstdint>

namespace forcebound::client {

/// Finds that a loop does not go on any more, as when a driver does not return from a call. It counts its own looks,
/// not the clock, so that a process that was stopped by the system for a while is not taken for that.
class StuckLoop {
 public:
  /// @param looks so many in a row without progress, at least 1
  explicit StuckLoop(int looks) : looks_(looks) {}

  /// @param rounds of the loop so far; 0: it has not begun @returns whether it is stuck
  bool update(std::uint64_t rounds) noexcept {
    without_progress_ = rounds == 0 || rounds != rounds_ ? 0 : without_progress_ + 1;
    rounds_ = rounds;
    return without_progress_ >= looks_;
  }

 private:
  int looks_;
  int without_progress_ = 0;
  std::uint64_t rounds_ = 0;
};

}  // namespace forcebound::client
