#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace forcebound::client::commands {

/// A sleep state that the system may put idle processors into (Linux's cpuidle).
struct SleepState {
  std::string name;            ///< POLL, C1, C6, ...
  double exit_latency_us = 0;  ///< until a processor in it works again, the longest of all processors
  bool enabled = false;        ///< on one processor at least
};

/// The states of all processors, in the order of their depth; none where the system does not tell, as on many virtual
/// machines. @param processors the folder /sys/devices/system/cpu
[[nodiscard]] std::vector<SleepState> read_sleep_states(const std::filesystem::path& processors);

/// The longest time [us] that an enabled one of them takes; 0 without any.
[[nodiscard]] double longest_exit_latency_us(const std::vector<SleepState>& states) noexcept;

}  // namespace forcebound::client::commands
