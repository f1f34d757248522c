#include "forcebound/server/robot/surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace forcebound::server {
namespace {

Eigen::Vector3d corner_of(const Eigen::Vector3d& half, int number) noexcept {
  return {(number & 1) != 0 ? half.x() : -half.x(), (number & 2) != 0 ? half.y() : -half.y(),
          (number & 4) != 0 ? half.z() : -half.z()};
}

/// Nearest point of a box's surface from a point in its frame, the direction out of it there, and the distance, below
/// zero inside.
struct Nearest {
  Eigen::Vector3d normal;
  double distance_m = 0;
};

Nearest nearest_of_box(const Eigen::Vector3d& half, const Eigen::Vector3d& point) noexcept {
  const Eigen::Vector3d inside = point.cwiseMax(-half).cwiseMin(half);
  const Eigen::Vector3d apart = point - inside;
  const double distance_m = apart.norm();
  if (distance_m > 0) return {.normal = apart / distance_m, .distance_m = distance_m};
  Eigen::Index axis = 0;
  const double depth_m = (half - point.cwiseAbs()).minCoeff(&axis);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  normal[axis] = point[axis] < 0 ? -1 : 1;
  return {.normal = normal, .distance_m = -depth_m};
}

}  // namespace

struct Surroundings::Call {
  const BodyState& tool;
  const BodyState& block;
  double step_s;
  Forces forces{};

  /// A point of the tool against something; `moving`: it is the block.
  void on_tool(PointContact& contact, const ContactMaterial& material, const Eigen::Vector3d& point,
               const Eigen::Vector3d& normal, double depth_m, bool moving = false) noexcept {
    Eigen::Vector3d velocity = tool.velocity_at(point);
    if (moving) velocity -= block.velocity_at(point);
    const Eigen::Vector3d force =
        contact.force(material, {.normal = normal, .depth_m = depth_m, .velocity = velocity}, step_s);
    if (!(depth_m > 0)) return;
    forces.tool_touches = true;
    forces.tool.head<3>() += force;
    forces.tool.tail<3>() += (point - tool.position).cross(force);
    if (!moving) return;
    forces.block.head<3>() -= force;
    forces.block.tail<3>() -= (point - block.position).cross(force);
  }

  void on_block(PointContact& contact, const ContactMaterial& material, const Eigen::Vector3d& point,
                const Eigen::Vector3d& normal, double depth_m) noexcept {
    const Eigen::Vector3d force =
        contact.force(material, {.normal = normal, .depth_m = depth_m, .velocity = block.velocity_at(point)}, step_s);
    forces.block.head<3>() += force;
    forces.block.tail<3>() += (point - block.position).cross(force);
  }
};

Surroundings::Surroundings(const Task::World& world) : tool_(world.tool) {
  for (const WorldObject& object : world.objects) {
    places_.push_back({.object = object});
    if (object.shape == WorldObject::Shape::block) block_half_ = object.half_size;
  }
}

Surroundings::Forces Surroundings::touch(const BodyState& tool, const BodyState& block, double step_s) noexcept {
  Call call{.tool = tool, .block = block, .step_s = step_s};
  for (Place& place : places_) {
    switch (place.object.shape) {
      case WorldObject::Shape::surface:
        touch_surface(place, call);
        break;
      case WorldObject::Shape::box:
      case WorldObject::Shape::block:
        touch_box(place, call);
        break;
      case WorldObject::Shape::hole:
        touch_hole(place, call);
        break;
    }
  }
  return call.forces;
}

double Surroundings::sunk_m(const WorldObject& block, const WorldObject& surface) noexcept {
  constexpr double kCorners = 4;
  return block.mass_kg * kGravity_m_per_s2 / (kCorners * surface.material.stiffness_N_per_m);
}

void Surroundings::touch_surface(Place& place, Call& call) const noexcept {
  const WorldObject& object = place.object;
  const double height_m = object.normal.dot(call.tool.position - object.position);
  // A plug that meets a plain surface is taken for a fingertip at its end.
  const double radius_m = tool_.kind == ToolShape::Kind::fingertip ? tool_.radius_m : 0;
  call.on_tool(place.tool[0], object.material, call.tool.position - radius_m * object.normal, object.normal,
               radius_m - height_m);
  if (block_half_.isZero(0)) return;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner = call.block.position + call.block.axes * corner_of(block_half_, i);
    call.on_block(place.corners[static_cast<std::size_t>(i)], object.material, corner, object.normal,
                  object.normal.dot(object.position - corner));
  }
}

void Surroundings::touch_box(Place& place, Call& call) const noexcept {
  const WorldObject& object = place.object;
  const bool moving = object.shape == WorldObject::Shape::block;
  const Eigen::Vector3d centre = moving ? call.block.position : object.position;
  const Eigen::Matrix3d axes = moving ? call.block.axes : Eigen::Matrix3d::Identity();
  const Nearest nearest = nearest_of_box(object.half_size, axes.transpose() * (call.tool.position - centre));
  const Eigen::Vector3d normal = axes * nearest.normal;
  call.on_tool(place.tool[0], object.material, call.tool.position - nearest.distance_m * normal, normal,
               tool_.radius_m - nearest.distance_m, moving);
}

void Surroundings::touch_hole(Place& place, Call& call) const noexcept {
  const WorldObject& hole = place.object;
  const double reach_m = tool_.length_m + tool_.radius_m;
  if (call.tool.position.z() - hole.position.z() > reach_m) return;
  const auto on_ring = [](int i) {
    const double angle = 2 * std::numbers::pi * i / kRing;
    return Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  };
  // The plug's end and the inner end of its chamfer, in the plate.
  const auto point_in_plate = [&](PointContact& contact, const Eigen::Vector3d& of_tool) {
    const Eigen::Vector3d point = call.tool.position + call.tool.axes * of_tool;
    Eigen::Vector3d out = point - hole.position;
    const double below_m = -out.z();
    out.z() = 0;
    const double radius_m = out.norm();
    const double beside_m = radius_m - hole.radius_m;
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    if (below_m > hole.depth_m && beside_m < 0)
      return call.on_tool(contact, hole.material, point, up, below_m - hole.depth_m);
    if (beside_m < below_m)
      return call.on_tool(contact, hole.material, point, -out / std::max(radius_m, 1e-12), beside_m);
    call.on_tool(contact, hole.material, point, up, std::min(below_m, beside_m));
  };
  // The hole's edge, in the plug's side.
  const auto edge_in_plug = [&](PointContact& contact, const Eigen::Vector3d& direction) {
    const Eigen::Vector3d point = hole.position + hole.radius_m * direction;
    Eigen::Vector3d of_tool = call.tool.axes.transpose() * (point - call.tool.position);
    const double behind_m = -of_tool.z();
    of_tool.z() = 0;
    const double cut_m = std::max(0.0, tool_.chamfer_m - behind_m);
    const double from_axis_m = of_tool.norm();
    const bool beside = behind_m > 0 && behind_m < tool_.length_m && from_axis_m > 0;
    if (!beside) return call.on_tool(contact, hole.material, point, Eigen::Vector3d::UnitZ(), 0);
    Eigen::Vector3d out = -of_tool / from_axis_m;
    double depth_m = tool_.radius_m - cut_m - from_axis_m;
    if (cut_m > 0) {  // a chamfer of 45 degrees
      out = (out - Eigen::Vector3d::UnitZ()) / std::numbers::sqrt2;
      depth_m /= std::numbers::sqrt2;
    }
    call.on_tool(contact, hole.material, point, call.tool.axes * out, depth_m);
  };
  for (int i = 0; i < kRing; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Eigen::Vector3d direction = on_ring(i);
    point_in_plate(place.tool[k], (tool_.radius_m - tool_.chamfer_m) * direction);
    point_in_plate(place.tool[k + kRing], tool_.radius_m * direction - Eigen::Vector3d(0, 0, tool_.chamfer_m));
    edge_in_plug(place.tool[k + 2 * kRing], direction);
  }
}

}  // namespace forcebound::server
