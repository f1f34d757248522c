#include "forcebound/client/commands/doctor/sleep_states.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::client::commands {
namespace {

namespace fs = std::filesystem;

/// The number behind a prefix: 12 of "cpu12". Nothing of "cpuidle".
std::optional<std::uint32_t> index_behind(std::string_view name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return std::nullopt;
  return text::whole_number<std::uint32_t>(name.substr(prefix.size()));
}

/// The first line; empty if there is none.
std::string first_line_of(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return std::string(text::trimmed(line));
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    entries.push_back(entry->path());
  return entries;
}

}  // namespace

std::vector<SleepState> read_sleep_states(const fs::path& processors) {
  std::map<std::uint32_t, SleepState> by_depth;
  for (const fs::path& processor : entries_of(processors)) {
    if (!index_behind(processor.filename().string(), "cpu")) continue;
    for (const fs::path& folder : entries_of(processor / "cpuidle")) {
      const auto depth = index_behind(folder.filename().string(), "state");
      if (!depth) continue;
      SleepState& state = by_depth[*depth];
      state.name = text::printable(first_line_of(folder / "name"));
      const double latency_us = text::finite_number(first_line_of(folder / "latency")).value_or(0);
      state.exit_latency_us = std::max(state.exit_latency_us, latency_us);
      state.enabled = state.enabled || first_line_of(folder / "disable") != "1";
    }
  }
  std::vector<SleepState> states;
  states.reserve(by_depth.size());
  for (auto& [depth, state] : by_depth) states.push_back(std::move(state));
  return states;
}

double longest_exit_latency_us(const std::vector<SleepState>& states) noexcept {
  double longest_us = 0;
  for (const SleepState& state : states) {
    if (state.enabled) longest_us = std::max(longest_us, state.exit_latency_us);
  }
  return longest_us;
}

}  // namespace forcebound::client::commands
