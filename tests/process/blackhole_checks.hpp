#pragma once

#include <chrono>

namespace forcebound::test {

/// Two clients in contact through a relay each, one with a blackout up and one with a blackout down: both stay passive,
/// recover, and name the direction in their summaries.
///
///     client --- relay (up is dead for a time) ---+
///                                                 +--- server
///     client --- relay (down is dead) ------------+
void expect_dead_ways_are_reported(std::chrono::seconds duration);

}  // namespace forcebound::test
