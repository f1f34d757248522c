#include "forcebound/scene/registry.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "forcebound/scene/effects/adhesion.hpp"
#include "forcebound/scene/effects/attractor.hpp"
#include "forcebound/scene/effects/constant_force.hpp"
#include "forcebound/scene/effects/drive.hpp"
#include "forcebound/scene/effects/flow.hpp"
#include "forcebound/scene/effects/friction.hpp"
#include "forcebound/scene/effects/grasp.hpp"
#include "forcebound/scene/effects/gravity.hpp"
#include "forcebound/scene/effects/magnet.hpp"
#include "forcebound/scene/effects/spring_to_line.hpp"
#include "forcebound/scene/effects/spring_to_plane.hpp"
#include "forcebound/scene/effects/spring_to_point.hpp"
#include "forcebound/scene/effects/stick_slip.hpp"
#include "forcebound/scene/effects/surface.hpp"
#include "forcebound/scene/effects/texture.hpp"
#include "forcebound/scene/effects/vibration.hpp"
#include "forcebound/scene/effects/viscosity.hpp"
#include "forcebound/scene/effects/workspace_limit.hpp"
#include "forcebound/scene/geometry/capsule.hpp"
#include "forcebound/scene/geometry/cylinder.hpp"
#include "forcebound/scene/geometry/distance_field.hpp"
#include "forcebound/scene/geometry/height_field.hpp"
#include "forcebound/scene/geometry/lathe.hpp"
#include "forcebound/scene/geometry/mesh_shape.hpp"
#include "forcebound/scene/geometry/torus.hpp"

namespace forcebound::scene {
namespace {

template <class Kind>
const Kind* find_in(const std::vector<Kind>& kinds, std::string_view name) noexcept {
  const auto found = std::ranges::find(kinds, name, &Kind::name);
  return found == kinds.end() ? nullptr : &*found;
}

template <class Kind>
void add_to(std::vector<Kind>& kinds, Kind kind, const char* what) {
  if (find_in(kinds, kind.name) != nullptr) {
    throw std::invalid_argument(std::string(what) + " '" + std::string(kind.name) + "' is registered twice");
  }
  kinds.push_back(std::move(kind));
}

const Registry& shipped() {
  static const Registry kShipped = Registry::standard();
  return kShipped;
}

[[noreturn]] void refuse_reuse(const char* what, std::string_view name) {
  throw std::invalid_argument(std::string(what) + " '" + std::string(name) +
                              "' is one of this library: another one needs another name, because clients that are "
                              "handed a scene run what they know by the name");
}

}  // namespace

Registry Registry::standard() {
  Registry registry;
  registry.effects_ = {surface_effect(),         friction_effect(),       stick_slip_effect(),
                       vibration_effect(),       magnet_effect(),         adhesion_effect(),
                       texture_effect(),         attractor_effect(),      constant_force_effect(),
                       drive_effect(),           flow_effect(),           grasp_effect(),
                       gravity_effect(),         spring_to_line_effect(), spring_to_plane_effect(),
                       spring_to_point_effect(), viscosity_effect(),      workspace_limit_effect()};
  registry.shapes_ = {half_space_shape(), sphere_shape(),         cavity_shape(), box_shape(),
                      capsule_shape(),    cylinder_shape(),       torus_shape(),  height_field_shape(),
                      mesh_shape(),       distance_field_shape(), lathe_shape()};
  return registry;
}

void Registry::add(EffectKind kind) {
  const EffectKind* const ours = shipped().find_effect(kind.name);
  if (ours != nullptr && ours->law != kind.law) refuse_reuse("effect", kind.name);
  add_to(effects_, std::move(kind), "effect");
}

void Registry::add(ShapeKind kind) {
  const ShapeKind* const ours = shipped().find_shape(kind.name);
  if (ours != nullptr && ours->description != kind.description) refuse_reuse("shape", kind.name);
  add_to(shapes_, std::move(kind), "shape");
}

const EffectKind* Registry::find_effect(std::string_view name) const noexcept { return find_in(effects_, name); }
const ShapeKind* Registry::find_shape(std::string_view name) const noexcept { return find_in(shapes_, name); }

}  // namespace forcebound::scene
