#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>

#include "forcebound/page/json_number.hpp"

namespace forcebound::page {

/// A value of a label in the text format of Prometheus, with its quotes.
[[nodiscard]] inline std::string label_value(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '\\' || c == '"') quoted += '\\';
    quoted += c == '\n' ? ' ' : c;
  }
  return quoted + '"';
}

/// Counts of durations up to edges from a microsecond to ten seconds, for a histogram of Prometheus. All have the same
/// edges, so that those of several servers can be added.
///
/// Real time: `add` is noexcept and allocates nothing.
class DurationHistogram {
 public:
  static constexpr std::array<double, 22> kEdges_s{1e-6, 2.5e-6, 5e-6,   1e-5, 2.5e-5, 5e-5,   1e-4, 2.5e-4,
                                                   5e-4, 1e-3,   2.5e-3, 5e-3, 1e-2,   2.5e-2, 5e-2, 0.1,
                                                   0.25, 0.5,    1,      2.5,  5,      10};

  void add(double duration_s) noexcept {
    const auto edge = std::ranges::lower_bound(kEdges_s, duration_s);
    ++counts_[static_cast<std::size_t>(std::distance(kEdges_s.begin(), edge))];
    sum_s_ += duration_s;
  }

  /// Adds the lines NAME_bucket, NAME_sum and NAME_count. @param labels such as `scene="wall"`
  void write(std::string& to, const std::string& name, const std::string& labels) const {
    constexpr int kDigits = 12;
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      below += counts_[i];
      to.append(name).append("_bucket{").append(labels).append(",le=\"");
      if (i < kEdges_s.size()) {
        add_number(to, kEdges_s[i]);
      } else {
        to += "+Inf";
      }
      to += "\"} " + std::to_string(below) + "\n";
    }
    to += name + "_sum{" + labels + "} ";
    add_number(to, sum_s_, kDigits);
    to += "\n" + name + "_count{" + labels + "} " + std::to_string(below) + "\n";
  }

 private:
  std::array<std::uint64_t, kEdges_s.size() + 1> counts_{};  // the last: above all edges
  double sum_s_ = 0;
};

}  // namespace forcebound::page
