// Cases 24, 27 and 28 for shapes with a closed form: corners, places without a nearest direction, and any scale.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "forcebound/scene/geometry/capsule.hpp"
#include "forcebound/scene/geometry/cylinder.hpp"
#include "forcebound/scene/geometry/height_field.hpp"
#include "forcebound/scene/geometry/torus.hpp"
#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/support/shape_checks.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::server {
namespace {

using test::vector_of;

constexpr double kPlane_N_per_m = 1000;

std::string plane_object(const std::string& name, const std::string& normal) {
  return "[[object]]\nname = '" + name + "'\nshape = { kind = 'half_space', through_m = [0, 0, 0], normal = " + normal +
         " }\neffects = ['surface']\nsurface = { stiffness_N_per_m = 1000 }\n";
}

std::shared_ptr<const scene::Scene> two_planes(const std::string& first, const std::string& second) {
  return parse_scene("[scene]\nname = 'x'\ndescription = ''\ndegrees_of_freedom = 3\n" + plane_object("first", first) +
                         plane_object("second", second),
                     "x.toml");
}

class Feeler {
 public:
  explicit Feeler(const std::shared_ptr<const scene::Scene>& scene) : state_(scene, 3) {}

  scene::Point operator()(const scene::Point& position_m) {
    const scene::Answer answer = state_.answer(position_m, time::Nanoseconds{0});
    return answer.force;
  }

 private:
  scene::SceneState state_;
};

TEST(HardCase24, BothWallsOfAConcaveCornerPushEachAsIfAlone) {
  Feeler corner(two_planes("[0, 0, 1]", "[1, 0, 0]"));
  EXPECT_LT((corner({-0.002, 5, -0.003}) - scene::Point(2, 0, 3)).norm(), 1e-12);
  EXPECT_LT((corner({0.002, 5, -0.003}) - scene::Point(0, 0, 3)).norm(), 1e-12);
  EXPECT_EQ(corner({0.002, 5, 0.003}), scene::Point(0, 0, 0));
}

TEST(HardCase24, ForceInAConcaveCornerIsContinuous) {
  Feeler corner(two_planes("[0, 0, 1]", "[1, 0, 0]"));
  constexpr double kStep_m = 1e-6;
  // Around the corner, along a small circle through both walls and the free space.
  scene::Point last = corner({0.003, 0, 0});
  for (double angle = 0; angle < 2 * std::numbers::pi; angle += kStep_m / 0.003) {
    const scene::Point force = corner({0.003 * std::cos(angle), 0, 0.003 * std::sin(angle)});
    ASSERT_LE((force - last).norm(), 1.01 * kPlane_N_per_m * kStep_m) << angle;
    last = force;
  }
}

TEST(HardCase24, PlanesATenthOfADegreeApartAddTheirForcesWithoutChatter) {
  // Normals [-+sin 0.05 deg, 0, cos 0.05 deg].
  const double half = 0.05 * std::numbers::pi / 180;
  Feeler planes(
      two_planes("[-8.726645152351496e-4, 0, 0.9999996192282494]", "[8.726645152351496e-4, 0, 0.9999996192282494]"));
  constexpr double kStep_m = 1e-6;
  scene::Point last = planes({-0.01, 0, -0.001});
  for (double x = -0.01; x < 0.01; x += kStep_m) {
    const scene::Point force = planes({x, 0, -0.001});
    // Two springs, each as deep as its own plane says.
    const double left_m = 0.001 * std::cos(half) + x * std::sin(half);
    const double right_m = 0.001 * std::cos(half) - x * std::sin(half);
    ASSERT_NEAR(force.z(), kPlane_N_per_m * (left_m + right_m) * std::cos(half), 1e-9) << x;
    ASSERT_NEAR(force.x(), kPlane_N_per_m * (right_m - left_m) * std::sin(half), 1e-9) << x;
    ASSERT_LE((force - last).norm(), 2.01 * kPlane_N_per_m * kStep_m) << x;
    last = force;
  }
}

struct Case {
  std::string name;
  std::unique_ptr<scene::Shape> (*make)(const scene::Point& at, double scale);
  /// A place without a nearest direction and how deep it is, at scale 1; zero: there is a direction everywhere.
  scene::Point without_direction = scene::Point::Zero();
  double depth_m = 0;
};

scene::HeightGrid hills(const scene::Point& at, double scale) {
  // At that distance, a larger difference is not rounding.
  scene::HeightGrid grid{
      .origin_m = at - scale * scene::Point(0.03125, 0.03125, 0), .spacing_m = 0.015625 * scale, .columns = 5};
  for (int i = 0; i < 25; ++i) grid.heights_m.push_back(0.003 * scale * std::sin(i));
  return grid;
}

const std::vector<Case>& cases() {
  static const std::vector<Case> kAll = {
      {"half_space",
       [](const scene::Point& at, double) {
         return scene::make_half_space(at, {1, 2, 3});
       },
       {0, 0, 0},
       0},
      {"sphere",
       [](const scene::Point& at, double scale) { return scene::make_sphere(at, 0.03 * scale); },
       {0, 0, 0},
       0.03},
      {"cavity",
       [](const scene::Point& at, double scale) { return scene::make_cavity(at, 0.03 * scale); },
       {0, 0, 0},
       -0.03},
      {"box",
       [](const scene::Point& at, double scale) { return scene::make_box(at, scale * scene::Point(0.06, 0.05, 0.04)); },
       {},
       0},
      {"capsule",
       [](const scene::Point& at, double scale) {
         return scene::make_capsule(at - scale * scene::Point(0.02, 0, 0.01), at + scale * scene::Point(0.02, 0, 0.01),
                                    0.02 * scale);
       },
       {0.004, 0, 0.002},
       0.02},
      {"cylinder",
       [](const scene::Point& at, double scale) {
         return scene::make_cylinder(at - scale * scene::Point(0.03, 0, 0.04), at + scale * scene::Point(0.03, 0, 0.04),
                                     0.02 * scale);
       },
       {0.003, 0, 0.004},
       0.02},
      {"torus",
       [](const scene::Point& at, double scale) {
         return scene::make_torus(at, {0, 0, 1}, 0.03 * scale, 0.01 * scale);
       },
       {0.03, 0, 0},
       0.01},
      {"height_field",
       [](const scene::Point& at, double scale) { return scene::make_height_field(hills(at, scale)); },
       {},
       0}};
  return kAll;
}

class Shapes : public testing::TestWithParam<std::size_t> {
 protected:
  static const Case& shape() { return cases()[GetParam()]; }
  static std::unique_ptr<scene::Shape> make(const scene::Point& at, double scale) { return shape().make(at, scale); }
};

class HardCase27 : public Shapes {};

TEST_P(HardCase27, WhereNoDirectionIsNearestTheLastValidOneCountsAndIsFlagged) {
  const auto made = make(scene::Point::Zero(), 1);
  test::KeptNormal kept;
  // From above, which is more across than along the axis of each.
  const scene::SurfacePoint before = made->nearest(shape().without_direction + scene::Point(0, 0, 1e-3), kept.bytes());
  ASSERT_FALSE(before.normal_is_old);
  const scene::SurfacePoint there = made->nearest(shape().without_direction, kept.bytes());
  EXPECT_TRUE(there.normal_is_old);
  EXPECT_NEAR(there.penetration_m, shape().depth_m, 1e-15);
  EXPECT_GT(there.normal.dot(before.normal), 0.8);
  EXPECT_NEAR(there.normal.norm(), 1, 1e-15);
}

TEST_P(HardCase27, ANewSessionGetsAUnitNormalThereToo) {
  const auto made = make(scene::Point::Zero(), 1);
  const scene::SurfacePoint there = test::nearest(*made, shape().without_direction);
  EXPECT_NEAR(there.normal.norm(), 1, 1e-15);
  EXPECT_TRUE(std::isfinite(there.penetration_m));
}

class HardCase28 : public Shapes {};

TEST_P(HardCase28, AnswersTheSameAtAnyScale) {
  std::mt19937_64 random(28);
  std::uniform_real_distribution<double> place(-0.05, 0.05);
  const auto unit = make(scene::Point::Zero(), 1);
  for (const double scale : {1e-6, 1e-4, 1e-2, 1e2, 1e4, 1e6}) {
    const auto scaled = make(scene::Point::Zero(), scale);
    for (int i = 0; i < 1000; ++i) {
      const scene::Point p(place(random), place(random), place(random));
      const scene::SurfacePoint expected = test::nearest(*unit, p);
      const scene::SurfacePoint found = test::nearest(*scaled, scale * p);
      ASSERT_NEAR(found.penetration_m / scale, expected.penetration_m, 1e-9 * 0.05) << scale;
      ASSERT_LT((found.normal - expected.normal).norm(), 1e-9) << scale;
      ASSERT_EQ(found.normal_is_old, expected.normal_is_old);
    }
  }
}

TEST_P(HardCase28, AnswersTheSameTenKilometresAway) {
  std::mt19937_64 random(28);
  std::uniform_real_distribution<double> place(-0.05, 0.05);
  const scene::Point far(1e4, -1e4, 1e4);
  const auto here = make(scene::Point::Zero(), 1);
  const auto there = make(far, 1);
  for (int i = 0; i < 1000; ++i) {
    // A place so far away is known to 2e-12 m; this is what is left of the one drawn.
    const scene::Point given = far + scene::Point(place(random), place(random), place(random));
    const scene::SurfacePoint expected = test::nearest(*here, given - far);
    const scene::SurfacePoint found = test::nearest(*there, given);
    ASSERT_NEAR(found.penetration_m, expected.penetration_m, 1e-9 * 0.05) << i;
    ASSERT_LT((found.normal - expected.normal).norm(), 1e-9) << i;
  }
}

std::string name_of(const testing::TestParamInfo<std::size_t>& shape) { return cases()[shape.param].name; }

std::vector<std::size_t> without_a_direction() {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < cases().size(); ++i) {
    if (cases()[i].depth_m != 0) found.push_back(i);
  }
  return found;
}

INSTANTIATE_TEST_SUITE_P(EveryShape, HardCase27, testing::ValuesIn(without_a_direction()), name_of);
INSTANTIATE_TEST_SUITE_P(EveryShape, HardCase28, testing::Range(std::size_t{0}, cases().size()), name_of);

}  // namespace
}  // namespace forcebound::server
