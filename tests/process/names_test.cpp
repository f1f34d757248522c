// Names that lead to several addresses, to others later, or nowhere yet: the programs in a namespace of mounts of their
// own, with the test's /etc/hosts in place of the system's.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <string>

#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const Words kHand{"--device", "omni", "--operator", "trace-sphere", "--rendering", "remote", "--scene-cache", "none"};

Words both(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

class NamesOfServers : public testing::Test {
 protected:
  void SetUp() override {
    write_file(folder_.file("nsswitch.conf"), "hosts: files\n");
    lead_to({});
    if (run("/usr/bin/unshare", in_namespace({"true"})).exit_code != 0) {
      GTEST_SKIP() << "no namespace of mounts may be made here";
    }
  }

  /// What haptics.test is from now on. In place, since the file itself is mounted.
  void lead_to(const Words& addresses) const {
    std::string hosts;
    for (const std::string& address : addresses) hosts += address + " haptics.test\n";
    write_file(folder_.file("hosts"), hosts);
  }

  [[nodiscard]] Words in_namespace(const Words& command) const {
    return both({"--mount", "--", "/bin/sh", "-ec",
                 "mount --bind \"$1\" /etc/hosts; mount --bind \"$2\" /etc/nsswitch.conf; shift 2; exec \"$@\"", "sh",
                 folder_.file("hosts"), folder_.file("nsswitch.conf")},
                command);
  }

  /// A program that finds the names.
  struct Program : Process {
    Program(const NamesOfServers& names, const Words& command)
        : Process("/usr/bin/unshare", names.in_namespace(command)) {}
  };

  [[nodiscard]] Words client_of(const std::string& port, const Words& more = {}) const {
    return both(both({kClient, "--server", "haptics.test:" + port}, kHand), more);
  }

  static std::string port_of(const std::string& address) { return address.substr(address.rfind(':') + 1); }

  TemporaryFolder folder_;
};

TEST_F(NamesOfServers, WithBothKindsOfAddressLeadToTheOneThatHasAServer) {
  const std::string port = port_of(free_address());
  for (const char* const at : {"[::1]", "127.0.0.1"}) {
    std::string address = at;
    address.append(":").append(port);
    Process server(kServer, {"--scene", "sphere", "--listen", address});
    if (!server.wait_for("listening on ")) GTEST_SKIP() << "this machine has no IPv6";
    lead_to({"127.0.0.1", "::1"});
    Program client(*this, client_of(port, {"--once", "--duration", "2"}));
    std::string words = "haptics.test:";
    words.append(port).append(" is at ").append(address);
    EXPECT_TRUE(client.wait_for(words)) << client.err();
    EXPECT_TRUE(client.wait_for("connected; simulated")) << client.err();
    EXPECT_EQ(server.stop(), 0);
  }
}

TEST_F(NamesOfServers, ThatLeadNowhereYetAreLookedUpAgain) {
  Server server({"--scene", "sphere"});
  const std::string port = port_of(server.address());
  Program client(*this, client_of(port));
  ASSERT_TRUE(client.wait_for("cannot find the address of host 'haptics.test'")) << client.err();
  ASSERT_TRUE(client.wait_for("; retrying")) << client.err();
  lead_to({"127.0.0.1"});
  EXPECT_TRUE(client.wait_for("haptics.test:" + port + " is at " + server.address())) << client.err();
  EXPECT_TRUE(client.wait_for("connected; simulated")) << client.err();
}

TEST_F(NamesOfServers, EndAClientThatIsToldOnceWithTheirName) {
  const Ran client = run("/usr/bin/unshare", in_namespace(client_of("1", {"--once"})));
  EXPECT_EQ(client.exit_code, 5);
  EXPECT_THAT(client.err, HasSubstr("gave up: no answer from haptics.test:1 (cannot find the address of host"));
}

//   client, relay --> 127.0.0.1: killed; started again at 127.0.0.2, where the name now leads
TEST_F(NamesOfServers, OfAServerThatMovesLeadClientAndRelayToIt) {
  std::optional<Server> server(std::in_place, Words{"--scene", "sphere"});
  const std::string port = port_of(server->address());
  lead_to({"127.0.0.1"});
  Program relay(*this, {kRelay, "--listen", "127.0.0.1:0", "--upstream", "haptics.test:" + port});
  ASSERT_TRUE(relay.wait_for("down:")) << relay.err();
  EXPECT_THAT(unwrapped(relay.out()), HasSubstr("upstream haptics.test:" + port + " (at 127.0.0.1:" + port + ")"));
  const std::string output = relay.out();
  const std::size_t at = output.find("listening on ") + 13;
  Client through_relay(output.substr(at, output.find(',', at) - at), kHand);
  Program client(*this, client_of(port));
  for (Process* const each : {static_cast<Process*>(&client), static_cast<Process*>(&through_relay)}) {
    ASSERT_TRUE(each->wait_for("connected; simulated")) << each->err();
  }
  server->signal(SIGKILL);
  server.reset();
  server.emplace(Words{"--scene", "sphere"}, "127.0.0.2:" + port);
  lead_to({"127.0.0.2"});
  EXPECT_TRUE(client.wait_for("haptics.test:" + port + " is at 127.0.0.2:" + port)) << client.err();
  EXPECT_TRUE(relay.wait_for("haptics.test:" + port + " is at 127.0.0.2:" + port)) << relay.err();
  // Each asks the new server for a session: told that it has none, or before the first such answer.
  for (Process* const each : {static_cast<Process*>(&client), static_cast<Process*>(&through_relay)}) {
    EXPECT_TRUE(each->wait_for("forces are fresh again")) << each->err();
  }
  EXPECT_EQ(relay.stop(), 0);
}

TEST_F(NamesOfServers, LeadTheDoctorToTheAddressThatHasAServer) {
  const std::string port = port_of(free_address());
  Process server(kServer, {"--scene", "sphere", "--listen", "[::1]:" + port});
  if (!server.wait_for("listening on ")) GTEST_SKIP() << "this machine has no IPv6";
  lead_to({"127.0.0.1", "::1"});
  const Words doctor{kForcebound, "doctor", "--server", "haptics.test:" + port, "--seconds", "0.3"};
  const Ran found = run("/usr/bin/unshare", in_namespace(doctor));
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_THAT(unwrapped(found.out), HasSubstr("Server haptics.test:" + port + " (at [::1]:" + port + ")"));
  lead_to({});
  const Ran lost = run("/usr/bin/unshare", in_namespace(doctor));
  EXPECT_EQ(lost.exit_code, 1);
  EXPECT_THAT(lost.err, HasSubstr("no answer from haptics.test:" + port + ": cannot find the address of host"));
}

}  // namespace
}  // namespace forcebound::test
