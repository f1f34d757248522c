#include "forcebound/scene/cost.hpp"

namespace forcebound::scene {

double predicted_cost_ns(const SceneObject& part) {
  double cost_ns = part.shape ? part.shape->facts().cost_ns : 0;
  for (const RequestedEffect& requested : part.effects) cost_ns += requested.effect->facts().cost_ns;
  return cost_ns;
}

double predicted_cost_ns(const DynamicModelFacts& facts) { return facts.cost_ns + facts.describe_cost_ns; }

double predicted_cost_ns(const Scene& scene) {
  double cost_ns = kMotion_ns;
  for (const auto* parts : {&scene.objects(), &scene.fields()}) {
    for (const SceneObject& part : *parts) cost_ns += predicted_cost_ns(part);
  }
  for (const SceneDynamicModel& dynamic_model : scene.dynamic_models())
    cost_ns += predicted_cost_ns(dynamic_model.dynamic_model->facts());
  return cost_ns;
}

}  // namespace forcebound::scene
