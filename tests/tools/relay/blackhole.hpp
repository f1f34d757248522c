#pragma once

#include <string>

#include "tests/tools/netem/impairment.hpp"

namespace forcebound::relay {

/// "up:5-65": a direction that is dead, from and until, in seconds since the relay's start. "both" is up and down.
struct BlackholeOption {
  bool up = false;
  bool down = false;
  netem::Blackhole when;
};

/// @throws std::invalid_argument with the text and what would be accepted
BlackholeOption parse_blackhole(const std::string& text);

}  // namespace forcebound::relay
