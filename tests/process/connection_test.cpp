#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <optional>
#include <span>
#include <string_view>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/net/udp_link.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/wire/codec.hpp"
#include "tests/process/programs.hpp"
#include "tests/process/recorded_run.hpp"
#include "tests/support/scene_files.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

const Words kSphere{"--device", "omni", "--operator", "trace-sphere"};

Words and_also(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(AClientWithoutAServer, GivesUpAndSaysWhyIfToldOnce) {
  const std::string closed_port = free_address();
  Client client(closed_port, {"--once"});
  EXPECT_EQ(client.wait(60s), 5);
  EXPECT_THAT(client.err(), HasSubstr("gave up: no answer from " + closed_port + ": port unreachable (ICMP)\n"));
  EXPECT_EQ(occurrences(client.err(), "error"), 1U);
}

TEST(AClientWithoutAServer, NeverConnectedOnceItsTimeIsOverIfToldOnce) {
  Client client(free_address(), {"--once", "--duration", "1"});
  EXPECT_EQ(client.wait(60s), 5);
  EXPECT_THAT(client.err(), HasSubstr("gave up: no answer from"));
}

TEST(AClientWithoutAServer, KeepsTryingAndEndsWithASummaryAndAStatusOfItsOwn) {
  const std::string closed_port = free_address();
  Client client(closed_port, {"--law", "fba-more", "--duration", "6"});
  EXPECT_EQ(client.wait(20s), 5);
  EXPECT_THAT(client.err(), HasSubstr("no answer from " + closed_port + " yet; retrying"));
  EXPECT_THAT(client.out(),
              AllOf(HasSubstr("Summary: never connected, no verdict"), HasSubstr("forces        none arrived")));
  const nlohmann::json summary = client.summary();
  ASSERT_TRUE(summary.is_object());
  EXPECT_EQ(summary["received"], 0);
  EXPECT_GT(summary["ticks"], 0);
  EXPECT_EQ(summary["force_N"]["max"], 0);
}

TEST(AClient, FindsTheServerThatComesLater) {
  const std::string address = free_address();
  RecordedClient client(address, kSphere);
  ASSERT_TRUE(client.wait_for("no answer from"));
  Server server({"--scene", "sphere"}, address);
  EXPECT_TRUE(client.wait_for_tick(is_answered));
  EXPECT_EQ(client.stop(), 0);
  EXPECT_GT(client.summary()["received"], 0);
  EXPECT_EQ(client.summary()["faults"]["reconnects"], 0);
}

TEST(AServer, RefusesAnUnknownSceneOnceNamingThoseItHas) {
  Server server;
  Client client(server.address(), {"--scene", "spere"});
  EXPECT_EQ(client.wait(20s), 5);
  EXPECT_THAT(client.err(), AllOf(HasSubstr("refused by the server: no scene 'spere', did you mean 'sphere'? (known: " +
                                            text::join(test::scene_files()) + ")"),
                                  HasSubstr("gave up: " + server.address() + " refused")));
  EXPECT_EQ(occurrences(client.err(), "refused by the server"), 1U);
}

TEST(AServer, RefusesWrongDegreesOfFreedomNamingThoseOfTheScene) {
  Server server({"--scene", "sphere"});
  Client client(server.address(), {"--device", "wall-1dof", "--once"});
  EXPECT_EQ(client.wait(20s), 5);
  EXPECT_THAT(client.err(),
              HasSubstr("scene 'sphere' accepts devices with 3 or 6 degrees of freedom, device 'wall-1dof' has 1"));
}

std::optional<wire::Message> ask(wire::Codec& codec, const wire::Hello& hello, const std::string& server) {
  static std::array<std::byte, net::kDatagramBytesMax> buffer;
  const net::Address address = net::resolve(net::parse_endpoint(server));
  net::UdpLink link = net::UdpLink::towards(address);
  link.send(codec.encode(hello), address);
  const std::array descriptors{link.descriptor()};
  net::wait_readable(descriptors, 5s);
  const auto received = link.receive(buffer);
  if (!received) return std::nullopt;
  const auto decoded = codec.decode(std::span(buffer).first(received->bytes));
  const auto* message = std::get_if<wire::Message>(&decoded);
  return message == nullptr ? std::nullopt : std::optional(*message);
}

TEST(AServer, RefusesAnotherProtocolVersionNamingBoth) {
  Server server;
  wire::Codec codec;
  const auto answer = ask(codec, {.protocol_version = 99, .client_nonce = 7, .degrees_of_freedom = 1, .period_s = 1e-3},
                          server.address());
  ASSERT_TRUE(answer && std::holds_alternative<wire::Refusal>(*answer));
  const auto& refusal = std::get<wire::Refusal>(*answer);
  EXPECT_EQ(refusal.reason, wire::RefusalReason::version_mismatch);
  EXPECT_EQ(refusal.client_nonce, 7U);
  EXPECT_EQ(refusal.text, "the server speaks protocol version 2, the client version 99: update the server");
}

TEST(AnAddressInUse, IsNamedByServerAndRelay) {
  Server server;
  const Ran second = run(kServer, {"--listen", server.address()});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_EQ(second.err, "forcebound-server: cannot listen on " + server.address() +
                            ": the address is already in use, by another program or a copy of this one\n");
  const Ran relay = run(kRelay, {"--listen", server.address(), "--upstream", free_address()});
  EXPECT_EQ(relay.exit_code, 1);
  EXPECT_THAT(relay.err,
              AllOf(HasSubstr("forcebound-relay: cannot listen on " + server.address()), HasSubstr("already in use")));
}

TEST(ARelayWithoutAServer, SaysSoInItsTotals) {
  const std::string closed_port = free_address();
  Relay relay(closed_port, {});
  Client client(relay.address(), {"--once", "--duration", "1"});
  EXPECT_EQ(client.wait(10s), 5);
  EXPECT_THAT(client.err(), HasSubstr("gave up: no answer from " + relay.address() + "\n"));
  EXPECT_EQ(relay.stop(), 0);
  EXPECT_THAT(relay.out(), HasSubstr("datagrams refused by " + closed_port + ": port unreachable (ICMP)"));
}

/// Asks a relay's control, again until it answers, since a datagram may be lost.
std::string ask_control(const std::string& address, std::string_view line) {
  const net::Address to = net::resolve(net::parse_peer(address));
  net::UdpLink link = net::UdpLink::towards(to);
  std::array<std::byte, net::kDatagramBytesMax> buffer{};
  for (int attempt = 0; attempt < 100; ++attempt) {
    link.send(std::as_bytes(std::span(line)), to);
    const std::array descriptors{link.descriptor()};
    net::wait_readable(descriptors, 200ms);
    if (const auto received = link.receive(buffer)) {
      return {reinterpret_cast<const char*>(buffer.data()), received->bytes};
    }
  }
  return "no answer";
}

TEST(ARelaysControl, ChangesTheNetworkWhileItRuns) {
  const std::string control = free_address();
  Relay relay(free_address(), {"--control", control});
  EXPECT_EQ(ask_control(control, "both loss 5%\n"), "up: loss 5%; down: loss 5%\n");
  EXPECT_TRUE(relay.wait_for("info: up: loss 5%; down: loss 5%")) << "each change is printed";
  EXPECT_THAT(ask_control(control, "up loss"), testing::StartsWith("error: "));
  EXPECT_EQ(relay.stop(), 0);
}

TEST(ARelaysControl, IsForThisMachineAlone) {
  const Ran relay =
      run(kRelay, {"--listen", "127.0.0.1:0", "--upstream", free_address(), "--control", "0.0.0.0:47802"});
  EXPECT_EQ(relay.exit_code, 2);
  EXPECT_THAT(relay.err, HasSubstr("--control: 0.0.0.0:47802 can be reached from other machines; expected"));
}

TEST(AServerThatEnds, TellsItsClients) {
  Server server({"--scene", "sphere"});
  Client client(server.address(), kSphere);
  ASSERT_TRUE(client.wait_for("connected"));
  EXPECT_EQ(server.stop(), 0);
  EXPECT_TRUE(client.wait_for("the server ended the session"));
  EXPECT_EQ(client.stop(), 0);
}

TEST(TwoClientsOfOneServer, EachFeelTheirOwnScene) {
  Server server;
  Client wall(server.address(), {"--device", "wall-1dof", "--operator", "press", "--duration", "2", "--once"});
  Client sphere(server.address(), and_also(kSphere, {"--scene", "sphere", "--duration", "2", "--once"}));
  EXPECT_EQ(wall.wait(20s), 0);
  EXPECT_EQ(sphere.wait(20s), 0);
  EXPECT_EQ(server.stop(), 0);
  EXPECT_THAT(server.err(), AllOf(HasSubstr("connected to scene 'wall' with device 'wall-1dof' (1 degree of freedom)"),
                                  HasSubstr("connected to scene 'sphere' with device 'omni' (3 degrees of freedom)")));
  EXPECT_EQ(counted(server.out(), "sessions", "opened"), 2U);
  EXPECT_EQ(counted(server.out(), "sessions", "ended by the client"), 2U);
  std::uint64_t received = 0;
  for (const Client* client : {&wall, &sphere}) {
    const nlohmann::json summary = client->summary();
    EXPECT_GT(summary["contact_ticks"], 0);
    EXPECT_EQ(summary["lost"], 0);
    received += summary["sent"].get<std::uint64_t>();
  }
  EXPECT_EQ(counted(server.out(), "motions", "received"), received);
}

}  // namespace
}  // namespace forcebound::test
