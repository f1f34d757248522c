#include "forcebound/client/runtime/stuck_loop.hpp"

#include <gtest/gtest.h>

namespace forcebound::client {
namespace {

TEST(StuckLoop, IsOneThatMadeNoRoundInSoManyLooks) {
  StuckLoop stuck(3);
  EXPECT_FALSE(stuck.update(7));
  EXPECT_FALSE(stuck.update(7));
  EXPECT_FALSE(stuck.update(7));
  EXPECT_TRUE(stuck.update(7));
  EXPECT_FALSE(stuck.update(8)) << "it goes on";
}

TEST(StuckLoop, IsNoneThatHasNotBegun) {
  StuckLoop stuck(1);
  for (int look = 0; look < 100; ++look) EXPECT_FALSE(stuck.update(0));
}

}  // namespace
}  // namespace forcebound::client
