#include "forcebound/wire/internal/frame.hpp"

#include <algorithm>
#include <array>

#include "forcebound/wire/frame_size.hpp"
#include "forcebound/wire/internal/crc32.hpp"

namespace forcebound::wire {
namespace {

constexpr std::byte kFrameVersion{1};
constexpr std::array kMark{std::byte{'F'}, std::byte{'B'}};
constexpr std::size_t kVersionAt = 2;
constexpr std::size_t kKindAt = 3;
constexpr std::size_t kChecksumAt = 4;

std::uint32_t checksum(std::span<const std::byte> datagram) noexcept {
  // The checksum covers the kind too: else a flipped bit could turn a Hello into a Bye.
  return crc32_of(datagram[kKindAt], datagram.subspan(kHeaderBytes));
}

}  // namespace

void write_header(std::span<std::byte> datagram, std::size_t kind) noexcept {
  std::ranges::copy(kMark, datagram.begin());
  datagram[kVersionAt] = kFrameVersion;
  datagram[kKindAt] = static_cast<std::byte>(kind);
  const std::uint32_t sum = checksum(datagram);
  for (std::size_t i = 0; i < 4; ++i) datagram[kChecksumAt + i] = static_cast<std::byte>(sum >> (8 * i));
}

std::optional<Malformed> flaw_of_header(std::span<const std::byte> datagram) noexcept {
  if (datagram.size() > kFrameBytesMax) return Malformed::oversize;
  if (datagram.size() < kHeaderBytes) return Malformed::truncated;
  if (!std::equal(kMark.begin(), kMark.end(), datagram.begin()) || datagram[kVersionAt] != kFrameVersion) {
    return Malformed::foreign;
  }
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum |= std::to_integer<std::uint32_t>(datagram[kChecksumAt + i]) << (8 * i);
  return sum == checksum(datagram) ? std::nullopt : std::optional(Malformed::corrupt);
}

std::size_t kind_of(std::span<const std::byte> datagram) noexcept {
  return std::to_integer<std::size_t>(datagram[kKindAt]);
}

std::uint64_t first_number(std::span<const std::byte> body, std::byte tag) noexcept {
  constexpr std::size_t kNumberBytes = sizeof(std::uint64_t);
  if (body.size() < 1 + kNumberBytes || body[0] != tag) return 0;
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < kNumberBytes; ++i) number |= std::to_integer<std::uint64_t>(body[1 + i]) << (8 * i);
  return number;
}

}  // namespace forcebound::wire
