#include "forcebound/server/environment/cost.hpp"

namespace forcebound::server {

double predicted_cost_ns(const scene::SceneObject& part) {
  double cost_ns = part.shape ? part.shape->facts().cost_ns : 0;
  for (const scene::RequestedEffect& requested : part.effects) cost_ns += requested.effect->facts().cost_ns;
  return cost_ns;
}

double predicted_cost_ns(const scene::Scene& scene) {
  double cost_ns = kMotion_ns;
  for (const auto* parts : {&scene.objects(), &scene.fields()}) {
    for (const scene::SceneObject& part : *parts) cost_ns += predicted_cost_ns(part);
  }
  for (const scene::SceneDynamicModel& dynamic_model : scene.dynamic_models())
    cost_ns += dynamic_model.dynamic_model->facts().cost_ns;
  return cost_ns;
}

}  // namespace forcebound::server
