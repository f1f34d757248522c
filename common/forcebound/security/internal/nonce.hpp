#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace forcebound::security {

inline constexpr std::size_t kNonceBytes = 12;

/// Four zero bytes and the counter, little end first (Noise, section 12.3).
[[nodiscard]] constexpr std::array<unsigned char, kNonceBytes> nonce_of(std::uint64_t counter) noexcept {
  constexpr unsigned kByteBits = 8;
  constexpr std::size_t kZeros = 4;
  std::array<unsigned char, kNonceBytes> nonce{};
  for (std::size_t i = kZeros; i < kNonceBytes; ++i) {
    nonce[i] = static_cast<unsigned char>(counter >> kByteBits * (i - kZeros));
  }
  return nonce;
}

}  // namespace forcebound::security
