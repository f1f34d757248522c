#pragma once

#include <Eigen/Core>

namespace forcebound::server {

/// A point, direction or force in the scene's frame. Scenes of one or two dimensions lie on the first axes.
using Point = Eigen::Vector3d;

}  // namespace forcebound::server
