#include "forcebound/server/session/server.hpp"

#include <stdexcept>

#include "forcebound/device/tick_rate.hpp"
#include "tests/support/auto_scene.hpp"
#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ServerTest : public ServerFixture {};

TEST_F(ServerTest, WelcomesWithTheScenesSummary) {
  arrive(hello(77));
  const auto welcome = only_answer<wire::Welcome>();
  EXPECT_EQ(welcome.client_nonce, 77u);
  EXPECT_NE(welcome.session, 0u);
  EXPECT_EQ(welcome.scene, "wall");
  EXPECT_EQ(welcome.scene_hash, load_scene("wall")->facts().hash);
  EXPECT_EQ(welcome.simulated, "wall (half_space): surface stiffness_N_per_m 50000, damping_N_s_per_m 0");
  EXPECT_THAT(diary.lines, ElementsAre("opened wall-1dof in wall"));
}

TEST_F(ServerTest, GivesTheWantedScene) {
  arrive({wire::Hello{.client_nonce = 1, .degrees_of_freedom = 3, .period_s = 1e-3, .scene = "sphere"}});
  EXPECT_EQ(only_answer<wire::Welcome>().scene, "sphere");
}

TEST_F(ServerTest, SameNonceFromTheSameAddressIsTheSameSession) {
  const auto session = join(7);
  EXPECT_EQ(join(7), session);
  EXPECT_EQ(server->sessions(), 1u);
  EXPECT_EQ(server->counters().hellos_repeated, 1u);
  EXPECT_NE(join(7, address(2)), session);
  EXPECT_NE(join(8), session);
}

TEST_F(ServerTest, AHelloBeforeItsSceneIsCompiledIsToBeRepeated) {
  EnvironmentLibrary scenes = SceneLibrary::shipped();
  (void)scenes.find("wall");
  scenes.make_elsewhere([](const EnvironmentLibrary::Later&) {});
  start({}, scenes);
  auto question = hello();
  question.scene = "free";
  arrive(question);
  EXPECT_TRUE(answers().empty());
  EXPECT_EQ(server->counters().hellos_too_early, 1U);
  (void)scenes.find("free");
  arrive(question);
  EXPECT_EQ(only_answer<wire::Welcome>().scene, "free");
}

TEST_F(ServerTest, RefusesASceneThatDoesNotCompileWithTheReason) {
  EnvironmentLibrary scenes = SceneLibrary::shipped();
  (void)scenes.find("wall");
  scenes.make_elsewhere([&](const EnvironmentLibrary::Later& wanted) { scenes.give_up(wanted.name, "no memory"); });
  start({}, scenes);
  auto question = hello();
  question.scene = "free";
  arrive(question);
  EXPECT_TRUE(answers().empty());
  arrive(question);
  EXPECT_EQ(only_answer<wire::Refusal>().text, "scene 'free' is not available at the moment: no memory");
}

TEST_F(ServerTest, PicksTheLevelOfAnAutoSceneByTheClientsRoundTrip) {
  SceneLibrary scenes = SceneLibrary::shipped();
  scenes.add(test::auto_wall());
  start({.scene = "auto_wall"}, scenes);
  wire::Hello question = hello();
  question.client_time = milliseconds{12};
  arrive(question);
  const auto wanted = only_answer<wire::Refusal>();
  EXPECT_EQ(wanted.reason, wire::RefusalReason::round_trip_wanted);
  EXPECT_EQ(wanted.client_time, milliseconds{12});
  EXPECT_EQ(server->sessions(), 0U);
  EXPECT_EQ(server->counters().hellos_to_measure, 1U);

  question.round_trip = milliseconds{1};
  arrive(question);
  const auto near = only_answer<wire::Welcome>();
  EXPECT_THAT(near.simulated, HasSubstr("accuracy auto: object.wall.surface.stiffness_N_per_m = 200 for a round trip "
                                        "of 1 ms, 2000 us a motion, "));
  EXPECT_THAT(near.simulated, HasSubstr("; wall (half_space): surface stiffness_N_per_m 200"));
  question.client_nonce = 8;
  question.round_trip = milliseconds{50};
  arrive(question);
  const auto far = only_answer<wire::Welcome>();
  EXPECT_THAT(far.simulated, HasSubstr("stiffness_N_per_m = 100 for a round trip of 50 ms"));

  arrive(motion(near.session, 1, 0.01));
  EXPECT_NEAR(only_answer<wire::EnvironmentForce>().answer.force[0], -2, 1e-12);
  arrive(motion(far.session, 1, 0.01));
  EXPECT_NEAR(only_answer<wire::EnvironmentForce>().answer.force[0], -1, 1e-12);
}

TEST_F(ServerTest, EndsASessionWhenAskedToAndTellsItsClient) {
  start({.scene = "free"}, SceneLibrary::shipped());
  arrive(hello());
  const std::uint64_t session = only_answer<wire::Welcome>().session;
  arrive(motion(session, 1, 0.01));
  (void)answers();
  const auto is_it = [&](const Session& any) { return any.info.session == session; };
  EXPECT_EQ(server->end_sessions(is_it), 1U);
  EXPECT_EQ(only_answer<wire::Bye>().session, session);
  EXPECT_EQ(server->sessions(), 0U);
  EXPECT_EQ(server->counters().sessions_removed, 1U);
  EXPECT_EQ(server->end_sessions(is_it), 0U);
}

TEST_F(ServerTest, RefusesOtherProtocolVersionsSayingWhichItSpeaksAndWhatToUpdate) {
  auto question = hello(9);
  question.protocol_version = 1;
  arrive(question);
  const auto older = only_answer<wire::Refusal>();
  EXPECT_EQ(older.client_nonce, 9u);
  EXPECT_EQ(older.reason, wire::RefusalReason::version_mismatch);
  EXPECT_EQ(older.protocol_version, 2u);
  EXPECT_EQ(older.text, "the server speaks protocol version 2, the client version 1: update the client");

  question.protocol_version = 3;
  arrive(question);
  EXPECT_EQ(only_answer<wire::Refusal>().text,
            "the server speaks protocol version 2, the client version 3: update the server");
  EXPECT_EQ(server->sessions(), 0U);
  EXPECT_EQ(server->counters().hellos_of_other_versions, 2u);
  EXPECT_EQ(server->counters().hellos_refused, 2u);
  EXPECT_THAT(server->counters().text(), HasSubstr("2 hellos refused, 2 of them of another protocol version"));
}

TEST_F(ServerTest, RefusesMoreSessionsThanItHas) {
  start({.sessions_max = 2});
  const std::uint64_t first = join(1);
  join(2);
  arrive(hello(3));
  const auto refusal = only_answer<wire::Refusal>();
  EXPECT_EQ(refusal.reason, wire::RefusalReason::server_full);
  EXPECT_EQ(refusal.text, "all 2 sessions are taken, try again later");
  EXPECT_EQ(join(1), first) << "those inside are still known";
}

TEST_F(ServerTest, AnswersMotionWithForceAndTimes) {
  const auto session = join();
  clock.time = milliseconds{20};
  arrive(motion(session, 41, 0.002));
  const auto force = only_answer<wire::EnvironmentForce>();
  EXPECT_EQ(force.session, session);
  EXPECT_EQ(force.sequence, 1u);
  EXPECT_EQ(force.motion_sequence, 41u);
  EXPECT_EQ(force.motion_device_time, milliseconds{41});
  EXPECT_EQ(force.answer.force, vector_of({-100}));
  EXPECT_EQ(force.position, vector_of({0.002}));
  EXPECT_EQ(force.answer.contact_normal, vector_of({-1}));
  EXPECT_EQ(force.answer.penetration_m, 0.002);
  EXPECT_EQ(force.server_receive_time, milliseconds{20});
  EXPECT_EQ(force.server_send_time, milliseconds{20});
  EXPECT_EQ(force.motions_received, 1u);
  EXPECT_EQ(diary.motions, 1);
  EXPECT_EQ(diary.forces, 1);
}

TEST_F(ServerTest, AnswersOnlyTheNewestAndCountsTheRest) {
  const auto session = join();
  for (const std::uint64_t sequence : {1U, 2U, 5U, 3U, 5U, 3U, 6U}) arrive(motion(session, sequence));
  const auto forces = answers();
  std::vector<std::uint64_t> answered;
  answered.reserve(forces.size());
  for (const auto& force : forces) answered.push_back(std::get<wire::EnvironmentForce>(force).motion_sequence);
  EXPECT_THAT(answered, ElementsAre(1, 2, 5, 6));
  const auto last = std::get<wire::EnvironmentForce>(forces.back());
  EXPECT_EQ(last.sequence, 4u);
  EXPECT_EQ(last.motions_received, 5u);
  EXPECT_EQ(last.motions_duplicated, 2u);
  EXPECT_EQ(last.motions_reordered, 1u);
}

TEST_F(ServerTest, SequenceMayWrapAround) {
  const auto session = join();
  arrive(motion(session, UINT64_MAX));
  arrive(motion(session, 0));
  arrive(motion(session, UINT64_MAX));
  EXPECT_EQ(answers().size(), 2u);
  EXPECT_EQ(server->counters().motions_duplicated, 1u);
}

TEST_F(ServerTest, RefusesMotionOfASessionItDoesNotKnow) {
  arrive(motion(4711, 1), address(3));
  const auto refusal = only_answer<wire::Refusal>();
  EXPECT_EQ(refusal.session, 4711u);
  EXPECT_EQ(refusal.reason, wire::RefusalReason::unknown_session);
  EXPECT_THAT(sent_to, ElementsAre(address(3)));
  EXPECT_EQ(server->counters().motions_without_session, 1u);
}

TEST_F(ServerTest, DropsMotionOfAnotherSize) {
  const auto session = join();
  arrive(wire::MotionSample{.session = session, .sequence = 1, .position = vector_of({1, 2})});
  EXPECT_TRUE(answers().empty());
  EXPECT_EQ(server->counters().motions_of_wrong_size, 1u);
  EXPECT_EQ(server->counters().motions_received, 0u);
}

TEST_F(ServerTest, FollowsAClientToItsNewAddress) {
  const auto session = join(1, address(1));
  std::uint64_t sequence = 0;
  while (link.sent.empty() && sequence < 10) arrive(motion(session, ++sequence), address(2));
  const auto challenged = only_answer<wire::EnvironmentForce>();
  ASSERT_NE(challenged.challenge, 0u);
  auto proof = motion(session, ++sequence);
  proof.challenge = challenged.challenge;
  arrive(proof, address(2));
  EXPECT_EQ(only_answer<wire::EnvironmentForce>().challenge, 0u) << "proven";
  arrive(motion(session, ++sequence), address(2));
  answers();
  EXPECT_THAT(sent_to, ElementsAre(address(1), address(2), address(2), address(2)));
  EXPECT_EQ(server->counters().addresses_changed, 1u);
  arrive(motion(session, ++sequence), address(3));
  EXPECT_TRUE(answers().empty()) << "another address, of which nothing is known";
}

TEST_F(ServerTest, ACopyOfOldMotionDoesNotMoveASession) {
  const auto session = join(1, address(1));
  arrive(motion(session, 2), address(1));
  arrive(motion(session, 2), address(66));
  arrive(motion(session, 1), address(66));
  arrive(motion(session, 3), address(1));
  answers();
  EXPECT_THAT(sent_to, ElementsAre(address(1), address(1), address(1)));
}

TEST_F(ServerTest, AnswersByeWithFinalCountsAndForgetsTheSession) {
  const auto session = join();
  for (const std::uint64_t sequence : {1U, 3U, 2U, 3U}) arrive(motion(session, sequence));
  answers();
  arrive(wire::Bye{.session = session});
  const auto bye = only_answer<wire::Bye>();
  EXPECT_EQ(bye.session, session);
  EXPECT_EQ(bye.motions_behind, 1u);
  EXPECT_EQ(bye.motions_received, 3u);
  EXPECT_EQ(bye.motions_duplicated, 1u);
  EXPECT_EQ(bye.motions_reordered, 1u);
  EXPECT_EQ(bye.forces_sent, 2u);
  EXPECT_EQ(server->sessions(), 0u);
  EXPECT_THAT(diary.lines, ElementsAre("opened wall-1dof in wall", "closed wall-1dof: bye"));
}

TEST_F(ServerTest, ReportsTheLargestLatenessOfAMotionEvenAfterBye) {
  const auto session = join();
  for (const std::uint64_t sequence : {1U, 9U, 5U}) arrive(motion(session, sequence));
  answers();
  arrive(wire::Bye{.session = session});
  EXPECT_EQ(only_answer<wire::Bye>().motions_behind, 4u);
  arrive(motion(session, 2));
  arrive(wire::Bye{.session = session});
  EXPECT_EQ(only_answer<wire::Bye>().motions_behind, 7u);
}

TEST_F(ServerTest, CountsEachMotionThatItDidNotAnswer) {
  const auto session = join();
  wire::Codec codec;
  const auto came = [&](std::uint64_t sequence) {
    const auto bytes = codec.encode(motion(session, sequence));
    server->receive(bytes, {.address = address(1)}, clock.time);
  };
  came(2);
  came(3);
  server->answer_waiting();
  came(1);  // too late
  came(4);  // its session ends before its answer
  arrive(wire::Bye{.session = session});
  came(6);
  came(5);
  const auto counters = server->counters();
  EXPECT_EQ(counters.motions_received, 6u);
  EXPECT_EQ(counters.forces_sent, 1u);
  EXPECT_EQ(counters.motions_superseded, 1u);
  EXPECT_EQ(counters.motions_reordered, 2u);
  EXPECT_EQ(counters.motions_after_end, 2u);
  EXPECT_EQ(counters.motions_unanswered(), 5u);
}

TEST_F(ServerTest, ACopyOfHelloAfterByeOpensNothing) {
  const auto session = join(5);
  arrive(wire::Bye{.session = session});
  answers();
  arrive(hello(5));
  EXPECT_TRUE(answers().empty());
  EXPECT_EQ(server->sessions(), 0u);
  EXPECT_EQ(server->counters().hellos_after_bye, 1u);
}

TEST_F(ServerTest, ClosesIdleSessions) {
  start({.idle_timeout = seconds{10}});
  const auto quiet = join(1);
  const auto busy = join(2);
  clock.time = seconds{9};
  arrive(motion(busy, 1));
  answers();
  server->on_timer(clock.time);
  EXPECT_EQ(server->sessions(), 2u);
  clock.time = seconds{10};
  server->on_timer(clock.time);
  EXPECT_EQ(server->sessions(), 1u);
  EXPECT_EQ(diary.lines.back(), "closed wall-1dof: idle");
  arrive(motion(quiet, 1));
  EXPECT_EQ(only_answer<wire::Refusal>().reason, wire::RefusalReason::unknown_session);
  EXPECT_NE(join(1), quiet) << "an idle client may come back with the same nonce";
}

TEST_F(ServerTest, SaysByeToAllWhenItStops) {
  const auto one = join(1, address(1));
  const auto two = join(2, address(2));
  arrive(motion(two, 1), address(2));
  answers();
  server->stop();
  std::uint64_t sessions = 0;
  for (const auto& message : answers()) sessions += std::get<wire::Bye>(message).session;
  EXPECT_EQ(sessions, one + two);
  EXPECT_EQ(server->sessions(), 0u);
  EXPECT_EQ(diary.lines.back(), "closed wall-1dof: stop");
}

TEST_F(ServerTest, EachClientHasItsOwnSceneState) {
  const auto one = join(1, address(1));
  arrive({wire::Hello{.client_nonce = 2, .degrees_of_freedom = 3, .period_s = 1e-3, .scene = "sphere"}}, address(2));
  const auto two = only_answer<wire::Welcome>().session;
  arrive(motion(one, 1), address(1));
  EXPECT_EQ(only_answer<wire::EnvironmentForce>().answer.force, vector_of({-50}));
  arrive(wire::MotionSample{.session = two, .sequence = 1, .position = vector_of({0, 0, 0.019})}, address(2));
  EXPECT_NEAR(only_answer<wire::EnvironmentForce>().answer.force[2], 10, 1e-9);
}

TEST_F(ServerTest, AnswersAtMostFourTimesThePromisedRate) {
  const auto session = join();
  const std::uint64_t ten_seconds = 200000;
  for (std::uint64_t i = 1; i <= ten_seconds; ++i) {
    clock.time = std::chrono::microseconds{50} * i;
    arrive(motion(session, i));
  }
  const auto counters = server->counters();
  EXPECT_EQ(counters.motions_received, ten_seconds) << "all that came is counted as received";
  EXPECT_LE(counters.forces_sent, 41000u);
  EXPECT_GE(counters.forces_sent, 40000u);
  EXPECT_EQ(counters.motions_over_rate, ten_seconds - counters.forces_sent);
}

TEST_F(ServerTest, AnswersEachMotionOfADeviceOf4000TicksASecond) {
  constexpr double kRate_Hz = device::kTickRateMost_Hz;
  wire::Hello fast = hello(1);
  fast.period_s = 1 / kRate_Hz;
  arrive(fast, address(1));
  const auto session = only_answer<wire::Welcome>().session;
  const auto ten_seconds = static_cast<std::uint64_t>(10 * kRate_Hz);
  for (std::uint64_t i = 1; i <= ten_seconds; ++i) {
    clock.time = std::chrono::microseconds{250} * i;
    arrive(motion(session, i));
  }
  const auto held_up = clock.time + seconds{1};
  for (std::uint64_t i = 1; i <= static_cast<std::uint64_t>(kRate_Hz); ++i) {
    clock.time = held_up;
    arrive(motion(session, ten_seconds + i));
  }
  const auto counters = server->counters();
  EXPECT_EQ(counters.forces_sent, ten_seconds + static_cast<std::uint64_t>(kRate_Hz))
      << "the last second of them came at once, after a delay";
  EXPECT_EQ(counters.motions_over_rate, 0U);
  EXPECT_EQ(counters.motions_far_ahead, 0U);
}

TEST_F(ServerTest, CountsAForceThatTheNetworkRefused) {
  const auto session = join();
  link.works = false;
  arrive(motion(session, 1));
  EXPECT_EQ(server->counters().sends_failed, 1u);
}

TEST_F(ServerTest, RefusesAnUnknownDefaultScene) {
  EXPECT_THROW(start({.scene = "wal"}), std::invalid_argument);
  EXPECT_THROW(start({.sessions_max = 0}), std::invalid_argument);
  EXPECT_THROW(start({.idle_timeout = seconds{0}}), std::invalid_argument);
}

}  // namespace
}  // namespace forcebound::server
