#include "forcebound/text/names.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace forcebound::text {
namespace {

const std::vector<std::string> kScenes{"box", "circle", "sphere"};
const std::vector<std::string> kKeys{"damping_N_s_per_m", "mass_kg", "friction_N"};

TEST(NearestName, FindsANameWithAMisspelling) {
  EXPECT_EQ(nearest_name("mas_kg", kKeys), "mass_kg");
  EXPECT_EQ(nearest_name("spere", kScenes), "sphere");
  EXPECT_EQ(nearest_name("circel", kScenes), "circle");
}

TEST(NearestName, FindsANameWithoutItsUnit) { EXPECT_EQ(nearest_name("damping", kKeys), "damping_N_s_per_m"); }

TEST(NearestName, FindsNothingForAnotherWord) {
  EXPECT_EQ(nearest_name("colour", kKeys), "");
  EXPECT_EQ(nearest_name("temperature", kScenes), "");
  EXPECT_EQ(nearest_name("", kScenes), "");
}

TEST(IsSlipOf, IsTwoLettersOrAUnitApartAndNoMore) {
  EXPECT_TRUE(is_slip_of("mas_kg", "mass_kg"));
  EXPECT_TRUE(is_slip_of("damping", "damping_N_s_per_m"));
  EXPECT_FALSE(is_slip_of("static_coefficient", "dynamic_coefficient"));
  EXPECT_FALSE(is_slip_of("mass_kg", "mass_kg"));
}

TEST(Suggestion, AsksAndListsWhatIsKnown) {
  EXPECT_EQ(suggestion("spere", kScenes), ", did you mean 'sphere'? (known: box, circle, sphere)");
  EXPECT_EQ(suggestion("x", kScenes), " (known: box, circle, sphere)");
}

TEST(Suggestion, SaysWhereNothingIsKnown) { EXPECT_EQ(suggestion("x", {}), "; there are none"); }

}  // namespace
}  // namespace forcebound::text
