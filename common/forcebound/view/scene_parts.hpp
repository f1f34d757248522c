#pragma once

#include <vector>

#include "forcebound/record/scene_part.hpp"
#include "forcebound/view/shown_scene.hpp"

namespace forcebound::view {

/// What a page draws, as a recording has it: a torus as a mesh, all else as it is. What lacks a number that its shape
/// needs is left out: a description may have come from anybody.
[[nodiscard]] std::vector<record::ScenePart> parts_of(const ShownScene& shown);

}  // namespace forcebound::view
