#include "forcebound/scene/cost.hpp"

#include "forcebound/scene/tool/tool.hpp"

namespace forcebound::scene {
namespace {

/// Of a tool with six contacts, beside asking its points.
constexpr double kConstrainedStep_ns = 2e4;

}  // namespace

double predicted_cost_ns(const SceneObject& part) {
  double cost_ns = part.shape ? part.shape->facts().cost_ns : 0;
  for (const RequestedEffect& requested : part.effects) cost_ns += requested.effect->facts().cost_ns;
  return cost_ns;
}

double predicted_cost_ns(const DynamicModelFacts& facts) { return facts.cost_ns + facts.describe_cost_ns; }

double predicted_cost_ns(const Scene& scene) {
  double cost_ns = kMotion_ns;
  const auto& tool = scene.facts().tool;
  const double points = tool ? static_cast<double>(tool->points().size()) : 1;
  if (tool && tool->contact() == ToolContact::constraint) cost_ns += kConstrainedStep_ns;
  for (const SceneObject& object : scene.objects()) cost_ns += points * predicted_cost_ns(object);
  for (const SceneObject& field : scene.fields()) cost_ns += predicted_cost_ns(field);
  for (const SceneDynamicModel& dynamic_model : scene.dynamic_models())
    cost_ns += predicted_cost_ns(dynamic_model.dynamic_model->facts());
  return cost_ns;
}

}  // namespace forcebound::scene
