#include <gtest/gtest.h>

#include "forcebound/net/datagram_link.hpp"

namespace forcebound::net {
namespace {

TEST(Address, ShowsMappedIpv4AsDottedQuad) {
  const Address address{{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 127, 0, 0, 1}, 47800};
  EXPECT_EQ(to_string(address), "127.0.0.1:47800");
}

TEST(Address, ShowsIpv6InBracketsAndShortened) {
  const Address loopback{{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}, 1};
  EXPECT_EQ(to_string(loopback), "[::1]:1");
  const Address documentation{{0x20, 0x01, 0x0d, 0xb8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x0a, 0xbc, 0xde}, 65535};
  EXPECT_EQ(to_string(documentation), "[2001:db8::a:bcde]:65535");
}

}  // namespace
}  // namespace forcebound::net
