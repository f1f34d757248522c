#pragma once

#include <memory>

#include "forcebound/scene/scene.hpp"

namespace forcebound::python {

/// A scene as Python has it.
struct SceneHandle {
  std::shared_ptr<const scene::Scene> scene;
};

}  // namespace forcebound::python
