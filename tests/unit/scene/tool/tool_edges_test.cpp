// Edges of a tool and of objects, asked about each other: nothing goes in between the points.

#include "forcebound/scene/tool/tool_edges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/allocation_guard.hpp"
#include "tests/unit/scene/tool/tool_scene.hpp"

namespace forcebound::scene {
namespace {

using std::chrono::milliseconds;

/// A tool of one part, with points at its corners alone or far apart.
std::shared_ptr<const Scene> with_part(const std::vector<PartDescription>& objects, const NamedValues& part,
                                       double spacing_m = 0.05) {
  return scene_with(objects, points_of(part.name, part.values, spacing_m), {}, ToolContact::constraint,
                    {convex_part(part.name, part.values).value()});
}

NamedValues box(const Point& center_m, const Point& size_m) {
  return {"box", {{"center_m", center_m}, {"size_m", size_m}}};
}

NamedValues straight(const std::string& kind, const Point& from_m, const Point& to_m, double radius_m) {
  return {kind, {{"from_m", from_m}, {"to_m", to_m}, {"radius_m", radius_m}}};
}

NamedValues ball(double radius_m) { return {"sphere", {{"center_m", Point(0, 0, 0)}, {"radius_m", radius_m}}}; }

TEST(ToolEdges, AreNearestWhereDenseSamplesOfBothAre) {
  const std::vector<NamedValues> parts{box({0.001, 0, 0}, {0.01, 0.006, 0.02}),
                                       straight("cylinder", {0, 0, -0.01}, {0.002, 0, 0.01}, 0.006),
                                       straight("capsule", {0, -0.01, 0}, {0, 0.01, 0.003}, 0.004), ball(0.005)};
  const std::vector<NamedValues> shapes{box({0, 0, 0}, {0.02, 0.03, 0.01}),
                                        straight("cylinder", {0, 0, -0.004}, {0, 0.001, 0.004}, 0.012),
                                        straight("capsule", {-0.01, 0, 0}, {0.01, 0, 0}, 0.005),
                                        ball(0.01),
                                        {"half_space", {{"through_m", Point(0, 0, 0)}, {"normal", Point(0, 0.1, 1)}}}};
  constexpr double kApart_m = 6e-4;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  int compared = 0;
  for (const NamedValues& part : parts) {
    const std::vector<ToolPoint> dense = points_of(part.name, part.values, kApart_m);
    for (const NamedValues& shape : shapes) {
      SCOPED_TRACE(part.name + " and " + shape.name);
      const auto scene = with_part({pushing("object", shape)}, part);
      const ToolEdges edges(*scene->facts().tool, scene->objects());
      ASSERT_TRUE(edges.knows(0));
      for (int i = 0; i < 6; ++i) {
        ToolPose pose;
        pose.rotation = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
        const Point away = Point(normal(random), normal(random), 1 + std::abs(normal(random))).normalized();
        // As far as its points are clear by less than 1 mm.
        const auto sampled_m = [&] {
          double least_m = 1;
          for (const ToolPoint& point : dense) {
            std::array<double, 3> fresh{};
            const SurfacePoint found =
                scene->plan().steps()[0].shape->nearest(pose * point.at_m, reinterpret_cast<std::byte*>(fresh.data()));
            least_m = std::min(least_m, -found.penetration_m - point.radius_m);
          }
          return least_m;
        };
        double to_samples_m = 0;
        for (double out_m = 0.06; (to_samples_m = sampled_m()) < 2e-4 || out_m == 0.06; out_m = 0) {
          pose.tip_m += (out_m > 0 ? out_m : 2e-4) * away;
        }
        for (int nearer = 0; nearer < 30 && to_samples_m > 8e-4; ++nearer) {
          pose.tip_m -= 0.9 * (to_samples_m - 4e-4) * away;
          to_samples_m = sampled_m();
        }
        if (to_samples_m > 1e-3) continue;
        std::vector<EdgeContact> found;
        found.reserve(edges.contacts_most());
        edges.find(0, pose, 1.5e-3, 5e-4, found);
        ASSERT_FALSE(found.empty());
        double least_m = 1;
        for (const EdgeContact& contact : found) {
          least_m = std::min(least_m, contact.gap_m);
          EXPECT_NEAR(contact.normal.norm(), 1, 1e-9);
        }
        EXPECT_LE(least_m, to_samples_m + 1e-6) << "no sample is nearer";
        // Between samples a corner may be nearer by what they are apart.
        EXPECT_GE(least_m, to_samples_m - 0.5 * kApart_m);
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 100) << "of 120";
}

TEST(ToolEdges, ABoxFlatOnAPlaneOrAcrossABarIsAsStiffAsOnePoint) {
  const NamedValues part = box({0, 0, 0}, {0.04, 0.02, 0.03});
  const double pressed_m = 1e-3;
  // The bar is under its middle, where it has no point.
  for (const PartDescription& object :
       {plane(), pushing("bar", box({0, 0, -0.005}, {0.004, 0.1, 0.01})),
        pushing("rod", straight("cylinder", {-0.05, 0, -0.005}, {0.05, 0, -0.005}, 0.005)),
        pushing("ball", {"sphere", {{"center_m", Point(0, 0, -0.01)}, {"radius_m", 0.01}}})}) {
    SceneState state(with_part({object}, part), 3);
    const Answer answer = felt_at(state, 0, {0, 0, 0.015 - pressed_m});
    EXPECT_NEAR(answer.force[2], kPush_N_per_m * pressed_m, 1e-6) << object.name;
    EXPECT_LT(answer.force.head<2>().norm(), 1e-6) << object.name;
    EXPECT_LT(answer.torque_N_m.norm(), 1e-6) << object.name;
  }
}

TEST(ToolEdges, ABallEqualsThePointWithAnOffsetSurface) {
  const double radius_m = 0.004;
  const std::vector<NamedValues> more{{"friction", {{"static_coefficient", 0.4}}}};
  SceneState tool(with_part({pushing("ball", ball(0.02), more)}, ball(radius_m)), 3);
  SceneState point(scene_with({pushing("ball", ball(0.02 + radius_m), more)}, {}), 3);
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

TEST(ToolEdges, ARodOnAnEdgeIsALever) {
  const double arm_m = 0.0613;  // between its points
  const double radius_m = 0.002;
  const auto scene = with_part({pushing("ridge", box({arm_m, 0, -0.01}, {5e-4, 0.02, 0.02}))},
                               straight("capsule", {0, 0, 0}, {0.1, 0, 0}, radius_m), 0.005);
  SceneState state(scene, 3);
  const double pressed_m = 1e-4;
  (void)felt_at(state, 0, {0, 0, radius_m});
  const Answer answer = felt_at(state, 1, {0, 0, radius_m - pressed_m});
  const Tool& tool = *scene->facts().tool;
  // On the ridge's edge that is nearer to its middle, or further: 0.25 mm either way.
  const double lever_m = arm_m - tool.centre_m().x();
  const double share_m = pressed_m / (1 + std::pow(lever_m / tool.spread_m(), 2));
  EXPECT_NEAR(answer.force[2], kPush_N_per_m * share_m, 0.01 * kPush_N_per_m * share_m);
  EXPECT_NEAR(answer.torque_N_m[1], -arm_m * answer.force[2], 0.01 * arm_m * answer.force[2]);
}

/// Work of a closed way, and all that went to and fro.
struct Work {
  double sum_J = 0;
  double paid_J = 0;
};

template <class Way>
Work work_on(SceneState& state, Way way) {
  constexpr int kSteps = 20000;
  Work work;
  std::pair before{Point(0, 0, 0), Eigen::Quaterniond::Identity()};
  Answer answer;
  for (int i = 0; i <= kSteps; ++i) {
    const auto at = way(2 * std::numbers::pi * i / kSteps);
    const Answer next = felt_at(state, i, at.first, at.second);
    if (i > 0) {
      const double step_J =
          (0.5 * (answer.force + next.force)).dot(Vector(at.first - before.first)) +
          0.5 * Point(answer.torque_N_m + next.torque_N_m).dot(control::rotation_vector(before.second, at.second));
      work.sum_J += step_J;
      work.paid_J += std::abs(step_J);
    }
    before = at;
    answer = next;
  }
  return work;
}

TEST(ToolEdges, DoNoWorkOnAClosedWayOverARim) {
  // A step down at x = 0, under the middle of a box whose corners are beside it.
  SceneState state(
      with_part({pushing("step", box({-0.05, 0, -0.01}, {0.1, 0.2, 0.02}))}, box({0, 0, 0}, {0.03, 0.02, 0.02})), 3);
  const Work work = work_on(state, [](double turn) {
    return std::pair(Point(0.008 * std::sin(turn), 0.002 * std::cos(turn), 0.0095 + 3e-4 * std::cos(2 * turn)),
                     control::turn_by(Point(0.02 * std::sin(2 * turn), 0.08 * std::cos(turn), 0.1 * std::sin(turn))));
  });
  EXPECT_GT(work.paid_J, 1e-5);
  EXPECT_LT(std::abs(work.sum_J), 2e-3 * work.paid_J);
}

const Point kPegMiddle_m(0, 0, 0.012);
const Point kPegSize_m(0.008, 0.008, 0.024);

struct Block {
  const char* name;
  Point center_m;
  Point size_m;
};

const std::vector<Block>& blocks() {
  static const std::vector<Block> kAll{{"left", {-0.01705, 0, -0.01}, {0.0259, 0.06, 0.02}},
                                       {"right", {0.01705, 0, -0.01}, {0.0259, 0.06, 0.02}},
                                       {"front", {0, -0.01705, -0.01}, {0.06, 0.0259, 0.02}},
                                       {"back", {0, 0.01705, -0.01}, {0.06, 0.0259, 0.02}}};
  return kAll;
}

std::shared_ptr<const Scene> peg_and_hole() {
  std::vector<PartDescription> objects;
  for (const Block& block : blocks())
    objects.push_back(
        pushing(block.name, box(block.center_m, block.size_m), {{"friction", {{"static_coefficient", 0.2}}}}));
  return with_part(objects, box(kPegMiddle_m, kPegSize_m), 0.004);
}

std::vector<Point> along_edges(const Point& center_m, const Point& size_m, int samples) {
  std::vector<Point> all;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 4; ++side) {
      for (int i = 0; i <= samples; ++i) {
        Point at;
        at[axis] = static_cast<double>(i) / samples - 0.5;
        at[(axis + 1) % 3] = (side & 1) - 0.5;
        at[(axis + 2) % 3] = (side >> 1) - 0.5;
        all.emplace_back(center_m + size_m.cwiseProduct(at));
      }
    }
  }
  return all;
}

double depth_in_box_m(const Point& at_m, const Point& center_m, const Point& size_m) {
  return (0.5 * size_m - (at_m - center_m).cwiseAbs()).minCoeff();
}

/// How deep edges of the sharp peg are in the blocks, and theirs in it.
double true_depth_m(const ToolPose& pose) {
  static const std::vector<Point> kOfPeg = along_edges(kPegMiddle_m, kPegSize_m, 60);
  static const std::vector<Point> kOfBlocks = [] {
    std::vector<Point> all;
    for (const Block& block : blocks()) {
      for (const Point& at_m : along_edges(block.center_m, block.size_m, 600)) {
        if (at_m.norm() < 0.03) all.push_back(at_m);
      }
    }
    return all;
  }();
  double deepest_m = -1;
  for (const Point& at_m : kOfBlocks) {
    const Point in_peg_m = pose.rotation.transpose() * (at_m - pose.tip_m);
    deepest_m = std::max(deepest_m, depth_in_box_m(in_peg_m, kPegMiddle_m, kPegSize_m));
  }
  for (const Point& at_m : kOfPeg) {
    for (const Block& block : blocks())
      deepest_m = std::max(deepest_m, depth_in_box_m(pose * at_m, block.center_m, block.size_m));
  }
  return deepest_m;
}

TEST(ToolEdges, APegPressedOverTheRimOfItsHoleGoesInWithoutAJump) {
  for (const double tilt_rad : {0.0, 0.03}) {
    for (const double aside_m : {0.0, 3e-4, 1e-3, 3e-3}) {
      SCOPED_TRACE(testing::Message() << tilt_rad << " rad, " << aside_m << " m");
      SceneState state(peg_and_hole(), 3);
      const Eigen::Quaterniond orientation = control::turn_by(tilt_rad * Point(0.3, 1, 0));
      Point before_m = Point::Zero();
      Point before_N = Point::Zero();
      for (int i = 0; i < 230; ++i) {
        const double share = std::clamp((i - 60) / 50.0, 0.0, 1.0);
        const Point tip_m(aside_m * share, 0.3 * aside_m * share, 0.003 - 1e-4 * std::min(i, 200));
        const Point force_N = felt_at(state, i, tip_m, orientation).force;
        if (i > 0) {
          const double by_hand_N = kPush_N_per_m * (tip_m - before_m).norm();
          EXPECT_LT((force_N - before_N).norm(), by_hand_N + 0.05 * force_N.norm() + 0.02) << i;
        }
        if (i % 5 == 0) {
          EXPECT_LT(true_depth_m(*state.simulated_tool()), 1e-6) << i;
        }
        before_m = tip_m;
        before_N = force_N;
      }
      EXPECT_LT(state.simulated_tool()->tip_m.z(), -0.0165);
    }
  }
}

TEST(ToolEdges, APegGoesIntoItsHoleAskewAndNeverIntoItsSides) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SceneState state(peg_and_hole(), 3);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> off(-1, 1);
    const Point aside_m(7e-5 * off(random), 7e-5 * off(random), 0);
    const Point askew(0.01 * off(random), 0.01 * off(random), 0.005 * off(random));
    double deepest_m = -1;
    for (int i = 0; i < 200; ++i) {
      const Point tip_m = aside_m + Point(0, 0, 0.004 - 1e-4 * i);
      (void)felt_at(state, i, tip_m, control::turn_by(std::sin(0.05 * i) * askew));
      if (i % 20 == 19) deepest_m = std::max(deepest_m, true_depth_m(*state.simulated_tool()));
    }
    EXPECT_LT(deepest_m, 1e-6) << seed;
    EXPECT_LT(state.simulated_tool()->tip_m.z(), -0.0155) << seed;
  }
}

TEST(ToolEdges, DoNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  std::vector<PartDescription> objects{plane(), pushing("box", box({0.01, 0, 0}, {0.03, 0.02, 0.02}))};
  objects.push_back(pushing("rod", straight("cylinder", {-0.02, 0, 0}, {-0.02, 0, 0.02}, 0.008),
                            {{"friction", {{"static_coefficient", 0.2}}}}));
  SceneState state(with_part(objects, straight("cylinder", {0, 0, 0}, {0, 0.01, 0.02}, 0.01)), 3);
  double sum_N = 0;
  std::uint64_t operations = 0;
  {
    const test::AllocationGuard guard;
    for (int i = 0; i < 300; ++i) {
      const Point tip_m(0.03 * std::cos(0.05 * i), 0, 0.03 * std::sin(0.05 * i));
      sum_N += felt_at(state, i, tip_m, control::turn_by(Point(0.01 * i, 0, 0))).force.norm();
    }
    operations = guard.heap_operations();
  }
  EXPECT_GT(sum_N, 1);
  EXPECT_EQ(operations, 0U);
}

TEST(ToolEdges, AreRefusedOfAPartThatIsNone) {
  using Kind = ToolPart::Kind;
  const auto with = [](const ToolPart& part) { return Tool({{}}, ToolContact::constraint, {part}); };
  EXPECT_NO_THROW(with({.kind = Kind::capsule, .radius_m = 1e-3}));
  EXPECT_THROW(with({.kind = Kind::capsule}), std::invalid_argument);
  EXPECT_THROW(with({.kind = Kind::cylinder, .radius_m = 1e-3}), std::invalid_argument);
  EXPECT_THROW(with({.kind = Kind::box, .to_m = Point(0.01, 0.01, 0)}), std::invalid_argument);
  EXPECT_THROW(with({.kind = Kind::box, .to_m = Point(2, 1, 1)}), std::invalid_argument);
  EXPECT_THROW(with({.kind = Kind::capsule, .to_m = Point(NAN, 0, 0), .radius_m = 1e-3}), std::invalid_argument);
  const std::vector<ToolPart> many(kToolPartsMost + 1, {.kind = Kind::capsule, .radius_m = 1e-3});
  EXPECT_THROW(Tool({{}}, ToolContact::constraint, many), std::invalid_argument);
}

}  // namespace
}  // namespace forcebound::scene
