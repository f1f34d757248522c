#include "forcebound/scene/effects/registry.hpp"

#include <algorithm>
#include <stdexcept>

#include "forcebound/scene/effects/adhesion.hpp"
#include "forcebound/scene/effects/attractor.hpp"
#include "forcebound/scene/effects/constant_force.hpp"
#include "forcebound/scene/effects/drive.hpp"
#include "forcebound/scene/effects/flow.hpp"
#include "forcebound/scene/effects/friction.hpp"
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

namespace forcebound::scene {

EffectRegistry EffectRegistry::standard() {
  EffectRegistry registry;
  registry.add(surface_effect());
  registry.add(friction_effect());
  registry.add(stick_slip_effect());
  registry.add(vibration_effect());
  registry.add(magnet_effect());
  registry.add(adhesion_effect());
  registry.add(texture_effect());
  registry.add(attractor_effect());
  registry.add(constant_force_effect());
  registry.add(drive_effect());
  registry.add(flow_effect());
  registry.add(gravity_effect());
  registry.add(spring_to_line_effect());
  registry.add(spring_to_plane_effect());
  registry.add(spring_to_point_effect());
  registry.add(viscosity_effect());
  registry.add(workspace_limit_effect());
  return registry;
}

void EffectRegistry::add(EffectKind kind) {
  if (find(kind.name) != nullptr) {
    throw std::invalid_argument("effect '" + std::string(kind.name) + "' is registered twice");
  }
  kinds_.push_back(std::move(kind));
}

const EffectKind* EffectRegistry::find(std::string_view name) const noexcept {
  const auto found = std::find_if(kinds_.begin(), kinds_.end(), [name](const auto& kind) { return kind.name == name; });
  return found == kinds_.end() ? nullptr : &*found;
}

}  // namespace forcebound::scene
