#include "tests/tools/lab/rendering/two_people.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "forcebound/server/environment/body_models.hpp"

namespace forcebound::lab {
namespace {

TEST(TwoPeople, FeelTheBlockWithEitherRenderingThoughTheOtherComesLate) {
  if (!server::has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  const TwoPeopleSettings settings{.seeds = 1};
  const std::vector<TwoPeopleRow> rows = study_two_people(settings);
  ASSERT_EQ(rows.size(), 2U);
  const TwoPeopleRow& remote = rows[0];
  const TwoPeopleRow& local = rows[1];
  ASSERT_TRUE(local.local && !remote.local);
  for (std::size_t i = 0; i < local.people.size(); ++i) {
    EXPECT_GT(local.people.at(i).force_N, 0.1);
    EXPECT_GE(local.people.at(i).minimum_J, -1e-9);
    EXPECT_GE(remote.people.at(i).minimum_J, -1e-9);
    EXPECT_EQ(remote.people.at(i).deviation_m, 0) << "nothing of it is at the client";
  }
  // What the other does now is not known before it is told: neither rendering spares a person that.
  for (const TwoPeopleRow& row : rows) {
    EXPECT_LT(row.people[0].error, 0.5) << "behind 10 ms";
    EXPECT_LT(row.people[1].error, 0.8) << "behind 80 ms";
    EXPECT_LT(row.impulse, 0.05) << "the block is at rest in the end";
  }
  EXPECT_THAT(two_people_table(settings, rows), testing::HasSubstr("local  at 80 ms"));
}

}  // namespace
}  // namespace forcebound::lab
