#include "forcebound/scene/scene.hpp"

#include <algorithm>

#include "forcebound/control/vector.hpp"
#include "forcebound/scene/part_at_client.hpp"

namespace forcebound::scene {

Scene::Scene(SceneFacts facts, SceneParts parts, AutoAccuracy accuracy)
    : facts_(std::move(facts)),
      parts_(std::move(parts)),
      plan_(parts_.objects, parts_.fields),
      inputs_(plan_.inputs()),
      accuracy_(std::move(accuracy)) {
  static const Registry kKnown = Registry::standard();
  renderings_.reserve(this->parts());
  for (const auto* const objects : {&parts_.objects, &parts_.fields}) {
    for (const SceneObject& part : *objects) renderings_.push_back(rendering_of(part, kKnown));
  }
  // Of a tool that touches several parts the torques come together, not those of the parts that are handed over apart.
  if (facts_.tool && least_rendering() != Rendering::at_client) {
    for (PartRendering& part : renderings_) {
      if (part.how == Rendering::at_client) part = {Rendering::held, "the tool touches a part that is held"};
    }
  }
  for (const SceneDynamicModel& dynamic_model : parts_.dynamic_models) {
    inputs_ = inputs_.with(dynamic_model.dynamic_model->facts().inputs);
    // What clients share, or is more than one gives, stays with the server.
    const auto* const runs = dynamic_cast<const RunsAtClient*>(dynamic_model.dynamic_model.get());
    const bool at_client = runs != nullptr && !facts_.shared && runs->fits_client();
    renderings_.push_back(at_client ? PartRendering{Rendering::at_client, {}}
                                    : rendering_of(*dynamic_model.dynamic_model));
  }
}

Rendering Scene::least_rendering() const noexcept {
  Rendering least = Rendering::at_client;
  for (const PartRendering& part : renderings_) least = std::max(least, part.how);
  return least;
}

bool Scene::can_be_handed_over() const noexcept {
  return std::ranges::any_of(renderings_, [](const PartRendering& part) { return part.how == Rendering::at_client; });
}

const std::string& Scene::name_of_step(std::size_t step) const noexcept {
  const std::size_t objects = parts_.objects.size();
  return step < objects ? parts_.objects[step].name : parts_.fields[step - objects].name;
}

Point Scene::on_surface_m(std::size_t part) const {
  const auto steps = plan_.steps();
  if (part >= steps.size()) return parts_.dynamic_models[part - steps.size()].dynamic_model->facts().on_surface_m;
  return steps[part].shape == nullptr ? Point::Zero() : steps[part].shape->facts().on_surface_m;
}

bool SceneFacts::accepts(std::uint32_t device_degrees_of_freedom) const noexcept {
  const auto ours = static_cast<std::uint32_t>(degrees_of_freedom);
  if (ours == kAnyDegreesOfFreedom)
    return device_degrees_of_freedom >= 1 && device_degrees_of_freedom <= control::kDofMax;
  return device_degrees_of_freedom == ours || (ours == 3 && device_degrees_of_freedom == 6);
}

std::string SceneFacts::accepted_degrees_of_freedom() const {
  if (degrees_of_freedom == kAnyDegreesOfFreedom) return "1 to " + std::to_string(control::kDofMax);
  return degrees_of_freedom == 3 ? "3 or 6" : std::to_string(degrees_of_freedom);
}

}  // namespace forcebound::scene
