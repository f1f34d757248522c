#pragma once

#include <memory>

#include "forcebound/scene/geometry/shape.hpp"
#include "forcebound/server/environment/checked_table.hpp"

namespace forcebound::server {

/// Reads `kind` and what belongs to it; points have `rows` numbers.
/// @param reach_m how far outside of it the distance to it is wanted; 0: only contact
/// @throws SceneError
std::unique_ptr<scene::Shape> parse_shape(CheckedTable& table, Eigen::Index rows, double reach_m);

}  // namespace forcebound::server
