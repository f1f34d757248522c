#pragma once

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "forcebound/scene/registry.hpp"

namespace forcebound::test {

/// Values that an effect accepts, whichever it is: 1 for each number that must be given, or for all of them where what
/// is left out contradicts itself; likewise a point of ones.
inline config::Values plain_values(const scene::EffectKind& kind) {
  for (const bool all : {false, true}) {
    config::Values values;
    for (const config::Parameter& parameter : kind.parameters) {
      if (config::may_be_left_out(parameter) && !all) continue;
      if (const auto* number = std::get_if<config::NumberParameter>(&parameter))
        values.set(number->key, std::min(1.0, number->most));
      if (const auto* point = std::get_if<config::PointParameter>(&parameter))
        values.set(point->key, scene::Point(scene::Point::Ones()));
    }
    try {
      (void)kind.make(config::completed(kind.parameters, values));
      return values;
    } catch (const std::invalid_argument&) {
      if (all) throw;
    }
  }
  return {};
}

}  // namespace forcebound::test
