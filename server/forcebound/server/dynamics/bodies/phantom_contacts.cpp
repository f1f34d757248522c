#include "forcebound/server/dynamics/bodies/phantom_contacts.hpp"

#include <mujoco/mujoco.h>

#include <cmath>
#include <utility>

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::server {
namespace {

// Rounding error of a depth, in addition to a share of it. [m]
constexpr double kRounding_m = 1e-9;
constexpr double kRounding = 1e-6;

mjfCollision of_mujoco = nullptr;

/// Half the extent of a box along a direction.
double reach_m(const mjModel& model, const mjData& data, int box, const scene::Point& direction) noexcept {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const mjtNum* const frame = data.geom_xmat + 9 * box;
    const scene::Point along(frame[axis], frame[3 + axis], frame[6 + axis]);
    sum += std::abs(direction.dot(along)) * model.geom_size[3 * box + axis];
  }
  return sum;
}

double overlap_m(const mjModel& model, const mjData& data, int one, int other, const scene::Point& normal) noexcept {
  const scene::Point apart_m = Eigen::Map<const scene::Point>(data.geom_xpos + 3 * other) -
                               Eigen::Map<const scene::Point>(data.geom_xpos + 3 * one);
  return reach_m(model, data, one, normal) + reach_m(model, data, other, normal) - std::abs(normal.dot(apart_m));
}

int collide_boxes(const mjModel* model, const mjData* data, mjContact* contacts, int one, int other, mjtNum margin) {
  const int found = of_mujoco(model, data, contacts, one, other, margin);
  int kept = 0;
  for (int i = 0; i < found; ++i) {
    const double most_m = overlap_m(*model, *data, one, other, Eigen::Map<const scene::Point>(contacts[i].frame));
    if (-contacts[i].dist > most_m + kRounding * std::abs(most_m) + kRounding_m) continue;
    if (kept != i) contacts[kept] = contacts[i];
    ++kept;
  }
  return kept;
}

}  // namespace

void leave_out_phantom_contacts() noexcept {
  if (of_mujoco != nullptr) return;
  of_mujoco = std::exchange(mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX], collide_boxes);
}

}  // namespace forcebound::server
