#include "forcebound/server/scene/cost.hpp"

namespace forcebound::server {

double predicted_cost_ns(const Scene& scene) {
  double cost_ns = kMotion_ns;
  for (const auto* parts : {&scene.objects(), &scene.fields()}) {
    for (const SceneObject& part : *parts) {
      if (part.shape) cost_ns += part.shape->facts().cost_ns;
      for (const RequestedEffect& requested : part.effects) cost_ns += requested.effect->facts().cost_ns;
    }
  }
  for (const SceneMedium& medium : scene.media()) cost_ns += medium.medium->facts().cost_ns;
  return cost_ns;
}

}  // namespace forcebound::server
