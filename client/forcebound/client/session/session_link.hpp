#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "forcebound/client/session/clock_offset.hpp"
#include "forcebound/client/session/closing.hpp"
#include "forcebound/client/session/connection.hpp"
#include "forcebound/client/session/event_reporter.hpp"
#include "forcebound/client/session/force_stream.hpp"
#include "forcebound/client/session/late_force_policy.hpp"
#include "forcebound/client/session/message_link.hpp"
#include "forcebound/client/session/motion_schedule.hpp"
#include "forcebound/client/session/outage_detector.hpp"
#include "forcebound/device/haptic_device.hpp"
#include "forcebound/record/run_info.hpp"

namespace forcebound::client {

using control::Vector;

/// The session with the server: the stage between datagrams and the other stages of a Session.
///
/// Takes motions, and what arrives; keeps the connection, the newest force, the clocks' offset and the counts of both
/// ends, and gives what of the messages concerns other stages. Reports refusals, the end of a session and what the
/// robot at the far end does.
///
/// Real time: noexcept, no allocation, but for the constructor and `add_to`.
class SessionLink {
 public:
  struct Options {
    net::Address server;
    std::string server_in_words{};  ///< of whom the summary tells; empty: its address
    Connection::Facts facts{};
    std::uint64_t seed = 1;    ///< for the nonces of the handshake
    LateForcePolicy policy{};  ///< from its times on a session is stale, or lost
    SendRate send_rate{};
  };

  /// @param datagrams, @param clock and @param events must outlive this
  /// @throws std::invalid_argument for a rate of motions below that of the ticks with a law that exchanges numbers with
  /// a server-side law on each
  SessionLink(Options options, net::DatagramLink& datagrams, const time::Clock& clock, EventReporter& events);

  /// Whether a motion is sent. Called on each tick that has a reading.
  /// @param place where the environment is asked
  [[nodiscard]] bool is_motion_due(const device::Reading& reading, const Vector& place) noexcept;

  /// Sends the motion that is due. @param motion all but session, number and challenge @returns its number
  std::uint64_t send(wire::MotionSample motion) noexcept;

  /// What the last tick's force needed of the server.
  void plan_motions(const ServerNeed& need) noexcept { schedule_.plan(need); }

  struct Arrival {
    /// A Welcome that began a session, a force of this session, a piece of its scene or of how that looks, or the Bye
    /// with which the server ended it. Valid until the next call.
    const wire::Message& message;
    Nanoseconds at{0};    ///< when it arrived at this machine
    bool newest = false;  ///< of a force: for a newer motion than all before
  };

  /// The next message that concerns another stage; none: that was all for this tick.
  [[nodiscard]] std::optional<Arrival> receive(Nanoseconds now, MessageLink::Received& in_tick) noexcept;

  /// Repeats Hello until there is a session. Called once a tick, after what has arrived.
  void keep_connected(Nanoseconds now) noexcept;

  /// From now on a Bye answers ours.
  void begin_closing(Nanoseconds now) noexcept { closing_.begin(now); }

  /// After `begin_closing` and what has arrived: repeats Bye. True once the server's counts are final.
  [[nodiscard]] bool close(Nanoseconds now) noexcept;

  [[nodiscard]] SessionState state() const noexcept { return connection_.state(); }
  [[nodiscard]] bool refused() const noexcept { return refusals_ > 0; }
  [[nodiscard]] const ForceStream& forces() const noexcept { return forces_; }
  [[nodiscard]] const ClockOffset& clocks() const noexcept { return clocks_; }

  /// Adds what was sent and received, and the longest blackout. Forces and motions on their way count as lost.
  void add_to(record::RunTotals& totals, Nanoseconds now) const;

 private:
  /// @returns whether it concerns another stage
  [[nodiscard]] bool accept(Arrival& arrival, Nanoseconds now) noexcept;
  [[nodiscard]] bool accept(const wire::EnvironmentForce& force, Arrival& arrival, Nanoseconds now) noexcept;
  [[nodiscard]] bool accept(const wire::Welcome& welcome, Nanoseconds now) noexcept;
  [[nodiscard]] bool accept(const wire::Bye& bye, Nanoseconds now) noexcept;
  void receive(const wire::Refusal& refusal, Nanoseconds now, Nanoseconds arrival) noexcept;
  void report_refusal(const wire::Refusal& refusal, Nanoseconds now) noexcept;
  void report_follower(control::FollowerState state, Nanoseconds now) noexcept;

  Options options_;
  const time::Clock& clock_;
  EventReporter& events_;
  MessageLink messages_;
  Connection connection_;
  ForceStream forces_;
  OutageDetector outages_;
  ClockOffset clocks_;
  MotionSchedule schedule_;
  std::optional<std::uint32_t> buttons_sent_;
  bool takes_energy_ = false;  // a robot at the far end
  control::FollowerState follower_ = control::FollowerState::none;
  Nanoseconds silent_since_{0};
  Nanoseconds last_reading_{0};
  Closing closing_;
  std::uint64_t refusals_ = 0;
};

}  // namespace forcebound::client
