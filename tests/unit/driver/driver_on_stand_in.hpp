#pragma once

#include <dlfcn.h>
#include <gmock/gmock.h>

#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "forcebound/driver/driver_device.hpp"
#include "forcebound/driver/driver_library.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/support/becomes_true.hpp"

namespace forcebound::driver {

/// A driver of ours on a library in place of its vendor's, behind which a device is simulated in real time.
class DriverOnStandIn : public testing::Test {
 protected:
  using Status = device::Reading::Status;

  DriverOnStandIn(std::string driver, const std::string& library)
      : stand_in(std::string(FORCEBOUND_TEST_DRIVERS) + "/" + library),
        driver_(std::move(driver)),
        library_(::dlopen(stand_in.c_str(), RTLD_NOW | RTLD_LOCAL)) {
    if (library_ == nullptr) throw std::runtime_error(::dlerror());
    of("stand_in_plug", plug);
    of("stand_in_press", press);
    of("stand_in_force", force);
    plug(1);
    press(0);
  }
  ~DriverOnStandIn() override {
    device.reset();
    ::dlclose(library_);
  }

  [[nodiscard]] std::unique_ptr<DriverDevice> opened(const std::string& settings) const {
    const std::string file = std::string(FORCEBOUND_DRIVERS) + "/forcebound-device-" + driver_ + ".so";
    return std::make_unique<DriverDevice>(std::make_shared<const DriverLibrary>(file, driver_),
                                          DriverRequest::parse(driver_ + ":" + settings));
  }

  void open(const std::string& more = "") { device = opened("library=" + stand_in + more); }

  /// Reads and commands at about 1 kHz until the condition holds.
  template <class Condition>
  void tick_until(const Vector& force_N, Condition condition) {
    EXPECT_TRUE(test::becomes_true([&] {
      reading = device->read(clock.now());
      if (reading.status == Status::ok) last = reading;
      device->apply(clock.now(), force_N);
      return condition();
    }));
  }

  void tick_until_read() {
    tick_until(Vector::Zero(3), [&] { return reading.status == Status::ok; });
  }

  /// A force along one axis of the scene, until the device has moved 1 cm.
  [[nodiscard]] double moved_m(int axis, double force_N) {
    tick_until_read();
    const Vector from = last.position;
    Vector push = Vector::Zero(3);
    push[axis] = force_N;
    tick_until(push, [&] { return (last.position - from).norm() > 0.01; });
    return last.position[axis] - from[axis];
  }

  /// At the motors, in the library's frame.
  [[nodiscard]] std::array<double, 3> felt_N() const {
    std::array<double, 3> now{};
    force(now.data());
    return now;
  }

  void wait_for_no_force() const {
    EXPECT_TRUE(test::becomes_true([&] { return felt_N() == std::array<double, 3>{}; }));
  }

  template <class Function>
  void of(const char* name, Function& function) {
    function = reinterpret_cast<Function>(::dlsym(library_, name));
    if (function == nullptr) throw std::runtime_error(name);
  }

  std::string stand_in;
  void (*plug)(int) = nullptr;
  void (*press)(unsigned) = nullptr;
  void (*force)(double*) = nullptr;
  time::SteadyClock clock;
  std::unique_ptr<DriverDevice> device;
  device::Reading reading;
  device::Reading last;

 private:
  std::string driver_;
  void* library_;
};

}  // namespace forcebound::driver
