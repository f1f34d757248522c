#include "forcebound/time/sequence_window.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <set>

namespace forcebound::time {
namespace {

using Arrival = SequenceWindow::Arrival;

TEST(SequenceWindow, FirstNumberMayBeAny) {
  for (const std::uint64_t first : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{1} << 63, UINT64_MAX}) {
    SequenceWindow window;
    EXPECT_EQ(window.add(first), Arrival::newest);
    EXPECT_EQ(window.add(first), Arrival::duplicate);
    EXPECT_EQ(window.add(first + 1), Arrival::newest);
  }
}

TEST(SequenceWindow, LatecomersAreToldFromCopies) {
  SequenceWindow window;
  EXPECT_EQ(window.add(10), Arrival::newest);
  EXPECT_EQ(window.add(13), Arrival::newest);
  EXPECT_EQ(window.add(11), Arrival::late);
  EXPECT_EQ(window.add(11), Arrival::duplicate);
  EXPECT_EQ(window.add(10), Arrival::duplicate);
  EXPECT_EQ(window.add(12), Arrival::late);
  EXPECT_EQ(window.add(9), Arrival::late) << "overtaken by the first";
  EXPECT_EQ(window.newest(), 13U);
}

TEST(SequenceWindow, RemembersSixteenSecondsAtOneKilohertz) {
  SequenceWindow window;
  EXPECT_EQ(window.add(100000), Arrival::newest);
  EXPECT_TRUE(window.is_fresh(100000 - SequenceWindow::kNumbers + 64));
  EXPECT_EQ(window.add(100000 - SequenceWindow::kNumbers + 64), Arrival::late);
  EXPECT_FALSE(window.is_fresh(100000 - SequenceWindow::kNumbers - 64)) << "too old to tell";
  EXPECT_EQ(window.add(100000 - SequenceWindow::kNumbers - 64), Arrival::duplicate) << "too old to tell";
  EXPECT_FALSE(window.is_fresh(0));
}

TEST(SequenceWindow, TakesEachNumberOnceInAnyOrder) {
  SequenceWindow window;
  // 7919 and 16384 have no common factor: all numbers of the window, far from in order.
  for (std::uint64_t i = 0; i < SequenceWindow::kNumbers; ++i) {
    const std::uint64_t number = i * 7919 % SequenceWindow::kNumbers;
    ASSERT_TRUE(window.is_fresh(number));
    ASSERT_NE(window.add(number), Arrival::duplicate);
    ASSERT_FALSE(window.is_fresh(number));
  }
  for (std::uint64_t number = 0; number < SequenceWindow::kNumbers; ++number) ASSERT_FALSE(window.is_fresh(number));
  window.add(SequenceWindow::kNumbers + 64);
  EXPECT_TRUE(window.is_fresh(SequenceWindow::kNumbers)) << "its place was another's before";
}

TEST(SequenceWindow, AskingChangesNothing) {
  SequenceWindow window;
  EXPECT_TRUE(window.is_fresh(7));
  EXPECT_EQ(window.add(5), Arrival::newest);
  EXPECT_TRUE(window.is_fresh(std::uint64_t{1} << 62));
  EXPECT_EQ(window.newest(), 5U);
  EXPECT_EQ(window.add(6), Arrival::newest);
}

TEST(SequenceWindow, AJumpForgetsEverythingBefore) {
  SequenceWindow window;
  EXPECT_EQ(window.add(5), Arrival::newest);
  EXPECT_EQ(window.add(5 + SequenceWindow::kNumbers * 10), Arrival::newest);
  EXPECT_EQ(window.add(5 + SequenceWindow::kNumbers * 10 - 1), Arrival::late);
  EXPECT_EQ(window.add(5), Arrival::duplicate);
}

TEST(SequenceWindow, ANumberTooFarAheadChangesNothing) {
  SequenceWindow window;
  EXPECT_EQ(window.add(5, 100), Arrival::newest);
  EXPECT_EQ(window.add(106, 100), Arrival::too_far_ahead);
  EXPECT_EQ(window.add(5 + (std::uint64_t{1} << 62), 100), Arrival::too_far_ahead);
  EXPECT_EQ(window.newest(), 5U);
  EXPECT_EQ(window.add(5, 100), Arrival::duplicate);
  EXPECT_EQ(window.add(105, 100), Arrival::newest);
  EXPECT_EQ(window.add(104, 100), Arrival::late);
}

TEST(SequenceWindow, ANumberHalfACircleAwayIsOldAndChangesNothing) {
  SequenceWindow window;
  EXPECT_EQ(window.add(5, 100), Arrival::newest);
  EXPECT_EQ(window.add(5 + (std::uint64_t{1} << 63), 100), Arrival::duplicate);
  EXPECT_EQ(window.newest(), 5U);
}

TEST(SequenceWindow, TheFirstNumberIsNeverTooFarAhead) {
  SequenceWindow window;
  EXPECT_EQ(window.add(std::uint64_t{1} << 62, 100), Arrival::newest);
}

// Against a set that remembers all, wherever on the circle of 64-bit numbers.
TEST(SequenceWindow, AgreesWithASetOfAllNumbersSeen) {
  ASSERT_TRUE(rc::check([] {
    const std::uint64_t origin = *rc::gen::element<std::uint64_t>(1000000, 0, UINT64_MAX - 500, std::uint64_t{1} << 63);
    SequenceWindow window;
    std::set<std::int64_t> seen;
    std::int64_t newest = 0;
    for (const int step : *rc::gen::container<std::vector<int>>(200, rc::gen::inRange(-3000, 3000))) {
      const std::int64_t offset = seen.empty() ? step : newest + step;
      const std::uint64_t number = origin + static_cast<std::uint64_t>(offset);
      RC_ASSERT(window.is_fresh(number) == !seen.contains(offset));
      const Arrival arrival = window.add(number);
      if (seen.contains(offset)) {
        RC_ASSERT(arrival == Arrival::duplicate);
      } else if (seen.empty() || offset > newest) {
        RC_ASSERT(arrival == Arrival::newest);
        newest = offset;
      } else {
        RC_ASSERT(arrival == Arrival::late);
      }
      seen.insert(offset);
    }
  }));
}

}  // namespace
}  // namespace forcebound::time
