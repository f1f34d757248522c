// The functions of OpenHaptics' libHD that our driver calls, with a simulated device behind them. What tests do to it,
// and see of it, are the functions stand_in_*.
//
// Like the real one it has a scheduler, a thread that calls what is scheduled once in each millisecond, the highest
// priority first, until it returns HD_CALLBACK_DONE; what a frame reads is latched as it begins, its force sent as it
// ends; errors are on a stack, the newest on top. Its frame has x to the user's right, y up, z towards him, in mm.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>
#include <thread>
#include <vector>

#include "forcebound/time/real_time.hpp"
#include "tests/support/drivers/stand_in_library.hpp"

namespace {

using forcebound::test::Axes;
using forcebound::test::device_of_library;
using forcebound::test::StandIn;

constexpr unsigned kSuccess = 0x0000;
constexpr unsigned kInvalidEnum = 0x0100;
constexpr unsigned kInvalidOperation = 0x0102;
constexpr unsigned kBadHandle = 0x0104;
constexpr unsigned kExceededMaxForce = 0x0201;
constexpr unsigned kDeviceFault = 0x0300;
constexpr unsigned kAlreadyInitiated = 0x0301;
constexpr unsigned kCommError = 0x0302;
constexpr unsigned kIllegalEnd = 0x0401;
constexpr unsigned kNoHandle = 0xFFFFFFFF;
constexpr unsigned kHandle = 0;
constexpr unsigned kForceOutput = 0x4000;
constexpr unsigned kCalibrationOk = 0x5000;
constexpr unsigned kCalibrationNeedsUpdate = 0x5001;
constexpr unsigned kCalibrationNeedsHand = 0x5002;
constexpr double kForceMost_N = 7.9;
constexpr double kForceContinuous_N = 1.75;
constexpr double kJump_m = 5e-3;  ///< of the position at an update of the calibration, along its x
constexpr double kMm = 1e3;

struct ErrorInfo {
  unsigned code = kSuccess;
  int internal_code = 0;
  unsigned handle = kHandle;
};

using Callback = unsigned (*)(void*);
struct Operation {
  unsigned long handle;
  Callback callback;
  void* user_data;
  unsigned short priority;
};

/// All that the library knows.
struct Library {
  std::mutex guard{};
  std::vector<ErrorInfo> errors{};
  std::vector<Operation> operations{};
  unsigned long next_operation = 1;
  std::atomic<bool> runs{false};
  std::thread scheduler{};
  std::atomic<bool> initiated{false};
  std::atomic<unsigned> calibration{kCalibrationOk};
  std::atomic<double> jumped_m{0};
  std::atomic<double> force_at_update_N{-1};  ///< at the motors
  std::atomic<unsigned> warning{kSuccess};    ///< comes with the next frame
  // Of the frame, which is the scheduler's.
  bool in_frame = false;
  bool has_force = false;
  StandIn::State state{};
  Axes force_N{};

  // The device ends after it.
  Library() { (void)device_of_library(); }
  ~Library() { stop(); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  void stop() {
    runs = false;
    if (scheduler.joinable()) scheduler.join();
  }
};

Library& the() {
  static Library library;
  return library;
}

Axes in_scene(const Axes& here) { return {here[0], -here[2], here[1]}; }
Axes from_scene(const Axes& scene) { return {scene[0], scene[2], -scene[1]}; }

void fail(unsigned code) {
  const std::scoped_lock lock(the().guard);
  the().errors.push_back({.code = code});
}

bool expect_device() {
  StandIn* const device = device_of_library();
  if (!the().initiated) fail(kBadHandle);
  return the().initiated && device != nullptr;
}

bool call(const Operation& operation) { return operation.callback(operation.user_data) == 1; }

void schedule_round() {
  std::vector<Operation> now;
  {
    const std::scoped_lock lock(the().guard);
    now = the().operations;
  }
  std::ranges::stable_sort(now, std::greater{}, &Operation::priority);
  for (const Operation& operation : now) {
    if (call(operation)) continue;
    const std::scoped_lock lock(the().guard);
    std::erase_if(the().operations, [&](const Operation& other) { return other.handle == operation.handle; });
  }
}

void run_scheduler() {
  constexpr int kPriority = 79;
  (void)forcebound::time::ask_for_first_in_first_out(kPriority);
  auto next = std::chrono::steady_clock::now();
  while (the().runs) {
    schedule_round();
    next = std::max(next + std::chrono::milliseconds(1), std::chrono::steady_clock::now());
    std::this_thread::sleep_until(next);
  }
}

/// Of a stylus that turns as it moves to the right: about libHD's y axis.
std::array<double, 16> transform_of(const Axes& position_m) {
  constexpr double kTurn_rad_per_m = 10;
  const double angle = kTurn_rad_per_m * position_m[0];
  const Axes here = from_scene(position_m);
  // Column by column.
  return {std::cos(angle),
          0,
          -std::sin(angle),
          0,
          0,
          1,
          0,
          0,
          std::sin(angle),
          0,
          std::cos(angle),
          0,
          kMm * here[0],
          kMm * here[1],
          kMm * here[2],
          1};
}

}  // namespace

// NOLINTBEGIN(readability-identifier-naming): the names are the vendor's.

STAND_IN_EXPORT unsigned hdInitDevice(const char* name) {
  StandIn* const device = device_of_library();
  const bool known = name == nullptr || std::strcmp(name, "Default Device") == 0 || std::strcmp(name, "Left") == 0;
  unsigned error = kSuccess;
  if (!known) error = kDeviceFault;
  if (the().initiated) error = kAlreadyInitiated;
  if (error == kSuccess && (device == nullptr || !device->read())) error = kCommError;
  if (error != kSuccess) {
    fail(error);
    return kNoHandle;
  }
  the().initiated = true;
  return kHandle;
}

STAND_IN_EXPORT void hdDisableDevice(unsigned handle) {
  if (handle != kHandle || !expect_device()) return;
  device_of_library()->enable(false);
  the().initiated = false;
}

STAND_IN_EXPORT void hdMakeCurrentDevice(unsigned handle) {
  if (handle != kHandle || !the().initiated) fail(kBadHandle);
}

STAND_IN_EXPORT void hdEnable(unsigned capability) {
  if (!expect_device()) return;
  if (capability != kForceOutput) return fail(kInvalidEnum);
  if (!device_of_library()->enable(true)) fail(kCommError);
}

STAND_IN_EXPORT void hdBeginFrame(unsigned handle) {
  if (handle != kHandle || !expect_device()) return;
  the().in_frame = true;
  the().has_force = false;
  const auto state = device_of_library()->read();
  if (!state) return fail(kCommError);
  the().state = *state;
  the().state.position_m[0] += the().jumped_m;
  const unsigned warning = the().warning.exchange(kSuccess);
  if (warning != kSuccess) fail(warning);
}

STAND_IN_EXPORT void hdEndFrame(unsigned handle) {
  if (handle != kHandle || !expect_device()) return;
  if (!the().in_frame) return fail(kIllegalEnd);
  the().in_frame = false;
  if (!the().has_force) return;
  const Axes& force_N = the().force_N;
  const bool too_much = std::hypot(force_N[0], force_N[1], force_N[2]) > kForceMost_N * (1 + 1e-9);
  if (too_much) fail(kExceededMaxForce);
  if (!device_of_library()->command(too_much ? Axes{} : in_scene(force_N))) fail(kCommError);
}

STAND_IN_EXPORT void hdGetDoublev(unsigned what, double* values) {
  const Axes position = from_scene(the().state.position_m);
  if (what == 0x2050) {
    std::ranges::transform(position, values, [](double metres) { return kMm * metres; });
  } else if (what == 0x2052) {
    std::ranges::copy(transform_of(the().state.position_m), values);
  } else if (what == 0x2603) {
    *values = kForceMost_N;
  } else if (what == 0x2604) {
    *values = kForceContinuous_N;
  } else {
    fail(kInvalidEnum);
  }
}

STAND_IN_EXPORT void hdSetDoublev(unsigned what, const double* values) {
  if (what != 0x2700) return fail(kInvalidEnum);
  if (!the().in_frame) return fail(kInvalidOperation);
  std::copy_n(values, the().force_N.size(), the().force_N.begin());
  the().has_force = true;
}

STAND_IN_EXPORT void hdGetIntegerv(unsigned what, int* values) {
  constexpr int kInInkwell = 4;
  if (what == 0x2000) {
    *values = static_cast<int>(the().state.buttons);
  } else if (what == 0x2555) {
    *values = kInInkwell;
  } else {
    fail(kInvalidEnum);
  }
}

STAND_IN_EXPORT const char* hdGetString(unsigned what) {
  if (what == 0x2501) return "Touch X";
  if (what == 0x2504) return "0042";
  fail(kInvalidEnum);
  return nullptr;
}

STAND_IN_EXPORT ErrorInfo hdGetError() {
  const std::scoped_lock lock(the().guard);
  if (the().errors.empty()) return {};
  const ErrorInfo newest = the().errors.back();
  the().errors.pop_back();
  return newest;
}

STAND_IN_EXPORT const char* hdGetErrorString(unsigned code) {
  switch (code) {
    case kSuccess:
      return "no error";
    case kCommError:
      return "communication error";
    case kDeviceFault:
      return "device fault";
    case kExceededMaxForce:
      return "exceeded maximum force";
    case 0x0200:
      return "warm motors";
    default:
      return "error";
  }
}

STAND_IN_EXPORT unsigned hdCheckCalibration() { return the().calibration; }

STAND_IN_EXPORT void hdUpdateCalibration(unsigned /*style*/) {
  if (!expect_device()) return;
  const Axes force_N = device_of_library()->look().force_N;
  the().force_at_update_N = std::hypot(force_N[0], force_N[1], force_N[2]);
  the().jumped_m = the().jumped_m + kJump_m;
  the().calibration = kCalibrationOk;
}

STAND_IN_EXPORT void hdStartScheduler() {
  if (the().runs.exchange(true)) return;
  the().scheduler = std::thread(run_scheduler);
}

STAND_IN_EXPORT void hdStopScheduler() { the().stop(); }

STAND_IN_EXPORT unsigned long hdScheduleAsynchronous(Callback callback, void* user_data, unsigned short priority) {
  const std::scoped_lock lock(the().guard);
  the().operations.push_back({the().next_operation, callback, user_data, priority});
  return the().next_operation++;
}

STAND_IN_EXPORT void hdUnschedule(unsigned long handle) {
  std::size_t erased = 0;
  {
    const std::scoped_lock lock(the().guard);
    erased = std::erase_if(the().operations, [&](const Operation& other) { return other.handle == handle; });
  }
  if (erased == 0) fail(kInvalidOperation);
}

// NOLINTEND(readability-identifier-naming)

STAND_IN_EXPORT void stand_in_plug(int in) {
  if (StandIn* const device = device_of_library()) device->plug(in != 0);
}

STAND_IN_EXPORT void stand_in_press(unsigned buttons) {
  if (StandIn* const device = device_of_library()) device->press(buttons);
}

STAND_IN_EXPORT void stand_in_calibrate(int calibrated) {
  the().calibration = calibrated != 0 ? kCalibrationOk : kCalibrationNeedsHand;
}

/// Wants an update of the calibration, by which the position jumps.
STAND_IN_EXPORT void stand_in_want_update() { the().calibration = kCalibrationNeedsUpdate; }

/// At the motors at the last update; below zero: there was none since the last call.
STAND_IN_EXPORT double stand_in_force_at_update() { return the().force_at_update_N.exchange(-1); }

/// An error that comes with the next frame.
STAND_IN_EXPORT void stand_in_warn(unsigned code) { the().warning = code; }

/// The scheduler ends without a word.
STAND_IN_EXPORT void stand_in_halt() { the().runs = false; }

/// At the motors, in libHD's frame.
STAND_IN_EXPORT void stand_in_force(double* force_N) {
  StandIn* const device = device_of_library();
  const Axes now = device != nullptr ? from_scene(device->look().force_N) : Axes{};
  std::memcpy(force_N, now.data(), sizeof now);
}
