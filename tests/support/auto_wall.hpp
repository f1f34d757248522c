#pragma once

namespace forcebound::test {

/// A wall with levels of accuracy: soft and quick, or stiff and slow; the softer, the larger its stated model error.
inline constexpr const char* kAutoWall = R"([scene]
name = "auto_wall"
description = "A wall of two kinds."
degrees_of_freedom = "any"
accuracy = "auto"

[accuracy]
key = "object.wall.surface.stiffness_N_per_m"
change_per_s = 20
levels = [
  { value = 100.0, model_error = 0.1 },
  { value = 200.0, model_error = 0.01 },
]

[[object]]
name = "wall"
shape = { kind = "half_space", through_m = [0], normal = [-1] }
effects = ["surface"]

[object.surface]
stiffness_N_per_m = 150
)";

}  // namespace forcebound::test
