#include "forcebound/server/dynamics/bodies/visible_geometries.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace forcebound::server {
namespace {

using Kind = scene::VisiblePart::Kind;

// Those of higher groups are for collisions alone, by MuJoCo's convention.
constexpr int kGroupShown = 2;

std::optional<Kind> kind_of(int type) noexcept {
  switch (type) {
    case mjGEOM_PLANE:
      return Kind::half_space;
    case mjGEOM_SPHERE:
      return Kind::sphere;
    case mjGEOM_CAPSULE:
      return Kind::capsule;
    case mjGEOM_CYLINDER:
      return Kind::cylinder;
    case mjGEOM_BOX:
      return Kind::box;
    case mjGEOM_MESH:
      return Kind::mesh;
    default:
      return std::nullopt;
  }
}

/// That of its body, with a number if that has several.
std::string name_of(const mjModel_& model, int geometry) {
  const int body = model.geom_bodyid[geometry];
  const char* const name = mj_id2name(&model, mjOBJ_BODY, body);
  std::string text = name != nullptr ? name : "body " + std::to_string(body);
  if (model.body_geomnum[body] > 1) text += " (" + std::to_string(geometry - model.body_geomadr[body] + 1) + ")";
  return text;
}

void add_mesh(const mjModel_& model, int mesh, scene::VisiblePart& part) {
  if (mesh < 0) return;
  const float* const vertices = model.mesh_vert + 3 * model.mesh_vertadr[mesh];
  for (int i = 0; i < model.mesh_vertnum[mesh]; ++i) {
    part.vertices_m.emplace_back(vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]);
  }
  const int* const faces = model.mesh_face + 3 * model.mesh_faceadr[mesh];
  for (int i = 0; i < model.mesh_facenum[mesh]; ++i) {
    part.triangles.push_back({static_cast<std::uint32_t>(faces[3 * i]), static_cast<std::uint32_t>(faces[3 * i + 1]),
                              static_cast<std::uint32_t>(faces[3 * i + 2])});
  }
}

}  // namespace

std::vector<int> visible_geometries(const mjModel_& model, const std::vector<int>& without, bool planes) {
  std::vector<int> found;
  for (int i = 0; i < model.ngeom; ++i) {
    const auto kind = kind_of(model.geom_type[i]);
    if (!kind || model.geom_group[i] > kGroupShown || (*kind == Kind::half_space) != planes) continue;
    if (std::ranges::find(without, model.geom_bodyid[i]) == without.end()) found.push_back(i);
  }
  return found;
}

std::optional<scene::VisiblePart> shape_of(const mjModel_& model, int geometry) {
  const auto kind = kind_of(model.geom_type[geometry]);
  if (!kind) return std::nullopt;
  const double* const size = model.geom_size + 3 * geometry;
  scene::VisiblePart part{.name = {}, .kind = *kind, .half_m = scene::Point(size[0], size[1], size[2])};
  // A capsule and a cylinder have their half length second.
  if (part.kind == Kind::capsule || part.kind == Kind::cylinder) part.half_m.z() = size[1];
  if (part.kind == Kind::mesh) add_mesh(model, model.geom_dataid[geometry], part);
  return part;
}

scene::VisiblePart part_of(const mjModel_& model, const mjData_& data, int geometry) {
  std::array<float, scene::kNumbersOfSolid> place{};
  put_place(data, geometry, place.data());
  scene::VisiblePart part = *shape_of(model, geometry);
  part.name = name_of(model, geometry);
  part.place_m = scene::Point(place[0], place[1], place[2]);
  part.turn = Eigen::Quaterniond(place[3], place[4], place[5], place[6]);
  return part;
}

void put_place(const mjData_& data, int geometry, float* to) noexcept {
  std::array<mjtNum, 4> turn{};
  mju_mat2Quat(turn.data(), data.geom_xmat + 9 * geometry);
  for (int axis = 0; axis < 3; ++axis) to[axis] = static_cast<float>(data.geom_xpos[3 * geometry + axis]);
  for (int i = 0; i < 4; ++i) to[3 + i] = static_cast<float>(turn.at(static_cast<std::size_t>(i)));
}

}  // namespace forcebound::server
