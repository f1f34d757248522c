#pragma once

#include <vector>

#include "tests/tools/lab/rendering/rendering_task.hpp"

namespace forcebound::lab {

/// Bodies that a ball of 6 mm pushes, presses or holds: a sled, a stack, a door, a button, a ball, and the shipped
/// scenes `blocks` and `two_on_a_block`. The hand goes from place to place whatever it feels; its first motion is 2 s
/// after the start.
///
/// @throws server::SceneError where there are no bodies (server::has_bodies)
[[nodiscard]] std::vector<RenderingTask> body_tasks();

}  // namespace forcebound::lab
