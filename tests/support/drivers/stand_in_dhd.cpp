// The functions of Force Dimension's libdhd that our driver calls, with a simulated device behind them. What tests do
// to it, and see of it, are the functions stand_in_*.
//
// Like the real one it takes a while for each call, keeps the last force until another comes or the device's watchdog
// disables the force, fails when the device is unplugged, and gives no force before dhdEnableForce, which brings back
// the last force that was set. Its frame has x towards the user, y to his right, z up.
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include "tests/support/drivers/stand_in_library.hpp"

namespace {

using forcebound::test::Axes;
using forcebound::test::device_of_library;
using forcebound::test::StandIn;

constexpr std::chrono::microseconds kCall{150};
constexpr double kWatchdogUnit_s = 125e-6;

std::atomic<bool> the_open{false};
std::atomic<double> the_watchdog_s{0};
std::atomic<double> the_commanded_s{0};
std::atomic<int> the_stall_ms{0};
Axes the_last_N{};  // of the scene, whether the force is enabled or not; the caller's thread
std::atomic<double> the_force_at_enable_N{-1};

Axes in_scene(const Axes& here) { return {here[1], -here[0], here[2]}; }
Axes from_scene(const Axes& scene) { return {-scene[1], scene[0], scene[2]}; }

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Null: there is none, or it is not open.
StandIn* opened_after_call() {
  std::this_thread::sleep_for(kCall + std::chrono::milliseconds(the_stall_ms.exchange(0)));
  return the_open ? device_of_library() : nullptr;
}

bool plugged() {
  StandIn* const device = device_of_library();
  return device != nullptr && device->read().has_value();
}

int result(bool done) {
  if (!done) the_open = false;
  return done ? 0 : -1;
}

}  // namespace

// NOLINTBEGIN(readability-identifier-naming): the names are the vendor's.

STAND_IN_EXPORT int dhdGetDeviceCount() { return plugged() ? 1 : 0; }

STAND_IN_EXPORT int dhdOpenID(char id) {
  if (id != 0 || !plugged()) return -1;
  the_open = true;
  return 0;
}

STAND_IN_EXPORT int dhdStop(char /*id*/) {
  StandIn* const device = opened_after_call();
  return result(device != nullptr && device->enable(false));
}

STAND_IN_EXPORT int dhdClose(char id) {
  const int stopped = dhdStop(id);
  the_open = false;
  return stopped;
}

STAND_IN_EXPORT const char* dhdGetSystemName(char /*id*/) { return "omega.3"; }

STAND_IN_EXPORT int dhdEnableForce(unsigned char on, char /*id*/) {
  StandIn* const device = opened_after_call();
  the_commanded_s = now_s();
  if (device == nullptr || !device->enable(on != 0)) return result(false);
  if (on == 0) return 0;
  the_force_at_enable_N = std::hypot(the_last_N[0], the_last_N[1], the_last_N[2]);
  return result(device->command(the_last_N));
}

STAND_IN_EXPORT int dhdSetWatchdog(unsigned char duration, char /*id*/) {
  StandIn* const device = opened_after_call();
  the_watchdog_s = kWatchdogUnit_s * duration;
  return result(device != nullptr && device->set_hold(the_watchdog_s));
}

STAND_IN_EXPORT int dhdGetPosition(double* x, double* y, double* z, char /*id*/) {
  StandIn* const device = opened_after_call();
  const auto state = device != nullptr ? device->read() : std::nullopt;
  if (!state) return result(false);
  const Axes position_m = from_scene(state->position_m);
  *x = position_m[0];
  *y = position_m[1];
  *z = position_m[2];
  return 0;
}

STAND_IN_EXPORT int dhdSetForce(double x, double y, double z, char /*id*/) {
  StandIn* const device = opened_after_call();
  const double before_s = the_commanded_s.exchange(now_s());
  const bool too_late = the_watchdog_s > 0 && the_commanded_s - before_s > the_watchdog_s;
  if (device != nullptr && too_late) device->enable(false);
  the_last_N = in_scene({x, y, z});
  return result(device != nullptr && device->command(the_last_N));
}

STAND_IN_EXPORT unsigned int dhdGetButtonMask(char /*id*/) {
  StandIn* const device = device_of_library();
  return device != nullptr ? device->look().buttons : 0;
}

STAND_IN_EXPORT const char* dhdErrorGetLastStr() { return plugged() ? "no error" : "no device found"; }

// NOLINTEND(readability-identifier-naming)

STAND_IN_EXPORT void stand_in_plug(int in) {
  if (StandIn* const device = device_of_library()) device->plug(in != 0);
}

STAND_IN_EXPORT void stand_in_press(unsigned int buttons) {
  if (StandIn* const device = device_of_library()) device->press(buttons);
}

/// At the motors, in libdhd's frame.
STAND_IN_EXPORT void stand_in_force(double* force_N) {
  StandIn* const device = device_of_library();
  const Axes now = device != nullptr ? from_scene(device->look().force_N) : Axes{};
  std::memcpy(force_N, now.data(), sizeof now);
}

/// That dhdEnableForce brought back; below zero: it was not called since the last call of this.
STAND_IN_EXPORT double stand_in_force_at_enable() { return the_force_at_enable_N.exchange(-1); }

/// The next call takes so long.
STAND_IN_EXPORT void stand_in_stall(int milliseconds) { the_stall_ms = milliseconds; }
