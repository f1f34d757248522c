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

/// A field, or an object that still lacks its shape, whose values are not yet checked. @throws as scene::make_part
[[nodiscard]] scene::SceneObject without_shape(const v1::ScenePart& part, bool is_object,
                                               const scene::Registry& registry, Eigen::Index axes);

}  // namespace forcebound::handover
