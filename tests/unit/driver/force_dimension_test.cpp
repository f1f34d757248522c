#include <dlfcn.h>
#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "forcebound/driver/driver_device.hpp"
#include "forcebound/driver/driver_library.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::driver {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
using namespace std::chrono_literals;
using Status = device::Reading::Status;

const std::string kStandIn = std::string(FORCEBOUND_TEST_DRIVERS) + "/libstand_in_dhd.so";

std::unique_ptr<DriverDevice> force_dimension(const std::string& settings) {
  const std::string file = std::string(FORCEBOUND_DRIVERS) + "/forcebound-device-force-dimension.so";
  return std::make_unique<DriverDevice>(std::make_shared<const DriverLibrary>(file, "force-dimension"),
                                        DriverRequest::parse("force-dimension:" + settings));
}

/// The driver with a library in place of libdhd, behind which a device is simulated in real time.
class ForceDimension : public testing::Test {
 protected:
  ForceDimension() : library_(::dlopen(kStandIn.c_str(), RTLD_NOW | RTLD_LOCAL)) {
    if (library_ == nullptr) throw std::runtime_error(::dlerror());
    of("stand_in_plug", plug);
    of("stand_in_press", press);
    of("stand_in_force", force);
    plug(1);
    press(0);
    device = force_dimension("library=" + kStandIn);
  }
  ~ForceDimension() override {
    device.reset();
    ::dlclose(library_);
  }

  /// Reads and commands at about 1 kHz until the condition holds, however long that takes.
  template <class Condition>
  void tick_until(const Vector& force_N, Condition condition) {
    do {
      reading = device->read(clock.now());
      if (reading.status == Status::ok) last = reading;
      device->apply(clock.now(), force_N);
      std::this_thread::sleep_for(1ms);
    } while (!condition());
  }

  [[nodiscard]] std::array<double, 3> felt_N() const {
    std::array<double, 3> now{};
    force(now.data());
    return now;
  }

  void (*plug)(int) = nullptr;
  void (*press)(unsigned) = nullptr;
  void (*force)(double*) = nullptr;
  time::SteadyClock clock;
  std::unique_ptr<DriverDevice> device;
  device::Reading reading;
  device::Reading last;

 private:
  template <class Function>
  void of(const char* name, Function& function) {
    function = reinterpret_cast<Function>(::dlsym(library_, name));
    if (function == nullptr) throw std::runtime_error(name);
  }

  void* library_;
};

TEST_F(ForceDimension, KnowsItsDeviceAndSaysThatItsBoundsAreGuesses) {
  EXPECT_EQ(device->facts().name, "omega.3");
  EXPECT_EQ(device->facts().degrees_of_freedom(), 3);
  EXPECT_EQ(device->facts().force_N_max, 12);
  EXPECT_THAT(device->facts_in_words(), HasSubstr("bounds not identified"));
}

TEST_F(ForceDimension, MovesAlongTheForceInTheScenesFrame) {
  device->start();
  for (int axis = 0; axis < 3; ++axis) {
    Vector push = Vector::Zero(3);
    tick_until(push, [&] { return reading.status == Status::ok; });
    const Vector from = last.position;
    push[axis] = 2;
    tick_until(push, [&] { return std::abs(last.position[axis] - from[axis]) > 0.01; });
    EXPECT_GT(last.position[axis], from[axis]) << axis;
  }
  Vector right = Vector::Zero(3);
  right[0] = 1;
  tick_until(right, [&] { return felt_N()[1] == 1; });
  EXPECT_EQ(felt_N()[0], 0) << "the scene's x is libdhd's y";
}

TEST_F(ForceDimension, GivesNoForceOnceNoCommandComes) {
  device->start();
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
  while (felt_N()[2] != 0) std::this_thread::sleep_for(1ms);
}

TEST_F(ForceDimension, StopsAtOnceAndGoesOnWithTheNextCommand) {
  device->start();
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
  device->stop(clock.now());
  while (felt_N()[2] != 0) std::this_thread::sleep_for(1ms);
  tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
}

TEST_F(ForceDimension, FailsWhileUnpluggedAndResumesAfterwards) {
  device->start();
  tick_until(Vector::Ones(3), [&] { return reading.status == Status::ok; });
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
  EXPECT_THAT([] { (void)force_dimension("library=/nonexistent/libdhd.so"); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr("driver 'force-dimension': Force Dimension's library /nonexistent/libdhd.so is not "
                                  "there"),
                        HasSubstr("forcedimension.com"))));
  EXPECT_THAT([] { (void)force_dimension("library=libm.so.6"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("lacks the function dhdGetDeviceCount")));
  EXPECT_THAT([] { (void)force_dimension("speed=1"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("'speed=1' is not accepted; accepted are number=0 to 15")));
  device.reset();
  EXPECT_THAT([] { (void)force_dimension("number=3,library=" + kStandIn); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no device number 3 among the 1 that libdhd finds")));
  plug(0);
  EXPECT_THAT([] { (void)force_dimension("library=" + kStandIn); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no device found")));
}

}  // namespace
}  // namespace forcebound::driver
