#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "forcebound/wire/malformed.hpp"

/// The header before the body of a datagram, see Codec. Private to wire.
namespace forcebound::wire {

inline constexpr std::size_t kHeaderBytes = 8;

/// Writes the header before the body that the datagram has. @param kind of the message: 1, 2, 3, ...
void write_header(std::span<std::byte> datagram, std::size_t kind) noexcept;

/// Why the datagram is none of the protocol's; none: it has a header, and the checksum is that of kind and body.
[[nodiscard]] std::optional<Malformed> flaw_of_header(std::span<const std::byte> datagram) noexcept;

/// Of a datagram with a header.
[[nodiscard]] std::size_t kind_of(std::span<const std::byte> datagram) noexcept;

/// The fixed64 that a body begins with; 0 if it begins with another field.
[[nodiscard]] std::uint64_t first_number(std::span<const std::byte> body, std::byte tag) noexcept;

}  // namespace forcebound::wire
