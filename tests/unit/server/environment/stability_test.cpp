#include "forcebound/server/environment/stability.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Ringing, NeedsHalfThePeriodTheAgeTheDelayAndTheDamper) {
  const Ringing part{.stiffness_N_per_m = 1000, .stiffening_N_per_m2 = 2e5, .damping_N_s_per_m = 3, .age_s = 0.002};
  EXPECT_NEAR(part.damping_needed_N_s_per_m(0), 1000 * 0.0025 + 3, 1e-12);
  EXPECT_NEAR(part.damping_needed_N_s_per_m(0.02), 1000 * 0.0225 + 3, 1e-12);
  EXPECT_NEAR(part.damping_needed_N_s_per_m(0, 0.01), 3000 * 0.0025 + 3, 1e-12);
}

TEST(Ringing, AddsUpAtOnePlace) {
  const Ringing both = Ringing{.stiffness_N_per_m = 1, .damping_N_s_per_m = 4, .age_s = 0.002}.with(
      {.stiffness_N_per_m = 2, .stiffening_N_per_m2 = 3, .damping_N_s_per_m = 5, .age_s = 0.001, .drives = true});
  EXPECT_EQ(both.stiffness_N_per_m, 3);
  EXPECT_EQ(both.stiffening_N_per_m2, 3);
  EXPECT_EQ(both.damping_N_s_per_m, 9);
  EXPECT_EQ(both.age_s, 0.002);
  EXPECT_TRUE(both.drives);
}

// The wall of the paper's device: 2 b/T is just passive.
TEST(StabilityText, SaysAMarginOfOneAtTwoBOverT) {
  const std::string text = stability_text({.stiffness_N_per_m = 60000}, {.damping_N_s_per_m = 30}, "  ");
  EXPECT_EQ(text,
            "passive without a law on a device with damping above 30 N s/m (b > K T/2 + B: K 60000 N/m, B 0 N s/m, T 1 "
            "ms)\n  margin 1 for a device of 30 N s/m");
}

TEST(StabilityText, TheDamperOfAWallAsksForItsOwn) {
  const std::string text = stability_text({.damping_N_s_per_m = 5}, {.damping_N_s_per_m = 2}, "");
  EXPECT_THAT(text, HasSubstr("damping above 5 N s/m"));
  EXPECT_THAT(text, HasSubstr("margin 0.4 for"));
}

TEST(StabilityText, GivesTheMarginBehindANetwork) {
  const std::string text =
      stability_text({.stiffness_N_per_m = 1000}, {.damping_N_s_per_m = 1, .round_trip_s = 0.0195}, "");
  EXPECT_THAT(text, HasSubstr("margin 2 for a device of 1 N s/m, 0.05 behind a round trip of 19.5 ms"));
}

TEST(StabilityText, GivesNoFinalValueForAStiffeningSpring) {
  const std::string text = stability_text({.stiffness_N_per_m = 1000, .stiffening_N_per_m2 = 1e5}, {}, "");
  EXPECT_THAT(text, HasSubstr("above 0.5 N s/m, 1 at a depth of 10 mm, the more the deeper"));
}

TEST(StabilityText, NoDampingMakesADrivePassive) {
  EXPECT_EQ(stability_text({.drives = true}, {}, ""),
            "drives the device with energy of its own, which a law bounds and no damping does");
  EXPECT_THAT(stability_text({.damping_N_s_per_m = 1, .drives = true}, {}, "  "),
              AllOf(StartsWith("drives the device"), HasSubstr("\n  apart from that energy passive without a law")));
  EXPECT_THAT(stability_text({.damping_N_s_per_m = 1}, {}, ""), StartsWith("passive without a law"));
}

TEST(StabilityText, SaysThatAnEmptySceneCannotRing) {
  EXPECT_EQ(stability_text({}, {}, ""), "neither stiffness nor damping: nothing that could ring");
}

}  // namespace
}  // namespace forcebound::server
