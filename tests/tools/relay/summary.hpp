#pragma once

#include <string>

#include "tests/tools/relay/relay.hpp"

namespace forcebound::relay {

/// What happened, for people: totals per direction, how late packets left, and what went wrong, if anything.
std::string summary(const Relay& relay);

}  // namespace forcebound::relay
