#include "forcebound/server/environment/placement_parser.hpp"

namespace forcebound::server {
namespace {

constexpr Eigen::Index kPlacementAxes = 3;

}  // namespace

Eigen::Matrix3d parse_rotation(CheckedTable& table) {
  if (table.find(kRotationKey) == nullptr) return Eigen::Matrix3d::Identity();
  return scene::rotation_from_degrees(table.point(kRotationKey, kPlacementAxes));
}

scene::MeshPlacement parse_placement(CheckedTable& table) {
  scene::MeshPlacement placement{.scale = table.number(kMeshScale)};
  placement.rotation = parse_rotation(table);
  if (table.find(kOffsetKey) != nullptr) placement.offset_m = table.point(kOffsetKey, kPlacementAxes);
  return placement;
}

}  // namespace forcebound::server
