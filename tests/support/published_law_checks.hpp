#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "tests/support/adversary.hpp"
#include "tests/support/law_loop.hpp"
#include "tests/support/random_ticks.hpp"

/// What holds for both published laws, checked in the same way.
namespace forcebound::test {

using Reference = std::vector<ReferenceAnswer> (*)(const std::vector<ReferenceTick>&, const ReferenceSetting&);

/// Force, energy and xi agree with the reference to 1e-9 relative on every tick, and bounding did happen.
void expect_agreement(std::string_view law, Reference reference, const RandomRun& run);

/// Symmetric, positive definite, no zero in it.
control::Matrix full_damping(int degrees_of_freedom, std::uint64_t seed);

/// No hand and no environment take more out than the damping takes, whatever the damping does from tick to tick.
void expect_passive_against_any_adversary(std::string_view law, const LawLoopSetting& setting = {});

/// The force is the request times a number from 0 to 1.
void expect_direction_kept(std::string_view law);

/// Whatever is asked for: force and energy are finite, what is not finite is no force, and the law recovers.
void expect_finite_for_hard_requests(std::string_view law);

}  // namespace forcebound::test
