#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "forcebound/client/rendering/local_rendering.hpp"
#include "forcebound/client/rendering/request_rendering.hpp"
#include "forcebound/client/rendering/tool.hpp"
#include "forcebound/client/session/clock_offset.hpp"
#include "forcebound/client/session/connection.hpp"
#include "forcebound/client/session/device_watch.hpp"
#include "forcebound/client/session/event.hpp"
#include "forcebound/client/session/force_stream.hpp"
#include "forcebound/client/session/hand_safety.hpp"
#include "forcebound/client/session/late_force_policy.hpp"
#include "forcebound/client/session/motion_schedule.hpp"
#include "forcebound/client/session/outage_detector.hpp"
#include "forcebound/client/session/unseen_energy.hpp"
#include "forcebound/client/session/view_sink.hpp"
#include "forcebound/control/passivity_controller.hpp"
#include "forcebound/device/command_times.hpp"
#include "forcebound/device/haptic_device.hpp"
#include "forcebound/net/datagram_link.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::client {

using control::Vector;
using time::Nanoseconds;

/// The device side of Forcebound, one tick at a time:
///
///     read the device -> send the motion -> take in what has come -> choose the newest force -> late-force policy
///     -> local rendering in its place, where the geometry is known, and of local models (RequestRendering)
///     -> limits for the hand on the device (HandSafety)
///     -> saturate, bound, round (PassivityController)
///     -> apply -> write down
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

  /// @throws std::invalid_argument for a policy with hold > drop, if the controller refuses the device or law, or for a
  /// rate of motions below that of the ticks with a law that exchanges numbers with a server-side law on each.
  Session(Options options, device::HapticDevice& device, std::unique_ptr<control::PassivityLaw> law,
          net::DatagramLink& link, const time::Clock& clock, Sinks sinks);

  /// Runs one tick. @param now time of the wake-up
  void tick(Nanoseconds now) noexcept;

  /// Ends the session: sets zero force and repeats Bye until the server's counts have not changed for the longest delay
  /// seen in this session, so that datagrams still on their way are not counted as lost. Call it about once a
  /// millisecond until it returns true or the caller's time limit is over.
  [[nodiscard]] bool close(Nanoseconds now) noexcept;

  [[nodiscard]] SessionState state() const noexcept { return connection_.state(); }
  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }
  [[nodiscard]] bool refused() const noexcept { return counts_.refusals > 0; }
  [[nodiscard]] const control::PassivityLaw& law() const noexcept { return controller_.law(); }

  /// Totals so far; forces and motions on their way count as lost. Allocates, and may wait for the builder of scenes,
  /// which need not have ended. Of the thread that ticks, or after it.
  [[nodiscard]] record::RunTotals totals() const;

 private:
  /// Data of one tick, for the record.
  struct Done {
    device::Reading reading{};
    Eigen::Vector3d arm_m = Eigen::Vector3d::Zero();  ///< from the grip to the tool's tip
    Vector tip{};                                     ///< of the tool in the hand; without one, the device's
    Vector place{};                     ///< where the environment is asked: there, unless the law moves it
    std::uint64_t motion_sequence = 0;  ///< sent, 0: none
    RequestRendering::Request request{};
    std::uint64_t force_sequence = 0;  ///< of the motion that the newest answer is for, 0: there is none
    Nanoseconds force_age{0};          ///< since that motion's reading
    Vector applied{};                  ///< force, and torque where the device shows it
    Nanoseconds interval{0};
    Nanoseconds latency{0};
  };

  /// Events that Session counts itself, for the totals.
  struct Counts {
    std::uint64_t foreign_session = 0;
    std::uint64_t refusals = 0;
    std::array<std::uint64_t, wire::kMalformedReasons> malformed{};
    std::uint64_t send_failures = 0;
    std::uint64_t held_too_long = 0;
    std::uint64_t released_by_device = 0;
    std::uint64_t stale_readings = 0;
    control::ReadingCounts readings{};
  };

  [[nodiscard]] device::Reading read_device(Nanoseconds now) noexcept;
  /// @param place where the environment is asked
  std::uint64_t send_motion(const Vector& place, const device::Reading& reading) noexcept;
  /// What the server asks for to prove this address; 0: nothing.
  [[nodiscard]] std::uint64_t challenge() const noexcept;
  bool send(const wire::Message& message) noexcept;
  void receive_all(Nanoseconds now) noexcept;
  /// False: dropped by its heading, and counted.
  bool receive(std::span<const std::byte> datagram, Nanoseconds now, Nanoseconds arrival) noexcept;
  void receive(const wire::Message& message, Nanoseconds now, Nanoseconds arrival) noexcept;
  void receive_refusal(const wire::Refusal& refusal, Nanoseconds now, Nanoseconds arrival) noexcept;
  void tell_refused(const wire::Refusal& refusal, Nanoseconds now) noexcept;
  void receive_force(const wire::EnvironmentForce& force, Nanoseconds now, Nanoseconds arrival) noexcept;
  void receive_bye(const wire::Bye& bye, Nanoseconds now) noexcept;
  void note_news(Nanoseconds now) noexcept;
  void note_follower(control::FollowerState state, Nanoseconds now) noexcept;
  void keep_connected(Nanoseconds now) noexcept;
  [[nodiscard]] RequestRendering::Request request_at(Done& done, Nanoseconds now) noexcept;
  [[nodiscard]] ModelAge model_age(const wire::EnvironmentForce& newest, Nanoseconds at) const noexcept;
  void tell_of_scene(Nanoseconds now) noexcept;
  void tell_of_device(device::Reading::Status status, Nanoseconds now) noexcept;
  void tell_of_torque(const device::Reading& reading, Nanoseconds now) noexcept;
  /// What is asked of the law: the force, and the torque where the device shows it.
  [[nodiscard]] Vector wrench_of(const Done& done) const noexcept;
  [[nodiscard]] ServerNeed need_of(const RequestRendering::Request& request) const noexcept;
  void note_late_force(const RequestRendering::Request& request, Nanoseconds age, Nanoseconds now) noexcept;
  void note_policy(ForcePolicy policy, Nanoseconds age, Nanoseconds now) noexcept;
  void write_down(const Done& done) const noexcept;
  void write_down(const wire::EnvironmentForce& force, Nanoseconds arrival) const noexcept;
  void note_contact(const Done& done, record::TickRecord& record) const noexcept;
  void tell(Event::Kind kind, Nanoseconds now, std::string_view words, Nanoseconds duration = {}) noexcept;

  Options options_;
  device::HapticDevice& device_;
  net::DatagramLink& link_;
  const time::Clock& clock_;
  Sinks sinks_;
  control::PassivityController controller_;
  device::CommandTimes times_;
  MotionSchedule schedule_;
  std::optional<std::uint32_t> buttons_sent_;
  Connection connection_;
  ForceStream forces_;
  OutageDetector outages_;
  wire::Codec codec_;
  std::array<std::byte, net::kDatagramBytesMax + 1> buffer_{};  // one more, so that an oversize datagram shows

  Event event_;
  std::uint64_t ticks_ = 0;
  ForcePolicy policy_ = ForcePolicy::none;
  wire::ServerParts server_parts_ = wire::ServerParts::held;
  bool energy_taken_ = false;  // by a robot at the far end
  control::FollowerState follower_ = control::FollowerState::none;
  bool scene_offered_ = false;
  Nanoseconds local_since_{0};
  std::uint64_t local_scene_ = 0;
  BuildPhase scene_phase_ = BuildPhase::nothing;
  Nanoseconds newest_arrived_{0};
  ClockOffset clocks_;
  RequestRendering rendering_;
  HandSafety safety_;
  UnseenEnergy unseen_;
  Tool tool_;
  bool told_of_torque_ = false;
  Vector last_applied_;  // as Done::applied
  Nanoseconds last_tick_{0};
  Nanoseconds silent_since_{0};
  Nanoseconds not_fresh_since_{0};
  Nanoseconds next_bye_{Nanoseconds::min()};
  bool closing_ = false;
  int answers_without_news_ = 0;
  Nanoseconds last_news_{0};
  Nanoseconds now_{0};
  Counts counts_;
  DeviceWatch device_watch_;
  // They hold all that a Welcome can carry, so that the tick does not allocate.
  std::string scene_;
  std::string simulated_;
};

}  // namespace forcebound::client
