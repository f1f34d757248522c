#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>

#include "forcebound/scene/registry.hpp"
#include "tests/support/effect_probe.hpp"
#include "tests/support/plain_values.hpp"

namespace forcebound::scene {
namespace {

std::unique_ptr<Effect> made(const EffectKind& kind) {
  return kind.make(config::completed(kind.parameters, test::plain_values(kind)));
}

using config::Value;

/// Both ends of what is accepted.
std::vector<Value> ends_of(const NumberParameter& number) {
  constexpr double kMost = std::numeric_limits<double>::max();
  return {number.least_excluded ? std::nextafter(number.least, kMost) : std::max(number.least, -kMost),
          std::min(number.most, kMost)};
}

std::vector<Value> ends_of(const Parameter& parameter) {
  std::vector<Value> ends;
  if (const auto* number = std::get_if<NumberParameter>(&parameter)) {
    ends = ends_of(*number);
  } else if (const auto* point = std::get_if<PointParameter>(&parameter)) {
    if (point->is_direction) return {Point(Point::UnitX()), Point(Point::Ones())};
    for (const Value& end : ends_of(point->each)) ends.emplace_back(Point(Point::Constant(std::get<double>(end))));
  } else {
    for (const auto choice : std::get<ChoiceParameter>(parameter).choices) ends.emplace_back(std::string(choice));
  }
  return ends;
}

/// Every combination of the parameters' ends, and of leaving out those that may be.
std::vector<Values> extremes_of(const EffectKind& kind) {
  std::vector<Values> all(1);
  for (const Parameter& parameter : kind.parameters) {
    std::vector<Values> longer;
    if (config::may_be_left_out(parameter)) longer = all;
    for (const Value& end : ends_of(parameter)) {
      for (Values& values : std::vector(all)) {
        values.set(config::key_of(parameter), end);
        longer.push_back(std::move(values));
      }
    }
    all = std::move(longer);
  }
  return all;
}

/// Null: the values contradict each other.
std::unique_ptr<Effect> made_of(const EffectKind& kind, const Values& values) {
  try {
    return kind.make(config::completed(kind.parameters, values));
  } catch (const std::invalid_argument&) {
    return nullptr;
  }
}

void expect_finite(const Effect& effect) {
  const EffectFacts facts = effect.facts();
  EXPECT_TRUE(std::isfinite(facts.stiffness_N_per_m + facts.stiffening_N_per_m2 + facts.damping_N_s_per_m));
  test::EffectProbe felt(effect);
  for (const double far_m : {0.0, 5e-324, 1e-200, 1e-9, 1.0, 1e9}) {
    for (const double fast_m_per_s : {0.0, 1e-300, 1e6}) {
      const Probe probe{.position_m = Point::Constant(far_m),
                        .velocity_m_per_s = Point::Constant(-fast_m_per_s),
                        .time_s = 1e6 * far_m,
                        .interval_s = 1e-3,
                        .penetration_m = far_m,
                        .pressure_N = 1,
                        .handle = {.buttons = 1}};
      const Reaction reaction = felt(probe);
      EXPECT_TRUE(reaction.force_N.allFinite()) << far_m << " m, " << fast_m_per_s << " m/s";
      for (const Point& wave : reaction.texture.waves_rad_per_m) EXPECT_TRUE(wave.allFinite());
    }
  }
}

TEST(AllEffects, AreFiniteFromTheOriginToFarOutAtAnySpeedWithAllThatIsAccepted) {
  const Registry registry = Registry::standard();
  for (const EffectKind& kind : registry.effects()) {
    int accepted = 0;
    for (const Values& values : extremes_of(kind)) {
      const auto effect = made_of(kind, values);
      if (!effect) continue;
      ++accepted;
      expect_finite(*effect);
      ASSERT_FALSE(HasFailure()) << kind.name << ": " << config::to_text(kind.parameters, values);
    }
    EXPECT_GT(accepted, 0) << kind.name;
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

struct Around {
  double center_m;  ///< along the normal of the surface: within it if below 0
  double begin_rad;
};

/// Energy that it returns to a device moved once around a circle, a second long.
double returned_J(const Effect& effect, const Around& circle) {
  constexpr int kSteps = 1000;
  constexpr double kRadius_m = 0.01;
  constexpr double kStep_rad = 2 * std::numbers::pi / kSteps;
  test::EffectProbe felt(effect);
  double sum_J = 0;
  std::optional<Probe> before;
  Point before_N = Point::Zero();
  for (int step = 0; step <= kSteps; ++step) {
    const double angle_rad = circle.begin_rad + step * kStep_rad;
    const Point along(std::cos(angle_rad), std::sin(angle_rad), 0);
    Probe probe = probe_at(circle.center_m * Point::UnitX() + kRadius_m * along,
                           2 * std::numbers::pi * kRadius_m * Point(-along.y(), along.x(), 0));
    probe.time_s = 1e-3 * step;
    probe.handle.buttons = 1;
    const Point now_N = felt(probe).force_N;
    if (before) sum_J += (before_N + now_N).dot(probe.position_m - before->position_m) / 2;
    before = probe;
    before_N = now_N;
  }
  return sum_J;
}

TEST(AllEffects, DriveIfTheyReturnEnergyAroundACircle) {
  const Registry registry = Registry::standard();
  int driving = 0;
  for (const EffectKind& kind : registry.effects()) {
    const auto effect = made(kind);
    double most_J = 0;
    for (const double center_m : {-0.02, 0.02}) {
      for (const double begin_rad : {0.0, 1.5, 3.0, 4.5}) {
        most_J = std::max(most_J, returned_J(*effect, {center_m, begin_rad}));
      }
    }
    if (most_J < 1e-6) continue;
    ++driving;
    EXPECT_TRUE(effect->facts().drives) << kind.name << " returns " << most_J << " J";
  }
  EXPECT_GE(driving, 2) << "drive and vibration";
}

}  // namespace
}  // namespace forcebound::scene
