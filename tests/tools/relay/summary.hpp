#pragma once

#include <string>

#include "tests/tools/relay/relay.hpp"

namespace forcebound::relay {

/// The summary as text: totals per direction, lateness of packets, and errors, if any.
std::string summary(const Relay& relay);

}  // namespace forcebound::relay
