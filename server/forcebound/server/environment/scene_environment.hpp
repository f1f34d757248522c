#pragma once

#include <memory>

#include "forcebound/scene/scene.hpp"
#include "forcebound/server/environment/environment.hpp"

namespace forcebound::server {

/// A scene as an environment. Each client has its own state of it, but for the dynamic models of a shared scene, which
/// begin with the first client and end with the last; who comes after one of them has ceased to be finite begins new
/// ones. With `accuracy = "auto"` the level that suits the client's round trip is made.
///
/// The environments of one kind belong to one thread.
EnvironmentKind scene_environment(const std::shared_ptr<const scene::Scene>& scene);

}  // namespace forcebound::server
