#include "forcebound/client/rendering/piece_receipts.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace forcebound::client {
namespace {

bool tells(const wire::PieceReceipt& receipt, std::uint64_t transmission) {
  if (transmission == receipt.newest) return transmission != 0;
  if (transmission > receipt.newest || receipt.newest - transmission > 64) return false;
  return ((receipt.before >> (receipt.newest - transmission - 1)) & 1U) != 0;
}

TEST(PieceReceipts, TellNothingBeforeAnythingCame) {
  EXPECT_EQ(PieceReceipts().receipt(true), (wire::PieceReceipt{.wanted = true}));
}

TEST(PieceReceipts, TellTheNewestAndExactlyWhatCameOfThe64Before) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    std::mt19937_64 random(seed);
    PieceReceipts receipts;
    std::set<std::uint64_t> came;
    std::uint64_t newest = 0;
    for (int i = 0; i < 300; ++i) {
      const std::uint64_t step = random() % 10 == 0 ? random() % 200 : random() % 4;
      const std::uint64_t transmission = random() % 3 == 0 && newest > 70 ? newest - random() % 70 : newest + step + 1;
      receipts.add(transmission);
      came.insert(transmission);
      newest = std::max(newest, transmission);
      const wire::PieceReceipt receipt = receipts.receipt(true);
      ASSERT_EQ(receipt.newest, newest);
      for (std::uint64_t back = 0; back <= 64 && back < newest; ++back)
        ASSERT_EQ(tells(receipt, newest - back), came.contains(newest - back)) << "seed " << seed << ", back " << back;
    }
  }
}

}  // namespace
}  // namespace forcebound::client
