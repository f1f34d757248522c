#include "forcebound/net/address_turns.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::net {
namespace {

using namespace std::chrono_literals;

constexpr Address kA{.ip = {1}, .port = 1};
constexpr Address kB{.ip = {2}, .port = 1};
constexpr Address kC{.ip = {3}, .port = 1};

/// Turns in a time that the test sets, with a datagram to send every 10 ms.
class AddressTurnsTest : public testing::Test {
 protected:
  void set(const std::vector<Address>& addresses) { turns_.set(addresses, now_); }

  /// Whose turns there are meanwhile, each change once: "abab".
  std::string turns_within(time::Nanoseconds duration) {
    std::string names;
    for (const auto end = now_ + duration; now_ < end; now_ += 10ms) {
      turns_.before_sending(now_);
      const char name = static_cast<char>('a' + turns_.current()->ip[0] - 1);
      if (names.empty() || names.back() != name) names += name;
    }
    return names;
  }

  void have_session(time::Nanoseconds duration) {
    for (const auto end = now_ + duration; now_ < end; now_ += 10ms) {
      turns_.before_sending(now_);
      turns_.on_received();
      turns_.on_session(now_);
    }
  }

  /// When the name was looked up meanwhile, since the beginning, in ms.
  std::vector<long> lookups_within(time::Nanoseconds duration) {
    std::vector<long> times;
    const auto begin = now_;
    for (const auto end = now_ + duration; now_ < end; now_ += 10ms) {
      if (turns_.look_up_due(now_)) times.push_back(static_cast<long>((now_ - begin) / 1ms));
    }
    return times;
  }

  time::Nanoseconds now_{0};
  AddressTurns turns_{now_};
};

TEST_F(AddressTurnsTest, GivesEach250MillisecondsAndThenTwiceAsLongUpTo4Seconds) {
  set({kA, kB});
  EXPECT_EQ(turns_within(250ms), "a");
  EXPECT_EQ(turns_within(250ms), "b");
  EXPECT_EQ(turns_within(500ms), "a");
  EXPECT_EQ(turns_within(500ms), "b");
  EXPECT_EQ(turns_within(2 * 1s + 2 * 2s), "abab");
  EXPECT_EQ(turns_within(4s), "a");
  EXPECT_EQ(turns_within(4s), "b");
  EXPECT_EQ(turns_within(4s), "a");
}

TEST_F(AddressTurnsTest, EndsATurnAtOnceWhereNobodyIs) {
  set({kA, kB, kC});
  turns_.on_unreachable(now_);
  EXPECT_EQ(*turns_.current(), kB);
  turns_.on_unreachable(now_);
  EXPECT_EQ(*turns_.current(), kC);
  turns_.on_unreachable(now_);
  EXPECT_EQ(*turns_.current(), kA);
}

TEST_F(AddressTurnsTest, HasOneAddressAlwaysAtItsTurn) {
  set({kA});
  turns_.on_unreachable(now_);
  EXPECT_EQ(turns_within(60s), "a");
}

TEST_F(AddressTurnsTest, EndsNoTurnWithoutADatagram) {
  set({kA, kB});
  now_ += 10s;
  EXPECT_EQ(*turns_.current(), kA);
  turns_.before_sending(now_);
  EXPECT_EQ(*turns_.current(), kB);
}

TEST_F(AddressTurnsTest, WaitsForASessionWhereSomethingAnswers) {
  set({kA, kB});
  turns_.on_received();
  turns_.on_unreachable(now_);
  EXPECT_EQ(turns_within(5s), "a");
  EXPECT_EQ(turns_within(250ms), "b") << "it was another's";
}

TEST_F(AddressTurnsTest, KeepsAnAddressWithASessionThroughTwoSecondsOfSilence) {
  set({kA, kB});
  turns_.on_unreachable(now_);
  have_session(60s);
  turns_.on_unreachable(now_);
  EXPECT_EQ(turns_within(1900ms), "b");
  EXPECT_EQ(turns_within(200ms), "ba");
}

TEST_F(AddressTurnsTest, KeepsTheTurnOfAnAddressThatTheNameStillLeadsTo) {
  set({kA, kB});
  turns_.on_unreachable(now_);
  have_session(1s);
  set({kC, kB});
  EXPECT_EQ(*turns_.current(), kB);
  set({kC, kA});
  EXPECT_EQ(*turns_.current(), kC);
  set({});
  EXPECT_EQ(turns_.current(), nullptr);
  set({kA});
  EXPECT_EQ(*turns_.current(), kA);
}

TEST_F(AddressTurnsTest, LeavesOutWhatItHasNoRoomFor) {
  std::vector<Address> many;
  for (std::uint8_t i = 1; i <= 20; ++i) many.push_back({.ip = {i}, .port = 1});
  set(many);
  for (std::size_t i = 0; i < AddressTurns::kAddressesMost; ++i) turns_.on_unreachable(now_);
  EXPECT_EQ(*turns_.current(), many.front());
}

TEST_F(AddressTurnsTest, HasTheNameLookedUpAgainAfterASecondWithoutASessionAndThenLessOften) {
  EXPECT_EQ(lookups_within(20s), (std::vector<long>{1000, 2000, 4000, 8000, 16000}));
  have_session(20s);
  EXPECT_EQ(lookups_within(5s), (std::vector<long>{990, 1990, 3990})) << "10 ms after the last session";
}

TEST_F(AddressTurnsTest, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const std::vector<Address> both{kA, kB};
  const test::AllocationGuard guard;
  turns_.set(both, now_);
  for (int i = 0; i < 1000; ++i) {
    now_ += 10ms;
    turns_.before_sending(now_);
    turns_.on_unreachable(now_);
    (void)turns_.look_up_due(now_);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::net
