#include "forcebound/client/commands/doctor/path_size.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "forcebound/net/endpoint.hpp"

namespace forcebound::client::commands {
namespace {

TEST(LargestThatPasses, IsTheLargestOfAllAtOnceWhereItPasses) {
  std::vector<std::size_t> tried;
  EXPECT_EQ(largest_that_passes({.least = 256, .most = 1200}, 8,
                                [&](std::size_t bytes) {
                                  tried.push_back(bytes);
                                  return true;
                                }),
            1200U);
  EXPECT_EQ(tried, std::vector<std::size_t>{1200});
}

TEST(LargestThatPasses, IsCloselyBelowWhateverThePathCarries) {
  for (std::size_t carries = 256; carries < 1200; ++carries) {
    int tries = 0;
    const std::size_t found = largest_that_passes({.least = 256, .most = 1200}, 8, [&](std::size_t bytes) {
      ++tries;
      return bytes <= carries;
    });
    EXPECT_LE(found, carries);
    EXPECT_GT(found + 8, carries);
    EXPECT_LE(tries, 9);
  }
}

TEST(LargestThatPasses, IsNoneWhereNotEvenTheLeastDoes) {
  EXPECT_EQ(largest_that_passes({.least = 256, .most = 1200}, 8, [](std::size_t) { return false; }), 0U);
  EXPECT_EQ(largest_that_passes({.least = 1200, .most = 1200}, 8, [](std::size_t) { return false; }), 0U);
}

TEST(PathSize, CountsTheHeadersOfEachKindOfAddress) {
  EXPECT_EQ(header_bytes(net::resolve({.host = "127.0.0.1", .port = 9})), 28U);
  net::Address loopback_v6;
  loopback_v6.ip.back() = 1;
  EXPECT_EQ(header_bytes(loopback_v6), 48U);
}

TEST(PathSize, BelievesThatTheLoopbackCarriesWhatTheProtocolSends) {
  const net::Address peer = net::resolve({.host = "127.0.0.1", .port = 9});
  const net::UdpLink link = net::UdpLink::towards(peer);
  set_fragments(link, peer, Fragments::never);
  const auto mtu = believed_mtu(link, peer);
  ASSERT_TRUE(mtu);
  EXPECT_GE(*mtu, 1228U);
}

}  // namespace
}  // namespace forcebound::client::commands
