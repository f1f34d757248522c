#include "forcebound/time/latest.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace forcebound::server {
namespace {

TEST(Latest, GivesTheNewestOnce) {
  time::Latest<int> latest;
  EXPECT_EQ(latest.take(), nullptr);
  latest.store(1);
  latest.store(2);
  ASSERT_NE(latest.take(), nullptr);
  EXPECT_EQ(latest.take(), nullptr);
  latest.store(3);
  const int* three = latest.take();
  ASSERT_NE(three, nullptr);
  EXPECT_EQ(*three, 3);
  latest.store(4);
  EXPECT_EQ(*three, 3) << "valid until it is asked again";
}

TEST(Latest, IsNeverTornAndNeverGoesBack) {
  struct Pair {
    long a = 0;
    long b = 0;
  };
  time::Latest<Pair> latest;
  constexpr long kLast = 200000;
  std::thread writer([&] {
    for (long n = 1; n <= kLast; ++n) latest.store({n, -n});
  });
  long seen = 0;
  while (seen < kLast) {
    const Pair* pair = latest.take();
    if (pair == nullptr) continue;
    ASSERT_EQ(pair->a, -pair->b);
    ASSERT_GT(pair->a, seen);
    seen = pair->a;
  }
  writer.join();
}

}  // namespace
}  // namespace forcebound::server
