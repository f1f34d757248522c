#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace forcebound::handover {

/// SHA-256, so that nobody can make another scene of the same hash.
using Hash = std::array<std::byte, 32>;

[[nodiscard]] Hash hash_of(std::span<const std::byte> bytes);

/// 64 digits, 0 to f.
[[nodiscard]] std::string to_text(const Hash& hash);

}  // namespace forcebound::handover
