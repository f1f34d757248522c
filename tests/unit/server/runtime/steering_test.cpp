#include "forcebound/server/runtime/steering.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/server/session/shared_limits.hpp"
#include "tests/unit/server/runtime/askers.hpp"

namespace forcebound::server {
namespace {

/// The beginning of a sealed datagram for the session of keys of this number.
Bytes record_for(std::uint32_t number) {
  Bytes record(security::kRecordOverhead);
  record[0] = std::byte{'F'};
  record[1] = std::byte{'S'};
  for (unsigned i = 0; i < 4; ++i) record[4 + i] = static_cast<std::byte>(number >> (8 * i));
  return record;
}

Bytes encoded(const wire::Message& message) {
  wire::Codec codec;
  const auto bytes = codec.encode(message);
  return {bytes.begin(), bytes.end()};
}

//   a sender ==( UDP of this machine )== four sockets at one address, with the filter
class Steering : public testing::Test {
 protected:
  static constexpr std::size_t kSockets = 4;

  Steering() {
    while (links_.size() < kSockets) links_.push_back(net::UdpLink::beside(links_.front()));
  }

  /// The socket at which it arrives.
  std::size_t arrival_of(std::span<const std::byte> datagram, net::UdpLink& sender) {
    EXPECT_TRUE(sender.send(datagram, address_));
    std::array<std::byte, net::kDatagramBytesMax> buffer{};
    for (std::size_t i = 0; i < 100 * kSockets; ++i) {
      if (links_[i % kSockets].receive(buffer)) return i % kSockets;
    }
    ADD_FAILURE() << "it did not arrive";
    return kSockets;
  }

  std::vector<net::UdpLink> links_ = [] {
    std::vector<net::UdpLink> links;
    links.push_back(net::UdpLink::listen(net::resolve({"127.0.0.1", 0})));
    return links;
  }();
  net::Address address_ = links_.front().local_address();
  net::UdpLink sender_ = net::UdpLink::towards(address_);
};

TEST_F(Steering, TheSystemSendsSessionsWhereTheirNumbersSay) {
  ASSERT_TRUE(steer(links_.front(), kSockets));
  for (std::uint64_t number = 0xabcd00; number < 0xabcd00 + 256; ++number) {
    const std::size_t owner = WorkerPlace::owner_of(number, kSockets);
    for (const Bytes& datagram : {encoded(motion_of(number, 1)), encoded(wire::Bye{.session = number}),
                                  record_for(static_cast<std::uint32_t>(number))}) {
      ASSERT_EQ(arrival_of(datagram, sender_), owner) << number;
      ASSERT_EQ(worker_for(datagram, kSockets), owner) << number;
    }
  }
}

TEST_F(Steering, AnOddNumberOfWorkersShareTheNumbersToo) {
  ASSERT_TRUE(steer(links_.front(), 3));
  for (std::uint64_t number = 0; number < 256; ++number) {
    ASSERT_EQ(arrival_of(encoded(motion_of(0x1100 + number, 1)), sender_), WorkerPlace::owner_of(0x1100 + number, 3));
  }
}

TEST_F(Steering, AClientWithoutASessionIsSentByItsAddress) {
  ASSERT_TRUE(steer(links_.front(), kSockets));
  std::array<int, kSockets> arrivals{};
  for (int i = 0; i < 64; ++i) {
    net::UdpLink sender = net::UdpLink::towards(address_);
    const Bytes hello = encoded(hello_of(1));
    EXPECT_FALSE(worker_for(hello, kSockets));
    const std::size_t first = arrival_of(hello, sender);
    ++arrivals.at(first);
    EXPECT_EQ(arrival_of(hello, sender), first) << "from the same address it comes to the same worker";
  }
  for (const int count : arrivals) EXPECT_GT(count, 0);
}

TEST_F(Steering, AWakeUpCallComesToWhomItNames) {
  ASSERT_TRUE(steer(links_.front(), kSockets));
  for (std::size_t worker = 0; worker < kSockets; ++worker) {
    const WakeUpCall call = wake_up_call(worker);
    EXPECT_TRUE(is_wake_up_call(call));
    EXPECT_EQ(arrival_of(call, sender_), worker);
  }
  EXPECT_FALSE(is_wake_up_call(record_for(1)));
}

TEST_F(Steering, AnythingArrivesSomewhere) {
  ASSERT_TRUE(steer(links_.front(), kSockets));
  Bytes datagram;
  for (int length = 0; length < 20; ++length) {
    EXPECT_LT(arrival_of(datagram, sender_), kSockets);
    datagram.push_back(std::byte{'F'});
  }
  EXPECT_FALSE(worker_for(Bytes{}, kSockets));
  EXPECT_FALSE(worker_for(bytes_of("something else"), kSockets));
}

}  // namespace
}  // namespace forcebound::server
