#include "tests/lab/load/crew.hpp"

#include <gmock/gmock.h>

#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class CrewTest : public testing::Test {
 protected:
  template <class Message>
  Message said(std::span<const std::byte> datagram) {
    const auto decoded = server_.decode(datagram);
    return std::get<Message>(std::get<wire::Message>(decoded));
  }

  void arrive(Crew& crew, const wire::Message& message, Nanoseconds arrival = 0ns, Nanoseconds now = 0ns) {
    const auto datagram = server_.encode(message);
    crew.on_datagram(std::vector(datagram.begin(), datagram.end()), arrival, now);
  }

  wire::Codec server_;
};

TEST_F(CrewTest, GivesEachMemberItsOwnNonceAndTheSessionOfItsWelcome) {
  Crew crew({.degrees_of_freedom = 2, .scene = "circle", .first_nonce = 1000});
  crew.grow(2);
  const auto first = said<wire::Hello>(crew.hello(0));
  EXPECT_EQ(first.degrees_of_freedom, 2U);
  EXPECT_EQ(first.scene, "circle");
  const auto second = said<wire::Hello>(crew.hello(1)).client_nonce;
  arrive(crew, wire::Welcome{.client_nonce = second, .session = 77});
  EXPECT_FALSE(crew.connected(0));
  EXPECT_TRUE(crew.connected(1));
  EXPECT_EQ(said<wire::MotionSample>(crew.motion(1, 5ms)).session, 77U);
  EXPECT_EQ(said<wire::Bye>(crew.bye(1)).session, 77U);
  arrive(crew, wire::Welcome{.client_nonce = 999, .session = 5});  // somebody else's
  EXPECT_FALSE(crew.connected(0));
}

TEST_F(CrewTest, NumbersTheMotionsOfEachMemberAndStampsThem) {
  Crew crew({.degrees_of_freedom = 3, .echo = true});
  crew.grow(2);
  static_cast<void>(crew.motion(0, 1ms));
  const auto motion = said<wire::MotionSample>(crew.motion(0, 2ms));
  EXPECT_EQ(motion.sequence, 2U);
  EXPECT_EQ(motion.device_time, 2ms);
  EXPECT_EQ(motion.position.rows(), 3);
  EXPECT_NEAR(motion.position.norm(), 0.02, 1e-12);
  EXPECT_EQ(said<wire::MotionSample>(crew.motion(1, 2ms)).sequence, 1U);
  EXPECT_EQ(crew.tally().sent, 3U);
}

TEST_F(CrewTest, MeasuresFromTheMotionToTheArrivalAndToTheReading) {
  Crew crew({});
  crew.grow(1);
  crew.begin(10ms);
  static_cast<void>(crew.motion(0, 11ms));
  arrive(crew, wire::EnvironmentForce{.motion_device_time = 11ms}, 11ms + 900ns, 11ms + 1000ns);
  EXPECT_EQ(crew.tally().answered, 1U);
  EXPECT_EQ(crew.tally().arrived_ns.max(), 900);
  EXPECT_EQ(crew.tally().read_ns.max(), 1000);
}

TEST_F(CrewTest, CountsEchoedMotionsLikeForces) {
  Crew crew({.echo = true});
  crew.grow(1);
  EXPECT_TRUE(crew.connected(0));
  const auto motion = crew.motion(0, 3ms);
  crew.on_datagram(std::vector(motion.begin(), motion.end()), 4ms, 4ms);
  EXPECT_EQ(crew.tally().answered, 1U);
  EXPECT_EQ(crew.tally().arrived_ns.max(), 1'000'000);
}

TEST_F(CrewTest, CountsAnswersFromBeforeAndNoiseAsForeign) {
  Crew crew({});
  crew.grow(1);
  crew.begin(10ms);
  arrive(crew, wire::EnvironmentForce{.motion_device_time = 9ms}, 11ms, 11ms);
  crew.on_datagram(std::vector<std::byte>(20), 11ms, 11ms);
  EXPECT_EQ(crew.tally().answered, 0U);
  EXPECT_EQ(crew.tally().foreign, 2U);
}

TEST_F(CrewTest, KeepsTheServersRefusal) {
  Crew crew({});
  crew.grow(1);
  arrive(crew, wire::Refusal{.text = "all 64 sessions are taken"});
  EXPECT_THAT(crew.refusal(), HasSubstr("64 sessions"));
}

TEST_F(CrewTest, DoesNotAllocateWhileMeasuring) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  Crew crew({});
  crew.grow(4);
  crew.begin(0ns);
  const auto force = server_.encode(wire::EnvironmentForce{.motion_device_time = 1ms});
  const test::AllocationGuard guard;
  for (std::size_t client = 0; client < 4; ++client) {
    static_cast<void>(crew.motion(client, 1ms));
    crew.on_datagram(force, 2ms, 2ms);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_EQ(crew.tally().answered, 4U);
}

}  // namespace
}  // namespace forcebound::lab
