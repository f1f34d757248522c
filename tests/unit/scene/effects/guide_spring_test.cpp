#include "forcebound/scene/effects/guide_spring.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "forcebound/scene/effects/spring_to_line.hpp"
#include "forcebound/scene/effects/spring_to_plane.hpp"
#include "forcebound/scene/effects/spring_to_point.hpp"
#include "tests/support/field_checks.hpp"
#include "tests/support/random_points.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::scene {
namespace {

using test::kInfinity;

struct Spring {
  double damping_N_s_per_m = 0;
  double radius_m = 0;
  double force_N_max = kInfinity;
};

/// K = 200 N/m.
Values values(const Spring& spring) {
  return {{"stiffness_N_per_m", 200.0},
          {"damping_N_s_per_m", spring.damping_N_s_per_m},
          {"radius_m", spring.radius_m},
          {"force_N_max", spring.force_N_max}};
}

const Point kThrough(0.01, 0.02, -0.01);
const Point kDirection(0.6, 0, 0.8);

struct Guide {
  std::string name;
  std::unique_ptr<Effect> (*make)(const Spring& spring);
  Point out;     ///< a unit vector away from the guide
  Point within;  ///< one along it; zero: there is none
};

std::unique_ptr<Effect> make_point(const Spring& spring) {
  Values all = values(spring);
  all.set("center_m", kThrough);
  return spring_to_point_effect().make(all);
}

std::unique_ptr<Effect> make_line(const Spring& spring) {
  Values all = values(spring);
  all.set("through_m", kThrough);
  all.set("direction", kDirection);
  return spring_to_line_effect().make(all);
}

std::unique_ptr<Effect> make_plane(const Spring& spring) {
  Values all = values(spring);
  all.set("through_m", kThrough);
  all.set("normal", kDirection);
  return spring_to_plane_effect().make(all);
}

class EveryGuide : public testing::TestWithParam<Guide> {
 protected:
  static std::unique_ptr<Effect> guide(const Spring& spring) { return GetParam().make(spring); }

  /// So far away from the guide, and anywhere along it.
  static Probe away(double out_m, const Point& velocity_m_per_s = Point::Zero()) {
    return {.position_m = kThrough + out_m * GetParam().out + 3 * GetParam().within,
            .velocity_m_per_s = velocity_m_per_s};
  }
};

TEST_P(EveryGuide, PullsBackLikeASpring) {
  EXPECT_LT((test::force_N(*guide({}), away(0.01)) - -2 * GetParam().out).norm(), 1e-12);
  EXPECT_LT((test::force_N(*guide({}), away(-0.01)) - 2 * GetParam().out).norm(), 1e-12);
}

TEST_P(EveryGuide, IsZeroOnTheGuide) {
  for (const Point& along : {Point(Point::Zero()), GetParam().within}) {
    const Probe probe{.position_m = kThrough + along};
    EXPECT_LT(test::force_N(*guide({}), probe).norm(), 1e-12);
  }
  EXPECT_EQ(test::force_N(*guide({.damping_N_s_per_m = 5}), {.position_m = kThrough}), Point(0, 0, 0));
}

TEST_P(EveryGuide, LeavesTheDeadZoneAlone) {
  const Spring spring{.damping_N_s_per_m = 5, .radius_m = 0.004};
  EXPECT_EQ(test::force_N(*guide(spring), away(0.003, {1, 2, 3})), Point(0, 0, 0));
  EXPECT_LT((test::force_N(*guide(spring), away(0.014)) - -2 * GetParam().out).norm(), 1e-12);
}

TEST_P(EveryGuide, DampsTheMotionAwayAndNotAlong) {
  const auto effect = guide({.damping_N_s_per_m = 5});
  EXPECT_LT((test::force_N(*effect, away(0.01, 0.1 * GetParam().out)) - -2.5 * GetParam().out).norm(), 1e-12);
  EXPECT_LT((test::force_N(*effect, away(0.01, 7 * GetParam().within)) - -2 * GetParam().out).norm(), 1e-12);
}

TEST_P(EveryGuide, LimitsTheSpringAndTheDamperEachToTheMost) {
  const auto effect = guide({.damping_N_s_per_m = 5, .force_N_max = 1.5});
  EXPECT_LT((test::force_N(*effect, away(0.5)) - -1.5 * GetParam().out).norm(), 1e-12);
  EXPECT_LT((test::force_N(*effect, away(0.5, 100 * GetParam().out)) - -3 * GetParam().out).norm(), 1e-12);
  EXPECT_LT(test::force_N(*effect, away(0.5, -100 * GetParam().out)).norm(), 1e-12);
}

TEST_P(EveryGuide, ReturnsNoEnergyAroundALoop) {
  for (const Spring& spring : {Spring{}, Spring{.radius_m = 0.03, .force_N_max = 2}}) {
    EXPECT_LT(test::work_around(*guide(spring), test::crooked_loop(kThrough)).share(), 1e-7);
  }
}

TEST_P(EveryGuide, DamperTakesEnergyOnly) {
  const auto effect = guide({.damping_N_s_per_m = 5, .radius_m = 0.01, .force_N_max = 1.5});
  ASSERT_TRUE(rc::check([&] {
    Probe probe{.position_m = test::draw_point(0.1)};
    const Point at_rest = test::force_N(*effect, probe);
    probe.velocity_m_per_s = test::draw_point(10);
    RC_ASSERT((test::force_N(*effect, probe) - at_rest).dot(probe.velocity_m_per_s) <= 1e-12);
  }));
}

TEST_P(EveryGuide, LooksAtVelocityOnlyIfItDampsAndStatesItsStiffness) {
  EXPECT_FALSE(guide({})->facts().inputs.velocity);
  EXPECT_TRUE(guide({.damping_N_s_per_m = 0.1})->facts().inputs.velocity);
  EXPECT_EQ(guide({})->facts().stiffness_N_per_m, 200);
}

INSTANTIATE_TEST_SUITE_P(GuideSpring, EveryGuide,
                         testing::Values(Guide{"point", make_point, {0, 0.6, 0.8}, {0, 0, 0}},
                                         Guide{"line", make_line, {0.8, 0, -0.6}, {0.6, 0, 0.8}},
                                         Guide{"plane", make_plane, {0.6, 0, 0.8}, {0.8, 0, -0.6}}),
                         [](const auto& guide) { return guide.param.name; });

TEST(GuideSpring, AddsItsParametersToThoseOfTheGuide) {
  for (const EffectKind& kind : {spring_to_point_effect(), spring_to_line_effect(), spring_to_plane_effect()}) {
    const auto has = [&](std::string_view key) {
      return std::any_of(kind.parameters.begin(), kind.parameters.end(),
                         [key](const Parameter& parameter) { return key_of(parameter) == key; });
    };
    for (const auto* const key : {"stiffness_N_per_m", "damping_N_s_per_m", "radius_m", "force_N_max"}) {
      EXPECT_TRUE(has(key)) << kind.name << " " << key;
    }
    EXPECT_EQ(kind.place, EffectPlace::space);
  }
}

}  // namespace
}  // namespace forcebound::scene
