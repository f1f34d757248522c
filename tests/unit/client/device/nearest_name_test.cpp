#include "forcebound/client/device/nearest_name.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace forcebound::client {
namespace {

const std::vector<std::string> kKnown = {"damping_N_s_per_m", "mass_kg", "friction_N"};

TEST(NearestName, ForgivesASlipOfTheFinger) { EXPECT_EQ(nearest_name("mas_kg", kKnown), "mass_kg"); }

TEST(NearestName, ForgivesAUnitLeftOut) { EXPECT_EQ(nearest_name("damping", kKnown), "damping_N_s_per_m"); }

TEST(NearestName, OffersNothingForAStranger) { EXPECT_EQ(nearest_name("colour", kKnown), ""); }

TEST(NearestName, SuggestionListsWhatIsKnown) {
  EXPECT_EQ(suggestion("frictionN", kKnown), "did you mean 'friction_N'? Known: damping_N_s_per_m mass_kg friction_N");
  EXPECT_EQ(suggestion("x", kKnown), "Known: damping_N_s_per_m mass_kg friction_N");
}

}  // namespace
}  // namespace forcebound::client
