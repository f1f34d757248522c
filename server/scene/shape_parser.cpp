#include "forcebound/server/scene/shape_parser.hpp"

#include <array>
#include <limits>

#include "forcebound/text/names.hpp"

namespace forcebound::server {
namespace {

using Shaped = std::unique_ptr<Shape>;

double parse_radius(CheckedTable& table) {
  return table.number({.key = "radius_m", .preset = {}, .least = 0, .least_excluded = true});
}

Shaped parse_half_space(CheckedTable& table, Eigen::Index rows) {
  const Point through_m = table.point("through_m", rows);
  const Point normal = table.point("normal", rows);
  if (normal.isZero(0)) table.fail("normal must not be zero");
  return make_half_space(through_m, normal);
}

Shaped parse_sphere(CheckedTable& table, Eigen::Index rows) {
  const Point center_m = table.point("center_m", rows);
  return make_sphere(center_m, parse_radius(table));
}

Shaped parse_cavity(CheckedTable& table, Eigen::Index rows) {
  const Point center_m = table.point("center_m", rows);
  return make_cavity(center_m, parse_radius(table));
}

Shaped parse_box(CheckedTable& table, Eigen::Index rows) {
  const Point center_m = table.point("center_m", rows);
  const Point size_m = table.point("size_m", rows, std::numeric_limits<double>::infinity());
  if (!(size_m.minCoeff() > 0)) {
    table.fail(table.at("size_m"), "size_m must be > 0 on every axis, got " + as_written(table.at("size_m")));
  }
  return make_box(center_m, size_m);
}

struct ShapeKind {
  std::string_view name;
  Shaped (*parse)(CheckedTable&, Eigen::Index rows);
};

constexpr std::array kKinds{ShapeKind{"half_space", parse_half_space}, ShapeKind{"sphere", parse_sphere},
                            ShapeKind{"cavity", parse_cavity}, ShapeKind{"box", parse_box}};

}  // namespace

std::unique_ptr<Shape> parse_shape(CheckedTable& table, Eigen::Index rows) {
  const std::string name = table.text("kind");
  std::vector<std::string> known;
  for (const ShapeKind& kind : kKinds) {
    if (kind.name == name) return kind.parse(table, rows);
    known.emplace_back(kind.name);
  }
  table.fail(table.at("kind"), "unknown kind '" + name + "'" + text::suggestion(name, known));
}

}  // namespace forcebound::server
