#include "forcebound/scene/auto_accuracy.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/text/numbers.hpp"

namespace forcebound::scene {
namespace {

constexpr double kTick_s = 1e-3;

}  // namespace

double AutoAccuracy::expected_error(const AccuracyLevel& level, const Client& client) const {
  const double age_s = client.round_trip_s + level.step_s + 0.5 * (kTick_s + std::max(level.step_s, kTick_s));
  return std::hypot(level.model_error, (client.renders_locally ? change_locally_per_s : change_per_s) * age_s);
}

const AccuracyLevel& AutoAccuracy::best(const Client& client) const {
  return *std::ranges::min_element(levels, {},
                                   [&](const AccuracyLevel& level) { return expected_error(level, client); });
}

std::string AutoAccuracy::text(const AccuracyLevel& picked, const Client& client) const {
  return "accuracy auto: " + key + " = " + picked.value + " for a round trip of " +
         text::rounded(client.round_trip_s * 1e3) + (client.renders_locally ? " ms and local rendering, " : " ms, ") +
         text::rounded(picked.step_s * 1e6) + " us a motion, the force about " +
         text::rounded(100 * expected_error(picked, client)) + " % off at the device";
}

}  // namespace forcebound::scene
