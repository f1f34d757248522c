#pragma once

#include <cstdint>
#include <optional>

#include "forcebound/control/handle.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/record/session_state.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/wire/messages.hpp"

/// A client's record of each tick and each force: enough to print its summary again from the recording alone.
namespace forcebound::record {

using time::Nanoseconds;

/// Where the force asked for came from.
enum class ForceOrigin : std::uint8_t {
  held,       ///< what the server said of where the device was
  at_client,  ///< the scene at the client, or local models
  both,       ///< these, and what the server said of the rest
};

/// One tick of the client: its reading, the force asked for, the force commanded, and the energies.
struct TickRecord {
  std::uint64_t tick = 0;   ///< 1, 2, 3, ...
  Nanoseconds time{0};      ///< of the reading, client's clock
  Nanoseconds interval{0};  ///< since the previous reading
  Nanoseconds latency{0};   ///< from the reading to the command
  SessionState state = SessionState::connecting;
  ForcePolicy policy = ForcePolicy::none;
  std::uint64_t motion_sequence = 0;     ///< sent on this tick, 0: none
  std::uint64_t force_sequence = 0;      ///< of the motion that the force used answers, 0: none
  Nanoseconds force_age{0};              ///< time since that motion's reading
  control::Vector position;              ///< reading, task space [m]
  control::Vector joint;                 ///< reading, joints
  control::Vector request;               ///< force asked for, after the late-force policy [N]
  control::Vector applied;               ///< force commanded [N]
  control::Vector request_torque_N_m{};  ///< asked for, on the handle, scene frame; no rows: the device shows none
  control::Vector applied_torque_N_m{};  ///< commanded; likewise
  bool contact = false;                  ///< the newest answer, or the true surface where it is known, says so
  double penetration_m = 0;              ///< below that surface; <= 0: no contact; not a number: not known here
  double displayed_N = 0;                ///< component of `applied` out of that surface
  double energy_J = 0;                   ///< energy that the law may spend now: E of its recursion
  /// Share, 0 to 1, of what the device's damping dissipates in the interval that begins here which the law will credit
  /// to E. fba-more: energy that the force needs over energy available, and 1 where the force is bounded or
  /// zero; other laws: always 1.
  double xi = 1;
  /// The ground-truth energy balance P(t) at the command, of a simulated device: since the start, what damping and
  /// friction took less what the motors gave to the hand (control/README.md, Definitions). 0 where it is not known.
  double audit_J = 0;
  /// The least P from the start until the command, between ticks too: never below 0 if the device was passive.
  double audit_minimum_J = 0;
  ForceOrigin rendering = ForceOrigin::held;
  control::Vector remote{};        ///< force that the newest answer alone would request [N]
  control::Vector local{};         ///< force of the scene at the client [N]; no rows: there was none
  std::uint64_t local_scene = 0;   ///< number of that scene, 1, 2, 3, ... as more of it came; 0: none
  Nanoseconds local_scene_age{0};  ///< since it was taken into use
  control::Vector model{};         ///< force of the server's local models at the device's own place [N]; no rows: none
  double model_deviation_m = 0;    ///< how far the newest answer moved a mass at the client
  /// The share of the newest answer's models that counts, by how they foretold the answers; absent: it has none.
  std::optional<double> model_trust{};
  control::Handle handle{};  ///< buttons, gripper and orientation at the reading; absent: it has none
};

/// One environment force as it arrived.
struct ForceRecord {
  Nanoseconds receive_time{0};  ///< client's clock
  Nanoseconds round_trip{0};    ///< since the reading of the motion it answers
  wire::EnvironmentForce force;
};

/// Receives the tick's records. Called by the tick: noexcept, no allocation, never waits.
class TickSink {
 public:
  virtual ~TickSink() = default;
  virtual void on_tick(const TickRecord& tick) noexcept = 0;
  virtual void on_force(const ForceRecord&) noexcept {}
};

}  // namespace forcebound::record
