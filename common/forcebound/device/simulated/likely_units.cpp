#include "forcebound/device/simulated/likely_units.hpp"

#include <array>
#include <utility>

#include "forcebound/text/numbers.hpp"

namespace forcebound::device {

std::string doubt_of_units(const RecordedPace& pace) {
  constexpr double kFastHand_m_per_s = 3;
  constexpr double kAbout = 0.9;  // rows do not come exactly on time
  constexpr std::array<std::pair<double, const char*>, 3> kTooLong{{{1e9, "ns"}, {1e6, "us"}, {1e3, "ms"}}};
  const double periods = pace.interval_s / pace.period_s;
  const auto rows = [&](const std::string& question) {
    return "has rows " + text::rounded(pace.interval_s) + " s apart, " + text::rounded(periods) +
           " times the period of " + text::rounded(pace.period_s) + " s: " + question;
  };
  for (const auto& [ratio, unit] : kTooLong) {
    if (periods >= kAbout * ratio) return rows("are its times in " + std::string(unit) + "?");
  }
  if (periods > 0 && periods <= 1e-3 / kAbout) return rows("are its times in 1000 s, or is the period in ms?");
  if (pace.speed_m_per_s_max < kFastHand_m_per_s) return {};
  return "moves at up to " + text::rounded(pace.speed_m_per_s_max) + " m/s: are its positions in mm?";
}

}  // namespace forcebound::device
