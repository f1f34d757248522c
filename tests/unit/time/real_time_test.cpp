#include "forcebound/time/real_time.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <cerrno>
#include <cstring>
#include <thread>

namespace forcebound::time {
namespace {

// As systemd starts a service with CPUSchedulingResetOnFork. A service without capabilities may not drop the flag.
TEST(RealTime, KeepsTheFlagThatChildrenHaveNone) {
  int before = 0;
  int refused = 0;
  int after = 0;
  int priority = 0;
  std::thread([&] {
    const sched_param lower{.sched_priority = 1};
    if (sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &lower) != 0) before = errno;
    refused = ask_for_first_in_first_out(2);
    after = sched_getscheduler(0);
    sched_param granted{};
    sched_getparam(0, &granted);
    priority = granted.sched_priority;
  }).join();
  if (before != 0) GTEST_SKIP() << "SCHED_FIFO is not granted here: " << std::strerror(before);
  EXPECT_EQ(refused, 0) << std::strerror(refused);
  EXPECT_EQ(after, SCHED_FIFO | SCHED_RESET_ON_FORK);
  EXPECT_EQ(priority, 2);
}

}  // namespace
}  // namespace forcebound::time
