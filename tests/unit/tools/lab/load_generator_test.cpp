#include "tests/tools/lab/load/load_generator.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class LoadGeneratorTest : public testing::Test {
 protected:
  template <class Message>
  Message sent(std::span<const std::byte> datagram) {
    const auto decoded = server_.decode(datagram);
    return std::get<Message>(std::get<wire::Message>(decoded));
  }

  void arrive(LoadGenerator& load_generator, const wire::Message& message, Nanoseconds arrival = 0ns,
              Nanoseconds now = 0ns) {
    const auto datagram = server_.encode(message);
    load_generator.on_datagram(std::vector(datagram.begin(), datagram.end()), arrival, now);
  }

  wire::Codec server_;
};

TEST_F(LoadGeneratorTest, GivesEachVirtualClientItsOwnNonceAndTheSessionOfItsWelcome) {
  LoadGenerator load_generator({.degrees_of_freedom = 2, .scene = "circle", .first_nonce = 1000});
  load_generator.grow(2);
  const auto first = sent<wire::Hello>(load_generator.hello(0, 0ms));
  EXPECT_EQ(first.degrees_of_freedom, 2U);
  EXPECT_EQ(first.scene, "circle");
  const auto second = sent<wire::Hello>(load_generator.hello(1, 0ms)).client_nonce;
  arrive(load_generator, wire::Welcome{.client_nonce = second, .session = 77});
  EXPECT_FALSE(load_generator.connected(0));
  EXPECT_TRUE(load_generator.connected(1));
  EXPECT_EQ(sent<wire::MotionSample>(load_generator.motion(1, 5ms)).session, 77U);
  EXPECT_EQ(sent<wire::Bye>(load_generator.bye(1)).session, 77U);
  arrive(load_generator, wire::Welcome{.client_nonce = 999, .session = 5});  // another client's
  EXPECT_FALSE(load_generator.connected(0));
}

TEST_F(LoadGeneratorTest, NumbersTheMotionsOfEachVirtualClientAndStampsThem) {
  LoadGenerator load_generator({.degrees_of_freedom = 3, .echo = true});
  load_generator.grow(2);
  static_cast<void>(load_generator.motion(0, 1ms));
  const auto motion = sent<wire::MotionSample>(load_generator.motion(0, 2ms));
  EXPECT_EQ(motion.sequence, 2U);
  EXPECT_EQ(motion.device_time, 2ms);
  EXPECT_EQ(motion.position.rows(), 3);
  EXPECT_NEAR(motion.position.norm(), 0.02, 1e-12);
  EXPECT_EQ(sent<wire::MotionSample>(load_generator.motion(1, 2ms)).sequence, 1U);
  EXPECT_EQ(load_generator.tally().sent, 3U);
}

TEST_F(LoadGeneratorTest, MeasuresFromTheMotionToTheArrivalAndToTheReading) {
  LoadGenerator load_generator({});
  load_generator.grow(1);
  load_generator.begin(10ms);
  static_cast<void>(load_generator.motion(0, 11ms));
  arrive(load_generator, wire::EnvironmentForce{.motion_device_time = 11ms}, 11ms + 900ns, 11ms + 1000ns);
  EXPECT_EQ(load_generator.tally().answered, 1U);
  EXPECT_EQ(load_generator.tally().arrived_ns.max(), 900);
  EXPECT_EQ(load_generator.tally().read_ns.max(), 1000);
}

TEST_F(LoadGeneratorTest, CountsEchoedMotionsLikeForces) {
  LoadGenerator load_generator({.echo = true});
  load_generator.grow(1);
  EXPECT_TRUE(load_generator.connected(0));
  const auto motion = load_generator.motion(0, 3ms);
  load_generator.on_datagram(std::vector(motion.begin(), motion.end()), 4ms, 4ms);
  EXPECT_EQ(load_generator.tally().answered, 1U);
  EXPECT_EQ(load_generator.tally().arrived_ns.max(), 1'000'000);
}

TEST_F(LoadGeneratorTest, CountsAnswersFromBeforeAndNoiseAsForeign) {
  LoadGenerator load_generator({});
  load_generator.grow(1);
  load_generator.begin(10ms);
  arrive(load_generator, wire::EnvironmentForce{.motion_device_time = 9ms}, 11ms, 11ms);
  load_generator.on_datagram(std::vector<std::byte>(20), 11ms, 11ms);
  EXPECT_EQ(load_generator.tally().answered, 0U);
  EXPECT_EQ(load_generator.tally().foreign, 2U);
}

TEST_F(LoadGeneratorTest, KeepsTheServersRefusal) {
  LoadGenerator load_generator({});
  load_generator.grow(1);
  arrive(load_generator, wire::Refusal{.text = "all 64 sessions are taken"});
  EXPECT_THAT(load_generator.refusal(), HasSubstr("64 sessions"));
  EXPECT_FALSE(load_generator.refused_for_now());
  load_generator.forget_refusal();
  arrive(load_generator, wire::Refusal{.reason = wire::RefusalReason::server_full, .text = "try again later"});
  EXPECT_THAT(load_generator.refusal(), HasSubstr("later"));
  EXPECT_TRUE(load_generator.refused_for_now());
}

TEST_F(LoadGeneratorTest, SaysTheRoundTripToAServerThatWantsItAndIsNotRefusedByThat) {
  LoadGenerator load_generator({});
  load_generator.grow(2);
  const auto hello = sent<wire::Hello>(load_generator.hello(1, 10ms));
  EXPECT_EQ(hello.round_trip, 0ms);
  EXPECT_EQ(hello.client_time, 10ms);
  arrive(load_generator,
         wire::Refusal{.client_nonce = hello.client_nonce,
                       .reason = wire::RefusalReason::round_trip_wanted,
                       .text = "say Hello again",
                       .client_time = hello.client_time},
         13ms, 13ms);
  EXPECT_EQ(load_generator.refusal(), "");
  const auto again = sent<wire::Hello>(load_generator.hello(1, 20ms));
  EXPECT_EQ(again.client_nonce, hello.client_nonce);
  EXPECT_EQ(again.round_trip, 3ms);
  EXPECT_EQ(sent<wire::Hello>(load_generator.hello(0, 20ms)).round_trip, 0ms) << "each measures its own";
}

TEST_F(LoadGeneratorTest, CountsMotionsThatAreNeverAnsweredAsNeverInTime) {
  LoadGenerator load_generator({});
  load_generator.grow(1);
  load_generator.begin(0ns);
  EXPECT_EQ(load_generator.tally().answered_within_ns(0.99), std::numeric_limits<double>::infinity());
  const auto send_and_answer = [&](int motions, Nanoseconds after) {
    for (int i = 0; i < motions; ++i) {
      static_cast<void>(load_generator.motion(0, 1ms));
      arrive(load_generator, wire::EnvironmentForce{.motion_device_time = 1ms}, 1ms + after, 1ms + after);
    }
  };
  send_and_answer(990, 100ns);
  send_and_answer(5, 900ns);
  for (int i = 0; i < 5; ++i) static_cast<void>(load_generator.motion(0, 1ms));  // lost
  EXPECT_EQ(load_generator.tally().answered_within_ns(0.99), 100);
  EXPECT_EQ(load_generator.tally().answered_within_ns(0.995), 900);
  EXPECT_EQ(load_generator.tally().answered_within_ns(0.996), std::numeric_limits<double>::infinity());
  send_and_answer(1, 900ns);
  EXPECT_EQ(load_generator.tally().answered_within_ns(0.99), 900) << "ten of 1001 were late or lost";
}

TEST_F(LoadGeneratorTest, AsksForTheSceneAndAcknowledgesItsPiecesUntilAllAreThere) {
  LoadGenerator load_generator({.renders_locally = true});
  load_generator.grow(2);
  const auto hello = sent<wire::Hello>(load_generator.hello(1, 0ms));
  EXPECT_TRUE(hello.renders_locally);
  const wire::Welcome welcome{
      .client_nonce = hello.client_nonce, .session = 77, .offer = {.manifest_bytes = 10, .pieces = 3}};
  arrive(load_generator, welcome);
  EXPECT_FALSE(load_generator.wants_pieces(0)) << "not connected";
  EXPECT_EQ(sent<wire::MotionSample>(load_generator.motion(1, 1ms)).pieces, (wire::PieceReceipt{.wanted = true}));
  const std::vector<std::byte> content(100);
  const auto piece = [&](std::uint64_t transmission, std::uint32_t number) {
    arrive(load_generator,
           wire::ScenePiece{.session = 77, .transmission = transmission, .number = number, .content = content});
  };
  piece(1, 2);
  piece(3, 0);
  piece(3, 0);                      // a copy
  arrive(load_generator, welcome);  // late: nothing begins anew
  EXPECT_EQ(sent<wire::MotionSample>(load_generator.motion(1, 2ms)).pieces,
            (wire::PieceReceipt{.wanted = true, .newest = 3, .before = 2}));
  EXPECT_TRUE(load_generator.wants_pieces(1));
  piece(4, 1);
  EXPECT_FALSE(load_generator.wants_pieces(1));
  EXPECT_EQ(sent<wire::MotionSample>(load_generator.motion(1, 3ms)).pieces, wire::PieceReceipt{});
  EXPECT_EQ(load_generator.handed_over().pieces, 4U);
  EXPECT_EQ(load_generator.handed_over().bytes, 400U);
  EXPECT_EQ(load_generator.tally().foreign, 0U);
  piece(5, 3);  // there is no such
  EXPECT_EQ(load_generator.tally().foreign, 1U);
}

TEST_F(LoadGeneratorTest, WantsNoSceneWithRemoteRenderingNorOneOfMorePiecesThanAClientTakes) {
  for (const bool locally : {false, true}) {
    LoadGenerator load_generator({.renders_locally = locally});
    load_generator.grow(1);
    const auto hello = sent<wire::Hello>(load_generator.hello(0, 0ms));
    EXPECT_EQ(hello.renders_locally, locally);
    arrive(load_generator, wire::Welcome{.client_nonce = hello.client_nonce,
                                         .session = 77,
                                         .offer = {.manifest_bytes = 10, .pieces = locally ? 1U << 20U : 3U}});
    EXPECT_TRUE(load_generator.connected(0));
    EXPECT_FALSE(load_generator.wants_pieces(0));
  }
}

TEST_F(LoadGeneratorTest, CountsAnswersWithLocalModels) {
  LoadGenerator load_generator({.height_m = -0.003});
  load_generator.grow(1);
  load_generator.begin(10ms);
  EXPECT_EQ(sent<wire::MotionSample>(load_generator.motion(0, 11ms)).position[2], -0.003);
  wire::EnvironmentForce force{.motion_device_time = 11ms};
  arrive(load_generator, force);
  force.answer.model.has_field = true;
  arrive(load_generator, force);
  force.motion_device_time = 9ms;
  arrive(load_generator, force);
  EXPECT_EQ(load_generator.tally().answered, 2U);
  EXPECT_EQ(load_generator.tally().modelled, 1U) << "one of them is from before";
}

TEST_F(LoadGeneratorTest, DoesNotAllocateWhileMeasuring) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  LoadGenerator load_generator({});
  load_generator.grow(4);
  load_generator.begin(0ns);
  const auto force = server_.encode(wire::EnvironmentForce{.motion_device_time = 1ms});
  const test::AllocationGuard guard;
  for (std::size_t client = 0; client < 4; ++client) {
    static_cast<void>(load_generator.motion(client, 1ms));
    load_generator.on_datagram(force, 2ms, 2ms);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_EQ(load_generator.tally().answered, 4U);
}

}  // namespace
}  // namespace forcebound::lab
