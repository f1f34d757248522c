#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "tests/support/adversary.hpp"
#include "tests/support/law_loop.hpp"
#include "tests/support/random_ticks.hpp"

/// Checks for both published laws.
namespace forcebound::test {

using Reference = std::vector<ReferenceAnswer> (*)(const std::vector<ReferenceTick>&, const ReferenceSetting&);

/// Force, energy and xi agree with the reference to 1e-9 relative on every tick, and the force was bounded at least
/// once.
void expect_agreement(std::string_view law, Reference reference, const RandomRun& run);

/// Symmetric, positive definite, no zero in it.
control::Matrix full_damping(int degrees_of_freedom, std::uint64_t seed);

/// No hand and no environment extract more energy than the damping dissipates, however the damping changes.
void expect_passive_against_any_adversary(std::string_view law, const LawLoopSetting& setting = {});

/// The force is the request times a number from 0 to 1.
void expect_direction_kept(std::string_view law);

/// For any request: force and energy are finite, a request that is not finite gives zero force, and the law recovers.
void expect_finite_for_hard_requests(std::string_view law);

}  // namespace forcebound::test
