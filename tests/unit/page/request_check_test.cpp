#include "forcebound/page/request_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstddef>

namespace forcebound::page {
namespace {

TEST(HostCheck, AcceptsThisMachineAtItsPortAlone) {
  const HostCheck check("127.0.0.1", 47880);
  for (const char* const host : {"127.0.0.1:47880", "localhost:47880", "LOCALHOST:47880", "[::1]:47880"}) {
    EXPECT_TRUE(check.accepts(host)) << host;
  }
  for (const char* const host :
       {"", "evil.example", "evil.example:47880", "127.0.0.1", "127.0.0.1:80", "localhost:", "localhost:47881",
        "127.0.0.1.evil.example:47880", "192.168.0.1:47880", "user@localhost:47880", "localhost:47880:47880"}) {
    EXPECT_FALSE(check.accepts(host)) << host;
  }
}

TEST(HostCheck, AcceptsTheHostThatIsListenedAt) {
  EXPECT_TRUE(HostCheck("Lab.local", 5000).accepts("lab.local:5000"));
  EXPECT_TRUE(HostCheck("fe80::1", 5000).accepts("[fe80::1]:5000"));
  EXPECT_FALSE(HostCheck("lab.local", 5000).accepts("192.168.0.7:5000"));
}

TEST(HostCheck, AcceptsAddressesButNoNamesWhereAllAddressesAreListenedAt) {
  const HostCheck check("0.0.0.0", 80);
  EXPECT_TRUE(check.accepts("192.168.0.7:80"));
  EXPECT_TRUE(check.accepts("192.168.0.7"));
  EXPECT_TRUE(check.accepts("[fe80::1]"));
  EXPECT_FALSE(check.accepts("evil.example:80"));
  EXPECT_FALSE(check.accepts("1.2.3.4.evil.example:80"));
}

TEST(HostCheck, AcceptsOriginsOfItsOwnPageAlone) {
  const HostCheck check("127.0.0.1", 47880);
  EXPECT_TRUE(check.accepts_origin("http://localhost:47880"));
  for (const char* const origin : {"null", "https://localhost:47880", "http://evil.example", "http://localhost",
                                   "file://", "http://localhost:47880.evil.example"}) {
    EXPECT_FALSE(check.accepts_origin(origin)) << origin;
  }
}

TEST(Token, IsLowerCaseHexadecimal) {
  EXPECT_EQ(token_of(std::array{std::byte{0}, std::byte{0xA5}, std::byte{0xFF}}), "00a5ff");
}

TEST(Token, IsComparedWhole) {
  EXPECT_TRUE(equal_in_constant_time("abc", "abc"));
  EXPECT_FALSE(equal_in_constant_time("abc", "abd"));
  EXPECT_FALSE(equal_in_constant_time("abc", "ab"));
  EXPECT_FALSE(equal_in_constant_time("", "a"));
}

TEST(Query, IsReadByKey) {
  EXPECT_EQ(path_of("/live?token=1&x=2"), "/live");
  EXPECT_EQ(path_of("/live"), "/live");
  EXPECT_EQ(query_value("/live?token=1&x=2", "x"), "2");
  EXPECT_EQ(query_value("/live?token=1&x=2", "token"), "1");
  EXPECT_EQ(query_value("/live?xtoken=1", "token"), "");
  EXPECT_EQ(query_value("/live?token", "token"), "");
  EXPECT_EQ(query_value("/live", "token"), "");
  EXPECT_EQ(bearer_token("Bearer abc"), "abc");
  EXPECT_EQ(bearer_token("Basic abc"), "");
}

}  // namespace
}  // namespace forcebound::page
