#pragma once

#include <functional>
#include <string>
#include <vector>

#include "forcebound/device/haptic_device.hpp"

namespace forcebound::lab {

using time::Nanoseconds;

/// What one call cost the thread that made it.
struct CallCost {
  Nanoseconds wall{0};
  Nanoseconds processor{0};
  long waits = 0;  ///< times that the thread gave the processor away by itself
};

/// Time, as the checks see it: real, or virtual in tests.
class Pace {
 public:
  virtual ~Pace() = default;
  [[nodiscard]] virtual Nanoseconds now() = 0;
  virtual void wait_until(Nanoseconds time) = 0;
  /// Runs `call`. @returns what it cost
  [[nodiscard]] virtual CallCost cost_of(const std::function<void()>& call) = 0;
};

enum class Verdict { passed, failed, not_checked };

/// One line of the table.
struct DeviceCheck {
  std::string name;
  Verdict verdict = Verdict::passed;
  std::string measured;  ///< or why it was not checked
  std::string accepted;
};

struct DeviceCheckSettings {
  double force_share = 0.3;                                                ///< of the device's largest force
  std::function<bool()> cancelled{};                                       ///< asked in every tick; no function: never
  std::function<void(const std::string& check, const char* call)> tell{};  ///< before each call of the device
};

/// Checks a device that nobody touches: reads it, pushes it along each axis by a few millimetres, and lets it go.
///
/// The force grows over 0.3 s to its share of the largest one, and ends when the device has moved 5 mm. Nothing is
/// pushed any more once the device does not go where it is pushed. Ends with `stop`, whatever happens.
///
/// @throws std::runtime_error if it was cancelled, or if the device does not start.
[[nodiscard]] std::vector<DeviceCheck> check_device(device::HapticDevice& device, Pace& pace,
                                                    const DeviceCheckSettings& settings);

}  // namespace forcebound::lab
