#include "forcebound/scene/geometry/height_field.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <utility>

#include "forcebound/text/file.hpp"
#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::scene {
namespace {

constexpr std::size_t kHeightsMost = 1U << 24U;

/// What tells one relief from another: "heights_m 3 x 2 from -0.01 to 0.02, hash 1b2c...".
std::string summary(const HeightGrid& grid) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const double height_m : grid.heights_m) hash = (hash ^ std::bit_cast<std::uint64_t>(height_m)) * 0x100000001b3;
  const auto [lowest, highest] = std::ranges::minmax_element(grid.heights_m);
  return "heights_m " + std::to_string(grid.columns) + " x " + std::to_string(grid.heights_m.size() / grid.columns) +
         " from " + text::to_text(*lowest) + " to " + text::to_text(*highest) + ", hash " + std::to_string(hash);
}

/// Height and slopes at a point.
using Relief = Eigen::Vector3d;

class HeightField final : public Shape {
 public:
  explicit HeightField(const HeightGrid& grid)
      : origin_m_(grid.origin_m),
        spacing_m_(grid.spacing_m),
        columns_(grid.columns),
        rows_(grid.heights_m.size() / grid.columns),
        size_m_(spacing_m_ * static_cast<double>(columns_ - 1), spacing_m_ * static_cast<double>(rows_ - 1)),
        text_(summary(grid)) {
    reliefs_.reserve(grid.heights_m.size());
    for (std::size_t row = 0; row < rows_; ++row) {
      for (std::size_t column = 0; column < columns_; ++column) reliefs_.push_back(relief(grid, row, column));
    }
  }

  SurfacePoint nearest(const Point& position_m, std::byte*) const noexcept override {
    const Point from_origin = position_m - origin_m_;
    const Eigen::Vector2d above = from_origin.head<2>().cwiseMax(0).cwiseMin(size_m_);
    const Relief here = relief_at(above);
    const Point normal = Point(-here[1], -here[2], 1).normalized();
    const double depth_m = (here[0] - from_origin.z()) * normal.z();

    Point beyond = Point::Zero();
    beyond.head<2>() = from_origin.head<2>() - above;
    const double beyond_m = beyond.norm();
    if (beyond_m > 0) return beyond_the_rim(beyond / beyond_m, beyond_m, normal, depth_m);
    const SurfacePoint cliff = nearest_cliff(above);
    return cliff.penetration_m < depth_m ? cliff : SurfacePoint{normal, depth_m};
  }

  ShapeGeometry geometry() const override {
    HeightGrid grid{.origin_m = origin_m_, .spacing_m = spacing_m_, .columns = columns_};
    grid.heights_m.reserve(reliefs_.size());
    for (const Relief& relief : reliefs_) grid.heights_m.push_back(relief[0]);
    return {.heights = std::make_shared<const HeightGrid>(std::move(grid))};
  }

  ShapeFacts facts() const override {
    ShapeFacts facts{.memory_bytes = sizeof *this + reliefs_.size() * sizeof(Relief), .cost_ns = 20, .text = text_};
    facts.bounds_m.extend(origin_m_).extend(origin_m_ + Point(size_m_.x(), size_m_.y(), 0));
    for (const Relief& relief : reliefs_) facts.bounds_m.extend(origin_m_ + Point(0, 0, relief[0]));
    return facts;
  }

 private:
  static SurfacePoint beyond_the_rim(const Point& outwards, double beyond_m, const Point& normal, double depth_m) {
    if (depth_m >= 0) return {outwards, -beyond_m};
    return {(beyond_m * outwards - depth_m * normal).normalized(), -std::hypot(beyond_m, depth_m)};
  }

  /// The nearest of the four cliffs, seen from inside.
  [[nodiscard]] SurfacePoint nearest_cliff(const Eigen::Vector2d& above) const noexcept {
    SurfacePoint cliff{Point::UnitX(), size_m_.x() - above.x()};
    const auto nearer = [&cliff](const Point& normal, double depth_m) {
      if (depth_m < cliff.penetration_m) cliff = {normal, depth_m};
    };
    nearer(-Point::UnitX(), above.x());
    nearer(Point::UnitY(), size_m_.y() - above.y());
    nearer(-Point::UnitY(), above.y());
    return cliff;
  }

  /// A point within the rim.
  [[nodiscard]] Relief relief_at(const Eigen::Vector2d& above) const noexcept {
    const double u = above.x() / spacing_m_;
    const double v = above.y() / spacing_m_;
    const std::size_t column = std::min(static_cast<std::size_t>(u), columns_ - 2);
    const std::size_t row = std::min(static_cast<std::size_t>(v), rows_ - 2);
    const double s = u - static_cast<double>(column);
    const double t = v - static_cast<double>(row);
    const Relief* const near = &reliefs_[row * columns_ + column];
    const Relief* const far = near + columns_;
    return (1 - t) * ((1 - s) * near[0] + s * near[1]) + t * ((1 - s) * far[0] + s * far[1]);
  }

  /// At a point of the grid: slopes by central differences, one-sided at the rim.
  [[nodiscard]] Relief relief(const HeightGrid& grid, std::size_t row, std::size_t column) const {
    const auto height_m = [&](std::size_t r, std::size_t c) { return grid.heights_m[r * columns_ + c]; };
    const std::size_t left = column - (column > 0 ? 1 : 0);
    const std::size_t right = column + (column + 1 < columns_ ? 1 : 0);
    const std::size_t before = row - (row > 0 ? 1 : 0);
    const std::size_t behind = row + (row + 1 < rows_ ? 1 : 0);
    return {
        height_m(row, column),
        (height_m(row, right) - height_m(row, left)) / (spacing_m_ * static_cast<double>(right - left)),
        (height_m(behind, column) - height_m(before, column)) / (spacing_m_ * static_cast<double>(behind - before))};
  }

  Point origin_m_;
  double spacing_m_;
  std::size_t columns_;
  std::size_t rows_;
  Eigen::Vector2d size_m_;
  std::vector<Relief> reliefs_;
  std::string text_;
};

config::Rows read_rows(const std::string& path) {
  std::istringstream text(text::read_file(path));
  text::LineReader reader(text, path);
  config::Rows rows;
  while (reader.next()) {
    if (reader.line().empty()) continue;
    std::vector<double>& row = rows.emplace_back();
    for (const std::string_view field : text::split(reader.line(), ',')) {
      const std::optional<double> number = text::finite_number(field);
      if (!number) reader.refuse("must have finite numbers only, got '" + std::string(field) + "'");
      row.push_back(*number);
    }
    if (row.size() == rows.front().size()) continue;
    reader.refuse("must have " + std::to_string(rows.front().size()) + " numbers like the first, got " +
                  std::to_string(row.size()));
  }
  return rows;
}

config::Rows rows_of(const config::Values& values, const ShapePurpose& purpose) {
  if (values.has("heights_m")) return values.rows("heights_m");
  try {
    return read_rows((std::filesystem::path(purpose.folder) / values.text("file")).string());
  } catch (const std::runtime_error& error) {
    throw config::ValueError("file", "file: " + std::string(error.what()));
  }
}

std::unique_ptr<Shape> make_relief(const config::Values& values, const ShapePurpose& purpose) {
  if (purpose.geometry.heights) return make_height_field(*purpose.geometry.heights);
  if (values.has("heights_m") == values.has("file")) {
    throw std::invalid_argument("a height_field needs either 'heights_m' or 'file'");
  }
  const config::Rows rows = rows_of(values, purpose);
  const char* const source = values.has("file") ? "file" : "heights_m";
  if (rows.size() < 2 || rows.front().size() < 2) {
    throw config::ValueError(source, "a height_field needs at least 2 rows of 2 numbers");
  }
  HeightGrid grid{
      .origin_m = values.point("origin_m"), .spacing_m = values.number("spacing_m"), .columns = rows.front().size()};
  if (rows.size() * grid.columns > kHeightsMost) {
    throw config::ValueError(source, "a height_field has at most " + std::to_string(kHeightsMost) + " heights");
  }
  for (const std::vector<double>& row : rows) grid.heights_m.insert(grid.heights_m.end(), row.begin(), row.end());
  return make_height_field(grid);
}

}  // namespace

std::unique_ptr<Shape> make_height_field(const HeightGrid& grid) { return std::make_unique<HeightField>(grid); }

ShapeKind height_field_shape() {
  return {.name = "height_field",
          .description =
              "A relief over a grid, solid below; 3 axes. Its heights stand in the scene or in a file, one of the two.",
          .axes_least = 3,
          .geometry = GeometryKind::heights,
          .parameters = {place_parameter("origin_m", "of the first height's column"),
                         positive_length("spacing_m", "of the grid, along x and y"),
                         config::RowsParameter{.key = "heights_m",
                                               .meaning = "rows follow each other along y, their numbers along x",
                                               .absent = "read from `file`"},
                         config::TextParameter{.key = "file",
                                               .meaning = "the same, separated by commas, one row to a line",
                                               .form = config::TextParameter::Form::file,
                                               .absent = "`heights_m`"}},
          .make = make_relief};
}

}  // namespace forcebound::scene
