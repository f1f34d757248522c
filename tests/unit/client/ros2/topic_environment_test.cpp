#include "forcebound/client/ros2/topic_environment.hpp"

#include <gmock/gmock.h>

#include <thread>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::ros2 {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

struct TopicEnvironmentTest : testing::Test {
  server::Answer respond(Nanoseconds now, const Vector& position, bool shows_torque = false) {
    TopicEnvironment environment(inbox, {.hold = 250ms, .drop = 500ms}, ages, shows_torque, &answered);
    return environment.respond({.position = position, .server_time = now});
  }
  void receive(Nanoseconds arrival) {
    (void)inbox.receive(
        {.publisher = 1, .frame = {}, .wrench = {.force_N = {1, 2, 3}, .torque_N_m = {4, 5, 6}, .arrival = arrival}});
  }

  WrenchInbox inbox{"base", 500ms};
  AnswerAges ages;
  StateQueue answered;
  const Vector place = Vector::Zero(3);
};

TEST_F(TopicEnvironmentTest, AnswersZeroBeforeTheFirstWrench) {
  const server::Answer answer = respond(1s, place);
  EXPECT_EQ(answer.force, Vector::Zero(3));
  EXPECT_EQ(ages.newest(), record::ForcePolicy::none);
}

TEST_F(TopicEnvironmentTest, HoldsThenFadesThenDropsByTheTimeSinceArrival) {
  receive(1s);
  EXPECT_EQ(respond(1250ms, place).force, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(respond(1375ms, place).force.isApprox(Eigen::Vector3d(0.5, 1, 1.5)));
  EXPECT_EQ(respond(1500ms, place).force, Vector::Zero(3));
  EXPECT_THAT(ages.counts(), ElementsAre(0, 1, 1, 1));
  EXPECT_EQ(ages.age(), 500ms);
}

TEST_F(TopicEnvironmentTest, GivesEachDeviceTheRowsThatItHas) {
  receive(1s);
  EXPECT_EQ(respond(1s, Vector::Zero(1)).force, Vector::Constant(1, 1));
  const server::Answer of_six = respond(1s, Vector::Zero(6));
  EXPECT_EQ(of_six.force.head(3), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(of_six.force.tail(3), Eigen::Vector3d::Zero());
  EXPECT_EQ(of_six.torque_N_m.rows(), 0);
}

TEST_F(TopicEnvironmentTest, FadesTheTorqueOfADeviceThatShowsIt) {
  receive(1s);
  EXPECT_TRUE(respond(1375ms, place, true).torque_N_m.isApprox(Eigen::Vector3d(2, 2.5, 3)));
}

TEST_F(TopicEnvironmentTest, TellsWhatItAnsweredInOrder) {
  receive(1s);
  (void)respond(1s, place);
  (void)respond(1600ms, place);
  answered.close();
  StateSample sample;
  ASSERT_TRUE(answered.wait_and_take(sample));
  EXPECT_EQ(sample.force_N, Eigen::Vector3d(1, 2, 3));
  ASSERT_TRUE(answered.wait_and_take(sample));
  EXPECT_EQ(sample.time, 1600ms);
  EXPECT_EQ(sample.force_N, Vector::Zero(3));
  EXPECT_FALSE(answered.wait_and_take(sample));
}

TEST_F(TopicEnvironmentTest, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  receive(1s);
  const test::AllocationGuard guard;
  (void)respond(1s, place, true);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(StateQueue, DropsAndCountsWhatFindsNoRoom) {
  StateQueue queue;
  constexpr std::uint64_t kMany = 5000;
  for (std::uint64_t i = 0; i < kMany; ++i) queue.push({});
  queue.close();
  std::uint64_t taken = 0;
  for (StateSample sample; queue.wait_and_take(sample);) ++taken;
  EXPECT_EQ(taken, 10U);
  EXPECT_EQ(taken + queue.dropped(), kMany);
}

TEST(StateQueue, GivesTheLastTenToASlowReader) {
  StateQueue queue;
  for (int i = 1; i <= 100; ++i) queue.push({.time = Nanoseconds{i}});
  StateSample sample;
  ASSERT_TRUE(queue.wait_and_take(sample));
  EXPECT_EQ(sample.time, 91ns);
  for (int i = 101; i <= 103; ++i) queue.push({.time = Nanoseconds{i}});
  ASSERT_TRUE(queue.wait_and_take(sample));
  EXPECT_EQ(sample.time, 94ns);
  EXPECT_EQ(queue.dropped(), 92U);
}

TEST(StateQueue, CarriesSamplesInOrderFromThreadToThread) {
  StateQueue queue;
  constexpr int kMany = 20000;
  std::jthread tick([&queue] {
    for (int i = 1; i <= kMany; ++i) queue.push({.time = Nanoseconds{i}});
    queue.close();
  });
  std::uint64_t taken = 0;
  Nanoseconds last{0};
  for (StateSample sample; queue.wait_and_take(sample); last = sample.time, ++taken) ASSERT_GT(sample.time, last);
  EXPECT_EQ(taken + queue.dropped(), kMany);
}

}  // namespace
}  // namespace forcebound::ros2
