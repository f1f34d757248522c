#include "forcebound/record/internal/foxglove_codec.hpp"

#include <google/protobuf/timestamp.pb.h>

#include <algorithm>
#include <cmath>

#include "forcebound/control/rotation.hpp"
#include "forcebound/control/translation.hpp"
#include "foxglove/geometry.pb.h"
#include "foxglove/scene.pb.h"

namespace forcebound::record {
namespace {

constexpr double kEndless_m = 0.4;  // edge of a plane, and of a box that has no end
constexpr double kThick_m = 0.002;  // of a plane
constexpr double kTip_m = 0.006;

struct Shade {
  double red, green, blue, alpha;
};
constexpr Shade kSolid{0.62, 0.66, 0.72, 1};
constexpr Shade kMoving{0.85, 0.68, 0.42, 1};
constexpr Shade kClear{0.62, 0.66, 0.72, 0.35};  // the tip can be within
constexpr Shade kTip{0.1, 0.1, 0.1, 1};

double shown_number(double value) { return std::isfinite(value) ? value : 0; }

void set_stamp(Nanoseconds at, google::protobuf::Timestamp& out) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t ns = std::max<std::int64_t>(at.count(), 0);
  out.set_seconds(ns / kSecond_ns);
  out.set_nanos(static_cast<std::int32_t>(ns % kSecond_ns));
}

template <class Point>
void set_point(const Eigen::Vector3d& point, Point& out) {
  out.set_x(shown_number(point.x()));
  out.set_y(shown_number(point.y()));
  out.set_z(shown_number(point.z()));
}

void set_turn(const Eigen::Quaterniond& turn, foxglove::Quaternion& out) {
  const double length = turn.norm();
  const bool sound = std::isfinite(length) && length > 0;
  const Eigen::Quaterniond unit = sound ? turn.normalized() : Eigen::Quaterniond::Identity();
  out.set_x(unit.x());
  out.set_y(unit.y());
  out.set_z(unit.z());
  out.set_w(unit.w());
}

void set_pose(const Eigen::Vector3d& place_m, const Eigen::Quaterniond& turn, foxglove::Pose& out) {
  set_point(place_m, *out.mutable_position());
  set_turn(turn, *out.mutable_orientation());
}

void set_colour(const Shade& shade, foxglove::Color& out) {
  out.set_r(shade.red);
  out.set_g(shade.green);
  out.set_b(shade.blue);
  out.set_a(shade.alpha);
}

void add_cube(const ScenePart& part, const Eigen::Vector3d& middle_m, const Eigen::Vector3d& size_m, const Shade& shade,
              foxglove::SceneEntity& entity) {
  foxglove::CubePrimitive& cube = *entity.add_cubes();
  set_pose(middle_m, part.turn, *cube.mutable_pose());
  set_point(size_m, *cube.mutable_size());
  set_colour(shade, *cube.mutable_color());
}

void add_sphere(const Eigen::Vector3d& middle_m, const Eigen::Vector3d& size_m, const Shade& shade,
                foxglove::SceneEntity& entity) {
  foxglove::SpherePrimitive& sphere = *entity.add_spheres();
  set_pose(middle_m, Eigen::Quaterniond::Identity(), *sphere.mutable_pose());
  set_point(size_m, *sphere.mutable_size());
  set_colour(shade, *sphere.mutable_color());
}

void add_cylinder(const ScenePart& part, const Shade& shade, foxglove::SceneEntity& entity) {
  foxglove::CylinderPrimitive& cylinder = *entity.add_cylinders();
  set_pose(part.place_m, part.turn, *cylinder.mutable_pose());
  set_point(part.size_m, *cylinder.mutable_size());
  cylinder.set_bottom_scale(1);
  cylinder.set_top_scale(1);
  set_colour(shade, *cylinder.mutable_color());
}

void add_triangles(const ScenePart& part, const Shade& shade, foxglove::SceneEntity& entity) {
  foxglove::TriangleListPrimitive& list = *entity.add_triangles();
  set_pose(part.place_m, part.turn, *list.mutable_pose());
  for (const Eigen::Vector3d& vertex : part.vertices_m) set_point(vertex, *list.add_points());
  for (const auto& triangle : part.triangles) {
    const bool sound = std::ranges::all_of(triangle, [&](std::uint32_t at) { return at < part.vertices_m.size(); });
    if (sound) list.mutable_indices()->Add(triangle.begin(), triangle.end());
  }
  set_colour(shade, *list.mutable_color());
}

void add_part(const ScenePart& part, foxglove::SceneEntity& entity) {
  using Kind = ScenePart::Kind;
  const Shade& shade = part.moves ? kMoving : kSolid;
  switch (part.kind) {
    case Kind::plane: {
      const Eigen::Vector3d below = part.place_m - 0.5 * kThick_m * (part.turn * Eigen::Vector3d::UnitZ());
      return add_cube(part, below, {kEndless_m, kEndless_m, kThick_m}, shade, entity);
    }
    case Kind::box: {
      const auto ended = [](double edge_m) { return std::isfinite(edge_m) ? edge_m : kEndless_m; };
      return add_cube(part, part.place_m, part.size_m.unaryExpr(ended), shade, entity);
    }
    case Kind::sphere:
      return add_sphere(part.place_m, part.size_m, shade, entity);
    case Kind::cavity:
      return add_sphere(part.place_m, part.size_m, kClear, entity);
    case Kind::capsule: {
      add_cylinder(part, shade, entity);
      const Eigen::Vector3d half_m = part.turn * Eigen::Vector3d(0, 0, 0.5 * part.size_m.z());
      const Eigen::Vector3d cap_m = Eigen::Vector3d::Constant(part.size_m.x());
      add_sphere(part.place_m + half_m, cap_m, shade, entity);
      return add_sphere(part.place_m - half_m, cap_m, shade, entity);
    }
    case Kind::cylinder:
      return add_cylinder(part, shade, entity);
    case Kind::mesh:
      return add_triangles(part, shade, entity);
  }
}

foxglove::SceneEntity& add_entity(foxglove::SceneUpdate& update, const std::string& id, Nanoseconds at) {
  foxglove::SceneEntity& entity = *update.add_entities();
  set_stamp(at, *entity.mutable_timestamp());
  entity.set_frame_id(std::string(kSceneFrame));
  entity.set_id(id);
  entity.set_frame_locked(true);
  return entity;
}

void add_arrow(const Eigen::Vector3d& tip_m, const ShownForce& shown, foxglove::SceneEntity& entity) {
  const Eigen::Vector3d force_N = control::translation_of(shown.force_N);
  const double norm_N = force_N.norm();
  constexpr double kHead_m = 0.006;
  constexpr double kHeadDiameter_m = 0.004;
  constexpr double kShaftDiameter_m = 0.002;
  if (!std::isfinite(norm_N) || norm_N <= 0) return;
  const double length_m = kArrow_m_per_N * norm_N;
  const double head_m = std::min(kHead_m, 0.5 * length_m);
  foxglove::ArrowPrimitive& arrow = *entity.add_arrows();
  set_pose(tip_m, control::turn_between(Eigen::Vector3d::UnitX(), force_N), *arrow.mutable_pose());
  arrow.set_shaft_length(length_m - head_m);
  arrow.set_shaft_diameter(kShaftDiameter_m);
  arrow.set_head_length(head_m);
  arrow.set_head_diameter(kHeadDiameter_m);
  const auto& [red, green, blue] = shown.colour;
  set_colour({red, green, blue, 1}, *arrow.mutable_color());
}

void set_lifetime(foxglove::SceneEntity& entity) {
  entity.mutable_lifetime()->set_nanos(static_cast<std::int32_t>(kArrowLifetime.count()));
}

}  // namespace

std::string encode_scene(std::span<const ScenePart> parts, Nanoseconds at) {
  foxglove::SceneUpdate update;
  foxglove::SceneEntityDeletion& deletion = *update.add_deletions();
  set_stamp(at, *deletion.mutable_timestamp());
  deletion.set_type(foxglove::SceneEntityDeletion::ALL);
  std::size_t number = 0;
  for (const ScenePart& part : parts) {
    // Names of a scene need not differ; what is drawn does.
    add_part(part, add_entity(update, std::to_string(++number) + " " + part.name, at));
  }
  return update.SerializeAsString();
}

std::string encode_device(std::string_view frame, const control::Vector& position_m, const control::Handle& handle,
                          Nanoseconds at) {
  foxglove::FrameTransform transform;
  set_stamp(at, *transform.mutable_timestamp());
  transform.set_parent_frame_id(std::string(kSceneFrame));
  transform.set_child_frame_id(std::string(frame));
  set_point(control::translation_of(position_m), *transform.mutable_translation());
  const auto [w, x, y, z] = handle.orientation.value_or(control::Handle::Orientation{1, 0, 0, 0});
  set_turn(Eigen::Quaterniond(w, x, y, z), *transform.mutable_rotation());
  return transform.SerializeAsString();
}

std::string encode_arrows(std::string_view device, const control::Vector& position_m,
                          std::span<const ShownForce> forces, Nanoseconds at) {
  foxglove::SceneUpdate update;
  const std::string name(device);
  const Eigen::Vector3d tip_m = control::translation_of(position_m);
  foxglove::SceneEntity& tip = add_entity(update, name, at);
  set_lifetime(tip);
  add_sphere(tip_m, Eigen::Vector3d::Constant(kTip_m), kTip, tip);
  for (const ShownForce& force : forces) {
    foxglove::SceneEntity& entity = add_entity(update, name + ": " + std::string(force.name), at);
    set_lifetime(entity);
    foxglove::KeyValuePair& scale = *entity.add_metadata();
    scale.set_key("m_per_N");
    scale.set_value("0.01");
    add_arrow(tip_m, force, entity);
  }
  return update.SerializeAsString();
}

}  // namespace forcebound::record
