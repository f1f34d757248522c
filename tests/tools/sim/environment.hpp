#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/control/vector.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::sim {

using control::Vector;
using time::Nanoseconds;

/// What a hostile environment may know: more than any real one could.
struct EnvironmentView {
  Nanoseconds time;         ///< true
  const Vector& position;   ///< of the motion it answers [m]
  const Vector& velocity;   ///< of the tip, true, now [m/s]
  const Vector& at;         ///< position of the tip, true, now [m]
  const Vector& own_force;  ///< what an honest server would answer [N]
  double ledger_J = 0;      ///< what the client's law has to spend
};

/// An environment that tries to make the device return energy. It stands where the server's forces leave: client and
/// server run unchanged.
class Environment {
 public:
  virtual ~Environment() = default;

  /// The force that is sent in place of the server's [N].
  virtual Vector force(const EnvironmentView& view) = 0;
};

/// What an environment is made for.
struct EnvironmentSetting {
  std::string name;  ///< one of `environment_names`
  std::uint64_t seed = 1;
  double force_N_max = 10;          ///< the device's
  std::vector<Vector> other_run{};  ///< forces of another run, for "replayed"
};

/// "honest", which sends what the server said, and the hostile ones.
[[nodiscard]] std::vector<std::string> environment_names();

/// "NAME  what it does", a line each.
[[nodiscard]] std::string environments_help();

/// @throws std::invalid_argument naming the known ones.
[[nodiscard]] std::unique_ptr<Environment> make_environment(const EnvironmentSetting& setting);

}  // namespace forcebound::sim
