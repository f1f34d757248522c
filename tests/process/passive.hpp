#pragma once

namespace forcebound::test {

/// fba-exact lets P fall to this by rounding and no further, whatever machine and network do.
inline constexpr double kPassive_J = -1e-9;

}  // namespace forcebound::test
