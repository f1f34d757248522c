// What a tool feels that is simulated as a body which stays outside, by closed forms.

#include "forcebound/scene/tool/tool_proxy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/meshes.hpp"
#include "tests/unit/scene/tool/tool_scene.hpp"

namespace forcebound::scene {
namespace {

using std::chrono::milliseconds;

std::shared_ptr<const Scene> constrained(const std::vector<PartDescription>& objects,
                                         const std::vector<ToolPoint>& tool, const ShapeGeometry& geometry = {}) {
  return scene_with(objects, tool, geometry, ToolContact::constraint);
}

/// How deep the points of the simulated tool are in an object at most [m].
double depth_m(const SceneState& state, const Scene& scene) {
  double deepest_m = -1;
  for (const PlanStep& step : scene.plan().steps()) {
    for (const ToolPoint& point : scene.facts().tool->points()) {
      std::vector<double> fresh(16 + step.near_state - step.shape_state);
      const SurfacePoint found =
          step.shape->nearest(*state.simulated_tool() * point.at_m, reinterpret_cast<std::byte*>(fresh.data()));
      deepest_m = std::max(deepest_m, found.penetration_m + point.radius_m);
    }
  }
  return deepest_m;
}

TEST(ToolProxy, ABoxFlatOnAPlaneIsAsStiffAsOnePointHoweverManyTouch) {
  for (const double spacing_m : {0.05, 0.004}) {
    SceneState state(constrained({plane()}, block(spacing_m)), 3);
    const Answer answer = felt_at(state, 0, {0, 0, 0.015 - kPressed_m});
    EXPECT_NEAR(answer.force[2], kPush_N_per_m * kPressed_m, 1e-7);
    EXPECT_LT(answer.force.head<2>().norm(), 1e-12);
    EXPECT_LT(answer.torque_N_m.norm(), 1e-8);
  }
}

TEST(ToolProxy, ABoxPressedFlatIsTurnedBackByASpringOfItsSpread) {
  for (const double tilt_rad : {1e-3, -4e-3, 1e-2}) {
    const auto scene = constrained({plane()}, block());
    SceneState state(scene, 3);
    const Answer answer =
        felt_at(state, 0, {0, 0, 0.015 - kPressed_m}, Eigen::Quaterniond(Eigen::AngleAxisd(tilt_rad, Point::UnitY())));
    EXPECT_NEAR(answer.force[2], kPush_N_per_m * kPressed_m, 1e-7);
    EXPECT_NEAR(answer.torque_N_m[1], -kPush_N_per_m * std::pow(scene->facts().tool->spread_m(), 2) * tilt_rad, 1e-6);
    EXPECT_LT(depth_m(state, *scene), 1e-7);
  }
}

TEST(ToolProxy, ARodOnAnEdgeIsALever) {
  const double arm_m = 0.06;
  const double radius_m = 0.002;
  const PartDescription ridge =
      pushing("ridge", {"box", {{"center_m", Point(arm_m, 0, -0.01)}, {"size_m", Point(5e-4, 0.02, 0.02)}}});
  const auto rod =
      points_of("capsule", {{"from_m", Point(0, 0, 0)}, {"to_m", Point(0.1, 0, 0)}, {"radius_m", radius_m}}, 0.005);
  const auto scene = constrained({ridge}, rod);
  SceneState state(scene, 3);
  const double pressed_m = 1e-4;
  (void)felt_at(state, 0, {0, 0, radius_m});
  const Answer answer = felt_at(state, 1, {0, 0, radius_m - pressed_m});
  // One point about whose middle it gives way in both: l (1 + (r x n)^2 / rho^2) = d.
  const Tool& tool = *scene->facts().tool;
  const double lever_m = arm_m - tool.centre_m().x();
  const double share_m = pressed_m / (1 + std::pow(lever_m / tool.spread_m(), 2));
  EXPECT_NEAR(answer.force[2], kPush_N_per_m * share_m, 1e-3 * kPush_N_per_m * share_m);
  EXPECT_NEAR(answer.torque_N_m[1], -arm_m * answer.force[2], 1e-3 * arm_m * answer.force[2]);
}

TEST(ToolProxy, ABallEqualsThePointWithAnOffsetSurface) {
  const double radius_m = 0.004;
  const std::vector<NamedValues> more{{"friction", {{"static_coefficient", 0.4}}}};
  const auto ball = [&](double r) {
    return pushing("ball", {"sphere", {{"center_m", Point(0, 0, 0)}, {"radius_m", r}}}, more);
  };
  SceneState tool(constrained({ball(0.02)}, {{Point::Zero(), radius_m}}), 3);
  SceneState point(scene_with({ball(0.02 + radius_m)}, {}), 3);
  double most_N = 0;
  for (int i = 0; i < 2000; ++i) {
    const double turn = 0.003 * i;
    const Point at_m = 0.0232 * Point(0.3 * std::cos(turn), std::sin(turn), std::cos(turn)).normalized();
    const Answer felt = felt_at(tool, i, at_m, control::turn_by(Point(turn, 0, 0)));
    const Answer expected = point.answer(Vector(at_m), milliseconds{i});
    EXPECT_LT((felt.force - expected.force).norm(), 1e-6 * (1 + expected.force.norm())) << i;
    EXPECT_LT(felt.torque_N_m.norm(), 1e-8) << "about its middle";
    most_N = std::max(most_N, expected.force.norm());
  }
  EXPECT_GT(most_N, 0.5);
}

TEST(ToolProxy, ForceAndTorqueDoNoWorkOnAWayThatEndsWhereItBegan) {
  const PartDescription ball = pushing("ball", {"sphere", {{"center_m", Point(0, 0, 0)}, {"radius_m", 0.03}}});
  SceneState state(constrained({ball}, block(0.01)), 3);
  constexpr int kSteps = 20000;
  double work_J = 0;
  double paid_J = 0;
  Point before_m;
  Eigen::Quaterniond turned_before;
  Answer answer;
  for (int i = 0; i <= kSteps; ++i) {
    const double turn = 2 * M_PI * i / kSteps;
    const Point tip_m(0.004 * std::sin(turn), 0.003 * std::sin(2 * turn), 0.0445 + 5e-4 * std::cos(turn));
    const Eigen::Quaterniond orientation =
        control::turn_by(Point(0.05 * std::sin(turn), 0.04 * std::cos(2 * turn), 0.1 * std::sin(turn)));
    const Answer next = felt_at(state, i, tip_m, orientation);
    if (i > 0) {
      const double step_J =
          (0.5 * (answer.force + next.force)).dot(Vector(tip_m - before_m)) +
          0.5 * Point(answer.torque_N_m + next.torque_N_m).dot(control::rotation_vector(turned_before, orientation));
      work_J += step_J;
      paid_J += std::abs(step_J);
    }
    before_m = tip_m;
    turned_before = orientation;
    answer = next;
  }
  EXPECT_GT(paid_J, 1e-4);
  EXPECT_LT(std::abs(work_J), 1e-3 * paid_J);
}

std::vector<PartDescription> hole() {
  const auto side = [](const std::string& name, const Point& center_m, const Point& size_m) {
    return pushing(name, {"box", {{"center_m", center_m}, {"size_m", size_m}}},
                   {{"friction", {{"static_coefficient", 0.2}}}});
  };
  return {side("left", {-0.01705, 0, -0.01}, {0.0259, 0.06, 0.02}),
          side("right", {0.01705, 0, -0.01}, {0.0259, 0.06, 0.02}),
          side("front", {0, -0.01705, -0.01}, {0.06, 0.0259, 0.02}),
          side("back", {0, 0.01705, -0.01}, {0.06, 0.0259, 0.02})};
}

/// The peg, pushed into a hole with 0.2 mm of play at 0.1 m/s and turned askew by the hand on its way.
struct Insertion {
  double deepest_m = -1;
  double most_N = 0;
  double tip_m = 0;  // of the simulated peg at the end
};

Insertion insert(std::uint64_t seed, ToolContact contact) {
  const auto peg = points_of("box", {{"center_m", Point(0, 0, 0.012)}, {"size_m", Point(0.008, 0.008, 0.024)}}, 0.004);
  const auto scene = scene_with(hole(), peg, {}, contact);
  SceneState state(scene, 3);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> off(-1, 1);
  const Point aside_m(7e-5 * off(random), 7e-5 * off(random), 0);
  const Point askew(0.01 * off(random), 0.01 * off(random), 0.005 * off(random));
  Insertion found;
  for (int i = 0; i < 200; ++i) {
    const double turn = 0.05 * i;
    const Answer answer =
        felt_at(state, i, aside_m + Point(0, 0, 0.004 - 1e-4 * i), control::turn_by(std::sin(turn) * askew));
    found.most_N = std::max(found.most_N, answer.force.norm());
    if (contact == ToolContact::constraint) found.deepest_m = std::max(found.deepest_m, depth_m(state, *scene));
  }
  if (state.simulated_tool() != nullptr) found.tip_m = state.simulated_tool()->tip_m.z();
  return found;
}

TEST(ToolProxy, APegGoesIntoItsHoleAndNeverIntoItsSides) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Insertion found = insert(seed, ToolContact::constraint);
    EXPECT_LT(found.deepest_m, 1e-6) << seed;
    EXPECT_LT(found.tip_m, -0.014) << seed;
  }
}

TEST(ToolProxy, PassesNoThinWallAtAMetreAndTenRadiansASecond) {
  PartDescription wall = pushing("wall", {"mesh", {{"file", std::string("a.obj")}, {"two_sided", true}}});
  const ShapeGeometry geometry{.mesh = test::shared_mesh(test::square(0.1, 4))};
  const std::vector<ToolPoint> blade =
      points_of("box", {{"center_m", Point(0, 0, 0)}, {"size_m", Point(0.04, 0.04, 0.004)}}, 5e-3);
  SceneState state(constrained({wall}, blade, geometry), 3);
  double least_N = 0;
  for (int i = 0; i <= 60; ++i) {
    const double passed_s = 1e-3 * i;
    const double height_m = 0.0305 - passed_s;
    const Answer felt = felt_at(state, i, {0, 0, height_m}, control::turn_by(Point(0, 0, 10 * passed_s)));
    EXPECT_GT(state.simulated_tool()->tip_m.z(), 0.002 - 1e-6) << "above the wall at " << height_m;
    if (height_m > 0.002) continue;
    EXPECT_GE(felt.force[2], least_N);
    EXPECT_NEAR(felt.force[2], kPush_N_per_m * (0.002 - height_m), 1e-3);
    least_N = felt.force[2];
  }
  EXPECT_GT(least_N, 10);
}

TEST(ToolProxy, StaysOutsideOfAMeshThatItRubsAgainst) {
  PartDescription mesh = pushing("ball", {"mesh", {{"file", std::string("a.obj")}}});
  const ShapeGeometry geometry{.mesh = test::shared_mesh(test::ball(0.03, 24))};
  const auto scene = constrained({mesh}, block(0.004), geometry);
  SceneState state(scene, 3);
  double most_N = 0;
  for (int i = 0; i < 1000; ++i) {
    const double turn = 0.003 * i;
    const Point tip_m = 0.043 * Point(std::sin(turn), 0.2 * std::sin(3 * turn), std::cos(turn)).normalized();
    const Answer felt = felt_at(state, i, tip_m, control::turn_by(Point(0.3 * std::sin(turn), turn, 0.2 * turn)));
    most_N = std::max(most_N, felt.force.norm());
    if (i % 10 != 0) continue;
    EXPECT_LT(depth_m(state, *scene), 2e-6) << i;
  }
  EXPECT_GT(most_N, 0.5);
}

TEST(ToolProxy, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const ShapeGeometry geometry{.mesh = test::shared_mesh(test::ball(0.03, 12))};
  PartDescription mesh = pushing("ball", {"mesh", {{"file", std::string("a.obj")}}});
  SceneState state(constrained({mesh, plane()}, block(2e-3), geometry), 3);
  double sum_N = 0;
  std::uint64_t operations = 0;
  {
    const test::AllocationGuard guard;
    for (int i = 0; i < 300; ++i) {
      const Point tip_m(0.05 * std::cos(0.05 * i), 0, 0.05 * std::sin(0.05 * i));
      sum_N += felt_at(state, i, tip_m, control::turn_by(Point(0.01 * i, 0, 0))).force.norm();
    }
    operations = guard.heap_operations();
  }
  EXPECT_GT(sum_N, 1);
  EXPECT_EQ(operations, 0U);
}

}  // namespace
}  // namespace forcebound::scene
