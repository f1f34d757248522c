#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "forcebound/control/vector.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using control::Vector;
using time::Nanoseconds;

/// What an environment is asked: where the device was. Positions, forces and normals have the device's rows, in the
/// environment's frame.
struct Motion {
  const Vector& position;      ///< [m], rotations [rad]; finite
  Nanoseconds device_time{0};  ///< client's clock at the reading; an untrusted client's may jump
  Nanoseconds server_time{0};  ///< server's clock when it came
};

/// What an environment answers. All of it is finite; vectors have the device's rows, or none where they are optional.
struct Response {
  Vector force{};            ///< on the device [N], then torque [N m]
  Vector contact_normal{};   ///< unit, out of the surface touched (deepest one); no rows: no contact
  double penetration_m = 0;  ///< depth below that surface, 0: no contact
  double texture_N = 0;      ///< amplitude of the surface's ripples, 0: smooth
  Vector texture_wave{};     ///< their wave vector [rad/m], in the tangent plane
  Vector texture_across{};   ///< a second one, for ripples in both directions
  /// Names of the environment's parts that are left out from now on; nothing new on most motions. Valid until the next
  /// motion.
  std::span<const std::string* const> quarantined{};
};

/// What went wrong within an environment and was kept from the client.
struct EnvironmentFaults {
  std::uint64_t old_normals = 0;        ///< contacts whose direction had to be the last valid one
  std::uint64_t quarantined = 0;        ///< parts whose force was not finite: left out from then on
  std::uint64_t contacts_left_out = 0;  ///< in tissue or among bodies: more than there was room for
  std::uint64_t not_converged = 0;      ///< steps of tissue that their budget ended
  double slipped_s = 0;                 ///< simulated time left out, because there was too much to make up for
};

/// What one client's device meets: a scene, a robot that follows, a program of somebody else's.
///
/// One instance for each session, which ends with it. A response that is not finite or has other rows than the device
/// reaches nobody: the client is sent zero force, and the server counts it.
///
/// Real time: `respond` is called on the server's one thread for each motion answered, and every other client waits
/// meanwhile. It must not allocate, wait, lock, print or throw.
class Environment {
 public:
  virtual ~Environment() = default;

  [[nodiscard]] virtual Response respond(const Motion& motion) noexcept = 0;

  /// Since it was made.
  [[nodiscard]] virtual EnvironmentFaults faults() const noexcept { return {}; }
};

/// What is known of a client when its environment is made.
struct ClientFacts {
  std::string device{};  ///< as the client calls it; printable
  std::uint32_t degrees_of_freedom = 0;
  double period_s = 0;        ///< how often motion will come, as promised
  double force_N_max = 0;     ///< more than this the device cannot show
  Nanoseconds round_trip{0};  ///< 0: not measured
};

/// An environment for one session, and what its client and the log are told of it.
struct MadeEnvironment {
  std::unique_ptr<Environment> environment{};
  std::string simulated{};  ///< in one line
  std::uint64_t hash = 0;   ///< the same hash, the same environment; 0: not known
  std::string choice{};     ///< what was picked for this client, and why; empty: there was no choice
};

/// Something that clients may ask for by name, described once. `make` is called for each session.
struct EnvironmentKind {
  std::string name{};
  std::vector<std::uint32_t> degrees_of_freedom{};  ///< of devices that it accepts; empty: any
  std::size_t sessions_max = 0;                     ///< at once; 0: as many as the server has room for
  bool wants_round_trip = false;                    ///< `make` depends on it, so the client measures it first

  /// @throws std::exception if none can be made now; the client is told why, and may ask again
  std::function<MadeEnvironment(const ClientFacts&)> make{};

  [[nodiscard]] bool accepts(std::uint32_t device_degrees_of_freedom) const noexcept;

  /// What `accepts` accepts, for people: "3 or 6".
  [[nodiscard]] std::string accepted_degrees_of_freedom() const;
};

}  // namespace forcebound::server
