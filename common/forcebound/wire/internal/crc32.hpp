#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

/// Private to wire.
namespace forcebound::wire {

/// CRC-32 as zlib's `crc32`, of one byte and of what follows it.
///
/// Where the processor multiplies without carries (PCLMULQDQ of x86-64), 16 bytes at a time are folded into one
/// remainder [Gopal et al., Fast CRC Computation for Generic Polynomials Using PCLMULQDQ Instruction, Intel 2009]; else
/// zlib computes it. For the 60 to 200 bytes of a motion and a force zlib takes several times as long (measured: 420
/// ns for 60 bytes, against 68).
///
/// Real time: noexcept, no allocation, O(bytes).
[[nodiscard]] std::uint32_t crc32_of(std::byte first, std::span<const std::byte> rest) noexcept;

/// The same by zlib, whatever the processor can do.
[[nodiscard]] std::uint32_t portable_crc32_of(std::byte first, std::span<const std::byte> rest) noexcept;

}  // namespace forcebound::wire
