#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/client/page/tick_tap.hpp"
#include "forcebound/record/run_info.hpp"

namespace forcebound::client::commands {

/// A client's recording as a page shows it, in memory: some 250 bytes a tick.
struct Recorded {
  /// More are left out: half an hour at 1 kHz, in half a gigabyte.
  static constexpr std::size_t kTicksMost = 2'000'000;

  record::RunInfo info;
  std::optional<record::RunTotals> totals{};  ///< none: it was cut off
  int degrees_of_freedom = 3;                 ///< of the positions
  std::vector<client::TickSample> ticks;      ///< at least one
  std::vector<client::ForceSample> forces;
  std::string flaw{};  ///< in one line, why not all is shown; empty: it is

  [[nodiscard]] double duration_s() const noexcept;
  /// As the server named it, else as it was asked for; empty: not known.
  [[nodiscard]] const std::string& scene() const noexcept;
};

/// Reads as much of the file as there is: of a damaged one what comes before the damage.
/// @throws std::runtime_error with one line if there is no tick of a client before that
[[nodiscard]] Recorded read_recorded(const std::filesystem::path& file);

}  // namespace forcebound::client::commands
