#include "forcebound/server/robot/driver_robot.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "forcebound/text/file.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/driven_arm.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using Status = device::Reading::Status;
using test::driven_arm;
using test::robot_driver;
using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

Vector push(double torque_N_m) { return Vector::Constant(7, torque_N_m); }

/// Reads and commands at 1 kHz; the readings' states.
std::vector<Status> drive(DriverRobot& arm, const Vector& torque, int ticks, Nanoseconds begin) {
  std::vector<Status> states;
  for (int tick = 0; tick < ticks; ++tick) {
    const Nanoseconds now = begin + tick * 1ms;
    states.push_back(arm.read(now).status);
    arm.apply(now, torque);
  }
  return states;
}

TEST(DriverRobot, HasWhatItsDriverTells) {
  const auto arm = driven_arm();
  EXPECT_EQ(arm->facts().name, "arm 7");
  EXPECT_EQ(arm->facts().joints(), 7);
  EXPECT_EQ(arm->facts().damping(0, 0), 5);
  EXPECT_EQ(arm->facts().damping(6, 6), 1);
  EXPECT_EQ(arm->facts().hold_s_max, 0.01);
  EXPECT_TRUE(arm->bounds_are_identified());
  EXPECT_FALSE(arm->is_simulated());
  EXPECT_TRUE(arm->compensates_gravity());
  ASSERT_TRUE(arm->force_sensor());
  EXPECT_EQ(arm->force_sensor()->period, 1ms);
  EXPECT_FALSE(driven_arm("sensor=0")->force_sensor());
  EXPECT_EQ(arm->facts_in_words(),
            "arm 7: 7 joints, damping 1 to 5 N m s/rad, largest torque 20 to 60 N m, period 1 ms, holds a torque for "
            "10 ms");
}

TEST(DriverRobot, HasTheGeometryThatItsDriverTells) {
  const auto arm = driven_arm();
  const ToolPose tool = arm->model().pose(arm->model().rest());
  const double x_m = 0.35 * std::sin(0.5) + 0.35 * std::sin(2.1);
  const double z_m = 0.3 + 0.35 * std::cos(0.5) + 0.35 * std::cos(2.1) - 0.2;
  EXPECT_LT((tool.position - Eigen::Vector3d(x_m, 0, z_m)).norm(), 1e-12);
  EXPECT_LT((tool.orientation * Eigen::Vector3d::UnitZ() + Eigen::Vector3d::UnitZ()).norm(), 1e-12) << "straight down";
}

TEST(DriverRobot, IsRefusedInOneLineWhereItCannotBe) {
  const auto refused = [](const std::string& robot, const std::string& why) {
    EXPECT_THAT([&] { (void)open_robot(robot); },
                ThrowsMessage<std::runtime_error>(AllOf(HasSubstr(why), Not(HasSubstr("\n")))))
        << robot;
  };
  const std::string arm = robot_driver() + ":";
  refused(std::string(FORCEBOUND_TEST_DRIVERS) + "/forcebound-device-slider.so",
          "is for haptic devices, not for robots");
  refused(robot_driver("lame"), "lacks the function 'resume'");
  refused("/nonexistent/arm.so", "driver '/nonexistent/arm.so': there is no such file");
  const test::TemporaryFolder folder;
  text::write_file(folder.file("arm.so"), "no library");
  refused(folder.file("arm.so"), "cannot be loaded");
  refused(arm + "colour=red", "'colour=red' is not accepted");
  refused(arm + "fault=open", "no arm at 192.0.2.1: is its power on?");
  refused(arm + "fault=crash-open", "Segmentation fault");
  refused(arm + "fault=describe", "driver 'arm' does not describe its robot");
  refused(arm + "joints=8", "driver 'arm': its robot's joints must be from 1 to 7, got 8");
  refused(arm + "joints=0", "its robot's joints must be from 1 to 7, got 0");
  refused(arm + "fault=undamped", "driver 'arm': its robot's damping of joint 1 must be > 0, got 0");
  refused(arm + "rate=-1", "torque_rate_max of joint 1 must be from 0 to");
  refused(arm + "gravity=1,brakes=0",
          "driver 'arm': gravity is left to the program, so the robot must have brakes, or it would fall at each stop");
}

TEST(DriverRobot, SaysWhyItDoesNotStart) {
  const auto arm = driven_arm("fault=start");
  EXPECT_THAT([&] { arm->start(); }, ThrowsMessage<std::runtime_error>("driver 'arm': its emergency stop is pressed"));
}

TEST(DriverRobot, MovesByTorquesAndIsAudited) {
  const auto arm = driven_arm();
  arm->start();
  Vector torque = push(0);
  torque[0] = 10;
  EXPECT_THAT(drive(*arm, torque, 500, 1s), Each(Status::ok));
  const device::Reading reading = arm->read(1500ms);
  EXPECT_GT(reading.joint[0], 0.1);
  EXPECT_EQ(reading.position, reading.joint);
  EXPECT_EQ(reading.latched, 1500ms);
  EXPECT_EQ(arm->effective_at(), 1499ms);
  EXPECT_EQ(arm->released_at(), std::nullopt);
  ASSERT_TRUE(arm->audit());
  EXPECT_LT(arm->audit()->energy_J, 0) << "no law bounds this";
  (void)arm->read(1600ms);
  EXPECT_EQ(arm->released_at(), 1509ms) << "10 ms after the last command";
}

TEST(DriverRobot, TorquesBeyondTheLargestAreShortenedByOneFactor) {
  const auto asked = driven_arm();
  const auto given = driven_arm();
  (void)drive(*asked, push(60), 50, 1s);
  (void)drive(*given, push(20), 50, 1s);
  EXPECT_LT((asked->read(1050ms).joint - given->read(1050ms).joint).norm(), 1e-12) << "joint 7 gives 20 N m";
}

TEST(DriverRobot, TorquesThatAreNoNumbersOrTooFewAreZeroAndCounted) {
  const auto arm = driven_arm();
  (void)drive(*arm, push(kNotANumber), 10, 1s);
  (void)drive(*arm, Vector::Ones(3), 10, 2s);
  EXPECT_EQ(arm->counters().faulty_commands, 20U);
  EXPECT_EQ(arm->read(3s).joint, arm->model().rest());
}

TEST(DriverRobot, FaultyReadingsAreNotUsedAndTheNextGoodOneIs) {
  for (const auto& [fault, why] :
       std::initializer_list<std::tuple<std::string, std::string>>{{"nan", "not finite"},
                                                                   {"far", "a joint is far beyond its limits"},
                                                                   {"backwards", "backwards in time"},
                                                                   {"future", "in the future"},
                                                                   {"fails", "joint 4 is too hot"},
                                                                   {"unplugged", "the robot is unplugged"}}) {
    const auto arm = driven_arm("fault=" + fault);
    arm->start();
    EXPECT_THAT(drive(*arm, push(0), 100, 1s), Each(Status::ok)) << fault;
    EXPECT_THAT(drive(*arm, push(0), 100, 2s), Each(testing::Ne(Status::ok))) << fault;
    EXPECT_THAT(std::string(arm->last_error()), AllOf(HasSubstr(why), Not(HasSubstr("\n")))) << fault;
    EXPECT_THAT(drive(*arm, push(0), 100, 3s), Each(Status::ok)) << fault;
  }
}

TEST(DriverRobot, CommandsThatFailAreToldAndCounted) {
  const auto arm = driven_arm("fault=write");
  (void)drive(*arm, push(0), 100, 1s);
  EXPECT_FALSE(arm->write_failed());
  (void)drive(*arm, push(0), 100, 2s);
  EXPECT_TRUE(arm->write_failed());
  EXPECT_EQ(arm->counters().failed_writes, 100U);
  EXPECT_EQ(arm->counters().unexplained, 100U);
  EXPECT_EQ(arm->last_error(), "the command failed");
}

TEST(DriverRobot, IsGivenNoTorqueFromASoftStopUntilItsBrakesAreOpen) {
  const auto arm = driven_arm();
  arm->start();
  (void)drive(*arm, push(5), 300, 1s);
  arm->soft_stop(1300ms);
  EXPECT_TRUE(arm->is_stopped());
  EXPECT_THAT(drive(*arm, push(5), 500, 1300ms), Each(Status::ok)) << "it is read on";
  EXPECT_TRUE(arm->write_failed());
  const Vector held = arm->read(1800ms).joint;
  EXPECT_LT((arm->read(1900ms).joint - held).norm(), 1e-6) << "its brakes hold it";
  arm->resume(1900ms);
  EXPECT_TRUE(arm->is_stopped()) << "until they are open";
  (void)arm->read(1920ms);
  EXPECT_TRUE(arm->is_stopped());
  (void)arm->read(1950ms);
  (void)arm->read(1951ms);
  EXPECT_FALSE(arm->is_stopped());
  (void)drive(*arm, push(5), 300, 1952ms);
  EXPECT_FALSE(arm->write_failed());
  EXPECT_GT(arm->read(2252ms).joint[0], held[0] + 1e-2);
}

/// How far the arm moves in 4 s after its brakes should have opened.
double moved_rad(const std::string& settings) {
  const auto arm = driven_arm(settings);
  arm->start();
  (void)drive(*arm, push(0), 10, 990ms);
  arm->soft_stop(1s);
  arm->resume(1s);
  (void)drive(*arm, push(5), 4000, 1s);
  EXPECT_TRUE(arm->is_stopped()) << settings;
  return (arm->read(5s).joint - arm->model().rest()).cwiseAbs().maxCoeff();
}

TEST(DriverRobot, StaysStoppedIfItsBrakesDoNotOpen) { EXPECT_EQ(moved_rad("fault=never-opens"), 0); }

TEST(DriverRobot, IsStoppedAgainIfItsBrakesOpenTooLateToBeWaitedFor) {
  EXPECT_LT(moved_rad("fault=opens-late,gravity=1"), 1e-9);
}

TEST(DriverRobot, IsStoppedAgainIfItSaysThatItsBrakesDoNotOpen) {
  EXPECT_LT(moved_rad("fault=resume,gravity=1"), 1e-9);
}

TEST(DriverRobot, IsHeldWhileItsBrakesOpen) {
  const auto arm = driven_arm("gravity=1");
  arm->start();
  (void)drive(*arm, push(0), 10, 990ms);
  arm->soft_stop(1s);
  arm->resume(1s);
  // They begin to open after the last command before the stop, let go after 25 ms and are open after 50 ms.
  (void)drive(*arm, push(5), 48, 1s);
  EXPECT_TRUE(arm->is_stopped());
  EXPECT_LT((arm->read(1048ms).joint - arm->model().rest()).cwiseAbs().maxCoeff(), 1e-9);
  (void)arm->read(1049ms);
  (void)arm->read(1050ms);
  EXPECT_FALSE(arm->is_stopped());
  EXPECT_EQ(arm->counters().failed_writes, 0U) << "what nobody commands does not fail";
}

TEST(DriverRobot, IsStoppedOnceMoreWhereACallOutlivedAStopFromOutside) {
  const auto arm = driven_arm("gravity=1,fault=rearms");
  arm->start();
  (void)drive(*arm, push(0), 10, 990ms);
  arm->stop(1s);
  (void)drive(*arm, push(0), 1000, 1s);
  EXPECT_TRUE(arm->is_stopped());
  EXPECT_LT((arm->read(2s).joint - arm->model().rest()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(DriverRobot, IsGivenNoTorqueBeforeItsFirstGoodReading) {
  const auto arm = driven_arm("gravity=1,fault=fails,from=0");
  arm->start();
  (void)drive(*arm, push(1), 50, 1s);
  EXPECT_TRUE(arm->write_failed());
  EXPECT_EQ(arm->counters().failed_writes, 0U) << "there was none";
}

TEST(DriverRobot, IsHeldThroughReadingsThatAreLost) {
  const auto arm = driven_arm("gravity=1,fault=nan");
  arm->start();
  (void)drive(*arm, push(0), 200, 1s);
  EXPECT_LT((arm->read(1200ms).joint - arm->model().rest()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(DriverRobot, ASampleOfItsSensorCountsForTenPeriods) {
  const auto arm = driven_arm("fault=frozen");
  arm->start();
  (void)drive(*arm, push(0), 100, 1s);
  EXPECT_TRUE(arm->sensed_force());
  (void)drive(*arm, push(0), 10, 1100ms);
  ASSERT_TRUE(arm->sensed_force());
  EXPECT_EQ(arm->sensed_force()->sampled, 1099ms);
  (void)drive(*arm, push(0), 2, 1110ms);
  EXPECT_FALSE(arm->sensed_force());
  EXPECT_EQ(arm->last_error(), "its force sensor tells nothing new");
  (void)drive(*arm, push(0), 100, 1112ms);
  EXPECT_TRUE(arm->sensed_force()) << "it tells again";
}

TEST(DriverRobot, TellsThatItStoppedByItself) {
  const auto arm = driven_arm("fault=stops");
  arm->start();
  (void)drive(*arm, push(0), 100, 1s);
  EXPECT_FALSE(arm->is_stopped());
  (void)drive(*arm, push(0), 1, 2s);
  EXPECT_TRUE(arm->is_stopped());
  EXPECT_EQ(arm->last_error(), "the robot stopped itself");
}

TEST(DriverRobot, ThatStoppedByItselfTellsWhenItReleasedItsTorque) {
  const auto arm = driven_arm("fault=stops");
  arm->start();
  (void)drive(*arm, push(5), 100, 1s);
  (void)arm->read(1200ms);
  EXPECT_TRUE(arm->is_stopped());
  EXPECT_EQ(arm->released_at(), 1109ms) << "10 ms after the last command";
  EXPECT_TRUE(arm->write_failed());
}

TEST(DriverRobot, CountsAsStoppedOnceAnotherThreadHasStoppedIt) {
  const auto arm = driven_arm();
  arm->start();
  (void)drive(*arm, push(1), 10, 1s);
  arm->stop(1010ms);
  (void)drive(*arm, push(1), 10, 1010ms);
  EXPECT_TRUE(arm->is_stopped());
  EXPECT_TRUE(arm->write_failed());
  EXPECT_THAT(std::string(arm->last_error()), HasSubstr("did not return from a call"));
}

TEST(DriverRobot, IsHeldAgainstGravityWhereItLeavesThatToTheProgram) {
  const auto held = driven_arm("gravity=1");
  held->start();
  EXPECT_FALSE(held->compensates_gravity());
  EXPECT_EQ(held->audit(), std::nullopt);
  (void)drive(*held, push(0), 2000, 1s);
  EXPECT_LT((held->read(3s).joint - held->model().rest()).cwiseAbs().maxCoeff(), 1e-9);

  const auto falling = driven_arm("gravity=1");
  falling->start();
  for (auto now = 1s + 0ms; now < 3s; now += 1ms) (void)falling->read(now);
  EXPECT_GT((falling->read(3s).joint - falling->model().rest()).cwiseAbs().maxCoeff(), 0.1) << "without a command";
}

TEST(DriverRobot, DoesNotAllocateInATick) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto arm = driven_arm("gravity=1,fault=nan");
  arm->start();
  const Vector torque = push(1);
  const test::AllocationGuard guard;
  for (int tick = 0; tick < 300; ++tick) {
    (void)arm->read(1s + tick * 1ms);
    arm->command_gripper(1s + tick * 1ms, 0.5);
    arm->apply(1s + tick * 1ms, torque);
  }
  arm->soft_stop(1300ms);
  arm->resume(1300ms);
  arm->stop(1300ms);
  (void)arm->read(1301ms);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::server
