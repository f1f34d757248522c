#pragma once

#include <cstddef>

namespace forcebound::wire {

/// Largest datagram of the protocol. A Hello always has this length: so no answer is larger than its request, and a
/// server cannot be used to flood a third party.
inline constexpr std::size_t kFrameBytesMax = 1200;

}  // namespace forcebound::wire
