#pragma once

#include <array>

#include "tests/support/drivers/stand_in.hpp"

/// What a library that stands in for a vendor's exports: its own functions, and those of tests.
#define STAND_IN_EXPORT extern "C" __attribute__((visibility("default")))

namespace forcebound::test {

/// The device at the other end of this library's cable, from the first call to the library's end; null: there is none,
/// which standard error says once.
[[nodiscard]] StandIn* device_of_library();

}  // namespace forcebound::test
