#pragma once

namespace forcebound::test {

/// With fba-exact P never falls below this, which is rounding, whatever machine and network do.
inline constexpr double kPassive_J = -1e-9;

}  // namespace forcebound::test
