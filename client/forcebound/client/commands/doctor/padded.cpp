#include "forcebound/client/commands/doctor/padded.hpp"

#include <zlib.h>

#include "forcebound/wire/codec.hpp"

namespace forcebound::client::commands {
namespace {

// Of a datagram's header (wire::Codec).
constexpr std::size_t kFrameHeaderBytes = 8;
constexpr std::size_t kFrameKindAt = 3;
constexpr std::size_t kFrameChecksumAt = 4;

// Field 15, of a length: the number that a Hello has for its padding. Tag, and a length in two bytes.
constexpr std::byte kPaddingTag{15U << 3U | 2U};
constexpr std::size_t kPaddingHeaderBytes = 3;

void write_checksum(std::span<std::byte> datagram) {
  const auto* bytes = reinterpret_cast<const Bytef*>(datagram.data());
  const uLong kind = crc32(crc32(0, nullptr, 0), bytes + kFrameKindAt, 1);
  const uLong all = crc32(kind, bytes + kFrameHeaderBytes, static_cast<uInt>(datagram.size() - kFrameHeaderBytes));
  for (std::size_t i = 0; i < 4; ++i) datagram[kFrameChecksumAt + i] = static_cast<std::byte>(all >> (8 * i) & 0xffU);
}

}  // namespace

std::optional<std::vector<std::byte>> padded(std::span<const std::byte> datagram, std::size_t bytes) {
  if (datagram.size() < kFrameHeaderBytes || bytes > wire::kFrameBytesMax) return std::nullopt;
  std::vector<std::byte> longer(datagram.begin(), datagram.end());
  if (bytes == datagram.size()) return longer;
  if (bytes < datagram.size() + kPaddingHeaderBytes) return std::nullopt;
  const std::size_t padding = bytes - datagram.size() - kPaddingHeaderBytes;
  static_assert(wire::kFrameBytesMax < 1U << 14U, "has a length of two bytes");
  longer.reserve(bytes);
  longer.push_back(kPaddingTag);
  longer.push_back(static_cast<std::byte>(0x80U | (padding & 0x7fU)));
  longer.push_back(static_cast<std::byte>(padding >> 7U));
  longer.resize(bytes);
  write_checksum(longer);
  return longer;
}

}  // namespace forcebound::client::commands
