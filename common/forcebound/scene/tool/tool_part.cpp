#include "forcebound/scene/tool/tool_part.hpp"

#include "forcebound/scene/geometry/capsule.hpp"
#include "forcebound/scene/geometry/cylinder.hpp"

namespace forcebound::scene {

std::optional<ToolPart> convex_part(std::string_view kind, const config::Values& values) {
  using Kind = ToolPart::Kind;
  if (kind == "sphere") {
    const Point center_m = values.point("center_m");
    return ToolPart{.kind = Kind::capsule, .from_m = center_m, .to_m = center_m, .radius_m = values.number("radius_m")};
  }
  if (kind == "box") {
    const Point center_m = values.point("center_m");
    const Point half_m = 0.5 * values.point("size_m");
    return ToolPart{.kind = Kind::box, .from_m = center_m - half_m, .to_m = center_m + half_m};
  }
  if (kind != "capsule" && kind != "cylinder") return {};
  return ToolPart{.kind = kind == "capsule" ? Kind::capsule : Kind::cylinder,
                  .from_m = values.point("from_m"),
                  .to_m = values.point("to_m"),
                  .radius_m = values.number("radius_m")};
}

std::unique_ptr<Shape> make_solid(const ToolPart& part, double less_m) {
  const Point size_m = part.to_m - part.from_m;
  switch (part.kind) {
    case ToolPart::Kind::capsule:
      return make_capsule(part.from_m, part.to_m, part.radius_m);
    case ToolPart::Kind::box:
      return make_box(0.5 * (part.from_m + part.to_m), size_m - Point::Constant(2 * less_m));
    case ToolPart::Kind::cylinder:
      break;
  }
  const Point inwards_m = less_m * size_m.stableNormalized();
  return make_cylinder(part.from_m + inwards_m, part.to_m - inwards_m, part.radius_m - less_m);
}

SolidEdges edges_of_box(const Point& center_m, const Point& size_m, double rounded_m) {
  const Point half_m = 0.5 * size_m - Point::Constant(rounded_m);
  const auto corner = [&](int number) {
    const Point sign((number & 1) == 0 ? -1 : 1, (number & 2) == 0 ? -1 : 1, (number & 4) == 0 ? -1 : 1);
    return Point(center_m + half_m.cwiseProduct(sign));
  };
  SolidEdges edges;
  for (int i = 0; i < 8; ++i) {
    edges.corners.push_back(Edge::between(corner(i), corner(i), rounded_m));
    for (const int axis : {1, 2, 4}) {
      if ((i & axis) == 0) edges.edges.push_back(Edge::between(corner(i), corner(i | axis), rounded_m));
    }
  }
  return edges;
}

SolidEdges edges_of_cylinder(const Point& from_m, const Point& to_m, double radius_m, double rounded_m) {
  const Point axis = (to_m - from_m).stableNormalized();
  const Point x = axis.unitOrthogonal();
  const double rim_m = radius_m - rounded_m;
  SolidEdges edges;
  for (const Point& end_m : {Point(from_m + rounded_m * axis), Point(to_m - rounded_m * axis)}) {
    edges.rims.push_back({.kind = Edge::Kind::circle,
                          .middle_m = end_m,
                          .x_m = rim_m * x,
                          .y_m = rim_m * axis.cross(x),
                          .radius_m = rounded_m});
  }
  edges.rims.push_back(Edge::between(from_m, to_m, radius_m, Edge::Kind::side));
  return edges;
}

}  // namespace forcebound::scene
