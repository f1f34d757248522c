#include "forcebound/server/scene/scene.hpp"

#include "forcebound/control/vector.hpp"

namespace forcebound::server {

Scene::Scene(SceneFacts facts, std::vector<SceneObject> objects)
    : facts_(std::move(facts)), objects_(std::move(objects)) {
  for (const SceneObject& object : objects_) {
    for (const RequestedEffect& requested : object.effects) {
      effects_.push_back(requested.effect.get());
      needs_velocity_ = needs_velocity_ || requested.effect->needs_velocity();
    }
    steps_.push_back({object.shape.get(), effects_.size()});
  }
}

bool Scene::accepts(std::uint32_t device_degrees_of_freedom) const noexcept {
  const auto ours = static_cast<std::uint32_t>(facts_.degrees_of_freedom);
  if (ours == kAnyDegreesOfFreedom)
    return device_degrees_of_freedom >= 1 && device_degrees_of_freedom <= control::kDofMax;
  return device_degrees_of_freedom == ours || (ours == 3 && device_degrees_of_freedom == 6);
}

std::string Scene::accepted_degrees_of_freedom() const {
  if (facts_.degrees_of_freedom == kAnyDegreesOfFreedom) return "1 to " + std::to_string(control::kDofMax);
  return facts_.degrees_of_freedom == 3 ? "3 or 6" : std::to_string(facts_.degrees_of_freedom);
}

}  // namespace forcebound::server
