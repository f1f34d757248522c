#pragma once

#include <string>

#include "forcebound/handover/handover_error.hpp"
#include "forcebound/handover/limits.hpp"
#include "forcebound/scene/part.hpp"
#include "forcebound/v1/handover.pb.h"

/// Private to handover: the parts of a manifest, from anybody.
namespace forcebound::handover {

/// Text of a manifest, fit for one line: cut, and without control characters.
[[nodiscard]] std::string one_line(const std::string& from);

/// @throws HandoverError if there are more parts than the limits let through, or one has a geometry that is none
void check_manifest(const v1::SceneManifest& manifest, const Limits& limits);

/// Of an object without its geometry. `scene::make_part` checks the values.
[[nodiscard]] scene::PartDescription object_of(const v1::ScenePart& part);
[[nodiscard]] scene::PartDescription field_of(const v1::ScenePart& part);

}  // namespace forcebound::handover
