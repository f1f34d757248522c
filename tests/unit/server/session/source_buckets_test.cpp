#include "forcebound/server/session/source_buckets.hpp"

#include <gtest/gtest.h>

#include <set>

namespace forcebound::server {
namespace {

using std::chrono::milliseconds;

net::Address ipv4(std::uint8_t last, std::uint16_t port = 1) {
  return {.ip = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 10, 0, 0, last}, .port = port};
}

TEST(SourceBuckets, AFloodFromOneSourceUsesUpItsOwnRateAlone) {
  SourceBuckets buckets(milliseconds{20}, 50, milliseconds{0}, 12345);
  int taken = 0;
  for (int i = 0; i < 10'000; ++i) taken += buckets.take(ipv4(1, static_cast<std::uint16_t>(i)), milliseconds{0});
  EXPECT_EQ(taken, 50);
  std::uint8_t other = 2;
  while (buckets.index(ipv4(other)) == buckets.index(ipv4(1))) ++other;
  EXPECT_TRUE(buckets.take(ipv4(other), milliseconds{0}));
}

TEST(SourceBuckets, ForgedSourcesTogetherGetABoundedRate) {
  SourceBuckets buckets(milliseconds{20}, 50, milliseconds{0}, 12345);
  std::size_t taken = 0;
  for (std::uint8_t last = 0; last < 255; ++last) {
    for (int i = 0; i < 100; ++i) taken += buckets.take(ipv4(last), milliseconds{0}) ? 1 : 0;
  }
  EXPECT_LE(taken, 50 * SourceBuckets::kBuckets);
}

TEST(SourceBuckets, AnIpv6SiteIsOneSource) {
  const SourceBuckets buckets(milliseconds{20}, 50, milliseconds{0}, 12345);
  net::Address one{.ip = {0x20, 1, 0xd, 0xb8, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, .port = 1};
  net::Address other = one;
  other.ip[15] = 99;
  EXPECT_EQ(source_of(one), source_of(other));
  for (int network = 0; network < 256; ++network) {
    other.ip[7] = static_cast<std::uint8_t>(network);
    ASSERT_EQ(source_of(one), source_of(other)) << "all networks of its /56";
  }
  other.ip[6] = 8;
  EXPECT_NE(source_of(one), source_of(other));
  other = one;
  // Bytes as in an address of IPv4, which whoever has the network can choose.
  one.ip[10] = one.ip[11] = other.ip[10] = other.ip[11] = 0xff;
  for (std::uint8_t last = 0; last < 255; ++last) {
    other.ip[15] = last;
    ASSERT_EQ(buckets.index(one), buckets.index(other));
  }
}

TEST(SourceBuckets, EachIpv4AddressIsASourceWhateverThePort) {
  EXPECT_EQ(source_of(ipv4(1, 1)), source_of(ipv4(1, 2)));
  std::set<std::uint64_t> sources;
  for (std::uint8_t last = 0; last < 255; ++last) sources.insert(source_of(ipv4(last)));
  EXPECT_EQ(sources.size(), 255U);
}

TEST(SourceBuckets, SourcesSpreadOverBucketsAsTheKeySays) {
  const SourceBuckets buckets(milliseconds{20}, 50, milliseconds{0}, 1);
  const SourceBuckets others(milliseconds{20}, 50, milliseconds{0}, 2);
  std::set<std::size_t> used;
  int moved = 0;
  for (std::uint8_t last = 0; last < 255; ++last) {
    used.insert(buckets.index(ipv4(last)));
    moved += buckets.index(ipv4(last)) != others.index(ipv4(last));
  }
  EXPECT_GT(used.size(), SourceBuckets::kBuckets / 2);
  EXPECT_GT(moved, 128);
}

}  // namespace
}  // namespace forcebound::server
