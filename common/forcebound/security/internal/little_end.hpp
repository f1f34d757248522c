#pragma once

#include <cstddef>
#include <span>

namespace forcebound::security {

inline constexpr unsigned kBitsOfByte = 8;

/// A whole number whose lowest byte comes first.
template <class Whole>
[[nodiscard]] Whole little_end_first(std::span<const std::byte> bytes) noexcept {
  Whole value = 0;
  for (std::size_t i = sizeof(Whole); i > 0; --i) {
    value = static_cast<Whole>(value << kBitsOfByte | std::to_integer<Whole>(bytes[i - 1]));
  }
  return value;
}

template <class Whole>
void put_little_end_first(Whole value, std::span<std::byte> bytes) noexcept {
  for (std::size_t i = 0; i < sizeof(Whole); ++i) bytes[i] = static_cast<std::byte>(value >> kBitsOfByte * i & 0xff);
}

}  // namespace forcebound::security
