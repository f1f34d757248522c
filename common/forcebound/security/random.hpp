#pragma once

#include <cstddef>
#include <span>

namespace forcebound::security {

/// Random bytes of the system, fit for keys. For programs alone: the core is given random bytes as arguments, so that
/// tests repeat.
/// @throws std::runtime_error if the system gives none
void fill_with_random(std::span<std::byte> bytes);

}  // namespace forcebound::security
