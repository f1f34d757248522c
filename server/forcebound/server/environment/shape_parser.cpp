#include "forcebound/server/environment/shape_parser.hpp"

#include <array>
#include <limits>

#include "forcebound/scene/geometry/capsule.hpp"
#include "forcebound/scene/geometry/cylinder.hpp"
#include "forcebound/scene/geometry/torus.hpp"
#include "forcebound/server/environment/height_field_parser.hpp"
#include "forcebound/server/environment/mesh_parser.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::server {
namespace {

using Shaped = std::unique_ptr<scene::Shape>;

double parse_radius(CheckedTable& table, std::string_view key = "radius_m") {
  return table.number({.key = key, .preset = {}, .least = 0, .least_excluded = true});
}

Shaped parse_half_space(CheckedTable& table, Eigen::Index rows) {
  const scene::Point through_m = table.point("through_m", rows);
  const scene::Point normal = table.point("normal", rows);
  if (normal.isZero(0)) table.fail("normal must not be zero");
  return scene::make_half_space(through_m, normal);
}

Shaped parse_sphere(CheckedTable& table, Eigen::Index rows) {
  const scene::Point center_m = table.point("center_m", rows);
  return scene::make_sphere(center_m, parse_radius(table));
}

Shaped parse_cavity(CheckedTable& table, Eigen::Index rows) {
  const scene::Point center_m = table.point("center_m", rows);
  return scene::make_cavity(center_m, parse_radius(table));
}

Shaped parse_box(CheckedTable& table, Eigen::Index rows) {
  const scene::Point center_m = table.point("center_m", rows);
  const scene::Point size_m = table.point("size_m", rows, std::numeric_limits<double>::infinity());
  if (!(size_m.minCoeff() > 0)) {
    table.fail(table.at("size_m"), "size_m must be > 0 on every axis, got " + as_written(table.at("size_m")));
  }
  return scene::make_box(center_m, size_m);
}

/// Of a shape between two points: `make` is given them and the radius.
template <class Make>
Shaped parse_along(CheckedTable& table, Eigen::Index rows, Make make) {
  const scene::Point from_m = table.point("from_m", rows);
  const scene::Point to_m = table.point("to_m", rows);
  if (from_m == to_m) table.fail(table.at("to_m"), "to_m must differ from from_m, got " + as_written(table.at("to_m")));
  return make(from_m, to_m, parse_radius(table));
}

Shaped parse_capsule(CheckedTable& table, Eigen::Index rows) { return parse_along(table, rows, scene::make_capsule); }

Shaped parse_cylinder(CheckedTable& table, Eigen::Index rows) { return parse_along(table, rows, scene::make_cylinder); }

Shaped parse_torus(CheckedTable& table, Eigen::Index rows) {
  const scene::Point center_m = table.point("center_m", rows);
  const scene::Point axis = table.direction("axis", rows);
  const double major_m = parse_radius(table, "major_radius_m");
  const double minor_m = parse_radius(table, "minor_radius_m");
  if (!(minor_m < major_m)) {
    table.fail(table.at("minor_radius_m"),
               "minor_radius_m must be < major_radius_m, got " + as_written(table.at("minor_radius_m")));
  }
  return scene::make_torus(center_m, axis, major_m, minor_m);
}

struct ShapeKind {
  std::string_view name;
  Shaped (*parse)(CheckedTable&, Eigen::Index rows, double reach_m);
  Eigen::Index rows_least = 1;  ///< on fewer axes it has no meaning
};

template <Shaped (*parse)(CheckedTable&, Eigen::Index)>
Shaped always_exact(CheckedTable& table, Eigen::Index rows, double) {
  return parse(table, rows);
}

template <Shaped (*parse)(CheckedTable&, double)>
Shaped in_space(CheckedTable& table, Eigen::Index, double reach_m) {
  return parse(table, reach_m);
}

constexpr std::array kShapeKinds{
    ShapeKind{"half_space", always_exact<parse_half_space>},         //
    ShapeKind{"sphere", always_exact<parse_sphere>},                 //
    ShapeKind{"cavity", always_exact<parse_cavity>},                 //
    ShapeKind{"box", always_exact<parse_box>},                       //
    ShapeKind{"capsule", always_exact<parse_capsule>, 2},            //
    ShapeKind{"cylinder", always_exact<parse_cylinder>, 2},          //
    ShapeKind{"torus", always_exact<parse_torus>, 3},                //
    ShapeKind{"height_field", always_exact<parse_height_field>, 3},  //
    ShapeKind{"mesh", in_space<parse_mesh>, 3},                      //
    ShapeKind{"distance_field", in_space<parse_distance_field>, 3},  //
    ShapeKind{"lathe", in_space<parse_lathe>, 3},                    //
};

}  // namespace

std::unique_ptr<scene::Shape> parse_shape(CheckedTable& table, Eigen::Index rows, double reach_m) {
  const std::string name = table.text("kind");
  std::vector<std::string> known;
  for (const ShapeKind& kind : kShapeKinds) {
    known.emplace_back(kind.name);
    if (kind.name != name) continue;
    if (rows >= kind.rows_least) return kind.parse(table, rows, reach_m);
    table.fail(table.at("kind"), "a " + name + " needs a scene of at least " + std::to_string(kind.rows_least) +
                                     " degrees of freedom, this one has " + std::to_string(rows));
  }
  table.fail(table.at("kind"), "unknown kind '" + name + "'" + text::suggestion(name, known));
}

}  // namespace forcebound::server
