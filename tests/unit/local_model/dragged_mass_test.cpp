#include "forcebound/local_model/dragged_mass.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::local_model {
namespace {

using namespace std::chrono_literals;

constexpr double kPuck_kg = 0.1;
constexpr double kPuckCoupling_N_per_m = 500;

/// A puck in free space, at the origin.
Mass free_puck() {
  return {.id = 1,
          .stiffness_N_per_m = kPuckCoupling_N_per_m,
          .body = {.mobility_per_kg = Eigen::Matrix3d::Identity() / kPuck_kg},
          .radius_m = 1};
}

/// A device on ticks of a millisecond.
struct Drag {
  DevicePoint to(const Point& place_m) {
    const DevicePoint device{.place_m = place_m, .velocity_m_per_s = (place_m - last_m) / 1e-3};
    last_m = place_m;
    now += 1ms;
    mass.advance(device, 1e-3, now);
    if (mass.has_caught_up()) mass.take_its_place();
    return device;
  }
  void rest(int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) (void)to(last_m);
  }
  DraggedMass mass;
  Point last_m = Point::Zero();
  Nanoseconds now{0};
};

TEST(DraggedMass, SwingsOnItsCouplingAsAMassOnASpringDoes) {
  const DevicePoint device{.place_m = {0.001, 0, 0}};
  DraggedMass mass;
  mass.update(free_puck(), {}, 0ms);
  Nanoseconds now{0};
  const double rate_per_s = std::sqrt(kPuckCoupling_N_per_m / kPuck_kg);
  while (now < time::from_seconds(2 * std::numbers::pi / rate_per_s)) {
    now += 20us;
    mass.advance(device, 2e-5, now);
    EXPECT_NEAR(mass.place_m().x(), 0.001 * (1 - std::cos(rate_per_s * time::to_seconds(now))), 1e-5);
  }
}

TEST(DraggedMass, MovesAsFarInOneTickOfTwentyMillisecondsAsInTwentyOfOne) {
  const auto device_at = [](double time_s) {
    return DevicePoint{.place_m = {0.05 * time_s, 0, 0}, .velocity_m_per_s = {0.05, 0, 0}};
  };
  Mass told = free_puck();
  told.damping_N_s_per_m = 2;
  DraggedMass often;
  DraggedMass once;
  often.update(told, {}, 0ms);
  once.update(told, {}, 0ms);
  for (int i = 1; i <= 20; ++i) often.advance(device_at(1e-3 * i), 1e-3, 1ms * i);
  once.advance(device_at(0.02), 0.02, 20ms);
  EXPECT_NEAR(once.place_m().x(), often.place_m().x(), 1e-12);
  EXPECT_GT(once.place_m().x(), 2e-4);
}

TEST(DraggedMass, ActsOnTheDeviceAsTheDeviceActsOnIt) {
  Mass told = free_puck();
  told.damping_N_s_per_m = 4;
  Drag drag;
  drag.mass.update(told, {}, drag.now);
  const DevicePoint device = drag.to({0.001, 0, 0});
  const Point moved_m = drag.mass.place_m();
  const Point pull_N = -drag.mass.force_N(device);
  EXPECT_LT((moved_m - 1e-6 * pull_N / kPuck_kg).norm(), 1e-15) << "by what it was accelerated, on a tick from rest";
  const Point apart_m_per_s = device.velocity_m_per_s - moved_m / 1e-3;
  EXPECT_LT((pull_N - 500 * (device.place_m - moved_m) - 4 * apart_m_per_s).norm(), 1e-12);
  EXPECT_GT(pull_N.x(), 0.5);
}

TEST(DraggedMass, PullsNoHarderThanItsReachAndSpeedAllow) {
  Mass told = free_puck();
  told.damping_N_s_per_m = 4;
  told.body.mobility_per_kg.setZero();
  DraggedMass mass;
  mass.update(told, {}, 0ms);
  const DevicePoint device{.place_m = {0, 90, 0}, .velocity_m_per_s = {0, 0, -70}};
  const Point expected_N(0, -500 * Mass::kReachMost_m, 4 * Mass::kSpeedMost_m_per_s);
  EXPECT_LT((mass.force_N(device) - expected_N).norm(), 1e-9);
}

TEST(DraggedMass, GoesOnThroughAnswersThatSayWhereItWasThen) {
  Mass told = free_puck();
  told.damping_N_s_per_m = 1;
  Drag with_answers;
  Drag alone;
  with_answers.mass.update(told, {}, with_answers.now);
  alone.mass.update(told, {}, alone.now);
  std::vector<Point> places_m;
  for (int i = 0; i < 300; ++i) {
    const Point device_m(0.01 * std::sin(0.02 * i), 0.005 * std::sin(0.05 * i), 0);
    (void)with_answers.to(device_m);
    (void)alone.to(device_m);
    places_m.push_back(alone.mass.place_m());
    if (i < 100) continue;
    const auto then = static_cast<std::size_t>(i - 50);
    told.place_m = places_m[then];
    told.body.velocity_m_per_s = (places_m[then] - places_m[then - 1]) / 1e-3;
    with_answers.mass.update(told, {.s = 0.05}, with_answers.now);
    EXPECT_LT((with_answers.mass.place_m() - alone.mass.place_m()).norm(), 1e-9);
    EXPECT_LT(with_answers.mass.deviation_m(), 1e-9);
  }
  EXPECT_GT(alone.mass.place_m().norm(), 1e-3);
}

TEST(DraggedMass, IsMovedAlongTheWayThatTheDeviceWentWhileThereWasNoMass) {
  Drag told_then;
  Drag told_late;
  told_late.mass.update(free_puck(), {}, told_late.now);
  told_late.mass.forget();
  told_then.mass.update(free_puck(), {}, told_then.now);
  for (int i = 1; i <= 50; ++i) (void)told_then.to({1e-4 * i, 0, 0});
  for (int i = 1; i <= 50; ++i) (void)told_late.to({1e-4 * i, 0, 0});
  told_late.mass.update(free_puck(), {.s = 0.05}, told_late.now);
  told_then.rest(5);
  told_late.rest(5);
  EXPECT_LT((told_late.mass.place_m() - told_then.mass.place_m()).norm(), 1e-12);
  EXPECT_GT(told_late.mass.place_m().x(), 1e-3);
  EXPECT_EQ(told_late.mass.deviation_m(), 0) << "there was none before";
}

// Of the last second the ring has 512 ticks; a damper slows what is known to have gone by them, and by 20 more.
TEST(DraggedMass, GoesStraightOnThroughWhatTheRingDoesNotTellOf) {
  constexpr int kRing = 512;
  Mass told = free_puck();
  told.stiffness_N_per_m = 0;
  told.body.velocity_m_per_s = {0.1, 0, 0};
  told.body.damper_N_s_per_m = 0.2;
  Drag drag;
  drag.rest(1000);
  drag.mass.update(told, {.s = 1}, drag.now);
  drag.rest(20);
  const double kept = 1 / (1 + 1e-3 * 0.2 / kPuck_kg);
  const double slowed_m = 1e-4 * kept * (1 - std::pow(kept, kRing + 20)) / (1 - kept);
  EXPECT_NEAR(drag.mass.place_m().x(), 1e-4 * (1000 - kRing) + slowed_m, 1e-9);
  DraggedMass unknown;
  unknown.update(told, {.s = 1}, 1s);
  EXPECT_NEAR(unknown.place_m().x(), 0.1, 1e-12) << "no tick yet";
}

TEST(DraggedMass, GoesStraightOnThroughAPauseInTheTicks) {
  Mass told = free_puck();
  told.stiffness_N_per_m = 0;
  told.body.velocity_m_per_s = {0.1, 0, 0};
  told.body.damper_N_s_per_m = 10;
  Drag drag;
  drag.rest(10);
  drag.now += 80ms;
  drag.mass.update(told, {.s = 0.085}, drag.now);
  const double kept = 1 / (1 + 1e-3 * 10 / kPuck_kg);
  const double slowed_m_per_s = 0.1 * std::pow(kept, 5);
  EXPECT_NEAR(drag.mass.place_m().x(), 1e-4 * kept * (1 - std::pow(kept, 5)) / (1 - kept) + 0.08 * slowed_m_per_s,
              1e-9);
}

TEST(DraggedMass, TellsHowFarAnAnswerMovedIt) {
  Mass told = free_puck();
  told.stiffness_N_per_m = 0;
  Drag drag;
  drag.mass.update(told, {}, drag.now);
  drag.rest(100);
  EXPECT_EQ(drag.mass.deviation_m(), 0);
  told.place_m = {0, 0.003, 0.004};
  drag.mass.update(told, {.s = 0.04}, drag.now);
  EXPECT_NEAR(drag.mass.deviation_m(), 0.005, 1e-12);
  drag.mass.update(told, {.s = 0.04}, drag.now);
  EXPECT_EQ(drag.mass.deviation_m(), 0);
  told.id = 2;
  told.place_m.setZero();
  drag.mass.update(told, {.s = 0.04}, drag.now);
  EXPECT_EQ(drag.mass.deviation_m(), 0) << "another mass";
  told.place_m = {1, 0, 0};
  drag.mass.update(told, {.s = 0.04}, drag.now);
  EXPECT_NEAR(drag.mass.deviation_m(), 1, 1e-12);
  drag.mass.forget();
  EXPECT_EQ(drag.mass.deviation_m(), 0);
}

TEST(DraggedMass, StandsUnlessSomethingButTheDevicePullsAtItOrAtWhatItMeets) {
  const auto stands = [](const auto& change) {
    Mass told = free_puck();
    told.contact_count = 1;
    change(told);
    DraggedMass mass;
    mass.update(told, {}, 0ms);
    return mass.stands();
  };
  EXPECT_TRUE(stands([](auto&) {}));
  EXPECT_TRUE(stands([](auto& told) { told.contacts[1].met.bias_m_per_s2.x() = 1; })) << "it has one contact";
  EXPECT_FALSE(stands([](auto& told) { told.others_move_it = true; }));
  EXPECT_FALSE(stands([](auto& told) { told.body.bias_m_per_s2.z() = -1; }));
  EXPECT_FALSE(stands([](auto& told) { told.contacts[0].met.bias_m_per_s2.x() = 1; }));
}

/// Log-uniform draws up to bounds that is_sound has.
class WildMasses {
 public:
  Mass draw() {
    Mass mass{.id = static_cast<std::uint32_t>(random_() % 3),
              .place_m = point(1e3),
              .stiffness_N_per_m = size(1e7),
              .damping_N_s_per_m = size(1e5),
              .body = body(),
              .contact_count = static_cast<std::uint32_t>(random_() % 4),
              .radius_m = size(1e3)};
    for (Contact& contact : mass.contacts) {
      contact = {.normal = point(1).normalized(),
                 .gap_m = size(1) - size(1),
                 .compliance_per_kg = zero_or(1e6),
                 .stiffness_per_s2 = zero_or(1e9),
                 .damping_per_s = zero_or(1e5),
                 .friction = zero_or(100),
                 .radius_m = size(1e3),
                 .travel_m = zero_or(1),
                 .return_m = zero_or(1),
                 .met = body()};
    }
    return mass;
  }
  double size(double most) { return most * std::pow(10, -9 * std::uniform_real_distribution(0.0, 1.0)(random_)); }
  Point point(double most) { return size(most / 2) * Point(sign(), sign(), sign()); }

 private:
  double sign() { return std::uniform_real_distribution(-1.0, 1.0)(random_); }
  double zero_or(double most) { return random_() % 4 == 0 ? 0 : size(most); }
  Body body() {
    Eigen::Matrix3d root = Eigen::Matrix3d::Random();
    if (random_() % 3 == 0) root.row(0).setZero();
    Eigen::Matrix3d mobility = root.transpose() * root;
    mobility *= zero_or(1e4) / 9;
    return {.velocity_m_per_s = point(100),
            .bias_m_per_s2 = point(1e4),
            .mobility_per_kg = mobility,
            .spring_N_per_m = zero_or(1e7),
            .damper_N_s_per_m = zero_or(1e5),
            .dry_friction_N = zero_or(1e6)};
  }
  std::mt19937_64 random_{1};
};

TEST(DraggedMass, StaysFiniteAndDoesNotAllocateWhateverItIsTold) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  WildMasses masses;
  Drag drag;
  for (int i = 0; i < 5000; ++i) {
    const Mass told = masses.draw();
    const Point device_m = masses.point(1e3);
    const double age_s = masses.size(1);
    LocalModel model{.mass = told};
    model.has_mass = true;
    ASSERT_TRUE(is_sound(model)) << i;
    const test::AllocationGuard guard;
    if (i % 3 == 0) drag.mass.update(told, {.s = age_s}, drag.now);
    const DevicePoint device = drag.to(device_m);
    EXPECT_TRUE(drag.mass.place_m().allFinite()) << i;
    EXPECT_TRUE(drag.mass.force_N(device).allFinite()) << i;
    EXPECT_EQ(guard.heap_operations(), 0U);
  }
}

}  // namespace
}  // namespace forcebound::local_model
