#include "forcebound/server/session/shared_limits.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;

net::Address limited_address(std::uint8_t last) {
  net::Address address{.port = last};
  address.ip[15] = last;
  return address;
}

TEST(SharedLimits, HoldExactlyHoweverManyAskAtOnce) {
  constexpr std::size_t kPlaces = 100;
  SharedLimits limits(50, 0s, 1);
  std::atomic<std::size_t> most{0};
  std::atomic<std::size_t> refused{0};
  {
    std::vector<std::jthread> askers;
    for (std::uint64_t asker = 0; asker < 4; ++asker) {
      askers.emplace_back([&, asker] {
        std::vector<SharedLimits::Place> mine;
        for (std::uint64_t i = 0; i < 2'000; ++i) {
          auto place = limits.take({.session = 4 * i + asker + 1, .address = limited_address(1)}, {.all = kPlaces});
          if (place) mine.push_back(std::move(*place));
          const std::size_t now = limits.sessions();
          for (std::size_t before = most; before < now && !most.compare_exchange_weak(before, now);) {
          }
          if (place) continue;
          ++refused;
          mine.clear();
        }
      });
    }
  }
  EXPECT_LE(most, kPlaces);
  EXPECT_GT(refused, 0U);
  EXPECT_EQ(limits.sessions(), 0U) << "each place was given back";
}

TEST(SharedLimits, HoldForAnAddressWhateverThePortAndForAClient) {
  SharedLimits limits(50, 0s, 1);
  net::Address other_port = limited_address(1);
  other_port.port = 999;
  const auto first =
      limits.take({.session = 1, .address = limited_address(1), .client = "ann"}, {.all = 9, .of_address = 1});
  ASSERT_TRUE(first);
  EXPECT_FALSE(limits.take({.session = 2, .address = other_port}, {.all = 9, .of_address = 1}));
  EXPECT_FALSE(limits.take({.session = 2, .address = limited_address(2), .client = "ann"}, {.all = 9, .of_client = 1}));
  EXPECT_TRUE(limits.take({.session = 2, .address = limited_address(2), .client = "bob"}, {.all = 9, .of_client = 1}));
  EXPECT_FALSE(limits.take({.session = 1, .address = limited_address(3)}, {.all = 9})) << "the number is taken";
  EXPECT_EQ(limits.sessions_of(limited_address(1)), 1U);
  EXPECT_EQ(limits.sessions_of(std::string_view("ann")), 1U);
  EXPECT_TRUE(limits.has(1));
}

TEST(SharedLimits, GiveAPlaceBackOnceWhereverItWasMovedTo) {
  SharedLimits limits(50, 0s, 1);
  {
    auto place = limits.take({.session = 1, .address = limited_address(1)}, {.all = 1});
    ASSERT_TRUE(place);
    SharedLimits::Place moved = std::move(*place);
    place.reset();
    EXPECT_EQ(limits.sessions(), 1U);
    SharedLimits::Place assigned;
    assigned = std::move(moved);
    EXPECT_EQ(limits.sessions(), 1U);
  }
  EXPECT_EQ(limits.sessions(), 0U);
}

TEST(SharedLimits, LetASourceSayHelloAsOftenAsOneServerWould) {
  SharedLimits limits(5, 0s, 1);
  int taken = 0;
  for (int i = 0; i < 20; ++i) taken += limits.take_hello({}, limited_address(1), 0s) ? 1 : 0;
  EXPECT_EQ(taken, 5);
  EXPECT_TRUE(limits.take_hello({}, limited_address(1), 1s));
}

TEST(WorkerPlace, OwnsSessionsByTheLowestByteOfTheirNumber) {
  const WorkerPlace second{.number = 1, .workers = 3};
  EXPECT_TRUE(second.owns(0x0701));
  EXPECT_FALSE(second.owns(0x0702));
  EXPECT_TRUE(second.owns(0x07fd));  // 253
  EXPECT_TRUE(WorkerPlace{}.owns(12345)) << "without others all are its own";
}

TEST(WorkerPlace, FindsAScenesHomeByItsNameAlone) {
  const WorkerPlace one{.number = 0, .workers = 4};
  const WorkerPlace other{.number = 3, .workers = 4};
  std::vector<std::size_t> homes(4);
  for (int i = 0; i < 100; ++i) {
    const std::string scene = "scene " + std::to_string(i);
    EXPECT_EQ(one.home_of(scene), other.home_of(scene));
    ++homes[one.home_of(scene)];
  }
  for (const std::size_t home : homes) EXPECT_GT(home, 10U);
}

}  // namespace
}  // namespace forcebound::server
