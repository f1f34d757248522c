// What answers cost: each session's share of the processor, and who is let in.

#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Takes time for each answer.
class SlowEnvironment final : public Environment {
 public:
  SlowEnvironment(test::FakeClock& clock, Nanoseconds cost) : clock_(clock), cost_(cost) {}

  Answer respond(const Motion& /*motion*/) noexcept override {
    clock_.time += cost_;
    return {.force = vector_of({1})};
  }

 private:
  test::FakeClock& clock_;
  Nanoseconds cost_;
};

/// Two environments: one whose answers take 0.2 ms, one where they take 2 ms.
class ServerLoad : public ServerFixture {
 protected:
  void SetUp() override {
    EnvironmentLibrary environments;
    environments.add(taking("light", std::chrono::microseconds{200}));
    environments.add(taking("heavy", milliseconds{2}));
    start({.scene = "light"}, std::move(environments));
  }

  EnvironmentKind taking(const std::string& name, Nanoseconds cost) {
    return {.name = name, .degrees_of_freedom = {1}, .make = [this, cost](const ClientFacts&) {
              return MadeEnvironment{.environment = std::make_unique<SlowEnvironment>(clock, cost),
                                     .simulated = "time"};
            }};
  }

  std::uint64_t join_in(const std::string& scene, std::uint16_t port) {
    auto wanted = hello(port);
    wanted.scene = scene;
    arrive(wanted, address(port));
    return only_answer<wire::Welcome>().session;
  }

  /// One motion a millisecond of each session, for a second; how many of each were answered.
  std::vector<int> answered_in_a_second(const std::vector<std::uint64_t>& sessions) {
    std::vector<int> answered(sessions.size());
    for (const Nanoseconds end = clock.time + seconds{1}; clock.time < end; clock.time += milliseconds{1}) {
      ++sequence_;
      wire::Codec codec;
      for (std::size_t i = 0; i < sessions.size(); ++i) {
        const auto datagram = codec.encode(motion(sessions[i], sequence_));
        server->receive(datagram, {.address = address(static_cast<std::uint16_t>(i + 1))}, clock.time);
      }
      server->answer_waiting();
      for (const auto& message : answers()) {
        const auto& force = std::get<wire::EnvironmentForce>(message);
        for (std::size_t i = 0; i < sessions.size(); ++i) answered[i] += force.session == sessions[i] ? 1 : 0;
      }
    }
    return answered;
  }

  std::uint64_t sequence_ = 0;
};

TEST_F(ServerLoad, ASessionAloneMayUseAllOfTheProcessor) {
  const auto answered = answered_in_a_second({join_in("heavy", 1)});
  EXPECT_GT(answered[0], 300) << "each answer takes 2 ms and is followed by 1 ms";
  EXPECT_EQ(server->counters().motions_over_budget, 0u);
}

TEST_F(ServerLoad, ASessionBesideOthersGetsItsShareAndTheyGetAllAnswers) {
  const std::vector sessions{join_in("heavy", 1), join_in("light", 2)};
  (void)answered_in_a_second(sessions);  // beyond the burst
  const Nanoseconds begin = clock.time;
  const auto answered = answered_in_a_second(sessions);
  const double busy_s = 2e-3 * answered[0];
  EXPECT_LE(busy_s, 0.52 * time::to_seconds(clock.time - begin)) << "half of the processor's time";
  EXPECT_GT(busy_s, 0.4);
  EXPECT_GT(answered[1], answered[0]);
  EXPECT_GT(server->counters().motions_over_budget, 0u);
  const auto counters = server->counters();
  EXPECT_EQ(counters.motions_unanswered() + counters.forces_sent, counters.motions_received);
}

TEST_F(ServerLoad, OneMoreIsRefusedWithTheReasonIfTheProcessorIsTooSlowForIt) {
  std::vector<std::uint64_t> sessions;
  for (std::uint16_t port = 1; port <= 3; ++port) sessions.push_back(join_in("light", port));
  for (int i = 0; i < 4; ++i) (void)answered_in_a_second(sessions);
  // Three take 0.6 ms of 1.6 ms.
  sessions.push_back(join_in("light", 4));
  for (int i = 0; i < 4; ++i) (void)answered_in_a_second(sessions);
  server->store_busy(0.95, 4000);
  arrive(hello(99), address(99));
  const auto refusal = only_answer<wire::Refusal>();
  EXPECT_EQ(refusal.reason, wire::RefusalReason::server_full);
  EXPECT_THAT(std::string(refusal.text), AllOf(HasSubstr("this server is busy"), HasSubstr("of 90 % at most")));
}

TEST_F(ServerLoad, SomebodyIsLetInAgainOnceOthersRest) {
  const std::vector sessions{join_in("heavy", 1), join_in("heavy", 2)};
  for (int i = 0; i < 4; ++i) (void)answered_in_a_second(sessions);
  auto wanted = hello(3);
  wanted.scene = "heavy";
  arrive(wanted, address(3));
  EXPECT_EQ(only_answer<wire::Refusal>().reason, wire::RefusalReason::server_full);
  clock.time += seconds{5};
  EXPECT_NE(join_in("heavy", 3), 0u);
}

}  // namespace
}  // namespace forcebound::server
