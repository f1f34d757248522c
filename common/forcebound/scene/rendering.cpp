#include "forcebound/scene/rendering.hpp"

namespace forcebound::scene {

PartRendering rendering_of(const SceneObject& part, const Registry& known) {
  if (part.shape && known.find_shape(part.shape_kind) == nullptr)
    return {Rendering::held, "its shape is known to this server only"};
  for (const RequestedEffect& requested : part.effects) {
    if (known.find_effect(requested.name) == nullptr)
      return {Rendering::held, "effect '" + requested.name + "' is known to this server only"};
  }
  return {Rendering::at_client, {}};
}

PartRendering rendering_of(const DynamicModel& model) {
  if (model.facts().describes_itself) return {Rendering::modelled, {}};
  return {Rendering::held, "it moves by a law of its own, and gives no local model"};
}

std::string to_text(const PartRendering& rendering) {
  if (rendering.how == Rendering::at_client) return "runs at the client";
  if (rendering.how == Rendering::modelled) return "local model with each answer";
  return "computed here, held at the client: " + rendering.why;
}

}  // namespace forcebound::scene
