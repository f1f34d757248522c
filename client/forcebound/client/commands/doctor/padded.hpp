#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace forcebound::client::commands {

/// A datagram of the protocol made longer, so that it is read as before: for finding what size of datagram a network
/// lets through. The bytes that are added are a field that no version of the messages knows, which every reader drops.
///
/// Nothing if it is no datagram of the protocol, or `bytes` is neither its own size nor at least three more, up to
/// wire::kFrameBytesMax.
[[nodiscard]] std::optional<std::vector<std::byte>> padded(std::span<const std::byte> datagram, std::size_t bytes);

}  // namespace forcebound::client::commands
