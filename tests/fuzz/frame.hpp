#pragma once

#include <algorithm>
#include <vector>

#include "forcebound/wire/codec.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/unit/wire/sample_messages.hpp"

namespace forcebound::fuzz {

/// A valid frame around any body: no random change of a datagram would get past the checksum. A Hello (kind 1) is
/// padded to the length that it must have, by a field of bytes at the end.
[[nodiscard]] inline std::vector<std::byte> framed(unsigned kind, Bytes body) {
  constexpr std::size_t kHeaderBytes = 8;
  constexpr std::size_t kPaddingOverhead = 3;
  std::vector<std::byte> padded(body.begin(), body.end());
  const std::size_t used = kHeaderBytes + kPaddingOverhead + padded.size();
  if (kind == 1 && used + 128 <= wire::kFrameBytesMax) {
    const std::size_t padding = wire::kFrameBytesMax - used;
    padded.push_back(std::byte{0x7a});  // field 15, bytes
    padded.push_back(std::byte((padding & 0x7fU) | 0x80U));
    padded.push_back(std::byte(padding >> 7U));
    padded.resize(padded.size() + padding);
  }
  return wire::framed(kind, padded);
}

}  // namespace forcebound::fuzz
