// Sessions in an environment that is not a scene.

#include <limits>
#include <new>
#include <stdexcept>

#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/sample_local_model.hpp"
#include "tests/support/special_numbers.hpp"
#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {
namespace {

using test::kNaN;
using testing::ElementsAre;
using testing::HasSubstr;

/// Gives the answers set by the test, and records its inputs.
struct Script {
  Answer answer{.force = vector_of({1})};
  Vector asked_at{};
  Nanoseconds device_time{0};
  Nanoseconds server_time{0};
  bool wanted_model = false;
  control::Handle handle{};
  EnvironmentFaults faults{};
  std::vector<ClientFacts> clients{};
  int there = 0;
};

class ScriptedEnvironment final : public Environment {
 public:
  explicit ScriptedEnvironment(Script& script) : script_(script) { ++script_.there; }
  ~ScriptedEnvironment() override { --script_.there; }
  ScriptedEnvironment(const ScriptedEnvironment&) = delete;
  ScriptedEnvironment& operator=(const ScriptedEnvironment&) = delete;

  Answer respond(const Motion& motion) noexcept override {
    script_.asked_at = motion.position;
    script_.device_time = motion.device_time;
    script_.server_time = motion.server_time;
    script_.wanted_model = motion.wants_model;
    script_.handle = motion.handle;
    return script_.answer;
  }
  EnvironmentFaults faults() const noexcept override { return script_.faults; }

 private:
  Script& script_;
};

///     test --on_datagram--> Server --> ScriptedEnvironment
class ServerEnvironment : public ServerFixture {
 protected:
  void SetUp() override { serve(scripted()); }

  EnvironmentKind scripted() {
    return {.name = "script", .degrees_of_freedom = {1, 2}, .make = [this](const ClientFacts& client) {
              script.clients.push_back(client);
              return MadeEnvironment{
                  .environment = std::make_unique<ScriptedEnvironment>(script), .simulated = "one newton", .hash = 77};
            }};
  }

  void serve(EnvironmentKind kind) {
    EnvironmentLibrary environments;
    ServerOptions options{.scene = kind.name};
    environments.add(std::move(kind));
    start(options, std::move(environments));
  }

  wire::EnvironmentForce answer_to(std::uint64_t session, std::uint64_t sequence) {
    arrive(motion(session, sequence));
    return only_answer<wire::EnvironmentForce>();
  }

  Script script;
};

TEST_F(ServerEnvironment, IsMadeForEachClientAndEndsWithItsSession) {
  arrive(wire::Hello{.client_nonce = 1,
                     .degrees_of_freedom = 2,
                     .device = "stick",
                     .period_s = 2e-3,
                     .force_N_max = 7,
                     .round_trip = milliseconds{3},
                     .renders_locally = true});
  const auto welcome = only_answer<wire::Welcome>();
  EXPECT_EQ(welcome.scene, "script");
  EXPECT_EQ(welcome.scene_hash, 77U);
  EXPECT_EQ(welcome.simulated, "one newton");
  ASSERT_EQ(script.clients.size(), 1U);
  EXPECT_EQ(script.clients[0].device, "stick");
  EXPECT_EQ(script.clients[0].degrees_of_freedom, 2U);
  EXPECT_EQ(script.clients[0].period_s, 2e-3);
  EXPECT_EQ(script.clients[0].force_N_max, 7);
  EXPECT_EQ(script.clients[0].round_trip, milliseconds{3});
  EXPECT_TRUE(script.clients[0].renders_locally);

  EXPECT_NE(join(2), 0U);
  EXPECT_FALSE(script.clients.back().renders_locally);
  EXPECT_EQ(script.there, 2);
  arrive(wire::Bye{.session = welcome.session});
  EXPECT_EQ(script.there, 1);
}

TEST_F(ServerEnvironment, IsToldOfTheHandleWhatCanBeTrue) {
  const std::uint64_t session = join(1);
  auto told_of = [&, sequence = std::uint64_t{0}](const control::Handle& sent) mutable {
    wire::MotionSample sample = motion(session, ++sequence);
    sample.handle = sent;
    arrive(sample);
    (void)only_answer<wire::EnvironmentForce>();
    return script.handle;
  };
  EXPECT_EQ(told_of({}), control::Handle{});
  EXPECT_EQ(told_of({.buttons = 6, .gripper = 0.5, .orientation = {{0, 1, 0, 0}}}),
            (control::Handle{.buttons = 6, .gripper = 0.5, .orientation = {{0, 1, 0, 0}}}));
  EXPECT_EQ(told_of({.buttons = 6, .gripper = 7, .orientation = {{0, 0, 0, 0}}}), control::Handle{.buttons = 6});
}

TEST_F(ServerEnvironment, GivesLocalModelsToClientsThatRenderLocallyAndNoUnsoundOnes) {
  arrive(wire::Hello{.client_nonce = 1, .degrees_of_freedom = 1, .period_s = 1e-3, .renders_locally = true});
  const auto session = only_answer<wire::Welcome>().session;
  script.answer.model.field = test::eddy();
  script.answer.model.has_field = true;
  EXPECT_TRUE(answer_to(session, 1).answer.model.has_field);
  EXPECT_TRUE(script.wanted_model);
  script.answer.model.field.jacobian_N_per_m(0, 0) = kNaN;
  const auto force = answer_to(session, 2);
  EXPECT_TRUE(force.answer.model.empty());
  EXPECT_EQ(force.answer.force, vector_of({1})) << "it is held";
  EXPECT_EQ(server->counters().models_unsound, 1U);
  EXPECT_EQ(server->counters().responses_unsound, 0U);

  script.answer.model.field = test::eddy();
  const auto other = join(2);
  EXPECT_TRUE(answer_to(other, 1).answer.model.empty()) << "it asked for forces alone";
  EXPECT_FALSE(script.wanted_model);
}

TEST_F(ServerEnvironment, IsAskedForEachMotionAndAnswersForceContactAndTexture) {
  const auto session = join();
  clock.time = milliseconds{20};
  script.answer = {.force = vector_of({-3}),
                   .contact_normal = vector_of({-1}),
                   .penetration_m = 2e-3,
                   .texture_N = 0.5,
                   .texture_wave = vector_of({100}),
                   .texture_across = vector_of({200})};
  const auto force = answer_to(session, 41);
  EXPECT_EQ(script.asked_at, vector_of({0.001}));
  EXPECT_EQ(script.device_time, milliseconds{41});
  EXPECT_EQ(script.server_time, milliseconds{20});
  EXPECT_EQ(force.answer.force, vector_of({-3}));
  EXPECT_EQ(force.position, vector_of({0.001}));
  EXPECT_EQ(force.answer.contact_normal, vector_of({-1}));
  EXPECT_EQ(force.answer.penetration_m, 2e-3);
  EXPECT_EQ(force.answer.texture_N, 0.5);
  EXPECT_EQ(force.answer.texture_wave, vector_of({100}));
  EXPECT_EQ(force.answer.texture_across, vector_of({200}));
}

TEST_F(ServerEnvironment, UnsoundResponseIsReplacedByZeroForceAndCounted) {
  const auto session = join();
  const std::vector<Answer> unsound{
      {.force = vector_of({kNaN})},
      {.force = vector_of({1, 2})},
      {.force = vector_of({1}), .contact_normal = vector_of({1}), .penetration_m = 1e-3, .texture_N = kNaN},
  };
  std::uint64_t sequence = 0;
  for (const Answer& answer : unsound) {
    SCOPED_TRACE(sequence);
    script.answer = answer;
    const auto sent = answer_to(session, ++sequence).answer;
    EXPECT_EQ(sent.force, vector_of({0}));
    EXPECT_EQ(sent.contact_normal.rows(), 0);
    EXPECT_EQ(sent.penetration_m, 0);
    EXPECT_EQ(sent.texture_N, 0);
    EXPECT_EQ(server->counters().responses_unsound, sequence);
  }
  EXPECT_EQ(diary.unsound, 1) << "the log hears of it once";
  script.answer = {.force = vector_of({5})};
  EXPECT_EQ(answer_to(session, ++sequence).answer.force, vector_of({5}));
  EXPECT_EQ(server->counters().forces_sent, unsound.size() + 1);
  EXPECT_THAT(server->counters().text(), HasSubstr("3 of zero because the environment's response was unsound"));
}

TEST_F(ServerEnvironment, UnsoundResponseDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto session = join();
  link.keep = false;
  script.answer = {.force = vector_of({kNaN})};
  const test::AllocationGuard guard;
  for (std::uint64_t i = 1; i <= 100; ++i) arrive(motion(session, i));
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_EQ(server->counters().responses_unsound, 100U);
}

TEST_F(ServerEnvironment, FaultsStayCountedAfterTheSessionsEnd) {
  const auto session = join();
  script.faults = {.old_normals = 1, .quarantined = 2, .contacts_left_out = 3, .not_converged = 4, .slipped_s = 5};
  const auto expect_counted = [&] {
    const ServerCounters counters = server->counters();
    EXPECT_EQ(counters.old_normals, 1U);
    EXPECT_EQ(counters.objects_quarantined, 2U);
    EXPECT_EQ(counters.contacts_left_out, 3U);
    EXPECT_EQ(counters.not_converged, 4U);
    EXPECT_EQ(counters.slipped_us, 5000000);
  };
  expect_counted();
  arrive(wire::Bye{.session = session});
  EXPECT_EQ(server->sessions(), 0U);
  expect_counted();
}

TEST_F(ServerEnvironment, RefusesADeviceThatItDoesNotAccept) {
  arrive(wire::Hello{.client_nonce = 1, .degrees_of_freedom = 3, .device = "omni", .period_s = 1e-3});
  EXPECT_EQ(only_answer<wire::Refusal>().text,
            "scene 'script' accepts devices with 1 or 2 degrees of freedom, device 'omni' has 3");
  EXPECT_TRUE(script.clients.empty());
}

TEST_F(ServerEnvironment, RefusesSessionsBeyondItsMaximum) {
  EnvironmentKind kind = scripted();
  kind.sessions_max = 1;
  serve(std::move(kind));
  const auto session = join(1);
  (void)answer_to(session, 1);
  arrive(hello(2));
  EXPECT_EQ(only_answer<wire::Refusal>().reason, wire::RefusalReason::server_full);
  arrive(wire::Bye{.session = session});
  (void)answers();
  EXPECT_NE(join(3), 0U);
}

TEST_F(ServerEnvironment, ThatAdmitsNoneGoesOnWithThoseWhoAreThere) {
  serve(scripted());
  const auto session = join(1);
  server->admit_none("it ends soon");
  arrive(hello(2));
  EXPECT_EQ(only_answer<wire::Refusal>().text, "it ends soon");
  (void)answer_to(session, 1);
  EXPECT_EQ(server->sessions(), 1U);
}

TEST_F(ServerEnvironment, GetsTheRoundTripIfItWantsIt) {
  EnvironmentKind kind = scripted();
  kind.wants_round_trip = true;
  serve(std::move(kind));
  auto question = hello();
  arrive(question);
  EXPECT_EQ(only_answer<wire::Refusal>().reason, wire::RefusalReason::round_trip_wanted);
  EXPECT_TRUE(script.clients.empty());
  question.round_trip = milliseconds{9};
  arrive(question);
  (void)only_answer<wire::Welcome>();
  EXPECT_EQ(script.clients.at(0).round_trip, milliseconds{9});
}

TEST_F(ServerEnvironment, FailureToMakeItIsRefusedWithTheReasonAndMayBeRetried) {
  EnvironmentKind kind = scripted();
  bool plugged_in = false;
  kind.make = [&plugged_in, make = kind.make](const ClientFacts& client) {
    if (!plugged_in) throw std::runtime_error("the robot is not plugged in");
    return make(client);
  };
  serve(std::move(kind));
  arrive(hello());
  EXPECT_EQ(only_answer<wire::Refusal>().text,
            "scene 'script' is not available at the moment: the robot is not plugged in");
  EXPECT_EQ(server->sessions(), 0U);
  plugged_in = true;
  EXPECT_NE(join(), 0U);
  EXPECT_THAT(diary.lines,
              ElementsAre("refused scene 'script' is not available at the moment: the robot is not plugged in",
                          "opened wall-1dof in script"));
}

TEST_F(ServerEnvironment, WithoutMemoryIsRefusedAndLeavesOtherSessionsAlone) {
  EnvironmentKind kind = scripted();
  bool has_memory = true;
  kind.make = [&has_memory, make = kind.make](const ClientFacts& client) {
    if (!has_memory) throw std::bad_alloc();
    return make(client);
  };
  serve(std::move(kind));
  const std::uint64_t session = join(1, address(1));
  has_memory = false;
  arrive(hello(2), address(2));
  EXPECT_EQ(only_answer<wire::Refusal>().text,
            "scene 'script' is not available at the moment: not enough memory for another session, try again later");
  EXPECT_EQ(server->sessions(), 1U);
  arrive(motion(session, 1), address(1));
  EXPECT_EQ(only_answer<wire::EnvironmentForce>().motion_sequence, 1U);
  has_memory = true;
  EXPECT_NE(join(2, address(2)), 0U);
}

TEST_F(ServerEnvironment, MakerThatReturnsNoneIsRefused) {
  serve({.name = "nothing", .make = [](const ClientFacts&) { return MadeEnvironment{}; }});
  arrive(hello());
  EXPECT_EQ(only_answer<wire::Refusal>().text,
            "scene 'nothing' is not available at the moment: its maker returned none");
}

TEST_F(ServerEnvironment, IsNamedAmongTheKnownBesideTheScenes) {
  EnvironmentLibrary environments = SceneLibrary::shipped();
  environments.add(scripted());
  start({.scene = "script"}, environments);
  auto question = hello();
  question.scene = "scrpt";
  arrive(question);
  const auto refusal = only_answer<wire::Refusal>();
  EXPECT_THAT(std::string(refusal.text), HasSubstr("did you mean 'script'? (known: "));
  EXPECT_THAT(std::string(refusal.text), HasSubstr("wall"));
  question.scene = "wall";
  arrive(question);
  EXPECT_EQ(only_answer<wire::Welcome>().scene, "wall");
}

}  // namespace
}  // namespace forcebound::server
