#pragma once

#include <memory>

#include "forcebound/scene/scene.hpp"
#include "forcebound/server/offer/environment.hpp"

namespace forcebound::server {

/// A scene as an environment. Each client has its own state, except for the dynamic models of a shared scene: they are
/// created for the first client and destroyed with the last. After one of them was quarantined, the next client to join
/// gets new ones. With `accuracy = "auto"`, the level is chosen by the client's round trip.
///
/// All environments of one kind must be used by one thread.
EnvironmentKind scene_environment(const std::shared_ptr<const scene::Scene>& scene);

}  // namespace forcebound::server
