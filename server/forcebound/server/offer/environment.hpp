#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "forcebound/answer/answer.hpp"
#include "forcebound/control/handle.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/handover/packed_scene.hpp"
#include "forcebound/scene/rendering.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/view/description.hpp"

namespace forcebound::server {

using answer::Answer;
using control::Vector;
using time::Nanoseconds;

/// Input of an environment: one motion of the device.
struct Motion {
  /// [m], rotations [rad], one row per degree of freedom of the device, in the environment's frame; finite.
  const Vector& position;
  Nanoseconds device_time{0};  ///< client's clock at the reading; it may jump, since clients are untrusted
  Nanoseconds server_time{0};  ///< server's clock at its arrival
  bool wants_model = false;    ///< the client renders locally: a local model would be sent to it
  /// Buttons, gripper and orientation at the reading, where the device has them; all that is there can be true.
  control::Handle handle{};
  /// That the law at the device has given up since it began, for a robot to spend [J]; as the client tells, finite.
  double energy_given_J = 0;
};

/// Counts of faults that an environment handled itself.
struct EnvironmentFaults {
  std::uint64_t old_normals = 0;        ///< contacts with the last valid normal, for lack of one of their own
  std::uint64_t quarantined = 0;        ///< parts whose force was not finite: left out from then on
  std::uint64_t contacts_left_out = 0;  ///< contacts of tissue or bodies beyond the fixed maximum
  std::uint64_t not_converged = 0;      ///< tissue steps that ended at the iteration limit
  double slipped_s = 0;                 ///< simulated time skipped, because too much was due at once
};

/// The source of one client's forces: a scene, a follower robot, or a user's own program.
///
/// One instance per session, destroyed with it. An answer that is unsound (answer::is_sound) is discarded: the client
/// is sent zero force, and the server counts it.
///
/// Real time: `respond` is called on the server's one thread for each motion answered, and every other client waits
/// meanwhile. It must not allocate, wait, lock, print or throw.
class Environment {
 public:
  virtual ~Environment() = default;

  [[nodiscard]] virtual Answer respond(const Motion& motion) noexcept = 0;

  /// Names of the parts that the last motion quarantined: they are left out from then on. Valid until the next motion.
  /// Real time, as `respond`.
  [[nodiscard]] virtual std::span<const std::string* const> quarantined() const noexcept { return {}; }

  /// How it looks, for a client that shows it to people; null: it is not to be seen. Not real time: may allocate.
  /// @param which of its static parts
  [[nodiscard]] virtual std::shared_ptr<const view::Description> appearance(view::Which which) {
    (void)which;
    return nullptr;
  }

  /// Where items of a group of that description are now, from number `first` on, as many as fit (view/description.hpp).
  /// @returns how many numbers were written; 0: nothing is known. Real time, as `respond`.
  [[nodiscard]] virtual std::size_t sample(std::size_t group, std::size_t first, std::span<float> to) const noexcept {
    (void)group;
    (void)first;
    (void)to;
    return 0;
  }

  /// Counted since construction.
  [[nodiscard]] virtual EnvironmentFaults faults() const noexcept { return {}; }
};

/// Facts of a client, from its Hello.
struct ClientFacts {
  std::string device{};  ///< as the client calls it; printable
  std::uint32_t degrees_of_freedom = 0;
  double period_s = 0;           ///< between motions, as the client promised
  double force_N_max = 0;        ///< the device's maximum force
  Nanoseconds round_trip{0};     ///< 0: not measured
  bool renders_locally = false;  ///< what it can: static parts, and local models of the rest
  bool shows_torque = false;     ///< it turns its handle by motors: Answer::torque_N_m is for it
};

/// An environment for one session, and its description for the client and the log.
struct MadeEnvironment {
  std::unique_ptr<Environment> environment{};
  std::string simulated{};  ///< in one line
  std::uint64_t hash = 0;   ///< the same hash, the same environment; 0: not known
  std::string choice{};     ///< the level picked for this client, and the reason; empty: there was no choice
  /// What a client can run itself; null: nothing. `Answer::server_parts_N` is then the force of the other parts.
  std::shared_ptr<const handover::PackedScene> packed{};
  /// The least of its parts' renderings, so that a client knows what to expect beside the packed ones.
  scene::Rendering least_rendering = scene::Rendering::held;
  bool takes_energy = false;  ///< it spends what the law at the device gives up: Motion::energy_given_J
  /// Of the tool in the hand, from the grip to its tip in the handle's axes [m]; motions then tell the tip. No rows:
  /// none.
  Vector tool_m{};
};

/// An environment that clients can request by name. `make` is called once per session.
struct EnvironmentKind {
  std::string name{};
  std::vector<std::uint32_t> degrees_of_freedom{};  ///< of devices that it accepts; empty: any
  std::size_t sessions_max = 0;                     ///< at once; 0: as many as the server has room for
  bool wants_round_trip = false;                    ///< `make` depends on it, so the client measures it first

  /// @throws std::exception if none can be made now; the client is told the reason, and may retry
  std::function<MadeEnvironment(const ClientFacts&)> make{};

  [[nodiscard]] bool accepts(std::uint32_t device_degrees_of_freedom) const noexcept;

  /// The accepted degrees of freedom as text: "3 or 6".
  [[nodiscard]] std::string accepted_degrees_of_freedom() const;
};

}  // namespace forcebound::server
