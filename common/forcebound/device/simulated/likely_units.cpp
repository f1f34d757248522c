#include "forcebound/device/simulated/likely_units.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "forcebound/text/numbers.hpp"

namespace forcebound::device {
namespace {

constexpr std::size_t kIntervalsKept = 1000;

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void RecordedPace::add_row(double interval_s, double distance_m) {
  if (intervals_s_.size() < kIntervalsKept) intervals_s_.push_back(interval_s);
  if (interval_s > 0 && distance_m / interval_s > speed_m_per_s_max_) speed_m_per_s_max_ = distance_m / interval_s;
}

std::string RecordedPace::doubt_of_units() const {
  constexpr double kFastHand_m_per_s = 3;
  constexpr double kAbout = 0.9;  // rows do not come exactly on time
  constexpr std::array<std::pair<double, const char*>, 3> kTooLong{{{1e9, "ns"}, {1e6, "us"}, {1e3, "ms"}}};
  const double interval_s = median_of(intervals_s_);
  const double periods = interval_s / period_s_;
  const auto rows = [&](const std::string& question) {
    return "has rows " + text::rounded(interval_s) + " s apart, " + text::rounded(periods) + " times the period of " +
           text::rounded(period_s_) + " s: " + question;
  };
  for (const auto& [ratio, unit] : kTooLong) {
    if (periods >= kAbout * ratio) return rows("are its times in " + std::string(unit) + "?");
  }
  if (periods > 0 && periods <= 1e-3 / kAbout) return rows("are its times in 1000 s, or is the period in ms?");
  if (speed_m_per_s_max_ < kFastHand_m_per_s) return {};
  return "moves at up to " + text::rounded(speed_m_per_s_max_) + " m/s: are its positions in mm?";
}

}  // namespace forcebound::device
