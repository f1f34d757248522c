#pragma once

#include <memory>

#include "forcebound/server/geometry/shape.hpp"
#include "forcebound/server/scene/checked_table.hpp"

namespace forcebound::server {

/// Reads `kind` and what belongs to it; points have `rows` numbers.
/// @throws SceneError
std::unique_ptr<Shape> parse_shape(CheckedTable& table, Eigen::Index rows);

}  // namespace forcebound::server
