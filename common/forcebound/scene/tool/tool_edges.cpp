#include "forcebound/scene/tool/tool_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "forcebound/scene/geometry/last_normal.hpp"

namespace forcebound::scene {
namespace {

constexpr double kExact_m = 1e-11;
constexpr int kHalvingsMost = 48;
constexpr int kHalvingsToEnd = 14;
// Of what is over the same face: normals that far apart are those of its rim.
constexpr double kSameNormal = 0.99;
constexpr double kTowards = 0.1;
constexpr double kShortest_m = 1e-6;
constexpr int kSamples = 16;
constexpr double kAcross = 0.02;

struct Sample {
  double t = 0;
  double gap_m = 0;
  double slope_m = 0;  // of the gap over t
  Point at_m = Point::Zero();
  Point normal = Point::UnitX();  // out of the solid
};

/// An edge about a solid, in that one's frame.
struct Asked {
  const Shape& solid;
  const Edge& edge;

  [[nodiscard]] Sample at(double t) const noexcept {
    const bool circle = edge.kind == Edge::Kind::circle;
    const double x = circle ? std::cos(t) : t;
    const double y = circle ? std::sin(t) : 0;
    const Point at_m = edge.middle_m + x * edge.x_m + y * edge.y_m;
    const SurfacePoint found = nearest_at_first(solid, at_m);
    const Point along_m = circle ? Point(x * edge.y_m - y * edge.x_m) : edge.x_m;
    return {.t = t,
            .gap_m = -found.penetration_m - edge.radius_m,
            .slope_m = found.normal.dot(along_m),
            .at_m = at_m,
            .normal = found.normal};
  }

  /// Of a line, where the gap is convex: the least, or any if none is below `margin_m`.
  [[nodiscard]] Sample least(double from, double to, double margin_m) const noexcept {
    Sample low = at(from);
    if (!(low.slope_m < 0)) return low;
    Sample high = at(to);
    if (!(high.slope_m > 0)) return high;
    for (int i = 0; i < kHalvingsMost; ++i) {
      // Below both tangents there is nothing.
      const double crossing =
          (high.gap_m - low.gap_m + low.slope_m * low.t - high.slope_m * high.t) / (low.slope_m - high.slope_m);
      const double bound_m = low.gap_m + low.slope_m * (crossing - low.t);
      if (!(std::min(low.gap_m, high.gap_m) - bound_m > kExact_m) || bound_m > margin_m) break;
      const bool tangents = i % 3 != 2 && crossing > low.t && crossing < high.t;
      const Sample next = at(tangents ? crossing : 0.5 * (low.t + high.t));
      if (!(std::abs(next.slope_m) > 0)) return next;
      (next.slope_m < 0 ? low : high) = next;
    }
    return between_faces(low, high);
  }

  /// Where two faces are as near, along the edge nothing is nearer by what is between their normals: across the edge.
  [[nodiscard]] static Sample between_faces(const Sample& low, const Sample& high) noexcept {
    Sample best = low.gap_m < high.gap_m ? low : high;
    const Point normal = (high.slope_m * low.normal - low.slope_m * high.normal) / (high.slope_m - low.slope_m);
    const double length = normal.norm();
    // Of faces that look apart it is between them.
    if (!(length > kTowards)) return best;
    best.normal = normal / length;
    best.gap_m /= length;
    best.slope_m = 0;
    return best;
  }

  /// The last place on the way to `to` where the same face is nearest.
  [[nodiscard]] Sample end_of_face(const Sample& from, double to, double high_m) const noexcept {
    const auto same = [&](const Sample& one) {
      return one.normal.dot(from.normal) > kSameNormal && one.gap_m < high_m;
    };
    Sample end = at(to);
    if (same(end)) return end;
    Sample inside = from;
    for (int i = 0; i < kHalvingsToEnd; ++i) {
      const Sample next = at(0.5 * (inside.t + end.t));
      (same(next) ? inside : end) = next;
    }
    return inside;
  }

  /// Of a circle: where the slope changes its sign.
  [[nodiscard]] Sample between(Sample low, Sample high) const noexcept {
    for (int i = 0; i < kHalvingsMost / 2; ++i) {
      const Sample next = at(0.5 * (low.t + high.t));
      (next.slope_m < 0 ? low : high) = next;
    }
    return low.gap_m < high.gap_m ? low : high;
  }
};

/// Of an edge about a solid, at most kSamples + 2 contacts.
template <class Add>
void find_on_line(const Asked& asked, double from, double to, double margin_m, double flat_m, Add add) noexcept {
  const Sample least = asked.least(from, to, margin_m);
  if (!(least.gap_m < margin_m)) return;
  const double length_m = asked.edge.x_m.norm();
  if (!(least.gap_m < flat_m) || !(length_m > kShortest_m)) return add(2, least);
  const double high_m = least.gap_m + flat_m;
  const Sample low = asked.end_of_face(least, from, high_m);
  const Sample high = asked.end_of_face(least, to, high_m);
  const bool has_low = (least.t - low.t) * length_m > kShortest_m;
  const bool has_high = (high.t - least.t) * length_m > kShortest_m;
  if (has_low) add(0, low);
  if (has_high) add(1, high);
  if (!has_low && !has_high) return add(2, least);
  if (!has_low) return add(0, least);
  if (!has_high) return add(1, least);
  const double share = (least.t - low.t) / (high.t - low.t);
  if (low.gap_m + share * (high.gap_m - low.gap_m) - least.gap_m > kExact_m) add(2, least);
}

template <class Add>
void find_on_circle(const Asked& asked, double margin_m, double flat_m, Add add) noexcept {
  std::array<Sample, kSamples + 2> samples;
  for (int i = 0; i < kSamples + 2; ++i) samples.at(i) = asked.at((i - 1) * 2 * std::numbers::pi / kSamples);
  std::uint32_t found = 0;
  for (int i = 1; i <= kSamples; ++i) {
    const Sample& before = samples.at(i - 1);
    const Sample& here = samples.at(i);
    const Sample& after = samples.at(i + 1);
    if (found >= 2 || here.gap_m > before.gap_m || !(here.gap_m < after.gap_m)) continue;
    if (!(here.gap_m - margin_m < asked.edge.x_m.norm() * 2 * std::numbers::pi / kSamples)) continue;
    const Sample least = here.slope_m > 0 ? asked.between(before, here) : asked.between(here, after);
    const Sample& best = least.gap_m < here.gap_m ? least : here;
    if (best.gap_m < margin_m) add(found++, best);
  }
  for (std::uint32_t i = 1; i <= kSamples; ++i) {
    if (samples.at(i).gap_m < flat_m) add(1 + i, samples.at(i));
  }
}

constexpr std::uint32_t kKeys = kSamples + 2;
constexpr std::uint32_t kEdgesOfPart = 32;
// Of one object: more are left out.
constexpr std::size_t kContactsMost = 512;

template <class Add>
void find_on(const Asked& asked, const Point& about_m, double reach_m, double margin_m, double flat_m,
             Add add) noexcept {
  const Edge& edge = asked.edge;
  const Point from_m = edge.middle_m - about_m;
  if (edge.kind == Edge::Kind::circle) {
    if (from_m.norm() - edge.reach_m() < reach_m) find_on_circle(asked, margin_m, flat_m, add);
    return;
  }
  // Only what is within the ball about the solid can be near to it.
  const double squared_m2 = edge.x_m.squaredNorm();
  const double middle = squared_m2 > 0 ? -from_m.dot(edge.x_m) / squared_m2 : 0;
  const double across_m2 = (from_m + middle * edge.x_m).squaredNorm();
  const double left_m2 = reach_m * reach_m - across_m2;
  if (!(left_m2 > 0)) return;
  const double half = squared_m2 > 0 ? std::sqrt(left_m2 / squared_m2) : 0;
  const double from = std::max(-1.0, middle - half);
  const double to = std::min(1.0, middle + half);
  if (squared_m2 > 0 && !(from < to)) return;
  find_on_line(asked, from, to, margin_m, flat_m, [&](std::uint32_t which, const Sample& sample) {
    if (edge.kind == Edge::Kind::side && std::abs(sample.slope_m) > kAcross * edge.x_m.norm()) return;
    add(which, sample);
  });
}

std::size_t most_on(const Edge& edge) { return edge.kind == Edge::Kind::circle ? kKeys : 3; }

}  // namespace

ToolEdges::ToolEdges(const Tool& tool, std::span<const SceneObject> objects) {
  for (const ToolPart& part : tool.parts()) parts_.push_back(part_of(part));
  for (const SceneObject& object : objects) {
    objects_.push_back(object_of(object));
    std::size_t most = 0;
    const auto count = [&](const Edge& edge, std::uint32_t) { most += most_on(edge); };
    for (const Part& part : parts_) {
      for_edges_of_tool(part, objects_.back(), count);
      for_edges_of_object(part, objects_.back(), count);
    }
    most_ = std::max(most_, std::min(most, kContactsMost));
  }
}

ToolEdges::Part ToolEdges::part_of(const ToolPart& part) {
  using Kind = ToolPart::Kind;
  const Point middle_m = 0.5 * (part.from_m + part.to_m);
  const Point size_m = part.to_m - part.from_m;
  const double length_m = size_m.norm();
  Part made{.middle_m = middle_m, .reach_m = 0.5 * length_m, .kind = part.kind};
  if (part.kind == Kind::box) {
    made.rounded_m = std::min(kRounded_m, 0.25 * size_m.minCoeff());
    made.edges = edges_of_box(middle_m, size_m, made.rounded_m);
  } else if (part.kind == Kind::cylinder) {
    made.rounded_m = std::min(kRounded_m, 0.25 * std::min(length_m, part.radius_m));
    made.reach_m = std::hypot(0.5 * length_m, part.radius_m);
    made.edges = edges_of_cylinder(part.from_m, part.to_m, part.radius_m, made.rounded_m);
  } else {
    made.reach_m = 0.5 * length_m + part.radius_m;
    made.edges.edges.push_back(Edge::between(part.from_m, part.to_m, part.radius_m));
  }
  made.core = make_solid(part, made.rounded_m);
  return made;
}

ToolEdges::Object ToolEdges::object_of(const SceneObject& object) {
  const std::string& kind = object.shape_kind;
  const config::Values& values = object.shape_values;
  Object made{.shape = object.shape.get()};
  if (kind == "half_space") made.solid = Solid::half_space;
  if (kind == "box") {
    made.solid = Solid::box;
    made.edges = edges_of_box(values.point("center_m"), values.point("size_m"));
  } else if (kind == "cylinder") {
    made.solid = Solid::cylinder;
    made.edges = edges_of_cylinder(values.point("from_m"), values.point("to_m"), values.number("radius_m"));
  } else if (kind == "sphere" || kind == "capsule") {
    made.solid = Solid::round;
    const Point from_m = values.point(kind == "sphere" ? "center_m" : "from_m");
    const Point to_m = values.point(kind == "sphere" ? "center_m" : "to_m");
    made.edges.edges.push_back(Edge::between(from_m, to_m, values.number("radius_m")));
  }
  return made;
}

// Each pair of a corner, edge, face, rim or side of a part with one of an object is asked by an edge of one of them.

template <class Use>
void ToolEdges::for_edges_of_tool(const Part& part, const Object& object, Use use) {
  if (object.solid == Solid::other) return;
  const bool cylinder = object.solid == Solid::cylinder;
  std::uint32_t number = 0;
  if (object.solid == Solid::half_space || object.solid == Solid::box) {
    for (const Edge& corner : part.edges.corners) use(corner, number++);
  }
  if (part.kind == ToolPart::Kind::capsule || cylinder) {
    for (const Edge& edge : part.edges.edges) use(edge, number++);
  }
  for (const Edge& rim : part.edges.rims) {
    if (rim.kind == Edge::Kind::circle ? object.solid != Solid::round : cylinder) use(rim, number++);
  }
}

template <class Use>
void ToolEdges::for_edges_of_object(const Part& part, const Object& object, Use use) {
  if (part.kind == ToolPart::Kind::capsule) return;
  std::uint32_t number = kEdgesOfPart;
  for (const Edge& edge : object.edges.edges) use(edge, number++);
  for (const Edge& rim : object.edges.rims) {
    if (rim.kind == Edge::Kind::circle || part.kind == ToolPart::Kind::box) use(rim, number++);
  }
}

void ToolEdges::find(std::size_t number, const ToolPose& pose, double margin_m, double flat_m,
                     std::vector<EdgeContact>& found) const noexcept {
  const Object& object = objects_[number];
  const auto add = [&](const EdgeContact& contact) {
    if (found.size() < most_) found.push_back(contact);
  };
  const Eigen::Matrix3d to_handle = pose.rotation.transpose();
  for (std::uint32_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    const double reach_m = part.reach_m + margin_m;
    if (object.shape->is_clear_of(pose * part.middle_m, reach_m)) continue;
    const std::uint32_t first = 2 * kEdgesOfPart * i;
    for_edges_of_tool(part, object, [&](const Edge& edge, std::uint32_t of_part) {
      const Edge there = edge.moved(pose.rotation, pose * edge.middle_m);
      const double edge_reach_m = edge.reach_m() + edge.radius_m + margin_m;
      if (object.shape->is_clear_of(there.middle_m, edge_reach_m)) return;
      find_on({*object.shape, there}, there.middle_m, 2 * edge_reach_m, margin_m, flat_m,
              [&](std::uint32_t which, const Sample& at) {
                // A ball's and a rod's are in their middle: they roll.
                const double inwards_m = edge.kind == Edge::Kind::segment ? 0 : edge.radius_m;
                add({.key = kKeys * (first + of_part) + which,
                     .at_m = at.at_m - inwards_m * at.normal,
                     .normal = at.normal,
                     .gap_m = at.gap_m});
              });
    });
    for_edges_of_object(part, object, [&](const Edge& edge, std::uint32_t of_part) {
      Edge here = edge.moved(to_handle, to_handle * (edge.middle_m - pose.tip_m));
      // The part is larger than its core.
      here.radius_m += part.rounded_m;
      find_on({*part.core, here}, part.middle_m, reach_m + here.radius_m, margin_m, flat_m,
              [&](std::uint32_t which, const Sample& at) {
                const Point normal = -(pose.rotation * at.normal);
                add({.key = kKeys * (first + of_part) + which,
                     .at_m = pose * at.at_m + edge.radius_m * normal,
                     .normal = normal,
                     .gap_m = at.gap_m});
              });
    });
  }
}

}  // namespace forcebound::scene
