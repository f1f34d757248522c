#include "forcebound/client/page/view_tap.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::client {
namespace {

std::vector<std::uint32_t> taken(ViewTap& tap) {
  std::vector<std::uint32_t> numbers;
  tap.drain([&numbers](const view::Assembly::Piece& piece) { numbers.push_back(piece.number); });
  return numbers;
}

TEST(ViewTap, CarriesPiecesInTheirOrderWithTheirContent) {
  ViewTap tap;
  const std::vector<std::byte> content{std::byte{1}, std::byte{2}};
  tap.on_view({.session = 3, .view = 4, .pieces = 5, .number = 2, .first = 6, .content = content});
  tap.on_view({.session = 3, .view = 4, .pieces = 5, .number = 1});
  int pieces = 0;
  tap.drain([&](const view::Assembly::Piece& piece) {
    if (pieces++ > 0) return;
    EXPECT_EQ(piece.session, 3U);
    EXPECT_EQ(piece.view, 4U);
    EXPECT_EQ(piece.pieces, 5U);
    EXPECT_EQ(piece.number, 2U);
    EXPECT_EQ(piece.first, 6U);
    EXPECT_EQ(std::vector<std::byte>(piece.content.begin(), piece.content.end()), content);
  });
  EXPECT_EQ(pieces, 2);
  EXPECT_TRUE(taken(tap).empty());
}

TEST(ViewTap, DropsWhatDoesNotFit) {
  ViewTap tap;
  const std::vector<std::byte> longer(view::kPieceBytes + 1);
  tap.on_view({.content = longer});
  EXPECT_TRUE(taken(tap).empty());
  for (std::uint32_t i = 0; i < ViewTap::kCapacity + 100; ++i) tap.on_view({.number = i});
  const auto numbers = taken(tap);
  EXPECT_EQ(numbers.size(), ViewTap::kCapacity);
  EXPECT_EQ(numbers.front(), 0U);
}

TEST(ViewTap, DoesNotAllocateInTheTick) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  ViewTap tap;
  const std::vector<std::byte> content(view::kPieceBytes);
  const test::AllocationGuard guard;
  for (std::uint32_t i = 0; i < 1000; ++i) tap.on_view({.number = i, .content = content});
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::client
