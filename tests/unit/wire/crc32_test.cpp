#include "forcebound/wire/internal/crc32.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <random>
#include <vector>

#include "forcebound/wire/codec.hpp"
#include "tests/support/allocation_guard.hpp"

namespace forcebound::wire {
namespace {

std::vector<std::byte> random_bytes(std::size_t count) {
  std::mt19937 random(7);
  std::vector<std::byte> bytes(count);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

std::uint32_t crc_of_zlib(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

TEST(Crc32, IsThatOfZlibForEveryLengthOfADatagramWhereverItBegins) {
  constexpr std::size_t kBeginnings = 17;
  const std::vector<std::byte> bytes = random_bytes(kFrameBytesMax + kBeginnings);
  for (std::size_t length = 1; length <= kFrameBytesMax; ++length) {
    for (std::size_t begin = 0; begin < kBeginnings; ++begin) {
      const auto all = std::span(bytes).subspan(begin, length);
      ASSERT_EQ(crc32_of(all[0], all.subspan(1)), crc_of_zlib(all)) << length << " bytes from " << begin;
    }
  }
}

TEST(Crc32, IsThatOfZlibOfEveryFirstByteAndOfZeros) {
  std::vector<std::byte> bytes(100);
  for (unsigned first = 0; first < 256; ++first) {
    bytes[0] = static_cast<std::byte>(first);
    ASSERT_EQ(crc32_of(bytes[0], std::span(bytes).subspan(1)), crc_of_zlib(bytes)) << first;
  }
}

TEST(Crc32, IsTheSameWhereTheProcessorCannotMultiplyWithoutCarries) {
  const std::vector<std::byte> bytes = random_bytes(kFrameBytesMax);
  for (std::size_t length = 1; length <= bytes.size(); ++length) {
    const auto all = std::span(bytes).first(length);
    ASSERT_EQ(portable_crc32_of(all[0], all.subspan(1)), crc_of_zlib(all)) << length;
  }
}

// The check value of the CRC catalogues.
TEST(Crc32, OfTheDigitsIsTheCheckValue) {
  const auto digits = std::as_bytes(std::span("123456789", 9));
  EXPECT_EQ(crc32_of(digits[0], digits.subspan(1)), 0xcbf43926U);
}

TEST(Crc32, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const std::vector<std::byte> bytes = random_bytes(kFrameBytesMax);
  (void)crc32_of(bytes[0], bytes);
  const test::AllocationGuard guard;
  (void)crc32_of(bytes[0], bytes);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::wire
