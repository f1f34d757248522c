#pragma once

#include <memory>

#include "forcebound/scene/scene.hpp"
#include "forcebound/server/app/options.hpp"
#include "forcebound/server/environment/scene_parser.hpp"

namespace forcebound::server {

/// load_scene of the options' scene, among the scenes of scene::Registry::standard(). Says on stderr what is being
/// built if that takes longer than 3 s, as tissue of many cells does.
/// @throws SceneError
[[nodiscard]] std::shared_ptr<const scene::Scene> build_scene(const ProgramOptions& options,
                                                              const scene::MeasureCost& measure = {});

}  // namespace forcebound::server
