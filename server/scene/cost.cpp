#include "forcebound/server/scene/cost.hpp"

namespace forcebound::server {

double predicted_cost_ns(const SceneObject& part) {
  double cost_ns = part.shape ? part.shape->facts().cost_ns : 0;
  for (const RequestedEffect& requested : part.effects) cost_ns += requested.effect->facts().cost_ns;
  return cost_ns;
}

double predicted_cost_ns(const Scene& scene) {
  double cost_ns = kMotion_ns;
  for (const auto* parts : {&scene.objects(), &scene.fields()}) {
    for (const SceneObject& part : *parts) cost_ns += predicted_cost_ns(part);
  }
  for (const SceneMedium& medium : scene.media()) cost_ns += medium.medium->facts().cost_ns;
  return cost_ns;
}

}  // namespace forcebound::server
