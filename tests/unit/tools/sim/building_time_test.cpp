#include "tests/tools/sim/building_time.hpp"

#include <gtest/gtest.h>

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

TEST(BuildingTime, IsThePauseAndThatOfAllThatWasBuilt) {
  EXPECT_EQ(time_of_building(0), 2ms);
  EXPECT_EQ(time_of_building(1000), 5ms);
  EXPECT_EQ(time_of_building(1'000'000), 3002ms);
}

}  // namespace
}  // namespace forcebound::sim
