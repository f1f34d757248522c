#pragma once

#include <cstdint>
#include <string>

#include "forcebound/scene/dynamic_model.hpp"
#include "forcebound/scene/plan.hpp"
#include "forcebound/scene/registry.hpp"

namespace forcebound::scene {

/// Where the force of a part is computed if the client renders locally.
enum class Rendering : std::uint8_t {
  at_client,  ///< at the client: the part is handed over once, and run by the same plan and effects
  modelled,   ///< at the client: by a local model that comes with each answer, where the part gives one
  held,       ///< at the server, for the position in a motion; held and faded at the client
};

struct PartRendering {
  Rendering how = Rendering::held;
  std::string why{};  ///< why it is held, for people
};

/// The one rule. An object or field runs at the client if it can be made again there by `make_part`: its shape and each
/// of its effects are of a kind that every client has. Of what moves by a law of its own a local model travels with
/// each answer; what gives none is held.
///
/// @param known the shapes and effects that every client has
[[nodiscard]] PartRendering rendering_of(const SceneObject& part, const Registry& known);
[[nodiscard]] PartRendering rendering_of(const DynamicModel& model);

/// "runs at the client"; "local model with each answer"; "computed here, held at the client: effect 'wind' is known to
/// this server only".
[[nodiscard]] std::string to_text(const PartRendering& rendering);

}  // namespace forcebound::scene
