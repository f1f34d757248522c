#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "forcebound/client/session/actuation.hpp"
#include "forcebound/client/session/event_reporter.hpp"
#include "forcebound/client/session/renderer.hpp"
#include "forcebound/client/session/session_link.hpp"
#include "forcebound/client/session/session_recorder.hpp"
#include "forcebound/client/session/view_sink.hpp"
#include "forcebound/device/haptic_device.hpp"
#include "forcebound/net/datagram_link.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

using control::Vector;
using time::Nanoseconds;

/// The device side of Forcebound, one tick at a time:
///
///     Actuation        read the device
///     SessionLink      send the motion, receive what has arrived
///     Renderer         newest force -> late-force policy -> scene and local models at the client in its place
///     Actuation        limits for the hand (HandSafety) -> saturate, bound, round (ForceBounder) -> apply
///     SessionRecorder  record the tick
///
/// Each stage owns its state and its counts; what one gives, Session passes to the next.
///
/// Where a tool is in the hand (Welcome), all that the environment is asked, and all of its force, is at the tool's
/// tip; a device that shows torques is asked for the torque of that force about the grip, and for what the answer says.
/// A device that tells its orientation but has no motors for it is told no torque, and the user once that there is
/// none.
///
/// The motion leaves before the force is chosen, so that an answer loses no tick where the server is near.
/// Recording never influences the force. Whatever fails, the force is zero and the event is counted. The law runs in
/// every state of the connection, and its ledger is never reset.
///
/// A device with a clock of its own has no new reading on some ticks. Such a tick is left out, for 5 ms at most and
/// while the device holds its force: the next one is late, for which the law accounts. It is in no record.
///
/// Real time: `tick` and `close` are noexcept, allocate nothing, wait for nothing. Owned by one thread.
class Session {
 public:
  struct Options {
    net::Address server;
    std::string server_in_words{};  ///< of whom the summary tells; empty: its address
    std::string scene{};            ///< requested; empty: the server's default
    LateForcePolicy policy{};
    std::uint64_t seed = 1;  ///< for the nonces of the handshake
    /// Runs the static parts of the scene, and lets local models go on; null: all forces are the server's.
    LocalRendering* local = nullptr;
    double force_slew_N_per_s = 0;     ///< largest change of the requested force; 0: no limit
    double torque_slew_N_m_per_s = 0;  ///< likewise of the torque
    SendRate send_rate{};
  };

  struct Sinks {
    std::span<record::TickSink* const> ticks;
    EventSink* events = nullptr;
    ViewSink* view = nullptr;  ///< null: what can be seen of the scene is not asked for
  };

  /// @throws std::invalid_argument for a policy with hold > drop, if ForceBounder refuses the device or law, or for a
  /// rate of motions below that of the ticks with a law that exchanges numbers with a server-side law on each.
  Session(const Options& options, device::HapticDevice& device, std::unique_ptr<control::PassivityLaw> law,
          net::DatagramLink& link, const time::Clock& clock, Sinks sinks);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Runs one tick. @param now time of the wake-up
  void tick(Nanoseconds now) noexcept;

  /// Ends the session: sets zero force and repeats Bye until the server's counts have not changed for the longest delay
  /// seen in this session, so that datagrams still on their way are not counted as lost. Call it about once a
  /// millisecond until it returns true or the caller's time limit is over.
  [[nodiscard]] bool close(Nanoseconds now) noexcept;

  [[nodiscard]] SessionState state() const noexcept { return link_.state(); }
  [[nodiscard]] std::uint64_t ticks() const noexcept { return recorder_.ticks(); }
  [[nodiscard]] bool refused() const noexcept { return link_.refused(); }
  [[nodiscard]] const control::PassivityLaw& law() const noexcept { return actuation_.law(); }

  /// Totals so far; forces and motions on their way count as lost. Allocates, and may wait for the builder of scenes,
  /// which need not have ended. Of the thread that ticks, or after it.
  [[nodiscard]] record::RunTotals totals() const;

 private:
  void receive(Nanoseconds now) noexcept;
  void pass_on(const SessionLink::Arrival& arrival, Nanoseconds now) noexcept;
  /// @param place where the environment is asked @returns the motion's number; 0: none is due
  std::uint64_t send_motion(const device::Reading& reading, const Vector& place) noexcept;

  EventReporter events_;
  Actuation actuation_;
  SessionLink link_;
  Renderer renderer_;
  SessionRecorder recorder_;
  ViewSink* view_;
  Nanoseconds now_{0};
};

}  // namespace forcebound::client
