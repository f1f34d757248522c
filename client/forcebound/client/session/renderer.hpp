#pragma once

#include <cstdint>
#include <optional>

#include "forcebound/client/rendering/local_rendering.hpp"
#include "forcebound/client/rendering/request_rendering.hpp"
#include "forcebound/client/rendering/tool.hpp"
#include "forcebound/client/session/clock_offset.hpp"
#include "forcebound/client/session/event_reporter.hpp"
#include "forcebound/client/session/late_force_policy.hpp"
#include "forcebound/client/session/motion_schedule.hpp"
#include "forcebound/device/haptic_device.hpp"
#include "forcebound/record/run_info.hpp"

namespace forcebound::client {

/// The stage of a Session that decides what force to ask for: that of the newest answer, as late as the policy allows,
/// and of what runs at the client, both at the tip of the tool in the hand (RequestRendering).
///
/// Takes the sessions and pieces of scenes that the server tells of, and on each tick the device's reading and the
/// newest answer; gives the force, and what it needed of the server. Reports how late forces are, and what becomes of
/// the scene that is handed over.
///
/// Real time: noexcept, no allocation, but for `add_to`.
class Renderer {
 public:
  struct Options {
    LocalRendering* local = nullptr;  ///< null: all forces are the server's
    LateForcePolicy policy{};
    RateLimiter::Limits force{};
    RateLimiter::Limits torque{};
  };

  /// @param events must outlive this
  /// @throws std::invalid_argument for a policy with hold > drop
  Renderer(const Options& options, EventReporter& events);

  void begin_session(const wire::Welcome& welcome) noexcept;
  /// The server ended that session.
  void end_session(std::uint64_t session) noexcept { rendering_.end(session); }
  void receive(const wire::ScenePiece& piece) noexcept;

  /// Where the tool is. @param proxy where the law wants the environment asked for this reading
  [[nodiscard]] ToolPoint point_of(const device::Reading& reading, const Vector& proxy) const noexcept {
    return tool_.at(reading.position, proxy, reading.handle.orientation);
  }

  /// A motion of this reading is sent: the pieces that it acknowledges.
  [[nodiscard]] wire::PieceReceipt begin_motion(Nanoseconds read_at) noexcept;

  struct Tick {
    Nanoseconds now{0};
    const device::Reading& reading;
    double elapsed_s = 0;  ///< since the reading before; zero on the first tick
    const ToolPoint& point;
    const std::optional<wire::EnvironmentForce>& newest;  ///< of the server's answers; finite, with the device's rows
    Nanoseconds newest_arrival{0};
    const ClockOffset& clocks;  ///< of server and device
  };

  struct Rendered {
    RequestRendering::Request request{};
    ForcePolicy policy = ForcePolicy::none;
    bool silent = false;               ///< nobody asks for a force
    std::uint64_t force_sequence = 0;  ///< of the motion that the newest answer is for, 0: there is none
    Nanoseconds force_age{0};          ///< since that motion's reading
    ServerNeed need{};
  };

  [[nodiscard]] Rendered render(const Tick& tick) noexcept;

  /// Adds counts of rate limiters, local models and scenes. May wait for the builder of scenes.
  void add_to(record::RunTotals& totals) const;

 private:
  [[nodiscard]] ModelAge model_age(const wire::EnvironmentForce& newest, const Tick& tick) const noexcept;
  [[nodiscard]] ForcePolicy policy_of(const RequestRendering::Request& request, const Tick& tick,
                                      Nanoseconds age) const noexcept;
  [[nodiscard]] ServerNeed need_of(const RequestRendering::Request& request, const Tick& tick) const noexcept;
  void report_lost_tool(const Tick& tick) noexcept;
  void report_scene(Nanoseconds now) noexcept;
  void report_policy(ForcePolicy policy, Nanoseconds age, Nanoseconds now) noexcept;

  LocalRendering* local_;
  LateForcePolicy policy_;
  EventReporter& events_;
  RequestRendering rendering_;
  Tool tool_;
  bool tool_lost_ = false;  // reported in this session
  wire::ServerParts server_parts_ = wire::ServerParts::held;
  bool scene_offered_ = false;
  BuildPhase scene_phase_ = BuildPhase::nothing;
  ForcePolicy reported_ = ForcePolicy::none;
  Nanoseconds not_fresh_since_{0};
};

}  // namespace forcebound::client
