#pragma once

#include "forcebound/local_model/local_model.hpp"
#include "forcebound/wire/messages.hpp"
#include "tests/tools/sim/draw.hpp"

namespace forcebound::lab {

/// What a server that lies may say of its environment near the device: surfaces, masses and fields of any strength,
/// which move and relax, some of them with numbers that no model can have.
[[nodiscard]] local_model::LocalModel lying_model(sim::Draw& draw, const wire::EnvironmentForce& answer);

}  // namespace forcebound::lab
