#include "tests/tools/lab/comparison/pareto.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace forcebound::lab {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(ParetoFront, HasThoseNotDominated) {
  const std::vector<Trade> trades{{1, 1}, {2, 2}, {2, 1}, {3, 1.5}};
  EXPECT_THAT(pareto_front(trades), ElementsAre(0, 1));
}

TEST(ParetoFront, KeepsBothOfTwoEqualOnes) {
  const std::vector<Trade> trades{{1, 1}, {1, 1}, {1, 0.5}};
  EXPECT_THAT(pareto_front(trades), ElementsAre(0, 1));
}

TEST(ParetoFront, LeavesOutNaN) {
  const std::vector<Trade> trades{{std::nan(""), 5}, {0, std::nan("")}, {1, 1}};
  EXPECT_THAT(pareto_front(trades), ElementsAre(2));
  EXPECT_THAT(pareto_front({}), IsEmpty());
}

}  // namespace
}  // namespace forcebound::lab
