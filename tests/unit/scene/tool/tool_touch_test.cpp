// What a tool with a shape feels, by closed forms.

#include "forcebound/scene/tool/tool_touch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/meshes.hpp"
#include "tests/unit/scene/tool/tool_scene.hpp"

namespace forcebound::scene {
namespace {

using std::chrono::milliseconds;

Eigen::Quaterniond random_turn(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
}

TEST(ToolTouch, ABoxFlatOnAPlaneTouchesWithFourCornersAndTurnsNothing) {
  const auto scene = scene_with({plane()}, block());
  SceneState state(scene, 3);
  const Answer answer = state.answer(Vector(Point(0, 0, 0.015 - kPressed_m)), Nanoseconds{0}, {}, false,
                                     turned(Eigen::Quaterniond(1, 0, 0, 0)));
  EXPECT_EQ(state.contacts(), 4U);
  EXPECT_NEAR(answer.force[2], 4 * kPush_N_per_m * kPressed_m, 1e-12);
  EXPECT_LT(answer.force.head<2>().norm(), 1e-15);
  EXPECT_LT(answer.torque_N_m.norm(), 1e-15);
  EXPECT_NEAR(answer.penetration_m, kPressed_m, 1e-15);
}

TEST(ToolTouch, ABoxTiltedIntoAPlaneIsTurnedBackByItsCorners) {
  const double tilt_rad = 0.01;
  const Answer answer = touch_at(scene_with({plane()}, block()), {0, 0, 0.015 - kPressed_m},
                                 Eigen::Quaterniond(Eigen::AngleAxisd(tilt_rad, Point::UnitY())));
  // Corners at (+-a, +-b, -c): x = +-a cos - c sin, z = -+a sin - c cos, all of them deeper than the plane.
  const double a = 0.02, c = 0.015, sine = std::sin(tilt_rad), cosine = std::cos(tilt_rad);
  double torque_N_m = 0;
  for (const double side : {-1.0, 1.0}) {
    const double x = side * a * cosine - c * sine;
    const double depth_m = -(0.015 - kPressed_m - side * a * sine - c * cosine);
    torque_N_m -= 2 * x * kPush_N_per_m * depth_m;
  }
  EXPECT_NEAR(answer.torque_N_m[1], torque_N_m, 1e-12);
  EXPECT_LT(torque_N_m, -1e-3) << "against the tilt";
  EXPECT_NEAR(answer.torque_N_m[0], 0, 1e-15);
  EXPECT_NEAR(answer.torque_N_m[2], 0, 1e-15);
}

TEST(ToolTouch, ARodOnAnEdgeIsALever) {
  const double arm_m = 0.06;
  const double radius_m = 0.002;
  const PartDescription ridge =
      pushing("ridge", {"box", {{"center_m", Point(arm_m, 0, -0.01)}, {"size_m", Point(5e-4, 0.02, 0.02)}}});
  const auto rod =
      points_of("capsule", {{"from_m", Point(0, 0, 0)}, {"to_m", Point(0.1, 0, 0)}, {"radius_m", radius_m}}, 0.005);
  const Answer answer = touch_at(scene_with({ridge}, rod), {0, 0, radius_m - kPressed_m});
  const Point force_N(0, 0, kPush_N_per_m * kPressed_m);
  EXPECT_LT((answer.force - force_N).norm(), 1e-12);
  EXPECT_LT((Point(answer.torque_N_m) - Point(arm_m, 0, 0).cross(force_N)).norm(), 1e-12);
}

TEST(ToolTouch, ACylinderInAGrooveIsHeldByBothSides) {
  const double radius_m = 0.01;
  const auto side = [](const std::string& name, double x) {
    return pushing(name, {"half_space", {{"through_m", Point(0, 0, 0)}, {"normal", Point(x, 0, 1)}}});
  };
  const auto rod =
      points_of("capsule", {{"from_m", Point(0, -0.02, 0)}, {"to_m", Point(0, 0.02, 0)}, {"radius_m", radius_m}}, 0.01);
  const auto scene = scene_with({side("left", 1), side("right", -1)}, rod);
  const double half = std::numbers::sqrt2 / 2;
  const double height_m = (radius_m - kPressed_m) / half;
  const Answer answer = touch_at(scene, {0, 0, height_m});
  const double each_N = 5 * kPush_N_per_m * kPressed_m;
  EXPECT_NEAR(answer.force[2], 2 * each_N * half, 1e-10);
  EXPECT_NEAR(answer.force[0], 0, 1e-12);
  EXPECT_LT(answer.torque_N_m.norm(), 1e-12);
  // To one side it is as stiff as one face squared by its slope, twice.
  const double aside_m = 1e-4;
  const double back_N = touch_at(scene, {aside_m, 0, height_m}).force[0];
  EXPECT_NEAR(back_N, -2 * 5 * kPush_N_per_m * half * half * aside_m, 1e-10);
}

struct Case {
  PartDescription object;
  PartDescription larger;  // by the ball's radius
};

TEST(ToolTouch, ABallEqualsThePointWithAnOffsetSurface) {
  const double radius_m = 0.004;
  const std::vector<NamedValues> more{{"friction", {{"static_coefficient", 0.4}}}};
  const auto ball = [&](double r) {
    return pushing("ball", {"sphere", {{"center_m", Point(0, 0, 0)}, {"radius_m", r}}}, more);
  };
  const auto rod = [&](double r) {
    return pushing("rod", {"capsule", {{"from_m", Point(-0.02, 0, 0)}, {"to_m", Point(0.02, 0, 0)}, {"radius_m", r}}},
                   more);
  };
  for (const auto& [object, larger] :
       {Case{ball(0.02), ball(0.02 + radius_m)}, Case{rod(0.01), rod(0.01 + radius_m)}}) {
    SceneState tool(scene_with({object}, {{Point::Zero(), radius_m}}), 3);
    SceneState point(scene_with({larger}, {}), 3);
    std::mt19937_64 random(7);
    for (int i = 0; i < 500; ++i) {
      const double turn = 0.02 * i;
      const Vector at = 0.022 * Point(0.3 * std::cos(turn), std::sin(turn), std::cos(turn));
      const Answer felt = tool.answer(at, milliseconds{i}, {}, false, turned(random_turn(random)));
      const Answer expected = point.answer(at, milliseconds{i});
      EXPECT_LT((felt.force - expected.force).norm(), 1e-9 * (1 + expected.force.norm()));
      EXPECT_LT(felt.torque_N_m.norm(), 1e-15) << "about its middle";
    }
  }
}

/// Shapes of all kinds about the origin, 60 mm large.
std::vector<PartDescription> all_shapes() {
  const std::vector<NamedValues> more{{"friction", {{"static_coefficient", 0.4}}},
                                      {"adhesion", {{"stiffness_N_per_m", 200.0}, {"tear_N", 0.1}}}};
  std::vector<PartDescription> all{plane(more)};
  all.push_back(pushing("ball", {"sphere", {{"center_m", Point(0, 0, 0)}, {"radius_m", 0.03}}}, more));
  all.push_back(pushing("hollow", {"cavity", {{"center_m", Point(0, 0, 0)}, {"radius_m", 0.03}}}, more));
  all.push_back(pushing("box", {"box", {{"center_m", Point(0, 0, 0)}, {"size_m", Point(0.06, 0.05, 0.04)}}}, more));
  const config::Values straight{{"from_m", Point(-0.02, 0, 0)}, {"to_m", Point(0.02, 0, 0.01)}, {"radius_m", 0.01}};
  all.push_back(pushing("capsule", {"capsule", straight}, more));
  all.push_back(pushing("cylinder", {"cylinder", straight}, more));
  all.push_back(pushing("field", {"distance_field", {{"file", std::string("a.obj")}, {"spacing_m", 2e-3}}}, more));
  return all;
}

TEST(ToolTouch, ForceAndTorqueAreTheSumsOverItsPointsOnEveryShape) {
  const std::vector<ToolPoint> points =
      points_of("cylinder", {{"from_m", Point(0, 0, 0)}, {"to_m", Point(0, 0.01, 0.04)}, {"radius_m", 0.01}}, 2e-3);
  ASSERT_GT(points.size(), 500U);
  const ShapeGeometry geometry{.mesh = test::shared_mesh(test::ball(0.03, 12))};
  for (const PartDescription& object : all_shapes()) {
    SCOPED_TRACE(object.name);
    SceneState tool(scene_with({object}, points, geometry), 3);
    const auto alone = scene_with({object}, {}, geometry);
    std::vector<SceneState> each;
    for (std::size_t k = 0; k < points.size(); ++k) each.emplace_back(alone, 3);
    std::size_t contacts = 0;
    for (int i = 0; i < 60; ++i) {
      const double turn = 0.05 * i;
      const Eigen::Quaterniond orientation = control::turn_by(Point(turn, 0.3 * turn, 0.1));
      const Point tip_m = 0.035 * Point(std::cos(turn), 0.5 * std::sin(turn), std::sin(1.7 * turn));
      const Answer felt = tool.answer(Vector(tip_m), milliseconds{i}, {}, false, turned(orientation));
      Point force_N = Point::Zero();
      Point torque_N_m = Point::Zero();
      const Eigen::Matrix3d rotation = control::quaternion_of(control::orientation_of(orientation)).toRotationMatrix();
      for (std::size_t k = 0; k < points.size(); ++k) {
        const Point arm_m = rotation * points[k].at_m;
        const Point one_N = each[k].answer(Vector(tip_m + arm_m), milliseconds{i}).force;
        force_N += one_N;
        torque_N_m += arm_m.cross(one_N);
      }
      EXPECT_LT((felt.force - force_N).norm(), 1e-9 * (1 + force_N.norm())) << i;
      EXPECT_LT((Point(felt.torque_N_m) - torque_N_m).norm(), 1e-9 * (1 + torque_N_m.norm())) << i;
      contacts += tool.contacts();
    }
    EXPECT_GT(contacts, 100U) << "or nothing was compared";
  }
}

TEST(ToolTouch, OfOnePointAtTheTipIsAnOrdinaryPointToTheLastDigit) {
  for (const PartDescription& object : all_shapes()) {
    const ShapeGeometry geometry{.mesh = test::shared_mesh(test::ball(0.03, 12))};
    SceneState tool(scene_with({object}, {{}}, geometry), 3);
    SceneState point(scene_with({object}, {}, geometry), 3);
    for (int i = 0; i < 1000; ++i) {
      const double turn = 0.01 * i;
      const Vector at = Point(0.031 * std::cos(turn), 0.02 * std::sin(3 * turn), 0.03 * std::sin(turn));
      const Answer felt = tool.answer(at, milliseconds{i}, {}, false, turned(control::turn_by(Point(0, turn, 0))));
      EXPECT_EQ(felt.force, point.answer(at, milliseconds{i}).force) << object.name << " " << i;
      EXPECT_TRUE(felt.torque_N_m.isZero(0));
    }
  }
}

TEST(ToolTouch, NoPointPassesThroughAThinWallAtAMetreAndTenRadiansASecond) {
  PartDescription wall = pushing("wall", {"mesh", {{"file", std::string("a.obj")}, {"two_sided", true}}});
  const ShapeGeometry geometry{.mesh = test::shared_mesh(test::square(0.1, 4))};
  const std::vector<ToolPoint> blade =
      points_of("box", {{"center_m", Point(0, 0, 0)}, {"size_m", Point(0.04, 0.04, 0.004)}}, 5e-3);
  // Of one point alone there is no ball about it that reaches further than it goes.
  for (const std::vector<ToolPoint>& points : {blade, {{Point(0.02, 0, 0)}}}) {
    SceneState tool(scene_with({wall}, points, geometry), 3);
    double least_N = 0;
    for (int i = 0; i <= 60; ++i) {
      const double passed_s = 1e-3 * i;
      const Point tip_m(0, 0, 0.0305 - passed_s);
      const Answer felt =
          tool.answer(Vector(tip_m), milliseconds{i}, {}, false, turned(control::turn_by(Point(0, 0, 10 * passed_s))));
      if (tip_m.z() > -0.003) continue;
      EXPECT_EQ(tool.contacts(), points.size()) << "all are behind the wall at " << tip_m.z();
      EXPECT_GT(felt.force[2], least_N);
      least_N = felt.force[2];
    }
    EXPECT_GT(least_N, 0);
  }
}

TEST(ToolTouch, APointThatWentRoundAThinWallComesToItFromItsOtherSide) {
  PartDescription wall = pushing("wall", {"mesh", {{"file", std::string("a.obj")}, {"two_sided", true}}});
  const ShapeGeometry geometry{.mesh = test::shared_mesh(test::square(0.1, 4))};
  SceneState tool(scene_with({wall}, {{Point(0.01, 0, 0)}}, geometry), 3);
  int ticks = 0;
  Answer felt;
  const auto go = [&](const Point& from_m, const Point& to_m) {
    for (int i = 0; i <= 100; ++i) {
      felt = tool.answer(Vector(from_m + 0.01 * i * (to_m - from_m)), milliseconds{++ticks}, {}, false,
                         turned({1, 0, 0, 0}));
      EXPECT_EQ(tool.contacts(), 0U) << ticks;
    }
  };
  const Point above(0, 0, 0.005);
  // It has touched the wall from above, and remembers that until it leaves.
  for (const double height_m : {0.001, -0.001, 0.005})
    felt = tool.answer(Vector(Point(0, 0, height_m)), milliseconds{++ticks}, {}, false, turned({1, 0, 0, 0}));
  const Point beside(0.2, 0, 0);
  go(above, {0, 0, 0.05});
  go({0, 0, 0.05}, beside);
  go(beside, {0, 0, -0.05});
  go({0, 0, -0.05}, -above);
  felt = tool.answer(Vector(above), milliseconds{++ticks}, {}, false, turned({1, 0, 0, 0}));
  EXPECT_EQ(tool.contacts(), 1U);
  EXPECT_NEAR(felt.force[2], -5, 1e-3) << "back to below";
}

TEST(ToolTouch, WithoutAnOrientationItTouchesNothing) {
  SceneState state(scene_with({plane()}, block()), 3);
  const Answer answer = state.answer(Vector(Point(0, 0, -0.01)), Nanoseconds{0});
  EXPECT_TRUE(answer.force.isZero(0));
  EXPECT_TRUE(answer.torque_N_m.isZero(0));
  EXPECT_EQ(state.contacts(), 0U);
}

TEST(ToolTouch, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const ShapeGeometry geometry{.mesh = test::shared_mesh(test::ball(0.03, 12))};
  std::vector<PartDescription> objects = all_shapes();
  objects.push_back(pushing("mesh", {"mesh", {{"file", std::string("a.obj")}}}));
  const auto scene = scene_with(
      objects, points_of("box", {{"center_m", Point(0, 0, 0)}, {"size_m", Point(0.04, 0.02, 0.03)}}, 2e-3), geometry);
  SceneState state(scene, 3);
  double sum_N = 0;
  std::uint64_t operations = 0;
  {
    const test::AllocationGuard guard;
    for (int i = 0; i < 300; ++i) {
      const Point tip_m(0.05 * std::cos(0.05 * i), 0, 0.05 * std::sin(0.05 * i));
      sum_N +=
          state.answer(tip_m, milliseconds{i}, {}, false, turned(control::turn_by(Point(0.01 * i, 0, 0)))).force.norm();
    }
    operations = guard.heap_operations();
  }
  EXPECT_GT(sum_N, 1);
  EXPECT_EQ(operations, 0U);
}

TEST(Tool, RefusesWhatIsNoneForAHand) {
  EXPECT_THROW(Tool({}), std::invalid_argument);
  EXPECT_THROW(Tool({{Point(0.6, 0, 0)}}), std::invalid_argument);
  EXPECT_THROW(Tool({{Point(0.3, 0, 0), 0.3}}), std::invalid_argument);
  EXPECT_THROW(Tool({{Point(0, 0, 0), -1e-3}}), std::invalid_argument);
  EXPECT_THROW(Tool({{Point(NAN, 0, 0)}}), std::invalid_argument);
  EXPECT_THROW(Tool(std::vector<ToolPoint>(kToolPointsMost + 1)), std::invalid_argument);
}

}  // namespace
}  // namespace forcebound::scene
