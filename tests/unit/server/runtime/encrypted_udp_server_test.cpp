#include <gmock/gmock.h>

#include <array>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "forcebound/server/runtime/udp_server.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/support/vector_of.hpp"
#include "tests/unit/server/runtime/askers.hpp"

namespace forcebound::server {
namespace {

using test::vector_of;
using testing::HasSubstr;

class Pull final : public Environment {
 public:
  Answer respond(const Motion& motion) noexcept override { return {.force = -100 * motion.position}; }
};

EnvironmentLibrary pulling() {
  EnvironmentLibrary environments;
  for (const char* const name : {"pull", "another"}) {
    environments.add({.name = name, .make = [](const ClientFacts&) {
                        return MadeEnvironment{.environment = std::make_unique<Pull>(), .simulated = "a pull"};
                      }});
  }
  return environments;
}

class Names final : public ServerObserver {
 public:
  void on_opened(const SessionInfo& info) override { clients.push_back(info.client); }
  std::vector<std::string> clients;
};

ServerKeys keys_with_anna_in_pull() {
  ServerKeys keys{.own = security::key_pair_from(security::key_bytes(2))};
  keys.clients = security::AllowedClients::parse(
      "[[client]]\nname = \"anna\"\npublic_key = \"" + security::public_text(1) + "\"\nscenes = [\"pull\"]\n",
      "clients.toml");
  return keys;
}

//   asker ==( sealed datagrams by UDP of this machine )== UdpServer, on a thread of its own
TEST(EncryptedUdpServer, AnswersSealedDatagramsAndKnowsWhoseTheyAre) {
  Names names;
  UdpServer server(listen({"127.0.0.1", 0}), {.scene = "pull"}, pulling(), &names, keys_with_anna_in_pull());
  std::jthread thread([&](const std::stop_token& stop) { server.run(stop); });
  SecureAsker asker(server.address());
  const auto refusal = asker.ask<wire::Refusal>(
      wire::Hello{.client_nonce = 1, .degrees_of_freedom = 1, .period_s = 1e-3, .scene = "another"});
  EXPECT_THAT(std::string(refusal.text), HasSubstr("client 'anna' may not use scene 'another' (allowed: pull)"));
  const auto welcome =
      asker.ask<wire::Welcome>(wire::Hello{.client_nonce = 2, .degrees_of_freedom = 1, .period_s = 1e-3});
  EXPECT_EQ(welcome.scene, "pull");
  const auto session = welcome.session;
  const auto force = asker.ask<wire::EnvironmentForce>(
      wire::MotionSample{.session = session, .sequence = 1, .position = vector_of({0.02})});
  EXPECT_EQ(force.answer.force, vector_of({-2}));
  thread.request_stop();
  EXPECT_EQ(asker.receive<wire::Bye>().session, session);
  thread.join();
  EXPECT_EQ(names.clients, std::vector<std::string>{"anna"});
  ASSERT_NE(server.encryption(), nullptr);
  EXPECT_EQ(server.encryption()->counters().handshakes, 1U);
  EXPECT_EQ(server.server().counters().sends_failed, 0U);
}

TEST(EncryptedUdpServer, MakesOneHandshakeATurn) {
  UdpServer server(listen({"127.0.0.1", 0}), {.scene = "pull"}, pulling(), nullptr,
                   ServerKeys{.shared = security::secret_key(3)});
  const security::SecretKey shared = security::secret_key(3);
  std::vector<ClientEnd> ends;
  std::vector<net::UdpLink> links;
  std::array<std::byte, net::kDatagramBytesMax> buffer{};
  const SecureCounters& counters = server.encryption()->counters();
  for (std::uint32_t number = 1; number <= 3; ++number) {
    ends.emplace_back(ClientEnd::Keys{.shared = &shared}, number);
    links.push_back(net::UdpLink::towards(server.address()));
    links.back().send(ends.back().request(), server.address());
    while (counters.cookies_offered < number) server.turn();
    net::wait_readable(std::array{links.back().descriptor()}, std::chrono::seconds{10});
    const auto received = links.back().receive(buffer);
    ASSERT_TRUE(received.has_value());
    ASSERT_TRUE(ends.back().accept_offer(std::span(buffer).first(received->bytes)).has_value());
  }
  for (std::size_t i = 0; i < ends.size(); ++i) links[i].send(ends[i].request(), server.address());
  while (counters.handshakes < ends.size()) {
    const std::uint64_t before = counters.handshakes;
    server.turn();
    ASSERT_LE(counters.handshakes, before + 1);
  }
}

TEST(EncryptedUdpServer, EndsASessionWhoseKeyWasReplacedUnderTheSameName) {
  UdpServer server(listen({"127.0.0.1", 0}), {.scene = "pull"}, pulling(), nullptr, keys_with_anna_in_pull());
  std::optional<std::jthread> thread(std::in_place, [&](const std::stop_token& stop) {
    while (!stop.stop_requested()) server.turn();
  });
  SecureAsker asker(server.address());
  const auto welcome =
      asker.ask<wire::Welcome>({wire::Hello{.client_nonce = 2, .degrees_of_freedom = 1, .period_s = 1e-3}});
  thread.reset();
  server.replace_clients(security::AllowedClients::parse(
      "[[client]]\nname = \"anna\"\npublic_key = \"" + security::public_text(4) + "\"\n", "clients.toml"));
  EXPECT_EQ(asker.receive<wire::Bye>().session, welcome.session);
  EXPECT_EQ(server.server().sessions(), 0U);
  EXPECT_EQ(server.encryption()->confirmed(), 0U);
}

TEST(EncryptedUdpServer, LetsNobodyInWithoutKeys) {
  UdpServer server(listen({"127.0.0.1", 0}), {.scene = "pull"}, pulling(), nullptr, keys_with_anna_in_pull());
  wire::Codec codec;
  net::UdpLink link = net::UdpLink::towards(server.address());
  link.send(codec.encode(wire::Hello{.client_nonce = 1, .degrees_of_freedom = 1, .period_s = 1e-3}), server.address());
  while (server.encryption()->counters().in_clear == 0) server.turn();
  EXPECT_EQ(server.server().sessions(), 0U);
  EXPECT_EQ(server.server().counters().datagrams, 0U) << "the server behind sees none of it";
}

TEST(EncryptedUdpServer, IsNoneWithoutKeys) {
  const UdpServer server(listen({"127.0.0.1", 0}), {.scene = "pull"}, pulling());
  EXPECT_EQ(server.encryption(), nullptr);
}

}  // namespace
}  // namespace forcebound::server
