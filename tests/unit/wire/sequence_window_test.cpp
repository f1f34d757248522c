#include "forcebound/wire/sequence_window.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <random>
#include <set>

namespace forcebound::wire {
namespace {

using Arrival = SequenceWindow::Arrival;

TEST(SequenceWindow, TellsNewestOvertakenAndDuplicateApart) {
  SequenceWindow window;
  EXPECT_EQ(window.note(1), Arrival::newest);
  EXPECT_EQ(window.note(3), Arrival::newest);
  EXPECT_EQ(window.note(2), Arrival::overtaken);
  EXPECT_EQ(window.note(2), Arrival::duplicate);
  EXPECT_EQ(window.note(3), Arrival::duplicate);
  EXPECT_EQ(window.newest(), 3U);
}

TEST(SequenceWindow, TakesZeroAndWhatIsTooOldForACopy) {
  SequenceWindow window;
  EXPECT_EQ(window.note(0), Arrival::duplicate);
  EXPECT_EQ(window.note(SequenceWindow::kWindow + 10), Arrival::newest);
  EXPECT_EQ(window.note(10), Arrival::duplicate);
  EXPECT_EQ(window.note(11), Arrival::overtaken);
}

TEST(SequenceWindow, SurvivesTheLargestNumbers) {
  SequenceWindow window;
  constexpr auto kLast = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(window.note(kLast - 1), Arrival::newest);
  EXPECT_EQ(window.note(kLast), Arrival::newest);
  EXPECT_EQ(window.note(kLast), Arrival::duplicate);
}

TEST(SequenceWindow, AgreesWithASetOverRandomOrders) {
  std::mt19937_64 random(7);
  SequenceWindow window;
  std::set<std::uint64_t> seen;
  std::uint64_t base = 1;
  for (int i = 0; i < 200'000; ++i) {
    base += random() % 3;
    const std::uint64_t sequence = base + random() % 200;
    const bool copy = !seen.insert(sequence).second;
    EXPECT_EQ(window.note(sequence) == Arrival::duplicate, copy);
  }
}

}  // namespace
}  // namespace forcebound::wire
