#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/control/vector.hpp"
#include "forcebound/server/offer/environment.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::sim {

using control::Vector;
using time::Nanoseconds;

/// Inputs of a hostile environment beside the motion: more than any real one could have.
struct Truth {
  Nanoseconds time{0};  ///< true
  Vector velocity{};    ///< of the tip, now [m/s]
  Vector turning{};     ///< of a tip that turns, now [rad/s]; no rows: it does not
  double ledger_J = 0;  ///< energy that the client's law may spend
};

/// Settings of an environment.
struct EnvironmentSetting {
  std::string name;  ///< one of `environment_names`
  std::uint64_t seed = 1;
  double force_N_max = 10;          ///< the device's
  std::vector<Vector> other_run{};  ///< forces of another run, for "replayed", as those below
  /// Above 0, a tip that turns is pushed and turned: an adversary sees and makes vectors of six rows, in which a turn
  /// is a length at the end of this lever and a torque a force there, so that their product is the power.
  double lever_m = 0;
};

/// A vector of an adversary: `turn` times `factor` below `straight`, which it is where a tip does not turn (no rows).
[[nodiscard]] Vector with_turn(const Vector& straight, const Vector& turn, double factor);

/// "honest", which answers as the scene, and the hostile ones.
[[nodiscard]] std::vector<std::string> environment_names();

/// "NAME  description", a line each.
[[nodiscard]] std::string environments_help();

/// An environment that tries to make the device return energy: it asks `honest`, and answers that with a force of its
/// own.
/// @throws std::invalid_argument naming the known ones.
[[nodiscard]] std::unique_ptr<server::Environment> make_environment(const EnvironmentSetting& setting,
                                                                    std::unique_ptr<server::Environment> honest,
                                                                    std::function<Truth()> truth);

/// A kind that gives every session such an environment instead of its own.
/// @throws std::invalid_argument naming the known ones.
[[nodiscard]] server::EnvironmentKind taken_over(server::EnvironmentKind kind, const EnvironmentSetting& setting,
                                                 std::function<Truth()> truth);

}  // namespace forcebound::sim
