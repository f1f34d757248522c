#include "forcebound/device/load_geometry.hpp"

#include <stdexcept>
#include <string>

namespace forcebound::device {
namespace {

using config::CheckedTable;
using config::NumberParameter;

NumberParameter length(std::string_view key) { return {.key = key, .least = 0, .least_excluded = true}; }

ArmGeometry read_arm(CheckedTable& section) {
  ArmGeometry arm;
  arm.upper_length_m = section.number(length("upper_length_m"));
  arm.fore_length_m = section.number(length("fore_length_m"));
  arm.origin_reach_m = section.number({.key = "origin_reach_m"});
  arm.origin_height_m = section.number({.key = "origin_height_m"});
  return arm;
}

FiveBarGeometry read_five_bar(CheckedTable& section) {
  FiveBarGeometry five_bar;
  five_bar.base_distance_m = section.number({.key = "base_distance_m", .least = 0});
  five_bar.proximal_length_m = section.number(length("proximal_length_m"));
  five_bar.distal_length_m = section.number(length("distal_length_m"));
  five_bar.origin_reach_m = section.number({.key = "origin_reach_m"});
  return five_bar;
}

DeltaGeometry read_delta(CheckedTable& section) {
  DeltaGeometry delta;
  delta.base_radius_m = section.number({.key = "base_radius_m", .least = 0});
  delta.platform_radius_m = section.number({.key = "platform_radius_m", .least = 0});
  delta.upper_arm_length_m = section.number(length("upper_arm_length_m"));
  delta.forearm_length_m = section.number(length("forearm_length_m"));
  delta.side_offset_m = section.number({.key = "side_offset_m", .preset = 0});
  delta.first_arm_rad = section.number({.key = "first_arm_rad"});
  delta.origin_reach_m = section.number({.key = "origin_reach_m"});
  return delta;
}

ChainGeometry read_chain(CheckedTable& section, int degrees_of_freedom) {
  ChainGeometry chain;
  chain.tip_m = section.vector({.key = "tip_m"}, 3);
  chain.tip_axes = degrees_of_freedom;
  section.each("joint", [&](CheckedTable& part, const std::string&) {
    ChainGeometry::Joint joint;
    joint.axis = part.vector({.key = "axis", .least = -1, .most = 1}, 3);
    if (joint.axis.isZero(0)) part.refuse("axis", "a direction, three numbers of which one is not 0");
    joint.point_m = part.vector({.key = "point_m"}, 3);
    joint.start_rad = part.number({.key = "start_rad", .preset = 0});
    part.refuse_unknown_keys();
    chain.joints.push_back(joint);
  });
  const std::string most = std::to_string(control::kDofMax);
  if (chain.joints.size() < static_cast<std::size_t>(degrees_of_freedom) || chain.joints.size() > control::kDofMax) {
    section.fail("needs from degrees_of_freedom = " + std::to_string(degrees_of_freedom) + " to " + most +
                 " tables [[chain.joint]], got " + std::to_string(chain.joints.size()));
  }
  return chain;
}

Geometry read(CheckedTable& section, std::string_view kind, int degrees_of_freedom) {
  if (kind == "arm") return read_arm(section);
  if (kind == "five_bar") return read_five_bar(section);
  if (kind == "delta") return read_delta(section);
  return read_chain(section, degrees_of_freedom);
}

}  // namespace

Geometry read_geometry(CheckedTable& file, std::string_view kind, int degrees_of_freedom) {
  CheckedTable section = file.table(kind);
  Geometry geometry = read(section, kind, degrees_of_freedom);
  section.refuse_unknown_keys();
  // An arm always reached what it could, and files of it rely on that.
  if (kind == "arm") return geometry;
  const std::string refusal = refusal_of_origin(*make_kinematics(geometry), degrees_of_freedom);
  if (!refusal.empty()) section.fail(refusal + "; lengths and origin must be such that it does");
  return geometry;
}

}  // namespace forcebound::device
