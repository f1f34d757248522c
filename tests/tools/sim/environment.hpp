#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/control/vector.hpp"
#include "forcebound/server/environment/environment.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::sim {

using control::Vector;
using time::Nanoseconds;

/// What a hostile environment may know beside the motion it answers: more than any real one could.
struct Truth {
  Nanoseconds time{0};  ///< true
  Vector velocity{};    ///< of the tip, now [m/s]
  double ledger_J = 0;  ///< what the client's law has to spend
};

/// What an environment is made for.
struct EnvironmentSetting {
  std::string name;  ///< one of `environment_names`
  std::uint64_t seed = 1;
  double force_N_max = 10;          ///< the device's
  std::vector<Vector> other_run{};  ///< forces of another run, for "replayed"
};

/// "honest", which answers what the scene says, and the hostile ones.
[[nodiscard]] std::vector<std::string> environment_names();

/// "NAME  what it does", a line each.
[[nodiscard]] std::string environments_help();

/// An environment that tries to make the device return energy: it asks `honest`, and answers that with a force of its
/// own.
/// @throws std::invalid_argument naming the known ones.
[[nodiscard]] std::unique_ptr<server::Environment> make_environment(const EnvironmentSetting& setting,
                                                                    std::unique_ptr<server::Environment> honest,
                                                                    std::function<Truth()> truth);

/// The same kind, of which every session meets such an environment in place of its own.
/// @throws std::invalid_argument naming the known ones.
[[nodiscard]] server::EnvironmentKind taken_over(server::EnvironmentKind kind, const EnvironmentSetting& setting,
                                                 std::function<Truth()> truth);

}  // namespace forcebound::sim
