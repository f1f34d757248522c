#include "forcebound/wire/internal/crc32.hpp"

#include <zlib.h>

#include <array>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace forcebound::wire {
namespace {

uLong crc_of_first(std::byte first) noexcept {
  constexpr z_crc_t kAllOnes = 0xffffffff;
  constexpr unsigned kByteBits = 8;
  return ~(get_crc_table()[std::to_integer<z_crc_t>(~first)] ^ (kAllOnes >> kByteBits)) & kAllOnes;
}

std::uint32_t continued(uLong crc, std::span<const std::byte> rest) noexcept {
  if (rest.empty()) return static_cast<std::uint32_t>(crc);
  return static_cast<std::uint32_t>(
      crc32(crc, reinterpret_cast<const Bytef*>(rest.data()), static_cast<uInt>(rest.size())));
}

#if defined(__x86_64__)

// A polynomial over {0, 1} is kept with its highest power in the lowest bit, as CRC-32 has it.
constexpr std::uint32_t kPolynomial = 0xedb88320;  // x^32 is left out

/// x^power modulo the polynomial.
constexpr std::uint32_t remainder_of_power(int power) noexcept {
  std::uint32_t remainder = 1U << 31U;
  for (int i = 0; i < power; ++i) remainder = (remainder >> 1U) ^ ((remainder & 1U) != 0 ? kPolynomial : 0);
  return remainder;
}

/// As a factor: the product of two numbers whose bits are kept in reverse has them one place too low.
constexpr std::uint64_t factor(int power) noexcept { return std::uint64_t{remainder_of_power(power)} << 1U; }

/// x^64 divided by the polynomial, without its remainder.
constexpr std::uint64_t quotient() noexcept {
  std::uint64_t quotient = 1;
  std::uint32_t remainder = kPolynomial;
  for (unsigned bit = 1; bit <= 32; ++bit) {
    quotient |= std::uint64_t{remainder & 1U} << bit;
    remainder = (remainder >> 1U) ^ ((remainder & 1U) != 0 ? kPolynomial : 0);
  }
  return quotient;
}

constexpr std::size_t kBlockBytes = 16;

/// Read from index n on, it moves the first n bytes of a block to its end, zeros before them (n = 3: 13 zeros, then
/// bytes 0, 1, 2); from 16 + n on, what follows them to its beginning (bytes 3 to 15, then zeros).
constexpr std::array<std::uint8_t, 3 * kBlockBytes> make_shifts() noexcept {
  std::array<std::uint8_t, 3 * kBlockBytes> shifts{};
  constexpr std::uint8_t kZero = 0x80;
  shifts.fill(kZero);
  for (std::size_t i = 0; i < kBlockBytes; ++i) shifts.at(kBlockBytes + i) = static_cast<std::uint8_t>(i);
  return shifts;
}
constexpr auto kShifts = make_shifts();

#define FORCEBOUND_CARRY_LESS __attribute__((target("pclmul,ssse3,sse4.1")))

FORCEBOUND_CARRY_LESS inline __m128i load(const void* from) noexcept {
  return _mm_loadu_si128(static_cast<const __m128i*>(from));
}

FORCEBOUND_CARRY_LESS inline __m128i factors(std::uint64_t low, std::uint64_t high) noexcept {
  return _mm_set_epi64x(static_cast<long long>(high), static_cast<long long>(low));
}

/// The CRC of 128 bits that begin with everything folded so far.
FORCEBOUND_CARRY_LESS std::uint32_t reduced(__m128i block) noexcept {
  const __m128i low_words = _mm_set_epi32(0, -1, 0, -1);
  // 128 bits to 96, to 64, and Barrett's reduction to 32.
  __m128i rest =
      _mm_xor_si128(_mm_srli_si128(block, 8), _mm_clmulepi64_si128(block, factors(factor(96), factor(64)), 0x00));
  rest = _mm_xor_si128(_mm_srli_si128(rest, 4),
                       _mm_clmulepi64_si128(_mm_and_si128(rest, low_words), factors(factor(96), factor(64)), 0x10));
  const __m128i division = factors(std::uint64_t{kPolynomial} << 1U | 1U, quotient());
  __m128i times = _mm_clmulepi64_si128(_mm_and_si128(rest, low_words), division, 0x10);
  times = _mm_clmulepi64_si128(_mm_and_si128(times, low_words), division, 0x00);
  return static_cast<std::uint32_t>(_mm_extract_epi32(_mm_xor_si128(rest, times), 1));
}

/// @param rest at least kBlockBytes
FORCEBOUND_CARRY_LESS std::uint32_t folded(std::uint32_t crc, std::span<const std::byte> rest) noexcept {
  // Zeros before it do not change a remainder: the first block has what is more than whole ones.
  const std::size_t first_bytes = (rest.size() - 1) % kBlockBytes + 1;
  const __m128i state = _mm_cvtsi32_si128(static_cast<int>(~crc));
  __m128i sum = _mm_shuffle_epi8(_mm_xor_si128(load(rest.data()), state), load(kShifts.data() + first_bytes));
  __m128i beyond_first = _mm_shuffle_epi8(state, load(kShifts.data() + kBlockBytes + first_bytes));
  const __m128i by_block = factors(factor(kBlockBytes * 8 + 32), factor(kBlockBytes * 8 - 32));
  for (std::size_t at = first_bytes; at < rest.size(); at += kBlockBytes) {
    const __m128i next = _mm_xor_si128(load(rest.data() + at), beyond_first);
    beyond_first = _mm_setzero_si128();
    sum = _mm_xor_si128(
        next, _mm_xor_si128(_mm_clmulepi64_si128(sum, by_block, 0x00), _mm_clmulepi64_si128(sum, by_block, 0x11)));
  }
  return ~reduced(sum);
}

bool multiplies_without_carries() noexcept {
  static const bool kCan = __builtin_cpu_supports("pclmul") && __builtin_cpu_supports("sse4.1");
  return kCan;
}

#endif

}  // namespace

std::uint32_t portable_crc32_of(std::byte first, std::span<const std::byte> rest) noexcept {
  return continued(crc_of_first(first), rest);
}

std::uint32_t crc32_of(std::byte first, std::span<const std::byte> rest) noexcept {
#if defined(__x86_64__)
  if (rest.size() >= kBlockBytes && multiplies_without_carries()) {
    return folded(static_cast<std::uint32_t>(crc_of_first(first)), rest);
  }
#endif
  return portable_crc32_of(first, rest);
}

}  // namespace forcebound::wire
