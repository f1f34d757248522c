#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "tests/unit/driver/driver_on_stand_in.hpp"

namespace forcebound::driver {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class OpenHaptics : public DriverOnStandIn {
 protected:
  OpenHaptics() : DriverOnStandIn("openhaptics", "libstand_in_hd.so") {
    of("stand_in_calibrate", calibrate);
    of("stand_in_warn", warn);
    of("stand_in_halt", halt);
    of("stand_in_want_update", want_update);
    of("stand_in_force_at_update", force_at_update_N);
    calibrate(1);
    // Where the test sees and presses what the library has.
    open(",process=same");
  }

  void expect_force() {
    tick_until(Vector::Ones(3), [&] { return felt_N()[1] == 1; });
  }

  [[nodiscard]] std::string why() const { return std::string(device->last_error()); }

  void (*calibrate)(int) = nullptr;
  void (*warn)(unsigned) = nullptr;
  void (*halt)() = nullptr;
  void (*want_update)() = nullptr;
  double (*force_at_update_N)() = nullptr;
};

TEST_F(OpenHaptics, KnowsItsDeviceAndSaysThatItsBoundsAreGuesses) {
  EXPECT_EQ(device->facts().name, "Touch X 0042");
  EXPECT_EQ(device->facts().degrees_of_freedom(), 3);
  EXPECT_EQ(device->facts().force_N_max, 7.9);
  EXPECT_EQ(device->facts().encoder_step[0], 2.3e-5);
  EXPECT_EQ(device->safety().rms_force_N_max, 1.75) << "what libHD says that the motors may give for ever";
  EXPECT_THAT(device->facts_in_words(), HasSubstr("bounds not identified"));
}

TEST_F(OpenHaptics, MovesAlongTheForceInTheScenesFrame) {
  device->start();
  for (int axis = 0; axis < 3; ++axis) EXPECT_GT(moved_m(axis, 2), 0) << axis;
  Vector away_and_up = Vector::Zero(3);
  away_and_up << 0, 2, 3;
  const std::array<double, 3> in_libhd{0, 3, -2};
  tick_until(away_and_up, [&] { return felt_N() == in_libhd; });
}

TEST_F(OpenHaptics, GivesNoForceOnceNoCommandComes) {
  device->start();
  expect_force();
  wait_for_no_force();
}

TEST_F(OpenHaptics, StopsAtOnceAndGoesOnWithTheNextCommand) {
  device->start();
  expect_force();
  device->stop(clock.now());
  wait_for_no_force();
  expect_force();
}

TEST_F(OpenHaptics, StartsAgainAfterAStop) {
  device->start();
  expect_force();
  device->stop(clock.now());
  device->start();
  wait_for_no_force();
  expect_force();
}

TEST_F(OpenHaptics, FailsWhileUnpluggedAndResumesAfterwards) {
  device->start();
  expect_force();
  plug(0);
  tick_until(Vector::Ones(3), [&] { return reading.status == Status::failed; });
  EXPECT_THAT(why(), HasSubstr("Touch X 0042 does not answer (libHD's error 0x0302)"));
  const time::Nanoseconds plugged_in = clock.now();
  plug(1);
  tick_until(Vector::Ones(3), [&] { return reading.status == Status::ok; });
  EXPECT_GT(last.latched, plugged_in) << "not a reading from before";
  expect_force();
}

TEST_F(OpenHaptics, BeginsAnewWhenTheSchedulerHasEndedWithoutAWord) {
  device->start();
  expect_force();
  halt();
  int silent = 0;
  tick_until(Vector::Ones(3), [&] {
    silent = reading.status == Status::ok ? 0 : silent + 1;
    return silent == 5;
  });
  tick_until(Vector::Ones(3), [&] { return reading.status == Status::ok; });
  expect_force();
}

TEST_F(OpenHaptics, FailsAReadingForEachErrorOfForceAndGoesOn) {
  device->start();
  expect_force();
  warn(0x0200);
  tick_until(Vector::Ones(3), [&] { return reading.status == Status::failed; });
  EXPECT_THAT(why(), HasSubstr("Touch X 0042 gives no force: warm motors (0x0200)"));
  tick_until(Vector::Ones(3), [&] { return reading.status == Status::ok; });
}

TEST_F(OpenHaptics, GivesNoForceUntilItIsCalibrated) {
  calibrate(0);
  device->start();
  tick_until(Vector::Ones(3), [&] { return reading.status == Status::failed; });
  EXPECT_THAT(why(), HasSubstr("put its stylus into the inkwell"));
  EXPECT_EQ(felt_N()[1], 0);
  calibrate(1);
  expect_force();
}

TEST_F(OpenHaptics, UpdatesItsCalibrationWithoutForceAndTellsThatThePositionMayHaveJumped) {
  device->start();
  expect_force();
  (void)force_at_update_N();
  want_update();
  tick_until(Vector::Ones(3), [&] { return reading.status == Status::failed; });
  EXPECT_THAT(why(), HasSubstr("Touch X 0042 was calibrated anew: its position may have jumped"));
  tick_until(Vector::Ones(3), [&] { return reading.status == Status::ok; });
  EXPECT_EQ(force_at_update_N(), 0);
  expect_force();
}

TEST_F(OpenHaptics, EndsWithZeroForce) {
  device->start();
  expect_force();
  device.reset();
  EXPECT_EQ(felt_N()[1], 0);
}

TEST_F(OpenHaptics, EndsWhileUnplugged) {
  device->start();
  tick_until_read();
  plug(0);
  tick_until(Vector::Ones(3), [&] { return reading.status == Status::failed; });
  device.reset();
  plug(1);
  open(",process=same");
  device->start();
  expect_force();
}

// The stand-in's stylus turns by 10 rad/m about libHD's y axis, the scene's z, as it moves to the right.
TEST_F(OpenHaptics, TellsButtonsAndTheStylusInTheScenesFrame) {
  const std::string file = std::string(FORCEBOUND_DRIVERS) + "/forcebound-device-openhaptics.so";
  device.reset();
  const DriverLibrary library(file, "openhaptics");
  const forcebound_driver& driver = library.functions();
  const std::array<forcebound_setting, 2> settings{{{"library", stand_in.c_str()}, {"process", "same"}}};
  std::array<char, FORCEBOUND_TEXT_BYTES> error{};
  forcebound_device* touch = nullptr;
  ASSERT_EQ(driver.open(settings.data(), settings.size(), &touch, error.data(), error.size()), FORCEBOUND_OK)
      << error.data();
  ASSERT_EQ(driver.start(touch), FORCEBOUND_OK);
  press(2);
  forcebound_reading told{};
  const auto read = [&] {
    forcebound_command right{};
    right.size = sizeof right;
    right.at_ns = clock.now().count();
    right.force_N[0] = 2;
    driver.command(touch, &right);
    told = {};
    told.size = sizeof told;
    return driver.read(touch, clock.now().count(), &told);
  };
  EXPECT_TRUE(test::becomes_true([&] { return read() == FORCEBOUND_OK && told.position_m[0] >= 0.05; }));
  driver.close(touch);
  ASSERT_EQ(told.has, FORCEBOUND_HAS_BUTTONS | FORCEBOUND_HAS_ORIENTATION);
  EXPECT_EQ(told.buttons, 2U);
  // libHD's axes in the scene are turned by 90 degrees about x; then by the stylus' own angle about its y.
  const double half = 5 * told.position_m[0];
  const double share = std::sqrt(0.5);
  const std::array<double, 4> expected{share * std::cos(half), share * std::cos(half), share * std::sin(half),
                                       share * std::sin(half)};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(told.orientation[i], expected[i], 1e-9) << i;
}

TEST_F(OpenHaptics, SaysWhatIsMissing) {
  EXPECT_THAT([&] { (void)opened("library=/nonexistent/libHD.so"); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr("driver 'openhaptics': no library of OpenHaptics: /nonexistent/libHD.so"),
                        HasSubstr("OpenHaptics for Linux from 3dsystems.com, and may be anywhere with library=PATH"))));
  EXPECT_THAT([&] { (void)opened("library=libm.so.6"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("lacks the function hdInitDevice")));
  EXPECT_THAT([&] { (void)opened("speed=1"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("'speed=1' is not accepted; accepted are name=NAME")));
  device.reset();
  EXPECT_THAT([&] { (void)opened("name=Right,library=" + stand_in); },
              ThrowsMessage<std::runtime_error>(HasSubstr("libHD finds no device 'Right': device fault (0x0300)")));
  EXPECT_NO_THROW(open(",name=Left,force_N_max=3,process=same"));
  EXPECT_EQ(device->facts().force_N_max, 3);
  device.reset();
  plug(0);
  EXPECT_THAT([&] { (void)opened("process=same,library=" + stand_in); },
              ThrowsMessage<std::runtime_error>(HasSubstr("'Default Device': communication error (0x0302)")));
}

}  // namespace
}  // namespace forcebound::driver
