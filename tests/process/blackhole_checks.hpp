#pragma once

#include <chrono>

namespace forcebound::test {

/// Two clients in contact through a relay each, one with a dead way up and one with a dead way down for so long: both
/// stay passive, recover, and tell in their summaries which way it was.
///
///     client --- relay (up is dead for a time) ---+
///                                                 +--- server
///     client --- relay (down is dead) ------------+
void expect_dead_ways_are_told(std::chrono::seconds duration);

}  // namespace forcebound::test
