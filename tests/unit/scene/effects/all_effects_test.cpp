#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

#include "forcebound/scene/registry.hpp"
#include "tests/support/effect_probe.hpp"

namespace forcebound::scene {
namespace {

/// The presets, or 1 for a number that has none, or where `all` says so.
Values values_for(const EffectKind& kind, bool all) {
  Values values;
  for (const Parameter& parameter : kind.parameters) {
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
  const Registry registry = Registry::standard();
  for (const EffectKind& kind : registry.effects()) {
    const auto effect = made(kind);
    test::EffectProbe felt(*effect);
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

/// Beside and within a surface through the origin, its normal along x.
Probe probe_at(const Point& position_m, const Point& velocity_m_per_s) {
  return {.position_m = position_m,
          .velocity_m_per_s = velocity_m_per_s,
          .interval_s = 1e-3,
          .normal = Point::UnitX(),
          .penetration_m = -position_m.x(),
          .pressure_N = 1};
}

TEST(AllEffects, AreNoSteeperThanTheyTellExplain) {
  constexpr double kStep_m = 1e-7;
  constexpr double kStep_m_per_s = 1e-5;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(-1, 1);
  const auto point = [&](double size) {
    return Point(size * share(random), size * share(random), size * share(random));
  };
  const Registry registry = Registry::standard();
  for (const EffectKind& kind : registry.effects()) {
    const auto effect = made(kind);
    const EffectFacts facts = effect->facts();
    const auto force_N = [&](const Point& position_m, const Point& velocity_m_per_s) {
      return test::EffectProbe(*effect)(probe_at(position_m, velocity_m_per_s)).force_N;
    };
    for (int i = 0; i < 2000; ++i) {
      const Point at_m = point(i % 2 == 0 ? 0.01 : 2);
      const Point moving_m_per_s = point(0.28);
      const Point way = point(1).normalized();
      const double over_way_N_per_m =
          (force_N(at_m + kStep_m * way, Point::Zero()) - force_N(at_m, Point::Zero())).norm() / kStep_m;
      const double over_speed_N_s_per_m =
          (force_N(at_m, moving_m_per_s + kStep_m_per_s * way) - force_N(at_m, moving_m_per_s)).norm() / kStep_m_per_s;
      const double reported_N_per_m =
          facts.stiffness_N_per_m + facts.stiffening_N_per_m2 * std::max(0.0, -at_m.x() + kStep_m);
      EXPECT_LE(over_way_N_per_m, reported_N_per_m * 1.001 + 1e-4) << kind.name << " at " << at_m.transpose();
      EXPECT_LE(over_speed_N_s_per_m, facts.damping_N_s_per_m * 1.001 + 1e-6) << kind.name;
    }
  }
}

TEST(AllEffects, SayWhichOfThemDrive) {
  const Registry registry = Registry::standard();
  for (const EffectKind& kind : registry.effects()) {
    // Flow drives where there is a stream, as there is with a 1 for everything.
    const bool drives = made(kind)->facts().drives;
    const bool should =
        kind.name == "drive" || kind.name == "vibration" || kind.name == "flow" || kind.name == "texture";
    EXPECT_EQ(drives, should) << kind.name;
  }
}

}  // namespace
}  // namespace forcebound::scene
