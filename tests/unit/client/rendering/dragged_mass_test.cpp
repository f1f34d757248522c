#include "forcebound/client/rendering/dragged_mass.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

constexpr double kMass_kg = 0.1;
constexpr double kCoupling_N_per_m = 500;

/// A puck in free space, at the origin.
local_model::Mass free_puck() {
  return {.id = 1,
          .stiffness_N_per_m = kCoupling_N_per_m,
          .damping_N_s_per_m = 0,
          .mobility_per_kg = Eigen::Matrix3d::Identity() / kMass_kg,
          .free_per_kg = Eigen::Matrix3d::Identity() / kMass_kg,
          .radius_m = 1};
}

/// A device on ticks of a millisecond.
struct Drag {
  DevicePoint to(const Point& place_m) {
    const DevicePoint device{.place_m = place_m, .velocity_m_per_s = (place_m - last_m) / 1e-3};
    last_m = place_m;
    now += 1ms;
    mass.advance(device, 1e-3, now);
    return device;
  }
  DevicePoint rest(int milliseconds) {
    DevicePoint device;
    for (int i = 0; i < milliseconds; ++i) device = to(last_m);
    return device;
  }
  DraggedMass mass;
  Point last_m = Point::Zero();
  Nanoseconds now{0};
};

TEST(DraggedMass, SwingsOnItsCouplingAsAMassOnASpringDoes) {
  Drag drag;
  drag.mass.update(free_puck(), {}, drag.now);
  drag.last_m = {0.001, 0, 0};
  const double period_s = 2 * std::numbers::pi * std::sqrt(kMass_kg / kCoupling_N_per_m);
  (void)drag.rest(static_cast<int>(std::lround(period_s / 2 * 1e3)));
  EXPECT_NEAR(drag.mass.place_m().x(), 0.002, 5e-5);
  (void)drag.rest(static_cast<int>(std::lround(period_s / 2 * 1e3)));
  EXPECT_NEAR(drag.mass.place_m().x(), 0, 1e-4);
}

TEST(DraggedMass, MovesAsFarInOneTickOfTwentyMillisecondsAsInTwentyOfOne) {
  const DevicePoint device{.place_m = {0.001, 0, 0}};
  DraggedMass often;
  DraggedMass once;
  often.update(free_puck(), {}, 0ms);
  once.update(free_puck(), {}, 0ms);
  for (int i = 1; i <= 20; ++i) often.advance(device, 1e-3, 1ms * i);
  once.advance(device, 0.02, 20ms);
  EXPECT_NEAR(once.place_m().x(), often.place_m().x(), 1e-12);
  EXPECT_GT(once.place_m().x(), 5e-4);
}

TEST(DraggedMass, ActsOnTheDeviceAsTheDeviceActsOnIt) {
  Drag drag;
  drag.mass.update(free_puck(), {}, drag.now);
  const DevicePoint device = drag.to({0.001, 0, 0});
  EXPECT_NEAR(drag.mass.force_N(device).x(), -kCoupling_N_per_m * 0.001, 1e-12) << "it was at the origin until then";
  const double before_m = drag.mass.place_m().x();
  EXPECT_NEAR(before_m, 1e-6 * kCoupling_N_per_m * 0.001 / kMass_kg, 1e-12);
  EXPECT_NEAR(drag.mass.force_N(drag.rest(1)).x(), -kCoupling_N_per_m * (0.001 - before_m), 1e-12);
}

TEST(DraggedMass, HasTheSpeedOfWhatHoldsIt) {
  Drag drag;
  drag.mass.update(free_puck(), {}, drag.now);
  for (int i = 1; i <= 100; ++i) (void)drag.to({0.001 * i, 0, 0});
  local_model::Mass held = free_puck();
  held.push = {1, 0, 0};
  held.mobility_per_kg(0, 0) = 1e-3 / kMass_kg;
  held.place_m = drag.mass.place_m();
  drag.mass.update(held, {}, drag.now);
  const double held_at_m = drag.mass.place_m().x();
  for (int i = 1; i <= 100; ++i) (void)drag.to({0.1 + 0.001 * i, 0, 0});
  EXPECT_NEAR(drag.mass.place_m().x(), held_at_m, 3e-3) << "a thousandth of what the coupling would have moved it by";
}

TEST(DraggedMass, HasTheMassOfWhatItPushesAndItsOwnWhenItLeaves) {
  local_model::Mass pushing = free_puck();
  pushing.push = {1, 0, 0};
  pushing.mobility_per_kg(0, 0) = 1 / (10 * kMass_kg);
  Drag towards;
  towards.mass.update(pushing, {}, towards.now);
  towards.last_m = {0.001, 0, 0};
  (void)towards.rest(5);
  Drag away;
  away.mass.update(pushing, {}, away.now);
  away.last_m = {-0.001, 0, 0};
  (void)away.rest(5);
  EXPECT_NEAR(-away.mass.place_m().x() / towards.mass.place_m().x(), 10, 1);
}

TEST(DraggedMass, StaysOnItsRailPushedStoppedOrLeaving) {
  const Point rail = Point(1, 1, 0).normalized();
  local_model::Mass on_rail = free_puck();
  on_rail.mobility_per_kg = on_rail.free_per_kg = rail * rail.transpose() / kMass_kg;
  on_rail.push = {1, 0, 0};
  on_rail.travel_m = 0.002;
  Drag drag;
  drag.mass.update(on_rail, {}, drag.now);
  for (const Point& device_m : {Point(0.01, 0.02, 0.01), Point(-0.02, 0, 0.01), Point(-0.01, 0.02, 0)}) {
    drag.last_m = device_m;
    for (int i = 0; i < 50; ++i) {
      (void)drag.rest(1);
      const Point place_m = drag.mass.place_m();
      EXPECT_LT((place_m - rail * rail.dot(place_m)).norm(), 1e-12);
      EXPECT_LE(place_m.x(), 0.002 + 1e-12);
    }
  }
}

TEST(DraggedMass, StopsWhereItCannotGoOnAndComesBack) {
  local_model::Mass stopped = free_puck();
  stopped.push = {1, 0, 0};
  stopped.travel_m = 0.002;
  Drag drag;
  drag.mass.update(stopped, {}, drag.now);
  drag.last_m = {0.01, 0, 0};
  for (int i = 0; i < 100; ++i) {
    const DevicePoint device = drag.rest(1);
    EXPECT_LE(drag.mass.place_m().x(), 0.002 + 1e-12);
    EXPECT_LE(drag.mass.force_N(device).x(), 0);
  }
  EXPECT_NEAR(drag.mass.place_m().x(), 0.002, 1e-9);
  drag.last_m = {-0.01, 0, 0};
  (void)drag.rest(50);
  EXPECT_LT(drag.mass.place_m().x(), 0);
}

TEST(DraggedMass, ComesBackSlowlyToALimitThatItHasPassedAndGoesNoFarther) {
  Drag drag;
  drag.mass.update(free_puck(), {}, drag.now);
  drag.last_m = {0.005, 0, 0};
  (void)drag.rest(10);
  local_model::Mass stopped = free_puck();
  stopped.push = {1, 0, 0};
  stopped.place_m = drag.mass.place_m();
  stopped.travel_m = 0;
  (void)drag.rest(10);
  double last_m = drag.mass.place_m().x();
  ASSERT_GT(last_m, stopped.place_m.x() + 0.002);
  drag.mass.update(stopped, {.s = 0.01}, drag.now);
  drag.last_m = {0.05, 0, 0};  // so that it is pulled on
  for (int i = 0; i < 1000; ++i) {
    (void)drag.rest(1);
    const double place_m = drag.mass.place_m().x();
    EXPECT_LE(place_m, last_m + 1e-12);
    EXPECT_GE(place_m, last_m - DraggedMass::kCorrection_m_per_s * 1e-3 - 1e-12);
    last_m = place_m;
  }
  EXPECT_NEAR(last_m, stopped.place_m.x(), 1e-6);
}

TEST(DraggedMass, BeginsWithinItsLimitHoweverOldTheAnswerIs) {
  local_model::Mass stopped = free_puck();
  stopped.push = {1, 0, 0};
  stopped.velocity_m_per_s = {0.5, 0, 0};
  stopped.travel_m = 0.002;
  Drag drag;
  drag.mass.update(stopped, {.s = 0.05}, drag.now);
  EXPECT_NEAR(drag.mass.place_m().x(), 0.002, 1e-12);
}

TEST(DraggedMass, GoesOnThroughAnswersThatSayWhereItWasThen) {
  Drag with_answers;
  Drag alone;
  with_answers.mass.update(free_puck(), {}, with_answers.now);
  alone.mass.update(free_puck(), {}, alone.now);
  std::vector<Point> places_m;
  for (int i = 0; i < 300; ++i) {
    const Point device_m(0.01 * std::sin(0.02 * i), 0, 0);
    (void)with_answers.to(device_m);
    (void)alone.to(device_m);
    places_m.push_back(alone.mass.place_m());
    if (i < 100) continue;
    local_model::Mass told = free_puck();
    told.place_m = places_m[static_cast<std::size_t>(i - 50)];
    with_answers.mass.update(told, {.s = 0.05}, with_answers.now);
    EXPECT_LT((with_answers.mass.place_m() - alone.mass.place_m()).norm(), 1e-9);
    EXPECT_LT(with_answers.mass.deviation_m(), 1e-9);
  }
}

TEST(DraggedMass, MovesSlowlyToWhereTheServerHasItAndNotBeyond) {
  Drag drag;
  drag.mass.update(free_puck(), {}, drag.now);
  (void)drag.rest(100);
  local_model::Mass told = free_puck();
  told.place_m = {0, 0.003, 0};
  told.stiffness_N_per_m = 0;  // so that nothing else moves it
  double last_m = 0;
  for (int i = 0; i < 1000; ++i) {
    drag.mass.update(told, {.s = 0.05}, drag.now);
    (void)drag.rest(1);
    const double place_m = drag.mass.place_m().y();
    EXPECT_LE(place_m - last_m, DraggedMass::kCorrection_m_per_s * 1e-3 + 1e-12);
    EXPECT_LE(place_m, 0.003 + 1e-9) << "what was corrected is not corrected again, though answers are late";
    last_m = place_m;
  }
  EXPECT_GE(last_m, 0.003 - DraggedMass::kAgrees_m - 1e-6);
}

TEST(DraggedMass, BeginsAnewWhereAnAnswerHasItFarAway) {
  Drag drag;
  drag.mass.update(free_puck(), {}, drag.now);
  (void)drag.rest(100);
  local_model::Mass told = free_puck();
  told.place_m = {0.1, 0, 0};
  told.velocity_m_per_s = {0.5, 0, 0};
  drag.mass.update(told, {.s = 0.05}, drag.now);
  EXPECT_NEAR(drag.mass.place_m().x(), 0.125, 1e-12);
}

TEST(DraggedMass, StaysFiniteAndDoesNotAllocateWhateverItIsTold) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  local_model::Mass wild = free_puck();
  wild.stiffness_N_per_m = 3.9e6 * kMass_kg;
  wild.bias_m_per_s2 = {1e4, -1e4, 0};
  wild.velocity_m_per_s = {100, 0, 0};
  Drag drag;
  const test::AllocationGuard guard;
  for (int i = 0; i < 5000; ++i) {
    wild.place_m = {i % 7 - 3.0, 0, 0};
    if (i % 3 == 0) drag.mass.update(wild, {.s = 0.001 * (i % 300)}, drag.now);
    const DevicePoint device = drag.to({i % 2 - 0.5, 0, 0});
    EXPECT_TRUE(drag.mass.force_N(device).allFinite());
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::client
