#pragma once

#include <array>
#include <cstddef>

#include "forcebound/client/commands/identify/release_fit.hpp"

namespace forcebound::client::commands::identify {

/// Position and speed of a joint, from its last readings.
class JointWatch {
 public:
  void add(double time_s, double position) noexcept;
  void forget() noexcept { count_ = 0; }

  [[nodiscard]] double position() const noexcept { return at(0).position; }
  /// Slope of a line through the last readings; 0 before there are three.
  [[nodiscard]] double speed() const noexcept;
  /// What rounding to this step can add to it.
  [[nodiscard]] double rounded_speed(double step) const noexcept;

 private:
  static constexpr std::size_t kReadings = 8;
  struct Reading {
    double time_s = 0;
    double position = 0;
  };
  [[nodiscard]] const Reading& at(std::size_t ago) const noexcept {
    return readings_[(next_ + kReadings - 1 - ago) % kReadings];
  }
  std::array<Reading, kReadings> readings_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

/// Brings a joint to a place, softly: a critically damped spring for its mass, with its friction in front.
/// @returns the force, at most `force_max`
[[nodiscard]] double force_towards(double target, const JointWatch& joint, const JointGuess& guess, double tolerance,
                                   double force_max) noexcept;

}  // namespace forcebound::client::commands::identify
