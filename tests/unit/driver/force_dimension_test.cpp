#include <gmock/gmock.h>

#include <stdexcept>
#include <string>

#include "tests/unit/driver/driver_on_stand_in.hpp"

namespace forcebound::driver {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class ForceDimension : public DriverOnStandIn {
 protected:
  ForceDimension() : DriverOnStandIn("force-dimension", "libstand_in_dhd.so") {
    of("stand_in_stall", stall_ms);
    of("stand_in_force_at_enable", force_at_enable_N);
    open();
  }

  void (*stall_ms)(int) = nullptr;
  double (*force_at_enable_N)() = nullptr;
};

TEST_F(ForceDimension, KnowsItsDeviceAndSaysThatItsBoundsAreGuesses) {
  EXPECT_EQ(device->facts().name, "omega.3");
  EXPECT_EQ(device->facts().degrees_of_freedom(), 3);
  EXPECT_EQ(device->facts().force_N_max, 12);
  EXPECT_THAT(device->facts_in_words(), HasSubstr("bounds not identified"));
}

TEST_F(ForceDimension, MovesAlongTheForceInTheScenesFrame) {
  device->start();
  for (int axis = 0; axis < 3; ++axis) EXPECT_GT(moved_m(axis, 2), 0) << axis;
  Vector right = Vector::Zero(3);
  right[0] = 1;
  tick_until(right, [&] { return felt_N()[1] == 1; });
  EXPECT_EQ(felt_N()[0], 0) << "the scene's x is libdhd's y";
}

TEST_F(ForceDimension, GivesNoForceOnceNoCommandComes) {
  device->start();
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
  wait_for_no_force();
}

TEST_F(ForceDimension, StopsAtOnceAndGoesOnWithTheNextCommand) {
  device->start();
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
  device->stop(clock.now());
  wait_for_no_force();
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
}

TEST_F(ForceDimension, StartsAgainAfterAStop) {
  device->start();
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
  device->stop(clock.now());
  device->start();
  wait_for_no_force();
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
}

TEST_F(ForceDimension, LetsTheDevicesWatchdogEndTheForceAndSwitchesItOnAgain) {
  device->start();
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
  stall_ms(300);  // the driver's only thread that talks to the device
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 0; });
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
}

TEST_F(ForceDimension, DoesNotBringBackTheOldForceWithTheMotors) {
  device->start();
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
  (void)force_at_enable_N();
  stall_ms(300);
  double brought_back_N = -1;
  tick_until(Vector::Ones(3), [&] { return (brought_back_N = force_at_enable_N()) >= 0; });
  EXPECT_EQ(brought_back_N, 0);
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
}

TEST_F(ForceDimension, FailsWhileUnpluggedAndResumesAfterwards) {
  device->start();
  tick_until_read();
  plug(0);
  tick_until(Vector::Ones(3), [&] { return reading.status == Status::failed; });
  EXPECT_THAT(std::string(device->last_error()), HasSubstr("omega.3 does not answer"));
  plug(1);
  tick_until(Vector::Ones(3), [&] { return reading.status == Status::ok; });
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
}

TEST_F(ForceDimension, EndsWithZeroForce) {
  device->start();
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
  device.reset();
  EXPECT_EQ(felt_N()[2], 0);
}

TEST_F(ForceDimension, SaysWhatIsMissing) {
  EXPECT_THAT([&] { (void)opened("library=/nonexistent/libdhd.so"); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr("driver 'force-dimension': Force Dimension's library /nonexistent/libdhd.so is not "
                                  "there"),
                        HasSubstr("forcedimension.com"))));
  EXPECT_THAT([&] { (void)opened("library=libm.so.6"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("lacks the function dhdGetDeviceCount")));
  EXPECT_THAT([&] { (void)opened("speed=1"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("'speed=1' is not accepted; accepted are number=0 to 15")));
  device.reset();
  EXPECT_THAT([&] { (void)opened("number=3,library=" + stand_in); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no device number 3 among the 1 that libdhd finds")));
  plug(0);
  EXPECT_THAT([&] { (void)opened("library=" + stand_in); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no device found")));
}

}  // namespace
}  // namespace forcebound::driver
