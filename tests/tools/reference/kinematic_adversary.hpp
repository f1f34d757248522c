#pragma once

#include <cstdint>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/law.hpp"

/// A device without mass whose hand, environment, clock and transport are one opponent that knows the true motion.
namespace forcebound::test {

/// How a device truly is, where its facts say otherwise. Brackets and limits are drawn from anew on each tick, or for
/// each game where only one value makes sense.
struct DeviceTruth {
  control::Bracket stamp_s{};            ///< latched so long after the stamp
  control::Bracket latency_s{};          ///< the latency is longer by this
  control::Bracket latency_offset_s{};   ///< and by one constant, drawn for each game
  control::Bracket hold_s{};             ///< each stage of the release comes later by this
  bool effects_reported = false;         ///< when a force took effect, where that was before the next reading
  bool releases_reported = false;        ///< likewise when its release began
  double early_release_share = 0;        ///< releases come early by up to this share of the hold time
  double clock_share = 0;                ///< the stamps' clock is fast or slow by this share, drawn for each game
  double encoder_steps = 0;              ///< readings are off by up to this
  double damping_share = 0;              ///< of the damping is missing
  double friction_share = 0;             ///< of the friction is missing
  control::Bracket torque_gain_share{};  ///< each motor makes a constant times the command, drawn for each game
  bool losses_with_gain = false;         ///< and its damping and friction are as many times those of the facts
  double torque_ripple_share = 0;        ///< the torque is off by this share, always to the opponent's advantage
  double actuator_lag_s = 0;             ///< time constant
  double failed_writes = 0;              ///< share of the commands
  bool failures_reported = false;        ///< or not
  double lost_counts = 0;                ///< share of the readings at which a count is lost
  double impossible_intervals =
      0;                     ///< share of the ticks at which the clock says what cannot be; at the next, anything
  double lost_readings = 0;  ///< share of the ticks, the first one's among them
};

struct KinematicGame {
  std::uint64_t seed = 1;
  control::DeviceFacts facts{};
  DeviceTruth truth{};
  bool late_ticks = false;
  bool turning = false;  ///< the Jacobian changes from tick to tick, now and then through singular ones
  int ticks = 2000;
  double received_J_per_tick = 0;  ///< energy that the law receives on average, in portions
};

/// From the true motion in long double; what the law received is added to P and what it gave up is subtracted.
struct KinematicOutcome {
  long double least_P_J = 0;        ///< the least P(t) [J] that the opponent could bring about
  long double least_surplus_J = 0;  ///< the least of P less what the law said it might spend, at the readings
};

KinematicOutcome play(control::PassivityLaw& law, const KinematicGame& game);

[[nodiscard]] inline long double least_P_J(control::PassivityLaw& law, const KinematicGame& game) {
  return play(law, game).least_P_J;
}

/// The same bounds as uncertainty, where they have one.
control::Uncertainty uncertainty_of(const DeviceTruth& truth, const control::DeviceFacts& facts);

}  // namespace forcebound::test
