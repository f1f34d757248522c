#include "tests/lab/load/crew.hpp"

#include <gmock/gmock.h>

#include <limits>
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
  const auto first = said<wire::Hello>(crew.hello(0, 0ms));
  EXPECT_EQ(first.degrees_of_freedom, 2U);
  EXPECT_EQ(first.scene, "circle");
  const auto second = said<wire::Hello>(crew.hello(1, 0ms)).client_nonce;
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

TEST_F(CrewTest, SaysTheRoundTripToAServerThatWantsItAndIsNotRefusedByThat) {
  Crew crew({});
  crew.grow(2);
  const auto hello = said<wire::Hello>(crew.hello(1, 10ms));
  EXPECT_EQ(hello.round_trip, 0ms);
  EXPECT_EQ(hello.client_time, 10ms);
  arrive(crew,
         wire::Refusal{.client_nonce = hello.client_nonce,
                       .reason = wire::RefusalReason::round_trip_wanted,
                       .text = "say Hello again",
                       .client_time = hello.client_time},
         13ms, 13ms);
  EXPECT_EQ(crew.refusal(), "");
  const auto again = said<wire::Hello>(crew.hello(1, 20ms));
  EXPECT_EQ(again.client_nonce, hello.client_nonce);
  EXPECT_EQ(again.round_trip, 3ms);
  EXPECT_EQ(said<wire::Hello>(crew.hello(0, 20ms)).round_trip, 0ms) << "each measures its own";
}

TEST_F(CrewTest, CountsMotionsThatAreNeverAnsweredAsNeverInTime) {
  Crew crew({});
  crew.grow(1);
  crew.begin(0ns);
  EXPECT_EQ(crew.tally().answered_within_ns(0.99), std::numeric_limits<double>::infinity());
  const auto send_and_answer = [&](int motions, Nanoseconds after) {
    for (int i = 0; i < motions; ++i) {
      static_cast<void>(crew.motion(0, 1ms));
      arrive(crew, wire::EnvironmentForce{.motion_device_time = 1ms}, 1ms + after, 1ms + after);
    }
  };
  send_and_answer(990, 100ns);
  send_and_answer(5, 900ns);
  for (int i = 0; i < 5; ++i) static_cast<void>(crew.motion(0, 1ms));  // lost
  EXPECT_EQ(crew.tally().answered_within_ns(0.99), 100);
  EXPECT_EQ(crew.tally().answered_within_ns(0.995), 900);
  EXPECT_EQ(crew.tally().answered_within_ns(0.996), std::numeric_limits<double>::infinity());
  send_and_answer(1, 900ns);
  EXPECT_EQ(crew.tally().answered_within_ns(0.99), 900) << "ten of 1001 were late or lost";
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
