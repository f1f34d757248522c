#pragma once

#include <functional>
#include <string>
#include <vector>

#include "forcebound/device/haptic_device.hpp"

namespace forcebound::client::commands {

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

/// A person at the device, who does what is asked.
class Person {
 public:
  virtual ~Person() = default;
  /// Called in every tick. @param left_s until the check gives up
  virtual void ask(const std::string& what, double left_s) = 0;
  /// Whether the person says that it is done.
  [[nodiscard]] virtual bool is_done() = 0;
};

enum class Verdict { passed, failed, not_checked };

/// One line of the table.
struct DeviceCheck {
  std::string name;
  Verdict verdict = Verdict::passed;
  std::string measured;  ///< or why it was not checked
  std::string accepted;
};

/// Is told of each call of the device, for who watches from outside.
class CallListener {
 public:
  virtual ~CallListener() = default;
  virtual void begin(const std::string& check, const char* call) = 0;
  virtual void end() = 0;
};

struct DeviceCheckSettings {
  double force_share = 0.3;                               ///< of the device's largest force
  double speed_m_per_s_max = 0.5;                         ///< no force on a tip that is faster
  Person* person = nullptr;                               ///< for the checks that need one; null: they are not made
  std::function<bool()> cancelled{};                      ///< asked in every tick; no function: never
  CallListener* calls = nullptr;                          ///< may be null
  std::function<void(const DeviceCheck& check)> found{};  ///< each check once it is judged
};

}  // namespace forcebound::client::commands
