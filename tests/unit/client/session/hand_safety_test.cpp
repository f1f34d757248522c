#include "forcebound/client/session/hand_safety.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace forcebound::client {
namespace {

using Trip = HandSafety::Trip;

Vector one(double value) { return Vector::Constant(1, value); }

/// A hand at 1 kHz, which feels what may be asked.
struct Hand {
  double tick(double at_m, double wanted_N) {
    applied = safety.limited(one(wanted_N),
                             {.position = one(at_m), .applied_N = applied, .elapsed_s = 1e-3, .handle = handle});
    return applied[0];
  }
  double ticks(int count, double at_m, double wanted_N) {
    double asked_N = 0;
    for (int i = 0; i < count; ++i) asked_N = tick(at_m, wanted_N);
    return asked_N;
  }
  HandSafety safety;
  Vector applied = one(0);
  control::Handle handle{};
};

TEST(HandSafety, WithoutLimitsChangesNothing) {
  Hand hand{HandSafety({})};
  EXPECT_EQ(hand.tick(0, 7), 7);
  EXPECT_EQ(hand.tick(5, -7), -7);
  EXPECT_EQ(hand.safety.take_trip(), std::nullopt);
}

TEST(HandSafety, RampsAfterTheStartAndAfterReadingsThatFailed) {
  Hand hand{HandSafety({.ramp_s = 0.1})};
  EXPECT_NEAR(hand.ticks(50, 0, 4), 2, 0.1);
  EXPECT_EQ(hand.ticks(60, 0, 4), 4);
  EXPECT_EQ(hand.ticks(30, std::numeric_limits<double>::quiet_NaN(), 4), 0);
  EXPECT_NEAR(hand.ticks(50, 0, 4), 2, 0.1);
  EXPECT_EQ(hand.ticks(60, 0, 4), 4);
}

TEST(HandSafety, FrozenReadingsEndTheForceOnceAndItComesBackByARamp) {
  HandSafety safety({.ramp_s = 0.1});
  const Vector at = one(0);
  const auto tick = [&](double believed, bool frozen) {
    return safety.limited(
        one(4), {.position = at, .applied_N = at, .elapsed_s = 1e-3, .believed = believed, .frozen = frozen})[0];
  };
  for (int i = 0; i < 110; ++i) (void)tick(1, false);
  EXPECT_EQ(tick(0.5, false), 2);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(tick(0, true), 0);
  EXPECT_EQ(safety.trips(Trip::frozen), 1U);
  EXPECT_EQ(safety.take_trip(), Trip::frozen);
  EXPECT_LT(tick(1, false), 0.1);
  for (int i = 0; i < 110; ++i) (void)tick(1, false);
  EXPECT_EQ(tick(1, false), 4);
}

TEST(HandSafety, AReadingThatIsLateBeginsNoRamp) {
  Hand hand{HandSafety({.ramp_s = 0.1})};
  EXPECT_EQ(hand.ticks(110, 0, 4), 4);
  EXPECT_EQ(hand.ticks(2, std::numeric_limits<double>::quiet_NaN(), 4), 0);
  EXPECT_EQ(hand.tick(0, 4), 4);
}

TEST(HandSafety, APauseBetweenReadingsIsNoPartOfTheRamp) {
  HandSafety safety({.ramp_s = 0.1});
  const Vector none = one(0);
  const Vector wanted = one(4);
  EXPECT_NEAR(safety.limited(wanted, {.position = none, .applied_N = none, .elapsed_s = 2})[0], 0.2, 1e-9);
}

TEST(HandSafety, APauseOfTheClientBeginsARamp) {
  HandSafety safety({.ramp_s = 0.1});
  const Vector none = one(0);
  const Vector wanted = one(4);
  for (int i = 0; i < 110; ++i) {
    (void)safety.limited(wanted, {.position = none, .applied_N = none, .elapsed_s = 1e-3});
  }
  EXPECT_NEAR(safety.limited(wanted, {.position = none, .applied_N = none, .elapsed_s = 2})[0], 0.2, 1e-9);
}

TEST(HandSafety, SeesASpeedThoughEachSecondReadingIsLate) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  Hand hand{HandSafety({.ramp_s = 0.1, .speed_m_per_s_max = 2})};
  EXPECT_EQ(hand.ticks(200, 0, 4), 4);
  double at_m = 0;
  for (int i = 0; i < 50; ++i) {
    (void)hand.tick(at_m += 3e-3, 4);
    (void)hand.tick((at_m += 3e-3) * none, 4);
  }
  EXPECT_EQ(hand.safety.take_trip(), Trip::speed);
  EXPECT_EQ(hand.tick(at_m += 3e-3, 4), 0) << "a late reading is no slow hand";
}

TEST(HandSafety, TheRampIsOneOfTheDevicesForceHoweverMuchIsWanted) {
  Hand hand{HandSafety({.ramp_s = 0.1}, 8)};
  EXPECT_NEAR(hand.ticks(10, 0, 1000), 0.8, 1e-9);
  EXPECT_NEAR(hand.ticks(40, 0, -1000), -4, 1e-9);
  EXPECT_NEAR(hand.ticks(10, 0, 2), 1.2, 1e-9) << "as without a bound";
}

TEST(HandSafety, GivesNoForceWhileTheHandIsTooFastAndThenARamp) {
  Hand hand{HandSafety({.ramp_s = 0.1, .speed_m_per_s_max = 2})};
  EXPECT_EQ(hand.ticks(200, 0, 4), 4);
  double at_m = 0;
  double asked_N = 0;
  for (int i = 0; i < 50; ++i) asked_N = hand.tick(at_m += 3e-3, 4);
  EXPECT_EQ(asked_N, 0);
  EXPECT_EQ(hand.safety.take_trip(), Trip::speed);
  EXPECT_EQ(hand.safety.take_trip(), std::nullopt) << "told once";
  for (int i = 0; i < 50; ++i) asked_N = hand.tick(at_m += 1.5e-3, 4);
  EXPECT_EQ(asked_N, 0) << "not yet half as fast";
  EXPECT_NEAR(hand.ticks(50, at_m, 4), 2, 0.3);
  EXPECT_EQ(hand.ticks(100, at_m, 4), 4);
  EXPECT_EQ(hand.safety.trips(Trip::speed), 1U);
}

TEST(HandSafety, GivesNeitherForceNorTorqueWhileTheHandTurnsTooFastAndThenARamp) {
  const Eigen::Vector3d wanted_N_m(0, 0, 0.2);
  Hand hand{HandSafety({.ramp_s = 0.1, .turn_rad_per_s_max = 20}, 10, 0.2)};
  double angle_rad = 0;
  const auto turn = [&](int count, double rad_per_s) {
    double asked_N = 0;
    for (int i = 0; i < count; ++i) {
      angle_rad += rad_per_s * 1e-3;
      hand.handle.orientation = {std::cos(angle_rad / 2), 0, std::sin(angle_rad / 2), 0};
      asked_N = hand.tick(0, 4);
    }
    return asked_N;
  };
  EXPECT_EQ(turn(200, 15), 4);
  EXPECT_EQ(turn(50, 30), 0);
  EXPECT_TRUE(hand.safety.limited_torque(wanted_N_m).isZero(0));
  EXPECT_EQ(hand.safety.take_trip(), Trip::turn);
  EXPECT_EQ(hand.safety.take_trip(), std::nullopt) << "told once";
  EXPECT_EQ(turn(50, 15), 0) << "not yet half as fast";
  EXPECT_NEAR(turn(50, 0), 2, 0.3);
  EXPECT_NEAR(hand.safety.limited_torque(wanted_N_m).z(), 0.1, 0.015);
  EXPECT_EQ(turn(100, 0), 4);
  EXPECT_EQ(hand.safety.trips(Trip::turn), 1U);
  EXPECT_EQ(hand.safety.trips(Trip::speed), 0U);
}

TEST(HandSafety, MeasuresATurnBetweenReadingsOfWhichEachSecondIsLate) {
  const auto trips_at = [](double rad_per_s) {
    Hand hand{HandSafety({.turn_rad_per_s_max = 20})};
    for (int i = 0; i < 100; ++i) {
      const double angle_rad = rad_per_s * 1e-3 * i;
      const bool late = i % 2 == 1;
      hand.handle.orientation = {std::cos(angle_rad / 2), std::sin(angle_rad / 2), 0, 0};
      (void)hand.tick(late ? std::numeric_limits<double>::quiet_NaN() : 0, 4);
    }
    return hand.safety.trips(Trip::turn);
  };
  EXPECT_EQ(trips_at(25), 1U);
  EXPECT_EQ(trips_at(15), 0U);
}

TEST(HandSafety, APauseLetsNoHandOffThatIsStillTooFast) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  Hand hand{HandSafety({.speed_m_per_s_max = 2})};
  double at_m = 0;
  for (int i = 0; i < 50; ++i) (void)hand.tick(at_m += 3e-3, 4);
  (void)hand.ticks(30, none, 4);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(hand.tick(at_m += 3e-3, 4), 0);
  EXPECT_EQ(hand.safety.trips(Trip::speed), 1U) << "it never was slow";
  EXPECT_EQ(hand.ticks(50, at_m, 4), 4);
}

TEST(HandSafety, AnOrientationAndItsNegativeAreTheSame) {
  Hand hand{HandSafety({.turn_rad_per_s_max = 1})};
  for (int i = 0; i < 20; ++i) {
    const double sign = i % 2 == 0 ? 1 : -1;
    hand.handle.orientation = {sign, 0, 0, 0};
    EXPECT_EQ(hand.tick(0, 4), 4);
  }
  EXPECT_EQ(hand.safety.take_trip(), std::nullopt);
}

TEST(HandSafety, ATurnBeforeAPauseIsNoSpeedAfterIt) {
  Hand hand{HandSafety({.turn_rad_per_s_max = 20})};
  hand.handle.orientation = {1, 0, 0, 0};
  EXPECT_EQ(hand.ticks(10, 0, 4), 4);
  hand.handle.orientation = {0, 1, 0, 0};
  EXPECT_EQ(hand.ticks(30, std::numeric_limits<double>::quiet_NaN(), 4), 0);
  EXPECT_EQ(hand.ticks(10, 0, 4), 4);
  EXPECT_EQ(hand.safety.take_trip(), std::nullopt);
}

TEST(HandSafety, OneJumpOfAnEncoderTripsNothing) {
  Hand hand{HandSafety({.speed_m_per_s_max = 2})};
  EXPECT_EQ(hand.ticks(10, 0, 4), 4);
  EXPECT_EQ(hand.ticks(10, 0.005, 4), 4) << "5 m/s for a millisecond";
}

TEST(HandSafety, GivesNoForceUnlessTheDeadManButtonIsPressed) {
  Hand hand{HandSafety({.ramp_s = 0.1, .dead_man_button = 2})};
  EXPECT_EQ(hand.ticks(200, 0, 4), 0) << "the device has no buttons";
  EXPECT_EQ(hand.safety.take_trip(), Trip::dead_man) << "so that the hand learns why it feels nothing";
  hand.handle.buttons = 3;
  EXPECT_EQ(hand.ticks(200, 0, 4), 0) << "others are pressed";
  EXPECT_EQ(hand.safety.trips(Trip::dead_man), 1U);
  hand.handle.buttons = 4;
  EXPECT_NEAR(hand.ticks(50, 0, 4), 2, 0.1);
  EXPECT_EQ(hand.ticks(60, 0, 4), 4);
  EXPECT_EQ(hand.safety.take_trip(), std::nullopt);
  hand.handle.buttons = 0;
  EXPECT_EQ(hand.tick(0, 4), 0) << "at once";
  EXPECT_EQ(hand.safety.take_trip(), Trip::dead_man);
  EXPECT_EQ(hand.safety.trips(Trip::dead_man), 2U);
  hand.handle.buttons = 4;
  EXPECT_NEAR(hand.ticks(50, 0, 4), 2, 0.1) << "in a ramp again";
}

TEST(HandSafety, WithoutADeadManButtonNoneIsAskedFor) {
  Hand hand{HandSafety({.ramp_s = 0.1})};
  EXPECT_EQ(hand.ticks(200, 0, 4), 4);
  EXPECT_EQ(hand.safety.trips(Trip::dead_man), 0U);
}

TEST(HandSafety, FadesBeyondTheWorkspace) {
  Hand hand{HandSafety({.workspace_radius_m = 0.1, .workspace_fade_m = 0.02})};
  EXPECT_EQ(hand.tick(0.1, 4), 4);
  EXPECT_NEAR(hand.tick(-0.105, 4), 3, 1e-9);
  EXPECT_NEAR(hand.tick(0.115, 4), 1, 1e-9);
  EXPECT_EQ(hand.tick(0.2, 4), 0);
  EXPECT_EQ(hand.tick(0.09, 4), 4);
  EXPECT_EQ(hand.tick(0.2, 4), 0);
  EXPECT_EQ(hand.safety.trips(Trip::workspace), 2U);
}

TEST(HandSafety, BoundsATorqueByTheSameRampAndFadeAndByALimitOfItsOwn) {
  const Eigen::Vector3d wanted_N_m(0, 0, 0.2);
  Hand ramp{HandSafety({.ramp_s = 0.1, .workspace_radius_m = 0.1, .workspace_fade_m = 0.02}, 10, 0.2)};
  (void)ramp.ticks(50, 0, 0);
  EXPECT_NEAR(ramp.safety.limited_torque(wanted_N_m).z(), 0.1, 0.005) << "half of the ramp";
  (void)ramp.ticks(60, 0, 0);
  EXPECT_EQ(ramp.safety.limited_torque(wanted_N_m), wanted_N_m);
  (void)ramp.tick(0.115, 0);
  EXPECT_NEAR(ramp.safety.limited_torque(wanted_N_m).z(), 0.05, 1e-9) << "outside the workspace";
  (void)ramp.tick(std::numeric_limits<double>::quiet_NaN(), 0);
  EXPECT_TRUE(ramp.safety.limited_torque(wanted_N_m).isZero(0)) << "without a reading";

  HandSafety warm({.rms_torque_N_m_max = 0.1, .rms_s = 2});
  const Vector none = one(0);
  Eigen::Vector3d asked_N_m = wanted_N_m;
  for (int i = 0; i < 20'000; ++i) {
    (void)warm.limited(none, {.position = none, .applied_N = none, .elapsed_s = 1e-3, .applied_N_m = asked_N_m});
    asked_N_m = warm.limited_torque(wanted_N_m);
  }
  EXPECT_NEAR(asked_N_m.z(), 0.1, 1e-9);
  EXPECT_EQ(warm.trips(Trip::heat), 1U);
}

TEST(HandSafety, BoundsTheMeanSquareOfTheForceWithoutAJump) {
  Hand hand{HandSafety({.rms_force_N_max = 3, .rms_s = 2})};
  double before_N = hand.tick(0, 6);
  double greatest_change_N = 0;
  double asked_N = 6;
  for (int i = 0; i < 20'000; ++i) {
    asked_N = hand.tick(0, 6);
    greatest_change_N = std::max(greatest_change_N, std::abs(asked_N - before_N));
    before_N = asked_N;
  }
  EXPECT_NEAR(asked_N, 3, 1e-9);
  EXPECT_LT(greatest_change_N, 0.004) << "3 N in each second";
  EXPECT_EQ(hand.safety.trips(Trip::heat), 1U);
  // A hand that rests lets the motors cool.
  (void)hand.ticks(10'000, 0, 0);
  EXPECT_EQ(hand.tick(0, 6), 6);
  EXPECT_EQ(hand.tick(0, -2), -2);
}

TEST(HandSafety, LeavesAShortPushAlone) {
  Hand hand{HandSafety({.rms_force_N_max = 3, .rms_s = 10})};
  EXPECT_EQ(hand.ticks(1000, 0, 6), 6);
  EXPECT_EQ(hand.safety.take_trip(), std::nullopt);
}

}  // namespace
}  // namespace forcebound::client
