#include "forcebound/client/commands/identify/encoder_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace forcebound::client::commands::identify {
namespace {

// Readings are whole steps but for the rounding of a double, or of a driver that scales in float.
constexpr double kWhole = 1e-2;

/// The greatest distance of which both are multiples (Euclid).
double common_step(double a, double b) noexcept {
  while (b > kWhole * a) {
    double rest = std::fmod(a, b);
    if (b - rest < kWhole * b) rest = 0;
    a = std::exchange(b, rest);
  }
  return a;
}

}  // namespace

void EncoderGrid::add(double reading) noexcept {
  if (!std::exchange(any_, true)) {
    first_ = last_ = reading;
    return;
  }
  const double distance = std::abs(reading - std::exchange(last_, reading));
  if (distance == 0) return;
  ++changes_;
  if (step_ == 0) {
    step_ = distance;
  } else if (const double steps = distance / step_; std::abs(steps - std::round(steps)) > kWhole) {
    const double common = common_step(std::max(distance, step_), std::min(distance, step_));
    // Noise has ever smaller distances.
    constexpr double kLeast = 1e-3;
    no_grid_ = no_grid_ || common < kLeast * std::min(distance, step_);
    step_ = common;
    farthest_ = 0;
  }
  // The farther apart two readings, the better they tell the step.
  const double apart = std::abs(reading - first_);
  constexpr double kDoubt = 0.3;
  if (apart > farthest_ && apart > step_ * (1 - kDoubt)) {
    farthest_ = apart;
    step_ = apart / std::round(apart / step_);
  }
}

std::optional<double> EncoderGrid::step() const noexcept {
  if (step_ == 0 || no_grid_) return std::nullopt;
  return step_;
}

}  // namespace forcebound::client::commands::identify
