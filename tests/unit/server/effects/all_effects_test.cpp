#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "forcebound/server/effects/registry.hpp"
#include "tests/support/effect_probe.hpp"

namespace forcebound::server {
namespace {

/// The presets, or 1 for a number that has none, or where `all` says so.
EffectValues values_for(const EffectKind& kind, bool all) {
  EffectValues values;
  for (const EffectParameter& parameter : kind.parameters) {
    if (const auto* number = std::get_if<NumberParameter>(&parameter)) {
      values.set(number->key, number->preset && !all ? *number->preset : std::min(1.0, number->most));
    } else if (const auto* point = std::get_if<PointParameter>(&parameter)) {
      values.set(point->key, point->preset.value_or(Point::UnitY()));
    } else {
      values.set(key_of(parameter), std::string(std::get<ChoiceParameter>(parameter).choices.front()));
    }
  }
  return values;
}

/// With its presets, unless some of them say that the scene must choose.
std::unique_ptr<Effect> made(const EffectKind& kind) {
  try {
    return kind.make(values_for(kind, false));
  } catch (const std::invalid_argument&) {
    return kind.make(values_for(kind, true));
  }
}

TEST(AllEffects, AreFiniteFromTheOriginToFarOutAtAnySpeed) {
  const EffectRegistry registry = EffectRegistry::standard();
  for (const EffectKind& kind : registry.kinds()) {
    const auto effect = made(kind);
    test::Felt felt(*effect);
    for (const double far_m : {0.0, 5e-324, 1e-9, 1.0, 1e9}) {
      for (const double fast_m_per_s : {0.0, 1e-300, 1e6}) {
        const Probe probe{.position_m = Point::Constant(far_m),
                          .velocity_m_per_s = Point::Constant(-fast_m_per_s),
                          .time_s = 1e6 * far_m,
                          .interval_s = 1e-3,
                          .penetration_m = far_m,
                          .pressure_N = 1};
        EXPECT_TRUE(felt(probe).force_N.allFinite()) << kind.name << " at " << far_m;
      }
    }
    EXPECT_FALSE(kind.law.empty() || kind.purpose.empty()) << kind.name;
  }
}

}  // namespace
}  // namespace forcebound::server
