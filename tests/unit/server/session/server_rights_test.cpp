#include <array>

#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;

/// A server whose clients have shown who they are.
class ServerRights : public ServerFixture {
 protected:
  void arrive_with(const wire::Message& message, const ClientRights& rights) {
    server->on_datagram(codec_.encode(message), address(1), clock.time, rights);
  }

  static wire::Hello hello_for(std::string_view scene) {
    wire::Hello wanted = hello();
    wanted.scene = scene;
    return wanted;
  }

  const std::array<std::string, 2> scenes{"sphere", "palpation"};
  const ClientRights anna{.name = "anna", .scenes = scenes};

 private:
  wire::Codec codec_;
};

TEST_F(ServerRights, RefusesASceneThatTheClientMayNotUseAndNamesThoseItMay) {
  arrive_with(hello_for("wall"), anna);
  const auto refusal = only_answer<wire::Refusal>();
  EXPECT_EQ(refusal.reason, wire::RefusalReason::unknown_scene);
  EXPECT_EQ(refusal.text, "client 'anna' may not use scene 'wall' (allowed: sphere, palpation)");
  EXPECT_EQ(server->sessions(), 0U);
}

TEST_F(ServerRights, HoldForTheServersOwnSceneToo) {
  arrive_with(hello_for(""), anna);
  EXPECT_THAT(only_answer<wire::Refusal>().text, HasSubstr("may not use scene 'wall'"));
}

TEST_F(ServerRights, DoNotGiveWhatTheServerDoesNotOffer) {
  start({.scene = "wall", .scenes = {"blocks"}});
  arrive_with(hello_for("sphere"), anna);
  EXPECT_THAT(only_answer<wire::Refusal>().text, HasSubstr("does not offer scene 'sphere'"));
}

TEST_F(ServerRights, WithoutAListLetAClientUseEveryScene) {
  arrive_with(hello_for("wall"), {.name = "bert"});
  EXPECT_EQ(only_answer<wire::Welcome>().scene, "wall");
}

TEST_F(ServerRights, BoundTheMotionsThatAreAnsweredAndLoseNoneOfTheirNumbers) {
  arrive_with(hello(), {.name = "bert", .motions_per_s_max = 10});
  const std::uint64_t session = only_answer<wire::Welcome>().session;
  constexpr std::uint64_t kMotions = 5000;
  for (std::uint64_t i = 1; i <= kMotions; ++i) {
    clock.time += milliseconds{1};
    arrive(motion(session, i));
  }
  const ServerCounters counters = server->counters();
  EXPECT_EQ(counters.motions_received, kMotions);
  EXPECT_EQ(counters.forces_sent + counters.motions_over_rate, kMotions);
  EXPECT_LE(counters.forces_sent, 10U * 5 + 16) << "ten in each of five seconds, and a burst";
  EXPECT_GE(counters.forces_sent, 10U * 5);
}

TEST_F(ServerRights, WithoutARateAreTheServersOwn) {
  arrive_with(hello(), {.name = "bert"});
  const std::uint64_t session = only_answer<wire::Welcome>().session;
  for (std::uint64_t i = 1; i <= 1000; ++i) {
    clock.time += milliseconds{1};
    arrive(motion(session, i));
  }
  EXPECT_EQ(server->counters().forces_sent, 1000U);
}

}  // namespace
}  // namespace forcebound::server
