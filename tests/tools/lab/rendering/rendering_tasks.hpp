#pragma once

#include <vector>

#include "tests/tools/lab/rendering/rendering_task.hpp"

namespace forcebound::lab {

/// Of scenes that stand still: plane, primitives, corner, edge, friction, stick-slip, height field, and meshes of 5,856
/// and 70,000 triangles at 0.05 to 0.5 m/s, on a firm device (30 N s/m, 15 um) at 10 N/mm; a plane and a mesh on a
/// light one (1 N s/m, 20 um) at 1 N/mm; a mesh of 181,920 touched at once. And of what moves, by local models: a pad
/// of tissue under a point and a ball, and, where there are bodies, a puck that is dragged, free and against a stop,
/// and those of body_tasks.hpp.
[[nodiscard]] std::vector<RenderingTask> rendering_tasks();

}  // namespace forcebound::lab
