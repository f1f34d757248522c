#include "forcebound/text/names.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace forcebound::text {
namespace {

// Letters to insert, remove or change (Levenshtein).
std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0U : 1U);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

bool is_beginning_of(std::string_view wrong, std::string_view right) {
  return wrong.size() >= 3 && right.starts_with(wrong);
}

}  // namespace

std::string join(std::span<const std::string> names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string nearest_name(std::string_view wrong, std::span<const std::string> known) {
  const std::string* nearest = nullptr;
  // With more than half of the letters wrong it is another word, not a misspelling.
  std::size_t fewest = wrong.size() / 2 + 1;
  for (const std::string& name : known) {
    // The most common mistake is a missing unit: "damping" for "damping_N_s_per_m".
    const std::size_t count = is_beginning_of(wrong, name) ? 0 : edits(wrong, name);
    if (count >= fewest) continue;
    fewest = count;
    nearest = &name;
  }
  return nearest == nullptr ? "" : *nearest;
}

bool is_slip_of(std::string_view wrong, std::string_view right) {
  return wrong != right && (is_beginning_of(wrong, right) || edits(wrong, right) <= 2);
}

std::string suggestion(std::string_view wrong, std::span<const std::string> known) {
  if (known.empty()) return "; there are none";
  const std::string nearest = nearest_name(wrong, known);
  return (nearest.empty() ? "" : ", did you mean '" + nearest + "'?") + " (known: " + join(known) + ")";
}

}  // namespace forcebound::text
