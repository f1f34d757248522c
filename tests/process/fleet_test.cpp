#include <gmock/gmock.h>
#include <stdlib.h>
#include <filesystem>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;

/// A variable of the environment of programs started meanwhile.
class Variable {
 public:
  Variable(std::string name, const std::string& value) : name_(std::move(name)) {
    setenv(name_.c_str(), value.c_str(), 1);
  }
  ~Variable() { unsetenv(name_.c_str()); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  std::string name_;
};

Words stand_in_words(const Words& options) {
  Words words{FORCEBOUND_STAND_IN};
  words.insert(words.end(), options.begin(), options.end());
  return words;
}

/// The sidecar of one server, and the allocator.
class StandIn : public Process {
 public:
  explicit StandIn(const Words& options) : Process(FORCEBOUND_NODE, stand_in_words(options)) {
    EXPECT_TRUE(wait_for("\"allocator\":"));
    EXPECT_TRUE(wait_for("\n"));
    const std::string output = out();
    const json ports = json::parse(output.substr(0, output.find('\n')));
    sidecar_ = std::to_string(ports["sidecars"][0].get<int>());
    allocator_ = std::to_string(ports["allocator"].get<int>());
  }

  [[nodiscard]] const std::string& sidecar() const { return sidecar_; }
  [[nodiscard]] std::string allocator(const std::string& scheme = "http") const {
    return scheme + "://127.0.0.1:" + allocator_;
  }

 private:
  std::string sidecar_;
  std::string allocator_;
};

std::string port_of(const std::string& address) { return address.substr(address.find(':') + 1); }

class AServerOfAFleet : public testing::Test {
 protected:
  void SetUp() override {
    if (std::string(FORCEBOUND_NODE).empty()) GTEST_SKIP() << "node is not installed (deploy/setup --tests)";
  }
};

class AClientOfAFleet : public AServerOfAFleet {};

TEST_F(AServerOfAFleet, IsReadyThenInUseThenReadyAgainAndShutsDownAtItsEnd) {
  const std::string at = free_address();
  StandIn fleet({"--first-port", port_of(at)});
  const Variable port("AGONES_SDK_HTTP_PORT", fleet.sidecar());
  Server server({"--scene", "sphere"}, at);
  ASSERT_TRUE(fleet.wait_for(R"("event":"ready","from":"Scheduled","to":"Ready")"));
  ASSERT_TRUE(fleet.wait_for("first health"));
  ASSERT_TRUE(fleet.wait_for(R"("event":"count","count":0)"));
  Client client(server.address(), {"--device", "omni"});
  ASSERT_TRUE(client.wait_for("connected"));
  ASSERT_TRUE(fleet.wait_for(R"("event":"allocate","from":"Ready","to":"Allocated")"));
  ASSERT_TRUE(fleet.wait_for(R"("event":"count","count":1)"));
  EXPECT_EQ(client.stop(), client.expected_end());
  ASSERT_TRUE(fleet.wait_for(R"("event":"ready","from":"Allocated","to":"Ready")", 60s));
  ASSERT_TRUE(server.wait_for("ready again: the last client has left"));
  EXPECT_EQ(server.stop(), 0);
  EXPECT_TRUE(fleet.wait_for(R"("event":"shutdown","from":"Ready","to":"Shutdown")"));
  EXPECT_THAT(fleet.out(), Not(HasSubstr("refused")));
}

TEST_F(AServerOfAFleet, EndsAfterUseIfItIsToldTo) {
  StandIn fleet({});
  const Variable port("AGONES_SDK_HTTP_PORT", fleet.sidecar());
  Server server({"--scene", "sphere", "--fleet-after-use", "shutdown"});
  Client client(server.address(), {"--device", "omni", "--duration", "1", "--once"});
  EXPECT_EQ(client.wait(60s), client.expected_end());
  EXPECT_EQ(server.wait(60s), 0) << "it was not told to end";
  EXPECT_THAT(fleet.out(), HasSubstr(R"("event":"shutdown","from":"Allocated","to":"Shutdown")"));
}

TEST_F(AServerOfAFleet, ServesWithoutASidecarAndFindsItLater) {
  const std::string sidecar = port_of(free_address());
  const Variable port("AGONES_SDK_HTTP_PORT", sidecar);
  Server server({"--scene", "sphere"});
  ASSERT_TRUE(server.wait_for("the sidecar does not answer: http://127.0.0.1:" + sidecar + "/ready: "));
  Client client(server.address(), {"--device", "omni", "--duration", "1", "--once"});
  EXPECT_EQ(client.wait(60s), client.expected_end());
  StandIn fleet({"--sidecar-port", sidecar});
  ASSERT_TRUE(server.wait_for("the sidecar answers again", 60s));
  ASSERT_TRUE(fleet.wait_for(R"("event":"ready","from":"Scheduled","to":"Ready")"));
  EXPECT_EQ(server.stop(), 0);
  // A stand-in on a busy machine may be silent again later.
  const std::string all = server.err();
  const std::string output = all.substr(0, all.find("the sidecar answers again"));
  const std::string silence = "the sidecar does not answer";
  EXPECT_EQ(output.find(silence), output.rfind(silence)) << "it is said once:\n" << output;
}

TEST_F(AServerOfAFleet, LogsAWrongAnswerOnceWhileTheSidecarAnswersAllElse) {
  StandIn fleet({"--odd-looks", "3"});
  const Variable port("AGONES_SDK_HTTP_PORT", fleet.sidecar());
  Server server({"--scene", "sphere"});
  ASSERT_TRUE(server.wait_for("/gameserver was answered with what is no state of a GameServer", 60s));
  ASSERT_TRUE(server.wait_for("the sidecar answers again: /gameserver", 60s));
  EXPECT_EQ(server.stop(), 0);
  const std::string output = server.err();
  const std::string fault = "no state of a GameServer";
  EXPECT_EQ(output.find(fault), output.rfind(fault)) << "it is said once:\n" << output;
}

TEST_F(AServerOfAFleet, ServesBesideASidecarThatTakesConnectionsAndNeverAnswers) {
  StandIn fleet({"--deaf"});
  const Variable port("AGONES_SDK_HTTP_PORT", fleet.sidecar());
  Server server({"--scene", "sphere"});
  Client client(server.address(), {"--device", "omni", "--duration", "1", "--once"});
  EXPECT_EQ(client.wait(60s), client.expected_end());
  ASSERT_TRUE(server.wait_for("no answer in time; serving on"));
  EXPECT_EQ(server.stop(), 0);
}

TEST_F(AServerOfAFleet, SaysOnceThatTheFleetCountsNoSessions) {
  StandIn fleet({"--no-counters"});
  const Variable port("AGONES_SDK_HTTP_PORT", fleet.sidecar());
  Server server({"--scene", "sphere"});
  ASSERT_TRUE(server.wait_for("needs a counter 'sessions'"));
  ASSERT_TRUE(fleet.wait_for("first health"));
  EXPECT_EQ(server.stop(), 0);
}

TEST_F(AServerOfAFleet, RefusesAnEnvironmentThatNamesNoPort) {
  const Variable port("AGONES_SDK_HTTP_PORT", "http");
  const Ran ran = run(kServer, {});
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_THAT(ran.err, HasSubstr("AGONES_SDK_HTTP_PORT in the environment must be a port from 1 to 65535, got 'http'"));
}

TEST_F(AClientOfAFleet, GetsAServerFromTheAllocator) {
  const std::string at = free_address();
  StandIn fleet({"--first-port", port_of(at)});
  const Variable port("AGONES_SDK_HTTP_PORT", fleet.sidecar());
  Server server({"--scene", "sphere"}, at);
  ASSERT_TRUE(fleet.wait_for(R"("to":"Ready")"));
  Process client(kClient, {"--allocate", fleet.allocator(), "--allocate-fleet", "forcebound", "--device", "omni",
                           "--duration", "1", "--once", "--scene-cache", "none"});
  ASSERT_TRUE(client.wait_for("the allocator gave server " + at));
  EXPECT_THAT(client.wait(60s), testing::AnyOf(0, 3));
  EXPECT_THAT(server.err(), HasSubstr("connected to scene 'sphere'"));
  EXPECT_THAT(fleet.out(), HasSubstr(R"("event":"allocated by the allocator","from":"Ready","to":"Allocated")"));
}

TEST_F(AClientOfAFleet, UsesItsOwnServerWhereTheAllocatorHasNone) {
  StandIn fleet({});
  Server server({"--scene", "sphere"});
  Client client(server.address(), {"--allocate", fleet.allocator(), "--device", "omni", "--duration", "1", "--once"});
  EXPECT_EQ(client.wait(60s), client.expected_end());
  EXPECT_THAT(client.err(), HasSubstr("no server from the allocator: HTTP status 429: there is no available GameServer "
                                      "to allocate; using --server " +
                                      server.address()));
}

TEST_F(AClientOfAFleet, SaysWhyThereIsNoServer) {
  const std::string nobody = free_address();
  const Ran refused = run(kClient, {"--allocate", "http://" + nobody});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("no server from the allocator: http://" + nobody + "/gameserverallocation: "));
  EXPECT_THAT(refused.err, HasSubstr("--server HOST:PORT would be used instead"));
  StandIn deaf({"--deaf"});
  const Ran silent = run(kClient, {"--allocate", deaf.allocator(), "--allocate-wait", "0.2"});
  EXPECT_EQ(silent.exit_code, 1);
  EXPECT_THAT(silent.err, HasSubstr("no answer in time"));
  const Ran wrong = run(kClient, {"--allocate", "allocator:443"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("begins with neither http:// nor https://"));
}

/// Certificates of an authority of this test, in a folder.
void make_certificates(const std::string& folder) {
  const std::string script =
      "cd '" + folder +
      "' && export OPENSSL_CONF=/dev/null && "
      "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=authority -keyout ca-key.pem "
      "-out ca.pem -days 2 -addext basicConstraints=critical,CA:TRUE && "
      "for name in server client; do "
      "openssl req -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=$name -keyout $name-key.pem "
      "-out $name.csr && echo subjectAltName=IP:127.0.0.1 >ext && openssl x509 -req -in $name.csr -CA ca.pem "
      "-CAkey ca-key.pem -CAcreateserial -days 2 -extfile ext -out $name.pem || exit 1; done";
  const Ran made = run("/bin/bash", {"-c", script});
  ASSERT_EQ(made.exit_code, 0) << made.err;
}

TEST_F(AClientOfAFleet, ShowsTheAllocatorItsCertificateAndChecksTheAllocators) {
  if (!std::filesystem::exists("/usr/bin/openssl")) GTEST_SKIP() << "no openssl; deploy/setup --tests installs it";
  const TemporaryFolder folder;
  make_certificates(folder.path().string());
  const std::string at = free_address();
  StandIn fleet({"--first-port", port_of(at), "--tls-folder", folder.path().string()});
  const Variable port("AGONES_SDK_HTTP_PORT", fleet.sidecar());
  Server server({"--scene", "sphere"}, at);
  ASSERT_TRUE(fleet.wait_for(R"("to":"Ready")"));
  const std::string url = fleet.allocator("https");
  const Ran distrusts = run(kClient, {"--allocate", url});
  EXPECT_EQ(distrusts.exit_code, 1);
  EXPECT_THAT(distrusts.err, HasSubstr("certificate verify failed"));
  const Ran unknown = run(kClient, {"--allocate", url, "--allocate-ca", folder.file("ca.pem")});
  EXPECT_EQ(unknown.exit_code, 1);
  Process client(kClient, {"--allocate", url, "--allocate-ca", folder.file("ca.pem"), "--allocate-certificate",
                           folder.file("client.pem"), "--allocate-key", folder.file("client-key.pem"), "--device",
                           "omni", "--duration", "1", "--once", "--scene-cache", "none"});
  EXPECT_THAT(client.wait(60s), testing::AnyOf(0, 3)) << client.err();
  EXPECT_THAT(client.err(), HasSubstr("the allocator gave server " + at));
}

}  // namespace
}  // namespace forcebound::test
