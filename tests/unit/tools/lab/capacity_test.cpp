#include "tests/tools/lab/load/capacity.hpp"

#include <gtest/gtest.h>

#include <random>

namespace forcebound::lab {
namespace {

TEST(MostThatHold, IsTheTrueMostWithinTheResolution) {
  for (const std::size_t truth : {1U, 2U, 3U, 7U, 8U, 9U, 100U, 333U, 4000U}) {
    const std::size_t found =
        most_that_hold({.resolution = 0.03}, [&](std::size_t clients) { return clients <= truth; });
    EXPECT_LE(found, truth);
    EXPECT_GE(static_cast<double>(found), 0.96 * static_cast<double>(truth));
  }
}

TEST(MostThatHold, IsExactWithoutAResolution) {
  for (std::size_t truth = 0; truth <= 50; ++truth) {
    const CapacitySearch search{.first = 4, .limit = 40, .resolution = 0};
    EXPECT_EQ(most_that_hold(search, [&](std::size_t clients) { return clients <= truth; }),
              std::min<std::size_t>(truth, 40));
  }
}

TEST(MostThatHold, NeverTriesMoreThanTheLimit) {
  std::size_t asked_most = 0;
  const auto holds = [&](std::size_t clients) {
    asked_most = std::max(asked_most, clients);
    return true;
  };
  EXPECT_EQ(most_that_hold({.first = 8, .limit = 100}, holds), 100U);
  EXPECT_EQ(asked_most, 100U);
}

TEST(MostThatHold, IsNearlyAsHighWithOneFailureInThree) {
  std::mt19937 random(7);
  for (int run = 0; run < 20; ++run) {
    const std::size_t found = most_that_hold({.resolution = 0.02, .attempts = 5},
                                             [&](std::size_t clients) { return clients <= 300 && random() % 3 != 0; });
    EXPECT_LE(found, 300U);
    EXPECT_GE(found, 250U) << "run " << run;
  }
}

TEST(MostThatHold, TriesFailedNumbersAgainAndOthersOnce) {
  int trials = 0;
  const auto never = [&](std::size_t) {
    ++trials;
    return false;
  };
  EXPECT_EQ(most_that_hold({.first = 1, .attempts = 3}, never), 0U);
  EXPECT_EQ(trials, 6);  // and again at the end
}

}  // namespace
}  // namespace forcebound::lab
