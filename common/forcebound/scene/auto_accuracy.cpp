#include "forcebound/scene/auto_accuracy.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/text/numbers.hpp"

namespace forcebound::scene {
namespace {

constexpr double kTick_s = 1e-3;

}  // namespace

double AutoAccuracy::expected_error(const AccuracyLevel& level, double round_trip_s) const {
  const double age_s = round_trip_s + level.step_s + 0.5 * (kTick_s + std::max(level.step_s, kTick_s));
  return std::hypot(level.model_error, change_per_s * age_s);
}

const AccuracyLevel& AutoAccuracy::best(double round_trip_s) const {
  return *std::ranges::min_element(levels, {},
                                   [&](const AccuracyLevel& level) { return expected_error(level, round_trip_s); });
}

std::string AutoAccuracy::text(const AccuracyLevel& picked, double round_trip_s) const {
  return "accuracy auto: " + key + " = " + picked.value + " for a round trip of " + text::rounded(round_trip_s * 1e3) +
         " ms, " + text::rounded(picked.step_s * 1e6) + " us a motion, the force about " +
         text::rounded(100 * expected_error(picked, round_trip_s)) + " % off at the device";
}

}  // namespace forcebound::scene
