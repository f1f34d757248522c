#include "forcebound/server/follower/follower.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "forcebound/server/follower/initial_energy.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/gantry_robot.hpp"

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using control::FollowerState;
using test::GantryRobot;
using test::GantrySettings;

/// A gantry that is led at 1 kHz by a place as a function of time; the leader's x is the world's.
class Led {
 public:
  explicit Led(FollowerSettings settings, const GantrySettings& gantry = {}) {
    settings.workspace.rotation.setIdentity();
    auto made = std::make_unique<GantryRobot>(gantry);
    robot = made.get();
    follower = std::make_unique<Follower>(std::move(made), settings, control::force_bounding_laws(), clock);
    follower->start();
    leader.position = Vector::Zero(3);
  }

  void run(Nanoseconds duration, const std::function<void(double, LeaderMotion&)>& lead, double given_W = 2) {
    for (const Nanoseconds begin = now; now < begin + duration; now += 1ms) {
      clock.time = now;
      follower->tick(now);
      if (!lead) continue;
      lead(time::to_seconds(now - begin), leader);
      leader.arrived = now;
      leader.energy_given_J += given_W * 1e-3;
      follower->receive(leader);
    }
  }
  void engage() {
    run(1s, [](double, LeaderMotion&) {});
    ASSERT_EQ(follower->report().state, FollowerState::following);
  }

  test::FakeClock clock;
  GantryRobot* robot = nullptr;
  std::unique_ptr<Follower> follower;
  LeaderMotion leader;
  Nanoseconds now{0};
};

TEST(Follower, FollowsWithinAMillimetreAndStaysPassive) {
  Led led({.architecture = "position-position"});
  led.engage();
  led.run(4s, [](double t, LeaderMotion& leader) {
    leader.position[1] = 0.03 * std::sin(3 * t);
    leader.position[2] = 0.02 * (1 - std::cos(2 * t));
  });
  EXPECT_NEAR(led.robot->place_m()[1], 0.03 * std::sin(12.0), 3e-3);
  EXPECT_NEAR(led.robot->place_m()[2], 0.02 * (1 - std::cos(8.0)), 3e-3);
  EXPECT_GE(led.follower->totals().port.minimum_J, -1e-12);
}

TEST(Follower, WithoutEnergyFromItsLeaderItHardlyMoves) {
  const auto lead = [](double t, LeaderMotion& leader) { leader.position[1] = 0.05 * std::min(t, 1.0); };
  Led poor({.architecture = "position-position", .initial_J = 0});
  poor.run(
      1s, [](double, LeaderMotion&) {}, 0);
  poor.run(2s, lead, 0);
  EXPECT_LT(std::abs(poor.robot->place_m()[1]), 1e-4) << "from rest nothing is dissipated, so nothing can be spent";
  EXPECT_GE(poor.follower->totals().port.minimum_J, -1e-12);
}

TEST(Follower, BorrowsFromItsStoreWhatItMovesWith) {
  const auto lead = [](double t, LeaderMotion& leader) { leader.position[1] = 0.05 * std::min(t, 1.0); };
  Led led({.architecture = "position-position", .initial_J = 0.5});
  led.run(
      1s, [](double, LeaderMotion&) {}, 0);
  led.run(2s, lead, 0);
  EXPECT_NEAR(led.robot->place_m()[1], 0.05, 2e-3);
  const FollowerTotals totals = led.follower->totals();
  EXPECT_EQ(totals.initial_J, 0.5);
  EXPECT_EQ(totals.received_J, 0);
  EXPECT_LT(totals.port.minimum_J, 0.5) << "it was spent";
  EXPECT_GE(totals.port.minimum_J, -1e-12);
}

TEST(Follower, BeginsWithNoMoreThanItsSpeedLimitAllows) {
  // 2 kg at 1 m/s.
  EXPECT_NEAR(largest_initial_J(test::GantryModel({})), 1, 1e-9);
  EXPECT_NEAR(Led({.architecture = "position-position"}).follower->totals().initial_J, 1, 1e-9);
  EXPECT_NEAR(Led({.architecture = "model-mediated"}).follower->totals().initial_J, 0.5, 1e-9);
  EXPECT_EQ(Led({.architecture = "position-position", .law = "none"}).follower->totals().initial_J, 0);
  EXPECT_EQ(Led({.initial_J = 1 + 1e-6}).follower->totals().initial_J, largest_initial_J(test::GantryModel({})))
      << "as it is told in a refusal";
  for (const double initial_J : {-0.1, 1.1, std::nan("")}) {
    try {
      const Led led({.initial_J = initial_J});
      ADD_FAILURE() << initial_J << " J were accepted";
    } catch (const std::invalid_argument& error) {
      const std::string said = error.what();
      EXPECT_NE(said.find("0 to 1 J"), std::string::npos) << said;
      EXPECT_NE(said.find("speed limit of 1 m/s"), std::string::npos) << said;
    }
  }
}

TEST(Follower, WithoutALawItLeaks) {
  Led led({.architecture = "position-position", .law = "none"});
  led.run(
      1s, [](double, LeaderMotion&) {}, 0);
  led.run(
      1s, [](double t, LeaderMotion& leader) { leader.position[1] = 0.05 * std::min(t, 1.0); }, 0);
  EXPECT_GT(led.robot->place_m()[1], 0.04);
  EXPECT_LT(led.follower->totals().port.minimum_J, -1e-4);
}

TEST(Follower, AsksForNoTorqueThatGrowsFasterThanTheRobotLetsIt) {
  const auto jump = [](double, LeaderMotion& leader) { leader.position[1] = 0.05; };
  const auto fastest_rise_N = [&](const GantrySettings& gantry) {
    Led led({.architecture = "position-position", .approach_m_per_s_max = 10}, gantry);
    led.engage();
    led.run(1s, jump);
    EXPECT_NEAR(led.robot->place_m()[1], 0.05, 5e-3) << "it gets there all the same";
    EXPECT_GE(led.follower->totals().port.minimum_J, -1e-12);
    return led.robot->fastest_rise_N();
  };
  EXPECT_GT(fastest_rise_N({}), 5);
  EXPECT_LE(fastest_rise_N({.force_N_per_s_max = 1000}), 1 + 1e-9);
}

TEST(Follower, ReflectsWhatItsSensorFeels) {
  Led led({.architecture = "position-force"});
  led.engage();
  led.run(3s, [](double t, LeaderMotion& leader) { leader.position[0] = 0.024 * std::min(t, 1.0); });
  const FollowerReport& report = led.follower->report();
  EXPECT_EQ(report.share, 1);
  const double force_N = report.map.to_leader_N(report.reflection.at(Eigen::Vector3d::Zero()))[0];
  EXPECT_LT(force_N, -2) << "the wall pushes back";
  EXPECT_NEAR(force_N, led.robot->wall_force_N(), 0.2);
}

TEST(Follower, TellsAModelOfTheWallThatItFelt) {
  Led led({.architecture = "model-mediated"});
  led.engage();
  led.run(4s, [](double t, LeaderMotion& leader) {
    leader.position[0] = 0.022 * std::min(t, 1.0) + (t > 1 ? 1e-3 * std::sin(6 * t) : 0);
  });
  const auto& plane = led.follower->report().reflection.plane;
  ASSERT_TRUE(plane);
  EXPECT_NEAR(plane->stiffness_N_per_m, 5000, 500);
  EXPECT_NEAR(plane->normal.x(), -1, 1e-3);
  EXPECT_NEAR(plane->place_m.x(), 0.02, 1e-3);
  EXPECT_EQ(plane->friction, 0);
}

TEST(Follower, StopsWhenItsLeaderIsSilentAndDoesNotJumpWhenItIsBack) {
  Led led({.architecture = "position-position"});
  led.engage();
  led.run(1s, [](double t, LeaderMotion& leader) { leader.position[1] = 0.1 * t; });
  led.run(150ms, nullptr);
  EXPECT_EQ(led.follower->report().state, FollowerState::holding);
  led.run(2s, nullptr);
  EXPECT_EQ(led.follower->report().state, FollowerState::stopped);
  EXPECT_TRUE(led.robot->is_stopped());
  EXPECT_EQ(led.follower->report().share, 0) << "no force on the hand";
  const Vector rest = led.robot->place_m();
  // The device is elsewhere meanwhile.
  led.run(1s, [](double, LeaderMotion& leader) { leader.position[1] = -0.2; });
  ASSERT_EQ(led.follower->report().state, FollowerState::following);
  EXPECT_LT((led.robot->place_m() - rest).norm(), 1e-3);
}

TEST(Follower, TheClutchKeepsTheOffset) {
  Led led({.architecture = "position-position"});
  led.leader.handle.buttons = 0;
  led.run(500ms, [](double, LeaderMotion& leader) { leader.handle.buttons = 1; });
  led.run(500ms, [](double, LeaderMotion& leader) { leader.handle.buttons = 0; });
  ASSERT_EQ(led.follower->report().state, FollowerState::following);
  led.run(1s, [](double t, LeaderMotion& leader) { leader.position[2] = 0.02 * t; });
  const double height_m = led.robot->place_m()[2];
  led.run(1s, [](double t, LeaderMotion& leader) {
    leader.handle.buttons = 1;
    leader.position[2] = 0.02 - 0.05 * t;
  });
  EXPECT_EQ(led.follower->report().state, FollowerState::clutched);
  EXPECT_NEAR(led.robot->place_m()[2], height_m, 2e-3);
  led.run(1s, [](double t, LeaderMotion& leader) {
    leader.handle.buttons = 0;
    leader.position[2] = -0.03 + 0.02 * t;
  });
  EXPECT_NEAR(led.robot->place_m()[2], height_m + 0.02, 3e-3) << "on from where it was";
}

TEST(Follower, StopsAtItsContactLimit) {
  Led led({.architecture = "position-position", .contact_N_max = 5});
  led.engage();
  led.run(2s, [](double t, LeaderMotion& leader) { leader.position[0] = 0.05 * std::min(t, 1.0); });
  EXPECT_EQ(led.follower->totals().why_stopped, "the contact force is beyond its limit");
  EXPECT_EQ(led.follower->totals().stops, 1U) << "held deep, it does not engage by itself";
}

TEST(Follower, StopsAJointThatIsTooFastOrOutsideOfItsLimits) {
  const auto why_stopped = [](const GantrySettings& gantry) {
    Led pushed({.architecture = "position-position"}, gantry);
    pushed.run(200ms, {});
    return pushed.follower->totals().why_stopped;
  };
  EXPECT_EQ(why_stopped({.push_N = 25}), "");
  EXPECT_EQ(why_stopped({.speed_m_per_s_max = 0.05, .push_N = 25}), "a joint is too fast");
  EXPECT_EQ(why_stopped({.highest_m = -0.2}), "a joint is beyond its limits");
}

TEST(Follower, ARobotThatIsUnpluggedFailsAndComesBack) {
  Led led({.architecture = "position-position"});
  led.engage();
  led.robot->unplugged = true;
  led.run(100ms, [](double, LeaderMotion&) {});
  EXPECT_EQ(led.follower->report().state, FollowerState::failed);
  EXPECT_EQ(led.follower->totals().why_stopped, "the robot refuses");
  led.robot->unplugged = false;
  led.run(1s, [](double t, LeaderMotion& leader) { leader.position[1] = 0.05 * std::sin(6 * t); });
  led.run(1s, [](double, LeaderMotion&) {});
  EXPECT_EQ(led.follower->report().state, FollowerState::following) << "after the operator was still";
  EXPECT_GE(led.follower->totals().port.minimum_J, -1e-12);
}

TEST(Follower, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const ArchitectureKind& kind : architectures()) {
    SCOPED_TRACE(kind.name);
    Led led({.architecture = std::string(kind.name)});
    led.engage();
    const std::function<void(double, LeaderMotion&)> lead = [](double t, LeaderMotion& leader) {
      leader.position[0] = 0.05 * t;
    };
    const test::AllocationGuard guard;
    led.run(1s, lead);
    EXPECT_EQ(guard.heap_operations(), 0U);
    EXPECT_LT(led.robot->wall_force_N(), -0.1) << "it touched";
  }
}

TEST(Follower, RefusesSettingsThatCannotBe) {
  const auto make = [](const FollowerSettings& settings, bool sensor = true) {
    test::FakeClock clock;
    GantrySettings gantry{.has_sensor = sensor};
    return Follower(std::make_unique<GantryRobot>(gantry), settings, control::force_bounding_laws(), clock);
  };
  EXPECT_NO_THROW(make({}));
  EXPECT_THROW(make({.architecture = "telepathy"}), std::invalid_argument);
  EXPECT_THROW(make({.law = "no-law"}), std::invalid_argument);
  EXPECT_THROW(make({.store_J = 0}), std::invalid_argument);
  EXPECT_THROW(make({.contact_N_max = -1}), std::invalid_argument);
  EXPECT_THROW(make({.times = {.hold = 2s, .stop = 1s}}), std::invalid_argument);
  EXPECT_THROW(make({.clutch_button = 32}), std::invalid_argument);
  EXPECT_THROW(make({.architecture = "position-force"}, false), std::invalid_argument);
  EXPECT_NO_THROW(make({.architecture = "position-position"}, false));
  EXPECT_NO_THROW(make({.law = "none", .initial_J = 0}));
  EXPECT_THROW(make({.law = "none", .initial_J = 0.1}), std::invalid_argument) << "which would not know of it";
}

TEST(Follower, ALostFirstReadingSendsItNowhere) {
  Led led({.architecture = "position-position", .law = "none"});
  led.robot->unplugged = true;
  led.run(
      20ms, [](double, LeaderMotion&) {}, 0);
  led.robot->unplugged = false;
  led.run(
      1s, [](double, LeaderMotion&) {}, 0);
  EXPECT_LT(led.robot->place_m().norm(), 1e-4);
  EXPECT_EQ(led.follower->report().state, FollowerState::following);
}

TEST(Follower, AnotherLeaderHasToEngage) {
  Led led({.architecture = "position-position"});
  led.engage();
  led.follower->leave();
  led.follower->begin_leader();
  led.leader.position[1] = 0.5;
  led.run(1ms, [](double, LeaderMotion&) {});
  led.run(2ms, [](double, LeaderMotion&) {});
  EXPECT_NE(led.follower->report().state, FollowerState::following);
}

/// Of a device that has an opening, or of one that has buttons.
void set_grip(LeaderMotion& leader, bool by_button, bool closed) {
  if (by_button) {
    leader.handle.buttons = closed ? 2 : 0;
  } else {
    leader.handle.gripper = closed ? 0 : 1;
  }
}

/// Another operator, whose grip is open: he keeps still, or presses and releases the clutch.
void change_operator(Led& led, bool by_button) {
  led.follower->leave();
  led.run(1s, nullptr);
  ASSERT_EQ(led.follower->report().state, FollowerState::stopped);
  led.follower->begin_leader();
  led.run(100ms, [&](double t, LeaderMotion& leader) {
    leader.position[1] = t;
    set_grip(leader, by_button, false);
    if (by_button) *leader.handle.buttons |= 1;
  });
  led.run(1s, [&](double, LeaderMotion& leader) { set_grip(leader, by_button, false); });
  ASSERT_EQ(led.follower->report().state, FollowerState::following);
}

TEST(Follower, KeepsWhatItHoldsUntilTheNextOperatorsGripHasMetWhereItStands) {
  for (const bool by_button : {false, true}) {
    SCOPED_TRACE(by_button ? "by button" : "by opening");
    Led led({.architecture = "position-position"});
    const auto hold = [&](bool closed) {
      return [=](double, LeaderMotion& leader) { set_grip(leader, by_button, closed); };
    };
    if (by_button) led.run(500ms, [](double, LeaderMotion& leader) { leader.handle.buttons = 1; });
    led.run(1s, hold(false));
    ASSERT_EQ(led.follower->report().state, FollowerState::following);
    EXPECT_EQ(led.robot->gripper(), 1);
    led.robot->held_opening = 0.3;
    led.run(1s, hold(true));
    ASSERT_EQ(led.robot->gripper_command, 0) << "it squeezes";

    change_operator(led, by_button);
    EXPECT_EQ(led.robot->gripper_command, 0) << "it still holds";
    EXPECT_TRUE(led.follower->report().picture.grip_waits);
    led.run(100ms, hold(true));
    EXPECT_EQ(led.robot->gripper_command, 0);
    EXPECT_FALSE(led.follower->report().picture.grip_waits);
    led.run(100ms, hold(false));
    EXPECT_EQ(led.robot->gripper_command, 1) << "let go by whom it obeys";
  }
}

TEST(Follower, KeepsWhatItHoldsWhereTheGripWasLetGoWhileTheClutchWasPressed) {
  Led led({.architecture = "position-position"});
  const auto press = [](std::uint32_t buttons) {
    return [=](double, LeaderMotion& leader) { leader.handle.buttons = buttons; };
  };
  for (const std::uint32_t buttons : {1U, 0U, 2U, 3U, 1U, 0U}) led.run(200ms, press(buttons));
  ASSERT_EQ(led.follower->report().state, FollowerState::following);
  EXPECT_EQ(led.robot->gripper_command, 0);
}

TEST(Follower, GoesOnWithTheGripOfAnOperatorWhoWasSilentForAWhile) {
  Led led({.architecture = "position-position"});
  led.leader.handle.gripper = 1;
  led.engage();
  led.run(150ms, nullptr);
  ASSERT_EQ(led.follower->report().state, FollowerState::holding);
  led.run(100ms, [](double, LeaderMotion& leader) { leader.handle.gripper = 0; });
  ASSERT_EQ(led.follower->report().state, FollowerState::following);
  EXPECT_EQ(led.robot->gripper_command, 0) << "he closed it meanwhile";
}

/// The next operator in free space after the one who is there: what he feels of the sensor.
double felt_in_free_space_N(Led& led) {
  led.follower->leave();
  led.run(3s, nullptr);
  EXPECT_EQ(led.follower->report().state, FollowerState::stopped);
  led.follower->begin_leader();
  led.run(200ms, [](double t, LeaderMotion& leader) { leader.position[1] = t; });
  led.run(1s, [](double, LeaderMotion&) {});
  EXPECT_EQ(led.follower->report().state, FollowerState::following);
  const FollowerReport& report = led.follower->report();
  return report.map.to_leader_N(report.reflection.at(report.picture.tool.position)).norm();
}

TEST(Follower, DoesNotReflectDriftOfItsSensorToTheNextOperator) {
  for (const bool while_led : {false, true}) {
    SCOPED_TRACE(while_led ? "drifts while it is led" : "drifts while it stands");
    Led led({.architecture = "position-force"});
    led.engage();
    const auto drift = [&](double t) { led.robot->drift_N = {0, 0.05 * t, 0.29 * t}; };
    if (while_led) {
      led.run(10s, [&](double t, LeaderMotion& leader) {
        drift(t);
        leader.position = Eigen::Vector3d(0, 0.01, 0.04) * std::sin(2 * t);
      });
    } else {
      led.follower->leave();
      led.run(1s, nullptr);
      for (int ms = 0; ms < 10'000; ++ms) {
        drift(1e-3 * ms);
        led.run(1ms, nullptr);
      }
    }
    ASSERT_GT(led.robot->drift_N.norm(), 2.9);
    EXPECT_LT(felt_in_free_space_N(led), 0.1);
    EXPECT_LT(*led.follower->report().picture.bias_age, 2s);
  }
}

TEST(Follower, DoesNotTakeTheForceThatItPressesWithForBias) {
  Led led({.architecture = "position-force"});
  led.engage();
  // Onto the wall, and sliding along it.
  led.run(3s, [](double t, LeaderMotion& leader) {
    leader.position[0] = 0.022 * std::min(t, 1.0);
    leader.position[2] = 0.03 * std::max(0.0, t - 1);
  });
  const double pressed_N = led.robot->sensed_force()->force_N[0];
  ASSERT_GT(pressed_N, 2);
  led.follower->learn_bias(led.now);
  led.run(10ms, [](double, LeaderMotion&) {});
  EXPECT_EQ(led.follower->report().bias.answer, SensorBias::Answer::touches);
  EXPECT_NEAR(led.follower->report().bias.off_N, pressed_N, 1);
  led.robot->drift_N = {3, 0, 0};  // as if somebody else pushed it on
  led.follower->leave();
  led.run(3s, nullptr);
  ASSERT_EQ(led.follower->report().state, FollowerState::stopped);
  led.robot->drift_N.setZero();
  led.follower->learn_bias(led.now);
  led.run(10ms, nullptr);
  EXPECT_EQ(led.follower->report().bias.answers, 2U);
  EXPECT_EQ(led.follower->report().bias.answer, SensorBias::Answer::touches);
  EXPECT_GT(*led.follower->report().picture.bias_age, 5s) << "nothing was learned since it engaged";
}

TEST(Follower, LearnsItsSensorsBiasWhenItIsTold) {
  Led led({.architecture = "position-force"});
  led.engage();
  led.robot->drift_N = {0, 0, 3};
  led.follower->learn_bias(led.now);
  led.run(500ms, [](double, LeaderMotion&) {});
  EXPECT_EQ(led.follower->report().bias.answer, SensorBias::Answer::touches) << "a step may be a touch";
  led.run(500ms, [](double t, LeaderMotion& leader) { leader.position[2] = 0.05 * std::min(1.0, 2 * t); });
  led.follower->learn_bias(led.now);
  led.run(500ms, [](double, LeaderMotion&) {});
  EXPECT_EQ(led.follower->report().bias.answer, SensorBias::Answer::learned) << "no touch is the same 2 cm along it";
  EXPECT_NEAR(led.follower->report().bias.off_N, 3, 1e-6);
  EXPECT_LT(led.follower->report().picture.sensed_N.norm(), 1e-6);
  led.robot->held_opening = 0.3;
  led.run(10ms, [](double, LeaderMotion& leader) { leader.handle.gripper = 1; });
  led.run(10ms, [](double, LeaderMotion& leader) { leader.handle.gripper = 0; });
  led.follower->learn_bias(led.now);
  led.run(10ms, [](double, LeaderMotion&) {});
  EXPECT_EQ(led.follower->report().bias.answer, SensorBias::Answer::holds);

  Led without({.architecture = "position-position"}, {.has_sensor = false});
  without.follower->learn_bias(without.now);
  without.run(10ms, nullptr);
  EXPECT_EQ(without.follower->report().bias.answer, SensorBias::Answer::no_sensor);
}

TEST(Follower, AMotionThatNoHandCanMakeIsRefused) {
  Led led({.architecture = "position-position"});
  led.engage();
  led.run(10ms, [](double, LeaderMotion& leader) { leader.position[2] = 1e200; });
  EXPECT_EQ(led.follower->totals().motions_refused, 10U);
  led.leader.position.setZero();
  led.run(1s, [](double, LeaderMotion&) {});
  EXPECT_EQ(led.follower->report().state, FollowerState::following);
  EXPECT_LT(led.robot->place_m().norm(), 1e-3);
}

}  // namespace
}  // namespace forcebound::server
