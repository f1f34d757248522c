#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <string_view>

#include "tests/process/programs.hpp"
#include "tests/support/source_folder.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// What a service manager is for a service: it binds the socket, and hears what the service says of itself.
class ServiceManager {
 public:
  ServiceManager() {
    sockaddr_in local{};
    local.sin_family = AF_INET;
    local.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t bytes = sizeof local;
    auto* const address = reinterpret_cast<sockaddr*>(&local);
    if (::bind(socket_, address, bytes) == 0 && ::getsockname(socket_, address, &bytes) == 0) {
      port_ = ntohs(local.sin_port);
    }
    sockaddr_un path{};
    path.sun_family = AF_UNIX;
    notify_path().copy(static_cast<char*>(path.sun_path), sizeof path.sun_path - 1);
    const timeval patience{.tv_sec = 20, .tv_usec = 0};
    setsockopt(notify_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    EXPECT_EQ(::bind(notify_, reinterpret_cast<const sockaddr*>(&path), sizeof path), 0);
  }
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;
  ~ServiceManager() {
    ::close(socket_);
    ::close(notify_);
  }

  /// The words of a bash that starts a server as a service with this socket.
  [[nodiscard]] Words started(const Words& options) const {
    Words words{"-c",
                "LISTEN_PID=$$ LISTEN_FDS=1 WATCHDOG_PID=$$ WATCHDOG_USEC=600000 NOTIFY_SOCKET=" + notify_path() +
                    " exec \"$@\" 3<&" + std::to_string(socket_),
                "sh", kServer};
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }

  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

  /// Whether one of the next 200 texts of the service has `words` in it, with at most 20 s of silence between them.
  bool hears(std::string_view words) const {
    std::array<char, 4096> text{};
    for (int texts = 0; texts < 200; ++texts) {
      const auto bytes = ::recv(notify_, text.data(), text.size(), 0);
      if (bytes <= 0) return false;
      if (std::string_view(text.data(), static_cast<std::size_t>(bytes)).find(words) != std::string_view::npos)
        return true;
    }
    return false;
  }

 private:
  [[nodiscard]] std::string notify_path() const { return folder_.file("notify"); }

  TemporaryFolder folder_;
  int socket_ = ::socket(AF_INET, SOCK_DGRAM, 0);
  int notify_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  int port_ = 0;
};

TEST(AService, TakesItsSocketAndTellsHowItIs) {
  const ServiceManager manager;
  Process server("/bin/bash", manager.started({"--scene", "sphere"}));
  EXPECT_TRUE(manager.hears("READY=1\nSTATUS=serving at " + manager.address()));
  EXPECT_TRUE(manager.hears("WATCHDOG=1"));
  EXPECT_TRUE(manager.hears("WATCHDOG=1"));
  Client client(manager.address(), {"--device", "omni", "--duration", "1", "--once"});
  EXPECT_EQ(client.wait(30s), client.expected_end());
  server.signal(SIGTERM);
  EXPECT_TRUE(manager.hears("STOPPING=1"));
  EXPECT_EQ(server.wait(20s), 0);
}

TEST(AService, ThatDrainsLetsNobodyInAndEndsWhenAllHaveLeft) {
  const ServiceManager manager;
  Process server("/bin/bash", manager.started({"--scene", "sphere", "--drain", "600"}));
  ASSERT_TRUE(manager.hears("READY=1"));
  Client client(manager.address(), {"--device", "omni"});
  ASSERT_TRUE(client.wait_for("connected"));
  server.signal(SIGTERM);
  ASSERT_TRUE(manager.hears("STOPPING=1\nSTATUS=ending: waiting up to 600 s for 1 session"));
  Client late(manager.address(), {"--device", "omni", "--once"});
  EXPECT_EQ(late.wait(30s), 5);
  EXPECT_THAT(late.err(), HasSubstr("the server is about to end and takes no more clients"));
  EXPECT_EQ(client.stop(), client.expected_end());
  EXPECT_EQ(server.wait(30s), 0);
  EXPECT_THAT(server.out(), HasSubstr("1 ended by the client"));
}

TEST(AService, ThatDrainsEndsAtASecondSigterm) {
  Server server({"--scene", "sphere", "--drain", "600"});
  Client client(server.address(), {"--device", "omni"});
  ASSERT_TRUE(client.wait_for("connected"));
  server.signal(SIGTERM);
  ASSERT_TRUE(server.wait_for("ending: waiting up to 600 s for 1 session"));
  EXPECT_EQ(server.stop(SIGTERM), 0);
  EXPECT_TRUE(client.wait_for("ended the session"));
}

TEST(AService, WithoutClientsEndsAtOnce) {
  Server server({"--drain", "600"});
  EXPECT_EQ(server.stop(SIGTERM), 0);
}

TEST(AService, TakesItsOptionsFromAFile) {
  const TemporaryFolder folder;
  const std::string file = folder.file("server.toml");
  write_file(file, "scene = \"sphere\"\ndrain = 5\nverbose = true\n");
  Server server({"--config", file});
  EXPECT_THAT(server.err(), HasSubstr("scene 'sphere'"));
  EXPECT_EQ(server.stop(), 0);
  write_file(file, "scene = \"sphere\"\nlisten_at = 1\n");
  const Ran wrong = run(kServer, {"--config", file});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr(file + ":2: unknown key 'listen_at'"));
}

TEST(AService, ThatReadsItsClientsAgainLetsThoseGoWhoAreNoMoreListed) {
  const TemporaryFolder folder;
  const auto key_of = [&](const std::string& name) {
    const Ran ran = run(kForcebound, {"keygen", folder.file(name)});
    const std::string_view before = "public key, for others: ";
    return ran.out.substr(ran.out.find(before) + before.size(), 44);
  };
  const auto entry = [&](const std::string& name, const std::string& key) {
    return "[[client]]\nname = \"" + name + "\"\npublic_key = \"" + key + "\"\n";
  };
  const std::string server_key = key_of("server.key");
  const std::string anna = entry("anna", key_of("anna.key"));
  const std::string bert = entry("bert", key_of("bert.key"));
  write_file(folder.file("clients.toml"), anna + bert);
  Server server({"--key", folder.file("server.key"), "--clients", folder.file("clients.toml")});
  Client stays(server.address(), {"--key", folder.file("anna.key"), "--server-key", server_key});
  Client goes(server.address(), {"--key", folder.file("bert.key"), "--server-key", server_key});
  ASSERT_TRUE(stays.wait_for("connected"));
  ASSERT_TRUE(goes.wait_for("connected"));
  write_file(folder.file("clients.toml"), "[[client]]\nname = 1\n");
  server.signal(SIGHUP);
  ASSERT_TRUE(server.wait_for("the clients are those of before"));
  write_file(folder.file("clients.toml"), anna);
  server.signal(SIGHUP);
  ASSERT_TRUE(server.wait_for("read again: 1 client"));
  EXPECT_TRUE(goes.wait_for("not", 60s)) << "its handshake is refused";
  EXPECT_EQ(stays.stop(), stays.expected_end());
  goes.stop();
  EXPECT_EQ(server.stop(), 0);
}

TEST(AService, SaysThatItReadsItsClientsAgainAndThenThatItIsReady) {
  const ServiceManager manager;
  const TemporaryFolder folder;
  const std::string key = folder.file("server.key");
  const std::string clients = folder.file("clients.toml");
  ASSERT_EQ(run(kForcebound, {"keygen", key}).exit_code, 0);
  write_file(clients, "");
  Process server("/bin/bash", manager.started({"--key", key, "--clients", clients}));
  ASSERT_TRUE(manager.hears("READY=1"));
  server.signal(SIGHUP);
  EXPECT_TRUE(manager.hears("RELOADING=1\nMONOTONIC_USEC="));
  EXPECT_TRUE(manager.hears("READY=1"));
  write_file(clients, "[[client]]\nname = 1\n");
  server.signal(SIGHUP);
  EXPECT_TRUE(manager.hears("RELOADING=1\nMONOTONIC_USEC="));
  EXPECT_TRUE(manager.hears("READY=1"));
  EXPECT_TRUE(server.wait_for("the clients are those of before"));
  server.signal(SIGTERM);
  EXPECT_TRUE(manager.hears("STOPPING=1"));
  EXPECT_EQ(server.wait(20s), 0);
}

TEST(EveryUnit, LeavesNoCoreFile) {
  int units = 0;
  for (const auto& file : std::filesystem::directory_iterator(source_folder() / "deploy" / "systemd")) {
    if (file.path().extension() != ".service") continue;
    ++units;
    EXPECT_THAT(content(file.path()), HasSubstr("\nLimitCORE=0\n")) << file.path() << ": it would hold secrets";
  }
  EXPECT_EQ(units, 2);
}

}  // namespace
}  // namespace forcebound::test
