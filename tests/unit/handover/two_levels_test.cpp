#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "forcebound/handover/coarse_level.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/handover/handed_over.hpp"

// A mesh that is large enough for a coarse level, as it arrives at a client.

namespace forcebound::handover {
namespace {

using namespace std::chrono_literals;

constexpr double kStiffness_N_per_m = 1000;

/// A ball of 30 mm with a valley all around, 3 mm deep.
test::Soup valley_ball() {
  test::Soup soup = test::ball(0.03, 70);
  for (Point& vertex : soup.vertices) vertex *= 1 - 0.1 * std::exp(-std::pow(vertex.normalized().x() / 0.1, 2));
  return soup;
}

struct Handed {
  std::shared_ptr<const Scene> scene = mesh_scene(valley_ball());
  std::shared_ptr<const PackedScene> packed = pack(*scene);
  double error_m = coarse_level_of(scene::Bvh(scene->objects()[0].shape->geometry().mesh)).value().error_m;
};

/// Made once.
const Handed& handed() {
  static const Handed kHanded;
  return kHanded;
}

/// Takes pieces and builds as a client does, with one state that goes on from build to build.
class AnArrivingMesh : public ::testing::Test {
 protected:
  void arrive(const std::function<bool(std::size_t)>& now) {
    for (std::size_t i = 0; i < packed->announcement().pieces; ++i) {
      if (now(i)) assembly.add(i, packed->piece(i));
    }
    made = assembly.build();
    auto next = std::make_unique<scene::SceneState>(made.scene, 3);
    if (state) {
      ASSERT_TRUE(next->go_on_from(*state));
    } else {
      next->begin_again(Vector(Point(0, 0, 0.05)), 0ms);
    }
    state = std::move(next);
  }
  void arrive_first() {
    arrive([&](std::size_t piece) { return packed->comes_first(piece); });
  }
  /// All within so much of a point.
  void arrive_within(double reach_m, const Point& of_m) {
    arrive([&](std::size_t piece) { return packed->where_m(piece).exteriorDistance(of_m) < reach_m; });
  }
  void arrive_whole() {
    arrive([](std::size_t) { return true; });
  }
  Point force_N(const Point& at_m) { return state->answer(Vector(at_m), time += 1ms).force; }
  Point true_force_N(const Point& at_m) { return truth.answer(Vector(at_m), time).force; }

  std::shared_ptr<const PackedScene> packed = handed().packed;
  double error_m = handed().error_m;
  SceneAssembly assembly = assembly_of(*packed);
  AssembledScene made{};
  std::unique_ptr<scene::SceneState> state{};
  scene::SceneState truth{handed().scene, 3};
  time::Nanoseconds time{0};
};

TEST_F(AnArrivingMesh, IsFeltWithinItsErrorBeforeAnyOfItHasArrived) {
  arrive_first();
  EXPECT_EQ(assembly.coarse_levels_here(), 1U);
  EXPECT_LT(3 * assembly.pieces_here(), packed->announcement().pieces);
  EXPECT_FALSE(made.whole);
  EXPECT_TRUE(made.coverage.at(0).whole());
  EXPECT_EQ(made.exact.at(0).known_within_m(Point(0, 0, 0.027)), 0);
  EXPECT_EQ(assembly.known_within_m(Point(0, 0, 0.027)), 0);
  double most_N = 0;
  for (int i = 0; i < 400; ++i) {
    // From above the valley's side down, and along.
    const Point at_m(0.008 + 1e-5 * i, 0, std::max(0.026, 0.032 - 1e-4 * i));
    most_N = std::max(most_N, true_force_N(at_m).norm());
    ASSERT_LE(std::abs(force_N(at_m).norm() - true_force_N(at_m).norm()), kStiffness_N_per_m * error_m) << i;
  }
  EXPECT_GT(most_N, 1);
}

TEST_F(AnArrivingMesh, IsNotFeltAtAllBeforeItsCoarseLevelIsThere) {
  arrive([&](std::size_t piece) { return piece + 1 != packed->announcement().pieces; });
  EXPECT_EQ(assembly.coarse_levels_here(), 0U);
  EXPECT_EQ(made.coverage.at(0).known_within_m(Point(0, 0, 0.03)), 0);
}

/// The force after each motion of a device that dwells at a place, and the largest change of it.
struct Settled {
  Point last_N;
  double change_N = 0;
};

TEST_F(AnArrivingMesh, GoesOverToWhatHasArrivedWithoutAJumpWhereverItIsTouched) {
  for (const Point& at_m : {Point(1e-3, 0, 0.0262), Point(0, 0, 0.0265), Point(4e-3, 2e-3, 0.026),
                            Point(0, 0.01, 0.024), Point(0.012, 0, 0.026), Point(0, 0, 0.02715)}) {
    SCOPED_TRACE(at_m.transpose());
    assembly = assembly_of(*packed);
    state.reset();
    truth.begin_again(Vector(Point(0, 0, 0.05)), 0ms);
    arrive_first();
    const Point above_m = at_m + Point(0, 0, 0.01);
    for (int i = 0; i <= 100; ++i) {
      (void)force_N(above_m + 0.01 * i * (at_m - above_m));
      (void)true_force_N(above_m + 0.01 * i * (at_m - above_m));
    }
    Point before_N = force_N(at_m);
    const auto settle = [&] {
      Settled settled;
      for (int i = 0; i < 15; ++i) {
        settled.last_N = force_N(at_m);
        settled.change_N =
            std::max(settled.change_N, (settled.last_N - std::exchange(before_N, settled.last_N)).norm());
      }
      return settled;
    };
    const Point true_N = true_force_N(at_m);
    const double off_N = (before_N - true_N).norm();
    arrive_within(0.016, at_m);
    ASSERT_FALSE(made.whole);
    const Settled there = settle();
    // In a valley of facets it may rest beside.
    EXPECT_LE((there.last_N - true_N).norm(), 0.1 * kStiffness_N_per_m * error_m);
    EXPECT_LE(there.change_N, 0.3 * off_N + 1e-3);
    arrive_whole();
    const Settled whole = settle();
    EXPECT_LE(whole.change_N, 1e-9) << "it was known there";
  }
}

TEST_F(AnArrivingMesh, GoesBackToTheCoarseLevelWhereNothingElseHasArrived) {
  arrive_first();
  const Point top_m(0.01, 0, 0.0265);
  arrive_within(0.014, top_m);
  (void)force_N(top_m + Point(0, 0, 0.005));
  Point before_N = force_N(top_m);
  (void)true_force_N(top_m + Point(0, 0, 0.005));
  (void)true_force_N(top_m);
  double change_N = 0;
  double off_N = 0;
  for (int i = 0; i <= 2000; ++i) {
    // Round to the other side and back.
    const double turn = 3.0 * std::sin(std::numbers::pi * i / 2000);
    const Point at_m = Eigen::AngleAxisd(turn, Point::UnitX()) * top_m;
    const Point now_N = force_N(at_m);
    off_N = std::max(off_N, (now_N - true_force_N(at_m)).norm());
    change_N = std::max(change_N, (now_N - std::exchange(before_N, now_N)).norm());
  }
  EXPECT_GT(off_N, 1e-6) << "it was never on the coarse level";
  EXPECT_LE(off_N, kStiffness_N_per_m * 3 * error_m);
  const double of_the_motion_N = kStiffness_N_per_m * 3.0 * std::numbers::pi / 2000 * top_m.norm();
  EXPECT_LE(change_N, 2 * of_the_motion_N);
  EXPECT_LE((before_N - true_force_N(top_m)).norm(), 1e-3 * before_N.norm());
}

TEST_F(AnArrivingMesh, ChangesLevelsWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  arrive_first();
  const Point at_m(0.01, 0, 0.027);
  (void)force_N(at_m + Point(0, 0, 0.005));
  const Point before_N = force_N(at_m);
  arrive_within(0.016, at_m);
  const test::AllocationGuard guard;
  (void)force_N(at_m);
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_GT(before_N.norm(), 0.1);
}

}  // namespace
}  // namespace forcebound::handover
