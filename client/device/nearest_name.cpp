#include "forcebound/client/device/nearest_name.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace forcebound::client {
namespace {

// Insertions, deletions and substitutions that lead from one word to the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(std::string_view wrong, std::span<const std::string> known) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, wrong.size() / 2);
  for (const std::string& name : known) {
    // A unit left out is the commonest slip: "damping" for "damping_N_s_per_m".
    const bool beginning = wrong.size() >= 3 && name.starts_with(wrong);
    const std::size_t distance = beginning ? 0 : edit_distance(wrong, name);
    if (distance >= least && !(distance == 0)) continue;
    least = distance;
    best = name;
  }
  return best;
}

std::string suggestion(std::string_view wrong, std::span<const std::string> known) {
  const std::string nearest = nearest_name(wrong, known);
  std::string text = nearest.empty() ? "" : "did you mean '" + nearest + "'? ";
  text += "Known:";
  for (const std::string& name : known) text += " " + name;
  return text;
}

}  // namespace forcebound::client
