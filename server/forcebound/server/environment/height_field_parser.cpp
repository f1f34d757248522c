#include "forcebound/server/environment/height_field_parser.hpp"

#include <algorithm>
#include <bit>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "forcebound/scene/geometry/height_field.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

constexpr std::size_t kHeightsMax = 1U << 24U;

/// Adds a row, or says what is wrong with it.
std::optional<std::string> add_row(scene::HeightGrid& grid, const std::vector<double>& row) {
  if (grid.columns == 0) grid.columns = row.size();
  if (row.size() != grid.columns) {
    return "must have " + std::to_string(grid.columns) + " numbers like the first, got " + std::to_string(row.size());
  }
  if (grid.heights_m.size() + row.size() > kHeightsMax) {
    return "is one too many: at most " + std::to_string(kHeightsMax) + " heights";
  }
  grid.heights_m.insert(grid.heights_m.end(), row.begin(), row.end());
  return {};
}

void read_file_rows(CheckedTable& table, const toml::node& where, scene::HeightGrid& grid) try {
  const std::string path = table.path("file");
  std::istringstream text(text::read_file(path));
  text::LineReader reader(text, path);
  while (reader.next()) {
    if (reader.line().empty()) continue;
    std::vector<double> row;
    for (const std::string_view field : text::split(reader.line(), ',')) {
      const std::optional<double> number = text::finite_number(field);
      if (!number) reader.refuse("must have finite numbers only, got '" + std::string(field) + "'");
      row.push_back(*number);
    }
    if (const auto wrong = add_row(grid, row)) reader.refuse(*wrong);
  }
} catch (const SceneError&) {
  throw;
} catch (const std::runtime_error& error) {
  table.fail(where, "file: " + std::string(error.what()));
}

void read_inline_rows(CheckedTable& table, scene::HeightGrid& grid) {
  const toml::array& list = table.array("heights_m");
  std::size_t count = 0;
  for (const toml::node& node : list) {
    const std::string place = "row " + std::to_string(++count) + " of heights_m";
    if (!node.is_array()) table.fail(node, place + " must be a list, got " + as_written(node));
    std::vector<double> row;
    for (const toml::node& height : *node.as_array()) row.push_back(table.finite(height, place));
    if (const auto wrong = add_row(grid, row)) table.fail(node, place + " " + *wrong);
  }
}

/// What tells one relief from another: "3 x 2 from -0.01 to 0.02, hash 1b2c...".
std::string summary(const scene::HeightGrid& grid) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const double height_m : grid.heights_m) hash = (hash ^ std::bit_cast<std::uint64_t>(height_m)) * 0x100000001b3;
  const auto [lowest, highest] = std::minmax_element(grid.heights_m.begin(), grid.heights_m.end());
  return std::to_string(grid.columns) + " x " + std::to_string(grid.heights_m.size() / grid.columns) + " from " +
         text::to_text(*lowest) + " to " + text::to_text(*highest) + ", hash " + std::to_string(hash);
}

}  // namespace

std::unique_ptr<scene::Shape> parse_height_field(CheckedTable& table, Eigen::Index rows) {
  scene::HeightGrid grid{
      .origin_m = table.point("origin_m", rows),
      .spacing_m = table.number({.key = "spacing_m", .preset = {}, .least = 0, .least_excluded = true})};
  const toml::node* const is_inline = table.find("heights_m");
  const toml::node* const is_file = table.find("file");
  if ((is_inline == nullptr) == (is_file == nullptr)) {
    table.fail("a height_field needs either 'heights_m' or 'file'");
  }
  if (is_inline != nullptr) {
    read_inline_rows(table, grid);
  } else {
    read_file_rows(table, *is_file, grid);
  }
  if (grid.columns < 2 || grid.heights_m.size() < 2 * grid.columns) {
    table.fail(is_inline != nullptr ? *is_inline : *is_file, "a height_field needs at least 2 rows of 2 numbers");
  }
  table.note("heights_m", summary(grid));
  return scene::make_height_field(grid);
}

}  // namespace forcebound::server
