#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/client/runtime/tick_amendment.hpp"
#include "forcebound/client/security/identity_files.hpp"
#include "forcebound/client/session/late_force_policy.hpp"
#include "forcebound/client/session/motion_schedule.hpp"
#include "forcebound/client/session/view_sink.hpp"
#include "forcebound/control/law.hpp"
#include "forcebound/device/haptic_device.hpp"
#include "forcebound/net/endpoint.hpp"
#include "forcebound/record/recording_writer.hpp"
#include "forcebound/record/summary.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/scene/scene.hpp"

namespace forcebound::client {

class EventQueue;

/// A complete client without command line and screen: a device and a law at work against a server, with the thread of
/// the tick, the socket, the recording and the summary.
///
///     MyDevice device;
///     client::Client client({.server = "127.0.0.1:47800", .duration_s = 10}, device,
///                           control::force_bounding_laws().make("fba-exact", device.facts()));
///     client.run(stop);
///     std::puts(client.summary().to_text().c_str());
///
/// If an assertion of Forcebound fails meanwhile, the device is stopped before the program ends.
class Client {
 public:
  /// Whom to connect to, how long, and what is written down. All but the server may be left out.
  struct Settings {
    std::string server;        ///< HOST:PORT; what a name leads to is tried by turns, and looked up again
    IdentityFiles identity{};  ///< keys; none: not encrypted, which is accepted on this machine alone
    bool insecure = false;     ///< not encrypted is accepted to any server
    std::string scene{};       ///< requested; empty: the server's default
    LateForcePolicy policy{};
    /// The static parts of the scene are handed over and run here; not with a law that has a server-side law, through
    /// which all forces go.
    bool renders_locally = true;
    std::string scene_cache{};         ///< folder of scenes that were handed over; empty: none are kept
    double force_slew_N_per_s = 0;     ///< largest change of the requested force; 0: no limit
    double torque_slew_N_m_per_s = 0;  ///< likewise of the torque
    SendRate send_rate{};              ///< of motions; on each tick unless said
    std::uint64_t seed = 1;            ///< of the handshake's nonces: must differ between runs
    double duration_s = 0;             ///< 0: until stopped
    bool once = false;                 ///< give up if the server does not answer for 5 s, or refuses another session
    bool asks_again = false;           ///< do not give up if the server refuses the first session
    std::string recording{};           ///< MCAP file for every tick and force; empty: none
    /// Runs beside another client of this process: it is that one's device that a failed assertion stops. For simulated
    /// devices alone.
    bool beside = false;
    /// The process goes on where the device does not return from a call: the watchdog stops it, and the tick waits.
    bool outlives_device = false;
    TickAmendment* amendment = nullptr;  ///< of each tick before it is recorded; must outlive the client
    ViewSink* view = nullptr;            ///< is told how the scene looks, by servers that tell; must outlive the client
    net::Resolver resolver = net::look_up;  ///< finds the addresses of the server's name
    // Further entries of the recording's metadata.
    std::string program{};
    std::string law{};  ///< its name; empty: the law's own
    std::string law_parameters{};
    std::string guarantee{};                          ///< what the law's ledger guarantees, and under which facts
    std::string hand{};                               ///< as requested
    std::string network{};                            ///< what is known of the way to the server
    std::vector<record::RecordedFile> attachments{};  ///< files that the recording has within
  };

  /// Called several times a second while it runs.
  using Housekeeping = std::function<void(time::Nanoseconds now, time::Nanoseconds elapsed)>;

  /// Tells the user that the device's driver has crashed, or does not return; the process ends after it.
  /// @param crash in words, and whether the device was stopped; empty: it does not return
  /// @param device_stopped then, whether the watchdog could stop the device
  /// @returns the process's exit code
  using Lost = std::function<int(std::string_view crash, bool device_stopped)>;

  /// Connects and opens the recording; does not start the device yet. `device` and `sinks` must outlive it.
  /// @throws std::invalid_argument if the server is on another machine, and neither keys nor `insecure` are given;
  /// std::exception with a message of one line: keys, recording, policy or what ForceBounder refuses. A name without
  /// an address is no reason: it may have one later.
  Client(const Settings& settings, device::HapticDevice& device, std::unique_ptr<control::PassivityLaw> law,
         std::vector<record::TickSink*> sinks = {});
  ~Client();

  /// Starts the device and runs until the time is up, the client gives up or `stop` is set; ends with zero force. To be
  /// called once. If the driver of a device crashes, or does not return from a call for 2 s, the process ends as `lost`
  /// says, else with EXIT_FAILURE, after the recording was written: no thread can be ended that is in a call. Not where
  /// it outlives the device.
  /// @throws std::exception if the device does not start, or the recording cannot be ended.
  void run(const std::atomic<bool>& stop, const Housekeeping& housekeeping = {}, const Lost& lost = {});

  /// Events for the user; to be taken by the thread that runs the client or its housekeeping.
  [[nodiscard]] EventQueue& events() noexcept;

  /// Which real-time scheduling the system granted, in words; null before the tick's thread has asked, right after it
  /// starts.
  [[nodiscard]] const std::string* real_time_grant() const noexcept;

  /// Why the recording is incomplete, once and as soon as it is known; else empty. For housekeeping.
  [[nodiscard]] std::string take_recording_fault();

  /// Where a server by name was found and what handshakes came to, in one line, and why it is not found or lets nobody
  /// in; each once, else empty. For housekeeping.
  [[nodiscard]] std::string take_server_news();
  [[nodiscard]] std::string take_server_problem();

  /// The server as the user wrote it, and of a name the addresses that it leads to now.
  [[nodiscard]] std::string server_in_words() const;

  /// Adds a line to what the summary and the recording say of the run, with its time since the start; after the first
  /// 100 they are passed over. For housekeeping.
  void add_note(const std::string& line);

  /// What has been handed over of the scene, to be looked at; null: nothing yet. Any thread but the tick's.
  [[nodiscard]] std::shared_ptr<const scene::Scene> scene_here() const;

  /// After `run`.
  [[nodiscard]] const record::Summary& summary() const noexcept;

  /// After `run`: whether the recording has all that was to be in it, or none was wanted.
  [[nodiscard]] bool recording_complete() const;

  /// Why it gave up; empty: it did not.
  [[nodiscard]] std::string why_no_session() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace forcebound::client
