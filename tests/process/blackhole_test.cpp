#include "tests/process/blackhole_checks.hpp"

#include <gtest/gtest.h>

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;

TEST(ADeadWayOfTheNetwork, IsNamedByTheClientsSummary) { expect_dead_ways_are_reported(3s); }

}  // namespace
}  // namespace forcebound::test
