#include <array>

#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;

/// A server whose clients have shown who they are.
class ServerRights : public ServerFixture {
 protected:
  void arrive_with(const wire::Message& message, const ClientRights& rights) {
    server->on_datagram(encoded(message), address(1), clock.time, rights);
  }

  std::span<const std::byte> encoded(const wire::Message& message) { return codec_.encode(message); }

  static wire::Hello hello_for(std::string_view scene) {
    wire::Hello wanted = hello();
    wanted.scene = scene;
    return wanted;
  }

  /// Another network for each.
  static net::Address from_network(std::uint16_t number) {
    net::Address from = address(1);
    from.ip[12] = static_cast<std::uint8_t>(number >> 8U);
    from.ip[13] = static_cast<std::uint8_t>(number & 0xffU);
    return from;
  }

  const std::array<std::string, 2> scenes{"sphere", "palpation"};
  const ClientRights anna{.name = "anna", .key = "anna\'s key", .scenes = scenes};

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
  arrive_with(hello_for("wall"), {.name = "bert", .key = "bert\'s key"});
  EXPECT_EQ(only_answer<wire::Welcome>().scene, "wall");
}

TEST_F(ServerRights, BoundTheMotionsThatAreAnsweredAndLoseNoneOfTheirNumbers) {
  const ClientRights bert{.name = "bert", .key = "bert\'s key", .motions_per_s_max = 10};
  arrive_with(hello(), bert);
  const std::uint64_t session = only_answer<wire::Welcome>().session;
  constexpr std::uint64_t kMotions = 5000;
  for (std::uint64_t i = 1; i <= kMotions; ++i) {
    clock.time += milliseconds{1};
    arrive_with(motion(session, i), bert);
  }
  const ServerCounters counters = server->counters();
  EXPECT_EQ(counters.motions_received, kMotions);
  EXPECT_EQ(counters.forces_sent + counters.motions_over_rate, kMotions);
  EXPECT_LE(counters.forces_sent, 10U * 5 + 16) << "ten in each of five seconds, and a burst";
  EXPECT_GE(counters.forces_sent, 10U * 5);
}

TEST_F(ServerRights, BoundTheSessionsOfAClientWhereverTheyComeFrom) {
  const ClientRights two{.name = "anna", .key = "anna\'s key", .sessions_max = 2};
  const ClientRights others{.name = "bert", .key = "bert\'s key", .sessions_max = 2};
  const auto join_as = [&](const ClientRights& rights, std::uint16_t number) {
    server->on_datagram(encoded(hello(number)), address(number), clock.time, rights);
    return answers();
  };
  const auto first = join_as(two, 1);
  const std::uint64_t session = std::get<wire::Welcome>(first.at(0)).session;
  ASSERT_EQ(join_as(two, 2).size(), 1U);
  const auto third = join_as(two, 3);
  ASSERT_TRUE(std::holds_alternative<wire::Refusal>(third.at(0)));
  EXPECT_EQ(std::get<wire::Refusal>(third.at(0)).text,
            "client 'anna' has as many sessions as it may, 2: end one or try again later");
  EXPECT_TRUE(std::holds_alternative<wire::Welcome>(join_as(others, 4).at(0)));
  arrive_with(wire::Bye{.session = session}, two);
  (void)answers();
  EXPECT_TRUE(std::holds_alternative<wire::Welcome>(join_as(two, 5).at(0)));
}

TEST_F(ServerRights, WithoutAMostOfSessionsAreAFairShareOfThem) {
  start({.sessions_max = 8});
  const ClientRights stolen{.name = "anna", .key = "stolen key"};
  const ClientRights other{.name = "bert", .key = "bert's key"};
  std::uint16_t number = 0;
  const auto enters = [&](const ClientRights& rights) {
    ++number;
    server->on_datagram(encoded(hello(number)), address(number), clock.time, rights);
    const auto replies = answers();
    return !replies.empty() && std::holds_alternative<wire::Welcome>(replies.back());
  };
  int held = 0;
  for (int i = 0; i < 64; ++i) held += enters(stolen) ? 1 : 0;
  EXPECT_EQ(held, 4) << "half of what there is";
  EXPECT_TRUE(enters(other));
  EXPECT_TRUE(enters(other));
  EXPECT_FALSE(enters(other)) << "as many as are free";
  EXPECT_TRUE(enters({.name = "carl", .key = "carl's key"}));
  EXPECT_TRUE(enters({.name = "carl", .key = "carl's key", .sessions_max = 2})) << "its entry in the list counts";
}

TEST_F(ServerRights, LeaveAPlaceToSomebodyElseWhereverThoseOfOneKeySayHelloFrom) {
  start({.hellos_per_s_max = 50});
  const ClientRights stolen{.name = "anna", .key = "stolen key", .sessions_max = 1};
  const ClientRights other{.name = "bert", .key = "bert's key"};
  for (std::uint16_t number = 1; number <= 5000; ++number) {
    server->on_datagram(encoded(hello(number)), from_network(number), clock.time, stolen);
  }
  EXPECT_EQ(server->counters().hellos_over_rate, 5000U - 50U);
  (void)answers();
  server->on_datagram(encoded(hello(6000)), address(6000), clock.time, other);
  EXPECT_TRUE(std::holds_alternative<wire::Welcome>(answers().back()));
}

TEST_F(ServerRights, EndWithTheKeyAndNotWithTheName) {
  const ClientRights stolen{.name = "anna", .key = "stolen key"};
  const ClientRights replaced{.name = "anna", .key = "new key"};
  arrive_with(hello(1), stolen);
  const std::uint64_t session = only_answer<wire::Welcome>().session;
  arrive_with(motion(session, 1), replaced);
  EXPECT_EQ(server->counters().datagrams_of_others, 1U) << "another key, whatever its name";
  EXPECT_EQ(server->end_sessions([](const Session& any) { return any.client != "new key"; }), 1U);
  EXPECT_EQ(server->sessions(), 0U);
}

TEST_F(ServerRights, LeaveASessionToTheClientThatOpenedIt) {
  const ClientRights other{.name = "bert", .key = "bert\'s key"};
  arrive_with(hello(), {.name = "anna", .key = "anna\'s key"});
  const std::uint64_t session = only_answer<wire::Welcome>().session;
  arrive_with(motion(session, 1), other);
  arrive_with(wire::Bye{.session = session}, other);
  EXPECT_TRUE(answers().empty());
  EXPECT_EQ(server->sessions(), 1U);
  EXPECT_EQ(server->counters().datagrams_of_others, 2U);
  EXPECT_EQ(server->counters().motions_received, 0U);
}

TEST_F(ServerRights, WithoutARateAreTheServersOwn) {
  const ClientRights bert{.name = "bert", .key = "bert\'s key"};
  arrive_with(hello(), bert);
  const std::uint64_t session = only_answer<wire::Welcome>().session;
  for (std::uint64_t i = 1; i <= 1000; ++i) {
    clock.time += milliseconds{1};
    arrive_with(motion(session, i), bert);
  }
  EXPECT_EQ(server->counters().forces_sent, 1000U);
}

}  // namespace
}  // namespace forcebound::server
