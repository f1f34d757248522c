#pragma once

#include <cstdint>
#include <optional>

#include "forcebound/client/rendering/answer_rendering.hpp"
#include "forcebound/client/rendering/bumpless_transfer.hpp"
#include "forcebound/client/rendering/local_rendering.hpp"
#include "forcebound/client/rendering/rate_limiter.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

/// The force that a tick requests, before the law bounds it: of the server's newest answer, of the scene at the client
/// where its geometry is known, and of local models.
///
///     remote  share of the answer's force, with the ripples of its texture
///     local   the scene here, in place of that, + share of the rest + what local models change of it
///             -> goes on where the one before ended (BumplessTransfer) -> rate limiter
///     torque  as the force, of the tool about its tip, + that of this force about the grip -> rate limiter
///
/// Real time: noexcept, no allocation. Owned by the tick.
class RequestRendering {
 public:
  /// @param local null: all forces are the server's
  RequestRendering(LocalRendering* local, const RateLimiter::Limits& force, const RateLimiter::Limits& torque) noexcept
      : local_(local),
        force_N_max_(force.most),
        transfer_(force.most),
        torque_transfer_(torque.most),
        force_limiter_(force),
        torque_limiter_(torque) {}

  struct Tick {
    Nanoseconds now{0};
    Nanoseconds read_at{0};    ///< of the device's position
    double elapsed_s = 0;      ///< since the reading before; zero on the first tick
    const Vector& position;    ///< of the device: the tip of its tool
    const Vector& place;       ///< where the environment is asked: the device's, unless the law moves it
    double share = 0;          ///< what the late-force policy leaves of the newest answer; zero: there is none
    ModelAge age{};            ///< of the state that it tells of
    control::Handle handle{};  ///< of the device at `read_at`
    Eigen::Vector3d arm_m = Eigen::Vector3d::Zero();  ///< from the grip to the tip of the tool, in the scene's frame
  };

  struct Request {
    Vector force_N{};
    Eigen::Vector3d torque_N_m = Eigen::Vector3d::Zero();  ///< about the grip
    Vector remote_N{};                                     ///< what the server's answers alone would ask for
    Eigen::Vector3d remote_N_m = Eigen::Vector3d::Zero();  ///< likewise, about the tip
    std::optional<Answer> local{};                         ///< of the scene here
    std::uint64_t local_scene = 0;                         ///< its number; 0: none runs here
    bool with_server_parts = false;      ///< of the server's answer there is a part in it, beside the scene here
    AnswerRendering::Rendered models{};  ///< what local models change of the server's answer
  };

  /// @param newest of the server's answers; its vectors have the device's rows or none
  [[nodiscard]] Request render(const std::optional<wire::EnvironmentForce>& newest, const Tick& tick) noexcept;

  /// The request was not asked for: the device has no force, from which the next request goes on.
  void rest() noexcept {
    force_limiter_.rest();
    torque_limiter_.rest();
  }

  /// The server ended that session.
  void end(std::uint64_t session) noexcept {
    if (local_ != nullptr) local_->end();
    answers_.end(session);
  }

  [[nodiscard]] const AnswerRendering& answers() const noexcept { return answers_; }

  /// Ticks on which the rate limiter bounded the request, of its force and of its torque.
  [[nodiscard]] std::uint64_t force_rate_limited() const noexcept { return force_limiter_.limited(); }
  [[nodiscard]] std::uint64_t torque_rate_limited() const noexcept { return torque_limiter_.limited(); }

 private:
  void render_locally(const std::optional<wire::EnvironmentForce>& newest, const Tick& tick, Request& request) noexcept;
  static void add_server_parts(const wire::EnvironmentForce& newest, const Tick& tick, Request& request) noexcept;
  void swap_sources(Nanoseconds now, Request& request) noexcept;

  LocalRendering* local_;
  double force_N_max_;
  AnswerRendering answers_;
  BumplessTransfer transfer_;
  BumplessTransfer torque_transfer_;  // of the torque about the tip
  RateLimiter force_limiter_;
  RateLimiter torque_limiter_;
  Vector last_request_N_{};
  Eigen::Vector3d last_request_N_m_ = Eigen::Vector3d::Zero();  // about the tip, before the limiter
  bool local_before_ = false;                                   // whether the last force was of the scene at the client
};

}  // namespace forcebound::client
