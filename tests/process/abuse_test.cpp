#include <gmock/gmock.h>
#include <zlib.h>

#include <array>
#include <limits>
#include <optional>
#include <random>
#include <sstream>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/net/udp_link.hpp"
#include "forcebound/time/heap_operations.hpp"
#include "forcebound/wire/codec.hpp"
#include "tests/process/passive.hpp"
#include "tests/process/programs.hpp"
#include "tests/support/becomes_true.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;

using Bytes = std::vector<std::byte>;

Bytes random_bytes(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  Bytes bytes(count);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

/// A frame as the codec makes it, around any body.
Bytes framed(std::uint8_t kind, const Bytes& body) {
  Bytes checked{std::byte{kind}};
  checked.insert(checked.end(), body.begin(), body.end());
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(checked.data()), checked.size());
  Bytes frame{std::byte{'F'}, std::byte{'B'}, std::byte{1}, std::byte{kind}};
  for (unsigned shift = 0; shift < 32; shift += 8) frame.push_back(static_cast<std::byte>(crc >> shift & 0xffU));
  frame.insert(frame.end(), body.begin(), body.end());
  return frame;
}

/// A socket that sends anything, to an address or to whoever spoke to it last.
class Peer {
 public:
  void say(const Bytes& datagram) { EXPECT_TRUE(link_.send(datagram, other_)); }
  void say(const wire::Message& message) {
    const auto datagram = codec_.encode(message);
    say(Bytes(datagram.begin(), datagram.end()));
  }

  /// The next message of a kind; everything else is dropped.
  template <class Kind>
  std::optional<Kind> next() {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    const std::array descriptors{link_.descriptor()};
    while (std::chrono::steady_clock::now() < end) {
      net::wait_readable(descriptors, 100ms);
      const auto received = link_.receive(buffer_);
      if (!received) continue;
      other_ = received->from;
      const auto decoded = codec_.decode(std::span(buffer_).first(received->bytes));
      const auto* message = std::get_if<wire::Message>(&decoded);
      if (message == nullptr) continue;
      if (const auto* kind = std::get_if<Kind>(message)) return *kind;
    }
    return std::nullopt;
  }

 protected:
  Peer(net::UdpLink link, const net::Address& other) : link_(std::move(link)), other_(other) {}

  net::UdpLink link_;
  net::Address other_;

 private:
  wire::Codec codec_;
  std::array<std::byte, net::kDatagramBytesMax> buffer_{};
};

class UntrustedClient : public Peer {
 public:
  explicit UntrustedClient(const std::string& to) : UntrustedClient(net::resolve(net::parse_endpoint(to))) {}
  explicit UntrustedClient(const net::Address& to) : Peer(net::UdpLink::towards(to), to) {}

  void say_malformed() {
    say(Bytes(1300));                                    // oversize
    say(random_bytes(1300, 1));                          // oversize
    say(random_bytes(4, 2));                             // truncated
    say(Bytes{});                                        // truncated
    say(random_bytes(200, 3));                           // foreign
    say(framed(4, Bytes(40, std::byte{0xff})));          // a motion of no session: nothing more of it is read
    say(framed(1, Bytes(1192, std::byte{0xff})));        // unreadable
    say(framed(99, {}));                                 // unreadable
    Bytes corrupt = framed(4, Bytes(40, std::byte{1}));  // its checksum was right ...
    corrupt.back() ^= std::byte{1};
    say(corrupt);
  }
};

TEST(AServer, CountsAbuseByReasonWithoutAnEffectOnItsClient) {
  Server server({"--scene", "sphere"});
  Client client(server.address(), {"--device", "omni", "--operator", "trace-sphere", "--duration", "3", "--once"});
  ASSERT_TRUE(client.wait_for("connected"));

  UntrustedClient untrusted(server.address());
  constexpr std::uint64_t kTimes = 20;
  const wire::Hello hello{.client_nonce = 42, .degrees_of_freedom = 3, .device = "untrusted", .period_s = 1e-3};
  for (std::uint64_t i = 0; i < kTimes; ++i) {
    untrusted.say_malformed();
    untrusted.say(wire::Welcome{.client_nonce = 1, .session = 2});
    untrusted.say(wire::MotionSample{.session = 77, .sequence = i, .position = control::Vector::Zero(3)});
    untrusted.say(wire::Bye{.session = 78});
    untrusted.say(hello);
    ASSERT_TRUE(untrusted.next<wire::Welcome>()) << "it has read all before it";
  }
  EXPECT_EQ(client.wait(20s), 0);
  EXPECT_EQ(server.stop(), 0);

  const auto count = [&](const char* subject, const char* what) { return counted(server.out(), subject, what); };
  EXPECT_EQ(count("datagrams", "oversize"), 2 * kTimes);
  EXPECT_EQ(count("datagrams", "truncated"), 2 * kTimes);
  EXPECT_EQ(count("datagrams", "foreign"), kTimes);
  EXPECT_EQ(count("datagrams", "unreadable"), 2 * kTimes);
  EXPECT_EQ(count("datagrams", "corrupt"), kTimes);
  EXPECT_EQ(count("datagrams", "unexpected"), kTimes);
  EXPECT_EQ(count("motions", "without a session"), 2 * kTimes);
  EXPECT_EQ(count("sessions", "byes of unknown sessions"), kTimes);
  EXPECT_EQ(count("sessions", "opened"), 2U);
  EXPECT_GE(count("sessions", "hellos repeated"), kTimes - 1) << "the client's own may be among them";
  EXPECT_EQ(client.summary()["lost"], 0);
  EXPECT_EQ(client.summary()["faults"]["reconnects"], 0);
}

/// A server that accepts a client and then sends what a test wants.
class HostileServer : public Peer {
 public:
  HostileServer() : Peer(net::UdpLink::listen(net::resolve({"127.0.0.1", 0})), {}) {}

  [[nodiscard]] std::string address() const { return net::to_string(link_.local_address()); }
  [[nodiscard]] net::Address client() const { return other_; }

  /// Waits until the client has read a force with this challenge, and so all that was sent before it.
  bool is_read(std::uint64_t challenge) {
    for (auto motion = next<wire::MotionSample>(); motion; motion = next<wire::MotionSample>()) {
      if (motion->challenge == challenge) return true;
    }
    return false;
  }
};

TEST(AClient, CountsAbuseByReasonAndStaysPassive) {
  HostileServer server;
  Client client(server.address(), {"--device", "omni", "--operator", "trace-sphere", "--duration", "4"});
  const auto hello = server.next<wire::Hello>();
  ASSERT_TRUE(hello);
  constexpr std::uint64_t kSession = 1234;
  server.say(
      wire::Welcome{.client_nonce = hello->client_nonce, .session = kSession, .scene = "x", .simulated = "abuse"});

  // Datagrams from another address than the server's: the client's socket does not receive them.
  ASSERT_TRUE(server.next<wire::MotionSample>());
  UntrustedClient untrusted(server.client());

  constexpr int kTimes = 10;
  std::uint64_t sequence = 0;
  for (int i = 0; i < kTimes; ++i) {
    untrusted.say_malformed();
    const auto motion = server.next<wire::MotionSample>();
    ASSERT_TRUE(motion);
    wire::EnvironmentForce force{.session = kSession,
                                 .sequence = ++sequence,
                                 .motion_sequence = motion->sequence,
                                 .motion_device_time = motion->device_time,
                                 .position = motion->position,
                                 .motions_received = sequence,
                                 .challenge = sequence,
                                 .answer = {.force = control::Vector::Constant(3, 1e300)}};
    auto other = force;
    other.session = kSession + 1;  // foreign session
    server.say(other);
    other = force;
    other.motion_sequence += 1'000'000;  // answers nothing that was sent: unreadable
    server.say(other);
    other = force;
    other.answer.force[1] = std::numeric_limits<double>::quiet_NaN();  // not finite
    server.say(other);
    server.say(wire::Hello{.client_nonce = 1});  // not a message to a client: unreadable
    server.say(random_bytes(1300, 1));           // oversize
    server.say(random_bytes(4, 2));              // truncated
    server.say(random_bytes(300, 3));            // foreign
    Bytes corrupt = framed(5, Bytes(40, std::byte{1}));
    corrupt.back() ^= std::byte{1};
    server.say(corrupt);
    server.say(force);
    server.say(force);  // duplicate
    ASSERT_TRUE(server.is_read(force.challenge));
  }
  EXPECT_EQ(client.wait(20s), 0);

  const nlohmann::json summary = client.summary();
  ASSERT_TRUE(summary.is_object());
  const nlohmann::json& faults = summary["faults"];
  EXPECT_EQ(faults["malformed_oversize"], kTimes);
  EXPECT_EQ(faults["malformed_truncated"], kTimes);
  EXPECT_EQ(faults["malformed_foreign"], kTimes);
  EXPECT_EQ(faults["malformed_corrupt"], kTimes);
  EXPECT_EQ(faults["malformed_non_finite"], kTimes);
  EXPECT_EQ(faults["malformed_unreadable"], 2 * kTimes);
  EXPECT_EQ(faults["foreign_session"], kTimes);
  EXPECT_EQ(summary["received"], kTimes);
  EXPECT_EQ(summary["duplicated"], kTimes);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), kPassive_J);
  EXPECT_EQ(faults["tick_allocations"], 0);
}

std::uint64_t rows_with(const std::string& log, const std::string& direction, const std::string& verdict) {
  std::uint64_t count = 0;
  std::istringstream rows(log);
  for (std::string row; std::getline(rows, row);) {
    if (row.starts_with(direction + ",") && row.find(verdict) != std::string::npos) ++count;
  }
  return count;
}

TEST(ANetworkThatCorruptsAndDuplicates, IsCountedExactlyAtBothEnds) {
  const TemporaryFolder folder;
  Server server({"--scene", "sphere"});
  Relay relay(server.address(),
              {"--netem", "delay 5ms corrupt 5% duplicate 5%", "--seed", "1", "--log", folder.file("log.csv")});
  Client client(relay.address(), {"--device", "omni", "--operator", "trace-sphere", "--duration", "4"});
  EXPECT_EQ(client.wait(30s), 0);
  Relay::let_everything_arrive();
  EXPECT_EQ(relay.stop(), 0);
  EXPECT_EQ(server.stop(), 0);
  const std::string log = content(folder.file("log.csv"));

  std::uint64_t malformed_at_server = 0;
  for (const char* reason : {"oversize", "truncated", "foreign", "corrupt", "unreadable", "not finite"}) {
    malformed_at_server += counted(server.out(), "datagrams", reason);
  }
  EXPECT_EQ(malformed_at_server, rows_with(log, "up", "corrupted+"));
  EXPECT_EQ(counted(server.out(), "datagrams", "received"), rows_with(log, "up", "forwarded,"));

  const nlohmann::json summary = client.summary();
  ASSERT_TRUE(summary.is_object());
  std::uint64_t malformed_at_client = 0;
  for (const char* reason : {"oversize", "truncated", "foreign", "corrupt", "unreadable", "non_finite"}) {
    malformed_at_client += summary["faults"][std::string("malformed_") + reason].get<std::uint64_t>();
  }
  // The client leaves while the last answers to its Byes may still be on their way.
  const std::uint64_t corrupted_down = rows_with(log, "down", "corrupted+");
  EXPECT_LE(malformed_at_client, corrupted_down);
  EXPECT_GE(malformed_at_client + 5, corrupted_down);
  EXPECT_GT(malformed_at_client, 0U);
  EXPECT_GT(summary["duplicated"], 0);
  EXPECT_EQ(summary["faults"]["foreign_session"], 0);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), kPassive_J);
}

// 150 clients, each of which wants a tissue of its own, of a server that has memory for few of them.
TEST(AServerWithoutMemory, RefusesSessionsAndGoesOn) {
  if (!time::kCountsHeapOperations) GTEST_SKIP() << "a sanitizer has terabytes of its own";
  const std::string address = free_address();
  const std::string limited = "ulimit -v 170000; exec \"$0\" \"$@\"";
  Process server("/bin/sh",
                 {"-c", limited, kServer, "--listen", address, "--scene", "soft_pad", "--sessions-max", "500"});
  ASSERT_TRUE(server.wait_for("listening on "));
  const Ran many = run(kLab, {"load", "--server", address, "--clients", "150", "--seconds", "0.2"});
  // On a slow machine one of them may also have no answer in time.
  EXPECT_THAT(many.err,
              testing::AnyOf("", testing::HasSubstr("not enough memory"), testing::HasSubstr("no answer from")));
  // Whether there is room for one more depends on how many of them are gone; it is answered in any case.
  Client one_more(address, {"--device", "omni"});
  const auto contains = [&](const char* text) { return one_more.err().find(text) != std::string::npos; };
  EXPECT_TRUE(becomes_true(
      [&] { return contains(" connected; ") || contains("not enough memory") || contains("this server is busy"); }));
  one_more.stop();
  EXPECT_EQ(server.stop(), 0);
  EXPECT_GT(counted(server.out(), "sessions", "opened"), 0U);
}

}  // namespace
}  // namespace forcebound::test
