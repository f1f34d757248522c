#include "forcebound/server/effects/registry.hpp"

#include <algorithm>
#include <stdexcept>

#include "forcebound/server/effects/adhesion.hpp"
#include "forcebound/server/effects/friction.hpp"
#include "forcebound/server/effects/magnet.hpp"
#include "forcebound/server/effects/stick_slip.hpp"
#include "forcebound/server/effects/surface.hpp"
#include "forcebound/server/effects/texture.hpp"
#include "forcebound/server/effects/vibration.hpp"

namespace forcebound::server {

EffectRegistry EffectRegistry::standard() {
  EffectRegistry registry;
  registry.add(surface_effect());
  registry.add(friction_effect());
  registry.add(stick_slip_effect());
  registry.add(vibration_effect());
  registry.add(magnet_effect());
  registry.add(adhesion_effect());
  registry.add(texture_effect());
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

}  // namespace forcebound::server
