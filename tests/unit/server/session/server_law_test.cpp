#include <memory>
#include <vector>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/counting_law.hpp"
#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {
namespace {

using test::CountingLaw;
using testing::ElementsAre;

/// A server with a server-side law "counting".
class ServerWithServerLaws : public ServerFixture {
 protected:
  void SetUp() override {
    ServerOptions options;
    options.laws = test::laws_with_counting(log);
    start(options);
  }

  static wire::Hello hello_with(std::string_view server_law, std::uint64_t nonce = 1) {
    wire::Hello question = hello(nonce);
    question.server_law = server_law;
    return question;
  }

  std::uint64_t join_with_counting(std::uint64_t nonce = 1) {
    arrive(hello_with("counting", nonce));
    return only_answer<wire::Welcome>().session;
  }

  static wire::MotionSample saying(wire::MotionSample motion, double number) {
    motion.server_law_numbers = control::ServerLawNumbers::Constant(1, number);
    return motion;
  }

  test::CountLog log;
};

TEST_F(ServerWithServerLaws, EvaluatesTheSceneAtTheServerSideLawsPositionAndSendsItsForce) {
  const auto session = join_with_counting();
  arrive(saying(motion(session, 5, 0.002), 77));
  const auto force = only_answer<wire::EnvironmentForce>();
  EXPECT_NEAR(force.position[0], 0.002 + CountingLaw::kShift_m, 1e-15);
  EXPECT_NEAR(force.answer.force[0], 2 * -50'000 * 0.003, 1e-9);
  EXPECT_NEAR(force.answer.penetration_m, 0.003, 1e-15);
  ASSERT_EQ(force.server_law_numbers.rows(), 2);
  EXPECT_EQ(force.server_law_numbers[0], 1);
  EXPECT_EQ(force.server_law_numbers[1], 77);
}

TEST_F(ServerWithServerLaws, TellsTheServerSideLawTheDevicesTimeSinceTheMotionAnsweredBefore) {
  const auto session = join_with_counting();
  for (const std::uint64_t sequence : {5U, 6U, 9U, 9U, 8U, 10U}) arrive(motion(session, sequence));
  auto back_in_time = motion(session, 11);
  back_in_time.device_time = milliseconds{3};
  arrive(back_in_time);
  EXPECT_THAT(log.intervals_s, ElementsAre(0, 1e-3, 3e-3, 1e-3, 0));
}

TEST_F(ServerWithServerLaws, DoesNotReceiveSupersededMotions) {
  const auto session = join_with_counting();
  wire::Codec client;
  for (const std::uint64_t sequence : {1U, 2U, 3U}) {
    server->receive(client.encode(saying(motion(session, sequence), static_cast<double>(sequence))),
                    {.address = address(1)}, clock.time);
  }
  server->answer_waiting();
  EXPECT_THAT(log.ticks_received, ElementsAre(3));
}

TEST_F(ServerWithServerLaws, GivesEachSessionAServerSideLawOfItsOwn) {
  const auto one = join_with_counting(1);
  const auto other = join_with_counting(2);
  arrive(saying(motion(one, 1), 10));
  arrive(motion(one, 2));
  (void)answers();
  arrive(motion(other, 1));
  EXPECT_EQ(only_answer<wire::EnvironmentForce>().server_law_numbers[0], 1);
  arrive(motion(one, 3));
  EXPECT_EQ(only_answer<wire::EnvironmentForce>().server_law_numbers[0], 3);
}

TEST_F(ServerWithServerLaws, SendsNoNumbersToAClientWithoutAServerSideLaw) {
  const auto session = join();
  arrive(saying(motion(session, 1, 0.002), 77));
  const auto force = only_answer<wire::EnvironmentForce>();
  EXPECT_EQ(force.server_law_numbers.rows(), 0);
  EXPECT_EQ(force.position, vector_of({0.002}));
  EXPECT_EQ(force.answer.force, vector_of({-100}));
}

TEST_F(ServerWithServerLaws, RefusesAServerSideLawThatItDoesNotHaveAndListsThoseItHas) {
  arrive(hello_with("cuonting"));
  const auto refusal = only_answer<wire::Refusal>();
  EXPECT_EQ(refusal.reason, wire::RefusalReason::unknown_server_law);
  EXPECT_THAT(std::string(refusal.text), testing::StartsWith("this server has no server-side law 'cuonting' (known: "));
  EXPECT_THAT(std::string(refusal.text), testing::EndsWith("counting)"));
  EXPECT_EQ(server->sessions(), 0U);
  ServerOptions options;
  options.laws = control::force_bounding_laws();
  start(options);
  arrive(hello_with("fba-less"));
  EXPECT_EQ(only_answer<wire::Refusal>().text, "this server has no server-side law 'fba-less' (known: none)");
}

class TouchesNothing final : public Environment {
 public:
  Answer respond(const Motion&) noexcept override { return {.force = vector_of({0, 0, 0})}; }
};

TEST_F(ServerWithServerLaws, RefusesOneForAToolInTheHandUnlessTheDeviceShowsTorque) {
  EnvironmentLibrary environments;
  environments.add(
      {.name = "pen", .make = [](const ClientFacts&) {
         return MadeEnvironment{.environment = std::make_unique<TouchesNothing>(), .tool_m = vector_of({0, 0, -0.1})};
       }});
  ServerOptions options{.scene = "pen"};
  options.laws = test::laws_with_counting(log);
  start(options, environments);
  wire::Hello question = hello_with("counting");
  question.degrees_of_freedom = 3;
  arrive(question);
  const auto refusal = only_answer<wire::Refusal>();
  EXPECT_EQ(refusal.reason, wire::RefusalReason::unknown_server_law);
  EXPECT_THAT(std::string(refusal.text), testing::HasSubstr("scene 'pen' has a tool in the hand ([tool])"));
  EXPECT_EQ(server->sessions(), 0U);
  question.shows_torque = true;
  arrive(question);
  EXPECT_NE(only_answer<wire::Welcome>().session, 0U);
  question = hello(2);
  question.degrees_of_freedom = 3;
  arrive(question);
  EXPECT_NE(only_answer<wire::Welcome>().session, 0U) << "without a server-side law";
}

TEST_F(ServerWithServerLaws, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto session = join_with_counting();
  link.keep = false;
  const test::AllocationGuard guard;
  for (std::uint64_t i = 1; i <= 100; ++i) arrive(saying(motion(session, i), static_cast<double>(i)));
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_EQ(log.ticks_received.size(), 100U);
}

/// Returns values that are not finite.
class BrokenServerSideLaw final : public control::ServerSideLaw {
 public:
  [[nodiscard]] control::Vector place(const Received& received) noexcept override { return received.position / 0.0; }
  [[nodiscard]] Reply answer(const control::Vector& force_N) noexcept override {
    return {.force = force_N, .numbers = {}};
  }
};

TEST_F(ServerWithServerLaws, AServerSideLawThatIsNotFiniteDoesNotReachTheScene) {
  ServerOptions options;
  options.laws.add({.name = "broken",
                    .summary = "divides by zero",
                    .make = options.laws.find("none").make,
                    .make_server_side = [](int) { return std::make_unique<BrokenServerSideLaw>(); }});
  start(options);
  arrive(hello_with("broken"));
  const auto session = only_answer<wire::Welcome>().session;
  arrive(motion(session, 1, 0.002));
  EXPECT_EQ(only_answer<wire::EnvironmentForce>().answer.force, vector_of({-100}));
}

}  // namespace
}  // namespace forcebound::server
