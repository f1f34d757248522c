#include "forcebound/net/udp_link.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/net/endpoint.hpp"
#include "tests/support/ipv6.hpp"

namespace forcebound::net {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr time::Nanoseconds kPatience = 5s;  // used up only when a test fails

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

struct Received {
  std::string text;
  std::size_t bytes;
  Address from;
};

std::optional<Received> receive(UdpLink& link, std::size_t room = kDatagramBytesMax) {
  const int descriptor = link.descriptor();
  wait_readable({&descriptor, 1}, kPatience);
  std::vector<std::byte> buffer(room);
  const auto received = link.receive(buffer);
  if (!received) return std::nullopt;
  const auto* text = reinterpret_cast<const char*>(buffer.data());
  return Received{{text, std::min(received->bytes, room)}, received->bytes, received->from};
}

class UdpLinkBothKinds : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (GetParam() == std::string("::1") && !test::machine_has_ipv6()) GTEST_SKIP() << "this machine has no IPv6";
  }
  Address any_port() { return resolve({GetParam(), 0}); }
};

TEST_P(UdpLinkBothKinds, CarriesQuestionAndAnswer) {
  UdpLink server = UdpLink::listen(any_port());
  UdpLink client = UdpLink::towards(server.local_address());
  ASSERT_TRUE(client.send(bytes_of("question"), server.local_address()));
  const auto question = receive(server);
  ASSERT_TRUE(question);
  EXPECT_EQ(question->text, "question");
  EXPECT_EQ(question->from, client.local_address());
  ASSERT_TRUE(server.send(bytes_of("answer"), question->from));
  const auto answer = receive(client);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->text, "answer");
  EXPECT_EQ(answer->from, server.local_address());
}

TEST_P(UdpLinkBothKinds, SurvivesAnAbsentServerAndReceivesWhenItIsBack) {
  auto server = std::make_optional(UdpLink::listen(any_port()));
  const Address address = server->local_address();
  UdpLink client = UdpLink::towards(address);
  server.reset();
  for (int i = 0; i < 3; ++i) {
    client.send(bytes_of("anybody?"), address);
    EXPECT_FALSE(receive(client));  // port unreachable (ICMP) wakes it
  }
  EXPECT_GE(client.counters().refused, 1U);
  server.emplace(UdpLink::listen(address));
  client.send(bytes_of("hello"), address);
  const auto hello = receive(*server);
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->text, "hello");
}

INSTANTIATE_TEST_SUITE_P(Loopback, UdpLinkBothKinds, testing::Values("127.0.0.1", "::1"),
                         [](const auto& kind) { return kind.index == 0 ? "IPv4" : "IPv6"; });

TEST(UdpLink, ReceivesNothingWithoutWaiting) {
  UdpLink link = UdpLink::listen(resolve({"127.0.0.1", 0}));
  std::array<std::byte, 16> buffer;
  EXPECT_FALSE(link.receive(buffer));
}

TEST(UdpLink, CutsOversizeDatagramsAndTellsTheirSize) {
  UdpLink server = UdpLink::listen(resolve({"127.0.0.1", 0}));
  UdpLink client = UdpLink::towards(server.local_address());
  ASSERT_TRUE(client.send(bytes_of(std::string(9000, 'x')), server.local_address()));
  const auto received = receive(server, 100);
  ASSERT_TRUE(received);
  EXPECT_EQ(received->bytes, 9000U);
  EXPECT_EQ(received->text, std::string(100, 'x'));
}

TEST(UdpLink, CarriesEmptyDatagrams) {
  UdpLink server = UdpLink::listen(resolve({"127.0.0.1", 0}));
  UdpLink client = UdpLink::towards(server.local_address());
  ASSERT_TRUE(client.send({}, server.local_address()));
  const auto received = receive(server);
  ASSERT_TRUE(received);
  EXPECT_EQ(received->bytes, 0U);
}

TEST(UdpLink, CountsWhatTheSystemDoesNotTake) {
  UdpLink server = UdpLink::listen(resolve({"127.0.0.1", 0}));
  UdpLink client = UdpLink::towards(server.local_address());
  EXPECT_FALSE(client.send(bytes_of(std::string(70'000, 'x')), server.local_address()));
  EXPECT_EQ(client.counters().send_failed, 1U);
}

TEST(UdpLink, CountsWhatASlowReaderMakesTheSystemDrop) {
  UdpLink server = UdpLink::listen(resolve({"127.0.0.1", 0}));
  UdpLink client = UdpLink::towards(server.local_address());
  std::uint64_t sent = 0;
  for (int i = 0; i < 20'000; ++i) sent += client.send(bytes_of("x"), server.local_address());
  std::uint64_t received = 0;
  std::array<std::byte, 16> buffer;
  while (server.receive(buffer)) ++received;
  EXPECT_EQ(server.counters().overflowed, sent - received);
  EXPECT_GT(server.counters().overflowed, 0U);
}

TEST(UdpLink, NamesAnAddressInUse) {
  UdpLink first = UdpLink::listen(resolve({"127.0.0.1", 0}));
  EXPECT_THAT([&] { UdpLink::listen(first.local_address()); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr("cannot listen on " + to_string(first.local_address())), HasSubstr("in use"))));
}

TEST(UdpLink, NamesAnAddressThatIsNotOfThisMachine) {
  EXPECT_THAT(
      [] {
        UdpLink::listen(resolve({"192.0.2.1", 0}));
      },
      ThrowsMessage<std::runtime_error>(
          AllOf(HasSubstr("cannot listen on 192.0.2.1:0"), HasSubstr("no interface of this machine"))));
}

TEST(WaitReadable, ReturnsAfterItsTimeoutAtTheEarliest) {
  UdpLink link = UdpLink::listen(resolve({"127.0.0.1", 0}));
  const int descriptor = link.descriptor();
  const auto before = std::chrono::steady_clock::now();
  EXPECT_FALSE(wait_readable({&descriptor, 1}, 3ms));
  EXPECT_GE(std::chrono::steady_clock::now() - before, 3ms);
  EXPECT_FALSE(wait_readable({&descriptor, 1}, -1ms));
}

TEST(WaitReadable, SeesADatagramOnAnyOfItsLinks) {
  UdpLink first = UdpLink::listen(resolve({"127.0.0.1", 0}));
  UdpLink second = UdpLink::listen(resolve({"127.0.0.1", 0}));
  UdpLink client = UdpLink::towards(second.local_address());
  client.send(bytes_of("x"), second.local_address());
  const std::array descriptors{first.descriptor(), second.descriptor()};
  EXPECT_TRUE(wait_readable(descriptors, kPatience));
}

TEST(UdpLink, TakesOneDescriptorEach) {
  const auto open_files = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), std::filesystem::directory_iterator());
  };
  const UdpLink first = UdpLink::listen(resolve({"127.0.0.1", 0}));
  const auto before = open_files();
  std::vector<UdpLink> links;
  links.reserve(100);
  for (int i = 0; i < 100; ++i) links.push_back(UdpLink::towards(first.local_address()));
  EXPECT_EQ(open_files() - before, 100) << "a relay has one for each of 256 clients";
}

TEST(UdpLink, AdoptsASocketThatAnotherBound) {
  const int descriptor = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in local{};
  local.sin_family = AF_INET;
  local.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(::bind(descriptor, reinterpret_cast<const sockaddr*>(&local), sizeof local), 0);
  UdpLink adopted = UdpLink::adopt(descriptor);
  EXPECT_NE(adopted.local_address().port, 0);
  UdpLink client = UdpLink::towards(adopted.local_address());
  ASSERT_TRUE(client.send(bytes_of("hello"), adopted.local_address()));
  EXPECT_EQ(receive(adopted)->text, "hello");
}

TEST(UdpLink, AdoptsNothingElse) {
  const int stream = ::socket(AF_INET, SOCK_STREAM, 0);
  const int unbound = ::socket(AF_INET, SOCK_DGRAM, 0);
  for (const int descriptor : {stream, unbound, -1}) {
    EXPECT_THAT([&] { UdpLink::adopt(descriptor); },
                ThrowsMessage<std::runtime_error>(HasSubstr("is no bound UDP socket")));
  }
  ::close(stream);
  ::close(unbound);
}

}  // namespace
}  // namespace forcebound::net
