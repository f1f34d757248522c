#pragma once

#include <cstdint>

#include "tests/tools/reference/kinematic_adversary.hpp"

namespace forcebound::test {

/// A device of one to six joints, with ticks on time or late, whose facts are exactly what is true.
[[nodiscard]] KinematicGame game_of_exact_facts(std::uint64_t seed);

/// What may be true in place of exact facts, in any mixture.
[[nodiscard]] DeviceTruth truth_beyond_facts(std::uint64_t seed);

}  // namespace forcebound::test
