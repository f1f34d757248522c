#include "forcebound/server/scene/height_field_parser.hpp"

#include <algorithm>
#include <bit>
#include <optional>
#include <stdexcept>

#include "forcebound/server/geometry/height_field.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

constexpr std::size_t kHeightsMax = 1U << 24U;

/// Takes rows of heights; whatever is wrong with them is an error at `where`.
class Rows {
 public:
  Rows(const CheckedTable& table, const toml::node& where, HeightGrid& grid)
      : table_(table), where_(where), grid_(grid) {}

  /// @param place of the row, for errors
  void add(const std::vector<double>& row, const std::string& place) {
    if (grid_.columns == 0) grid_.columns = row.size();
    if (row.size() != grid_.columns) {
      fail(place + " must have " + std::to_string(grid_.columns) + " numbers like the first, got " +
           std::to_string(row.size()));
    }
    if (grid_.heights_m.size() + row.size() > kHeightsMax) {
      fail("more than " + std::to_string(kHeightsMax) + " heights");
    }
    grid_.heights_m.insert(grid_.heights_m.end(), row.begin(), row.end());
  }

  void finish() const {
    if (grid_.columns >= 2 && grid_.heights_m.size() >= 2 * grid_.columns) return;
    fail("a height field needs at least 2 rows of 2 numbers");
  }

  [[noreturn]] void fail(const std::string& what) const { table_.fail(where_, what); }

 private:
  const CheckedTable& table_;
  const toml::node& where_;
  HeightGrid& grid_;
};

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t begin = std::min(text.find_first_not_of(kBlank), text.size());
  return text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

std::string read_file(const CheckedTable& table, const toml::node& where, const std::string& path) try {
  return text::read_file(path);
} catch (const std::runtime_error& error) {
  table.fail(where, "file: " + std::string(error.what()));
}

void read_file_rows(CheckedTable& table, HeightGrid& grid) {
  const toml::node& where = table.at("file");
  const std::string path = table.path("file");
  const std::string text = read_file(table, where, path);
  Rows rows(table, where, grid);
  std::size_t line = 0;
  for (const std::string_view row : split(text, '\n')) {
    const std::string place = "file: " + path + ":" + std::to_string(++line) + ":";
    if (trimmed(row).empty()) continue;
    std::vector<double> numbers;
    for (const std::string_view field : split(row, ',')) {
      const std::optional<double> number = text::finite_number(trimmed(field));
      if (!number) rows.fail(place + " must have finite numbers only, got '" + std::string(trimmed(field)) + "'");
      numbers.push_back(*number);
    }
    rows.add(numbers, place);
  }
  rows.finish();
}

void read_inline_rows(CheckedTable& table, HeightGrid& grid) {
  const toml::array& list = table.array("heights_m");
  Rows rows(table, list, grid);
  std::size_t row = 0;
  for (const toml::node& node : list) {
    const std::string place = "row " + std::to_string(++row) + " of heights_m";
    if (!node.is_array()) table.fail(node, place + " must be a list, got " + as_written(node));
    std::vector<double> numbers;
    for (const toml::node& height : *node.as_array()) numbers.push_back(table.finite(height, place));
    rows.add(numbers, place);
  }
  rows.finish();
}

/// What tells one relief from another: "3 x 2 from -0.01 to 0.02, hash 1b2c...".
std::string summary(const HeightGrid& grid) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const double height_m : grid.heights_m) hash = (hash ^ std::bit_cast<std::uint64_t>(height_m)) * 0x100000001b3;
  const auto [lowest, highest] = std::minmax_element(grid.heights_m.begin(), grid.heights_m.end());
  return std::to_string(grid.columns) + " x " + std::to_string(grid.heights_m.size() / grid.columns) + " from " +
         text::to_text(*lowest) + " to " + text::to_text(*highest) + ", hash " + std::to_string(hash);
}

}  // namespace

std::unique_ptr<Shape> parse_height_field(CheckedTable& table, Eigen::Index rows) {
  HeightGrid grid{.origin_m = table.point("origin_m", rows),
                  .spacing_m = table.number({.key = "spacing_m", .preset = {}, .least = 0, .least_excluded = true})};
  const toml::node* const is_inline = table.find("heights_m");
  const toml::node* const is_file = table.find("file");
  if ((is_inline == nullptr) == (is_file == nullptr)) {
    table.fail("a height_field needs either 'heights_m' or 'file'");
  }
  if (is_inline != nullptr) {
    read_inline_rows(table, grid);
  } else {
    read_file_rows(table, grid);
  }
  table.note("heights_m", summary(grid));
  return make_height_field(grid);
}

}  // namespace forcebound::server
