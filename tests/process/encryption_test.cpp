#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/net/udp_link.hpp"
#include "tests/process/passive.hpp"
#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

/// What every datagram that is not sealed begins with.
constexpr std::string_view kInTheClear = "FB\x01";
const Words kRun{"--device", "omni", "--operator", "trace-sphere", "--duration", "2", "--once"};

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Keys of a client and a server, and one that they share.
class Encryption : public testing::Test {
 protected:
  /// @return the public key
  std::string new_pair(const std::string& name) const {
    const Ran ran = run(kForcebound, {"keygen", file(name)});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    const std::string_view before = "public key, for others: ";
    const std::size_t at = ran.out.find(before);
    return at == std::string::npos ? "" : ran.out.substr(at + before.size(), 44);
  }

  void new_shared(const std::string& name) const {
    EXPECT_EQ(run(kForcebound, {"keygen", file(name), "--shared"}).exit_code, 0);
  }

  void allow(const std::string& name, const std::string& key, const std::string& more = "") const {
    write_file(file("clients.toml"), "[[client]]\nname = \"" + name + "\"\npublic_key = \"" + key + "\"\n" + more);
  }

  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

  TemporaryFolder folder_;
};

/// A server of user 10001, as deploy/kubernetes runs it: in a group of its own, and in others as given.
class ServersKeysOfRoot : public Encryption {
 protected:
  void SetUp() override {
    if (::geteuid() != 0) GTEST_SKIP() << "only root can run a server as another user";
    // Where the server is built, another user may have no way to it.
    namespace fs = std::filesystem;
    fs::permissions(folder_.path(), fs::perms::owner_all | fs::perms::group_exec | fs::perms::others_exec);
    fs::copy_file(kServer, file("server"));
    (void)new_pair("server.key");
    new_shared("shared.key");
    allow("anna", new_pair("client.key"));
  }

  /// All that Kubernetes mounts has one owner, group and mode.
  void give(::gid_t group, ::mode_t mode) const {
    for (const char* const name : {"server.key", "shared.key", "clients.toml"}) {
      ASSERT_EQ(::chown(file(name).c_str(), 0, group), 0);
      ASSERT_EQ(::chmod(file(name).c_str(), mode), 0);
    }
  }

  [[nodiscard]] Words started(const std::string& group, const std::string& others) const {
    return {"--reuid=10001",
            "--regid=" + group,
            "--groups=" + others,
            file("server"),
            "--listen",
            "127.0.0.1:0",
            "--key",
            file("server.key"),
            "--clients",
            file("clients.toml"),
            "--psk",
            file("shared.key")};
  }
};

constexpr ::gid_t kFsGroup = 10001;
const char* const kSetpriv = "/usr/bin/setpriv";

TEST_F(ServersKeysOfRoot, AreReadWhereOneGroupOfItsOwnMayReadThem) {
  give(kFsGroup, 0440);
  Process with_group(kSetpriv, started("10001", "10001"));
  EXPECT_TRUE(with_group.wait_for("listening on ")) << with_group.err();
  EXPECT_THAT(with_group.err(), HasSubstr("encrypted: IKpsk2"));
  EXPECT_EQ(with_group.stop(), 0);
  Process in_group_beside(kSetpriv, started("20002", "10001"));
  EXPECT_TRUE(in_group_beside.wait_for("listening on ")) << in_group_beside.err();
  EXPECT_EQ(in_group_beside.stop(), 0);
}

TEST_F(ServersKeysOfRoot, AreRefusedWhereOthersMayReadThemOrItMayNot) {
  give(kFsGroup, 0444);
  const Ran for_all = run(kSetpriv, started("10001", "10001"));
  EXPECT_EQ(for_all.exit_code, 1);
  EXPECT_THAT(for_all.err, HasSubstr("others than its owner may use it (mode 0444)"));
  give(kFsGroup, 0400);
  const Ran for_root = run(kSetpriv, started("10001", "10001"));
  EXPECT_EQ(for_root.exit_code, 1);
  EXPECT_THAT(for_root.err, HasSubstr("server.key: cannot be read: Permission denied"));
}

/// Passes datagrams on both ways, and keeps them: what somebody on the way has.
class Recorder {
 public:
  explicit Recorder(const std::string& server)
      : server_(net::resolve(net::parse_endpoint(server))),
        from_client_(net::UdpLink::listen(net::resolve({"127.0.0.1", 0}))),
        from_server_(net::UdpLink::towards(server_)),
        thread_([this](const std::stop_token& ended) { pass_on(ended); }) {}

  [[nodiscard]] std::string address() const { return net::to_string(from_client_.local_address()); }

  /// All datagrams that passed. Ends the recording.
  [[nodiscard]] std::vector<std::string> end() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
    return recorded_;
  }

 private:
  void pass_on(const std::stop_token& ended) {
    const std::array descriptors{from_client_.descriptor(), from_server_.descriptor()};
    std::optional<net::Address> client;
    std::array<std::byte, net::kDatagramBytesMax> buffer;
    while (!ended.stop_requested()) {
      net::wait_readable(descriptors, 10ms);
      while (const auto received = from_client_.receive(buffer)) {
        client = received->from;
        from_server_.send(kept(std::span(buffer).first(received->bytes)), server_);
      }
      while (const auto received = from_server_.receive(buffer)) {
        if (client) from_client_.send(kept(std::span(buffer).first(received->bytes)), *client);
      }
    }
  }

  std::span<const std::byte> kept(std::span<const std::byte> datagram) {
    recorded_.emplace_back(reinterpret_cast<const char*>(datagram.data()), datagram.size());
    return datagram;
  }

  net::Address server_;
  net::UdpLink from_client_;
  net::UdpLink from_server_;
  std::vector<std::string> recorded_;
  std::jthread thread_;
};

TEST_F(Encryption, OfKeyPairsLetsInWhoIsListedAndHidesEverythingFromWhoRecords) {
  const std::string server_key = new_pair("server.key");
  allow("anna", new_pair("client.key"));
  Server server({"--scene", "sphere", "--key", file("server.key"), "--clients", file("clients.toml")});
  Recorder recorder(server.address());
  Client client(recorder.address(), with(kRun, {"--key", file("client.key"), "--server-key", server_key}));
  EXPECT_EQ(client.wait(20s), client.expected_end()) << client.err();
  EXPECT_THAT(client.err(), HasSubstr("encrypted (IKpsk2), server's key " + server_key));
  EXPECT_EQ(client.summary()["encryption"], "IKpsk2");
  const std::vector<std::string> recorded = recorder.end();
  EXPECT_GT(recorded.size(), 100U);
  // No short words: what is encrypted is as good as random, and has any three letters once in 60 runs.
  for (const std::string_view word : {"sphere", "fba-exact", "ball (", "stiffness"}) {
    EXPECT_THAT(recorded, Not(Contains(HasSubstr(word))));
  }
  EXPECT_THAT(recorded, Not(Contains(StartsWith(kInTheClear))));
  EXPECT_EQ(server.stop(), 0);
  EXPECT_THAT(server.err(), AllOf(HasSubstr("encrypted: IKpsk2"), HasSubstr("anna")));
}

TEST_F(Encryption, RecordedInTheClearIsReadable) {
  Server server({"--scene", "sphere"});
  Recorder recorder(server.address());
  Client client(recorder.address(), kRun);
  EXPECT_EQ(client.wait(20s), client.expected_end()) << client.err();
  EXPECT_EQ(client.summary()["encryption"], "none");
  const std::vector<std::string> recorded = recorder.end();
  EXPECT_THAT(recorded, Contains(HasSubstr("sphere"))) << "so the recorder records";
  EXPECT_THAT(recorded, Contains(StartsWith(kInTheClear)));
}

TEST_F(Encryption, OfASharedKeyAloneLetsInWhoHasIt) {
  new_shared("shared.key");
  new_shared("other.key");
  Server server({"--psk", file("shared.key")});
  Client client(server.address(), with(kRun, {"--psk", file("shared.key")}));
  EXPECT_EQ(client.wait(20s), client.expected_end()) << client.err();
  EXPECT_EQ(client.summary()["encryption"], "NNpsk0");
  // No answer means nothing before 3 s.
  Client other(server.address(), {"--device", "omni", "--operator", "trace-sphere", "--duration", "5", "--once",
                                  "--psk", file("other.key")});
  EXPECT_EQ(other.wait(20s), 5);
  EXPECT_THAT(other.err(), HasSubstr("does not answer the handshake: it has another --psk"));
}

TEST_F(Encryption, RefusesAClientThatIsNotListedInOneLine) {
  const std::string server_key = new_pair("server.key");
  allow("anna", new_pair("client.key"));
  const std::string stranger = new_pair("stranger.key");
  Server server({"--key", file("server.key"), "--clients", file("clients.toml")});
  Client client(server.address(), with(kRun, {"--key", file("stranger.key"), "--server-key", server_key}));
  EXPECT_EQ(client.wait(20s), 5);
  EXPECT_THAT(client.err(), HasSubstr("does not let this client in: its list of clients lacks the key " + stranger));
}

TEST_F(Encryption, RefusesASceneThatTheClientMayNotUse) {
  const std::string server_key = new_pair("server.key");
  allow("anna", new_pair("client.key"), "scenes = [\"wall\"]\n");
  Server server({"--key", file("server.key"), "--clients", file("clients.toml")});
  const Words keys{"--key", file("client.key"), "--server-key", server_key};
  Client client(server.address(), with(with(kRun, keys), {"--scene", "sphere"}));
  EXPECT_EQ(client.wait(20s), 5);
  EXPECT_THAT(client.err(), AllOf(HasSubstr("refused by the server"), HasSubstr("wall")));
}

TEST_F(Encryption, RefusesAServerThatIsNewUnlessToldToTrustIt) {
  const std::string server_key = new_pair("server.key");
  allow("anna", new_pair("client.key"));
  Server server({"--key", file("server.key"), "--clients", file("clients.toml")});
  const Words keys{"--key", file("client.key"), "--known-servers", file("known")};
  Client first(server.address(), with(kRun, keys));
  EXPECT_EQ(first.wait(20s), 5);
  EXPECT_THAT(first.err(), AllOf(HasSubstr(server_key), HasSubstr("--trust-new")));
  Client trusting(server.address(), with(kRun, with(keys, {"--trust-new"})));
  EXPECT_EQ(trusting.wait(20s), trusting.expected_end()) << trusting.err();
  EXPECT_THAT(content(file("known")), HasSubstr(server.address() + " " + server_key));
  Client again(server.address(), with(kRun, keys));
  EXPECT_EQ(again.wait(20s), again.expected_end()) << again.err();

  const std::string address = server.address();
  EXPECT_EQ(server.stop(), 0);
  (void)new_pair("another.key");
  const Server restarted({"--key", file("another.key"), "--clients", file("clients.toml")}, address);
  Client deceived(address, with(kRun, with(keys, {"--trust-new"})));
  EXPECT_EQ(deceived.wait(20s), 5);
  EXPECT_THAT(deceived.err(), HasSubstr("but is known with the key " + server_key));
}

TEST_F(Encryption, SurvivesAServerThatIsRestartedWithTheSameKey) {
  const std::string server_key = new_pair("server.key");
  allow("anna", new_pair("client.key"));
  const Words keys{"--scene", "sphere", "--key", file("server.key"), "--clients", file("clients.toml")};
  std::optional<Server> server(std::in_place, keys);
  const std::string address = server->address();
  Client client(address, {"--device", "omni", "--operator", "trace-sphere", "--duration", "20", "--key",
                          file("client.key"), "--server-key", server_key});
  ASSERT_TRUE(client.wait_for("connected"));
  server->signal(SIGKILL);
  server.reset();
  server.emplace(keys, address);
  ASSERT_TRUE(client.wait_for("the server does not know this session", 15s)) << client.err();
  ASSERT_TRUE(server->wait_for("connected to scene", 15s)) << server->err();
  EXPECT_EQ(client.wait(30s), client.expected_end()) << client.err();
  EXPECT_GE(client.summary()["passivity"]["minimum_J"].get<double>(), kPassive_J);
}

TEST_F(Encryption, IsSaidToBeWantedToAClientWithoutKeys) {
  new_shared("shared.key");
  Server server({"--psk", file("shared.key")});
  Client client(server.address(), kRun);
  EXPECT_EQ(client.wait(20s), 5);
  EXPECT_THAT(client.err(), AllOf(HasSubstr("refused by the server"), HasSubstr("--psk")));
}

TEST_F(Encryption, IsMissedByAServerWithoutKeys) {
  new_shared("shared.key");
  Server server;
  Client client(server.address(), with(kRun, {"--psk", file("shared.key")}));
  EXPECT_EQ(client.wait(20s), 5);
  EXPECT_THAT(client.err(), HasSubstr("gave up: no answer from"));
}

TEST_F(Encryption, IsRequiredForOtherMachines) {
  const Ran server = run(kServer, {"--listen", "0.0.0.0:0"});
  EXPECT_EQ(server.exit_code, 2);
  EXPECT_THAT(server.err, AllOf(HasSubstr("--insecure"), HasSubstr("--psk")));
  const Ran client = run(kClient, with(kRun, {"--server", "192.0.2.1:47800"}));
  EXPECT_EQ(client.exit_code, 2);
  EXPECT_THAT(client.err, AllOf(HasSubstr("--insecure"), HasSubstr("--server-key"), HasSubstr("--psk")));
}

TEST_F(Encryption, IsLeftOutIfInsecureIsSaidAndThenSaysSo) {
  Server server({"--insecure"}, "0.0.0.0:0");
  EXPECT_THAT(server.err(), HasSubstr("NOT ENCRYPTED"));
}

TEST_F(Encryption, NeedsAKeyFileThatNobodyElseMayRead) {
  new_shared("shared.key");
  std::filesystem::permissions(file("shared.key"), std::filesystem::perms{0644});
  for (const char* const program : {kServer, kClient}) {
    Words words{"--psk", file("shared.key")};
    if (program == kClient) words = with(words, {"--server", "127.0.0.1:1"});
    const Ran ran = run(program, words);
    EXPECT_EQ(ran.exit_code, 1) << ran.err;
    EXPECT_THAT(ran.err, AllOf(HasSubstr(file("shared.key")), HasSubstr("0600")));
    EXPECT_EQ(lines(ran.err), 1U) << ran.err;
  }
}

TEST_F(Encryption, IsForDoctorAndLoadToo) {
  const std::string server_key = new_pair("server.key");
  allow("anna", new_pair("client.key"));
  Server server({"--scene", "sphere", "--key", file("server.key"), "--clients", file("clients.toml")});
  const Words keys{"--server", server.address(), "--key", file("client.key"), "--server-key", server_key};
  const Ran doctor = run(kForcebound, with({"doctor", "--seconds", "1"}, keys));
  EXPECT_EQ(doctor.exit_code, 0) << doctor.err;
  const Ran load = run(kLab, with({"load", "--clients", "3", "--seconds", "1"}, keys));
  EXPECT_EQ(load.exit_code, 0) << load.err;
  EXPECT_THAT(load.out, Not(IsEmpty()));
}

}  // namespace
}  // namespace forcebound::test
