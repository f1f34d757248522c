#pragma once

#include <memory>

#include "forcebound/scene/geometry/shape.hpp"
#include "forcebound/server/environment/checked_table.hpp"

namespace forcebound::server {

/// Reads a height field: `origin_m`, `spacing_m`, and either `heights_m`, a list of rows, or `file`, a table of numbers
/// separated by commas, one row to a line, beside the scene's file. Rows follow each other along y, their numbers
/// along x.
/// @throws SceneError
std::unique_ptr<scene::Shape> parse_height_field(CheckedTable& table, Eigen::Index rows);

}  // namespace forcebound::server
