#include "forcebound/server/robot/command_queue.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace forcebound::server {
namespace {

using std::chrono::microseconds;

control::DeviceFacts facts() {
  control::DeviceFacts facts;
  facts.damping = control::Matrix::Identity(1, 1);
  facts.latency_s = 3e-4;
  facts.hold_s_max = 2e-3;
  return facts;
}

double torque_at(CommandQueue& queue, Nanoseconds now) {
  queue.pass(now);
  return queue.torque()[0];
}

TEST(CommandQueue, HoldsACommandFromItsLatencyUntilItsHoldTime) {
  CommandQueue queue(facts());
  queue.command(microseconds(0), Vector::Constant(1, 5));
  EXPECT_EQ(torque_at(queue, microseconds(299)), 0);
  EXPECT_EQ(queue.next_change(microseconds(0), microseconds(9000)), microseconds(300));
  EXPECT_EQ(torque_at(queue, microseconds(300)), 5);
  EXPECT_EQ(queue.next_change(microseconds(300), microseconds(9000)), microseconds(2300));
  EXPECT_FALSE(queue.released().has_value());
  EXPECT_EQ(torque_at(queue, microseconds(2299)), 5);
  EXPECT_EQ(torque_at(queue, microseconds(2300)), 0);
  EXPECT_EQ(queue.released(), microseconds(2300));
}

TEST(CommandQueue, ANewCommandEndsTheOneBefore) {
  CommandQueue queue(facts());
  queue.command(microseconds(0), Vector::Constant(1, 5));
  (void)torque_at(queue, microseconds(1000));
  queue.command(microseconds(1000), Vector::Constant(1, -1));
  EXPECT_EQ(torque_at(queue, microseconds(1299)), 5);
  EXPECT_EQ(torque_at(queue, microseconds(1300)), -1);
  EXPECT_EQ(torque_at(queue, microseconds(3299)), -1);
  EXPECT_EQ(torque_at(queue, microseconds(3300)), 0);
}

TEST(CommandQueue, PassesAReleaseAndALaterCommandInTheirOrder) {
  CommandQueue queue(facts());
  queue.command(microseconds(0), Vector::Constant(1, 5));
  (void)torque_at(queue, microseconds(2100));
  queue.command(microseconds(2100), Vector::Constant(1, 7));
  EXPECT_EQ(torque_at(queue, microseconds(2350)), 0);
  EXPECT_FALSE(queue.released().has_value()) << "the last command is still on its way";
  EXPECT_EQ(torque_at(queue, microseconds(5000)), 0);
  EXPECT_EQ(queue.released(), microseconds(4400));
}

TEST(CommandQueue, DropsWhatIsInEffectAndWhatIsOnItsWay) {
  CommandQueue queue(facts());
  queue.command(microseconds(0), Vector::Constant(1, 5));
  (void)torque_at(queue, microseconds(500));
  queue.command(microseconds(500), Vector::Constant(1, 7));
  queue.drop(microseconds(600));
  EXPECT_EQ(torque_at(queue, microseconds(900)), 0);
  EXPECT_EQ(queue.released(), microseconds(600));
  EXPECT_EQ(queue.next_change(microseconds(900), microseconds(9000)), microseconds(9000));
}

}  // namespace
}  // namespace forcebound::server
