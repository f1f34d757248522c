#include "forcebound/security/cookies.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>

#include "tests/support/allocation_guard.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound::security {
namespace {

using Address = std::array<std::byte, 18>;

constexpr time::Nanoseconds kStart = std::chrono::hours(5);
constexpr time::Nanoseconds kJust{1};

TEST(Cookies, AreGoodForAPeriodAtLeastAndTwoAtMost) {
  const Cookies cookies(secret_key(1));
  const Address address{std::byte{7}};
  ASSERT_EQ(kStart % Cookies::kPeriod, time::Nanoseconds{0});
  const Cookie first = cookies.made_for(address, kStart);
  const Cookie last = cookies.made_for(address, kStart + Cookies::kPeriod - kJust);
  EXPECT_EQ(first, last);
  EXPECT_TRUE(cookies.is_good(first, address, kStart));
  EXPECT_TRUE(cookies.is_good(first, address, kStart + 2 * Cookies::kPeriod - kJust));
  EXPECT_FALSE(cookies.is_good(first, address, kStart + 2 * Cookies::kPeriod));
  EXPECT_FALSE(cookies.is_good(first, address, kStart - kJust)) << "of a period that is yet to come";
}

TEST(Cookies, AreOfOneAddressAndOneKey) {
  const Cookies cookies(secret_key(1));
  const Cookies others(secret_key(2));
  const Address address{std::byte{7}};
  const Cookie cookie = cookies.made_for(address, kStart);
  EXPECT_FALSE(others.is_good(cookie, address, kStart));
  EXPECT_FALSE(cookies.is_good(Cookie{}, address, kStart));
  for (std::size_t i = 0; i < address.size(); ++i) {
    Address another = address;
    another[i] ^= std::byte{1};
    EXPECT_FALSE(cookies.is_good(cookie, another, kStart));
  }
  for (std::size_t bit = 0; bit < cookie.size() * 8; ++bit) {
    Cookie flipped = cookie;
    flipped[bit / 8] ^= std::byte{1} << bit % 8;
    EXPECT_FALSE(cookies.is_good(flipped, address, kStart));
  }
}

TEST(Cookies, DoNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const Cookies cookies(secret_key(1));
  const Address address{};
  const test::AllocationGuard guard;
  const Cookie cookie = cookies.made_for(address, kStart);
  const bool good = cookies.is_good(cookie, address, kStart);
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_TRUE(good);
}

}  // namespace
}  // namespace forcebound::security
