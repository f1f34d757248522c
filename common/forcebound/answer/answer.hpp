#pragma once

#include "forcebound/control/follower_state.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/local_model/local_model.hpp"

namespace forcebound::answer {

using control::Vector;

/// What an environment answers to one motion: one value from the scene or robot that computes it, through the wire,
/// which frames it (wire::EnvironmentForce), to the client that renders it. A scene that runs at the client gives the
/// same.
///
/// Vectors have one row per degree of freedom of the device, in the environment's frame; all but the force may have
/// none.
struct Answer {
  Vector force{};                        ///< on the device [N], rotations [N m]
  Vector torque_N_m{};                   ///< on its handle, three rows; no rows: none
  Vector contact_normal{};               ///< unit, out of the surface touched (deepest one); no rows: no contact
  double penetration_m = 0;              ///< depth below that surface, 0: no contact
  double texture_N = 0;                  ///< amplitude A of that surface's ripples (ripples_N), 0: smooth
  Vector texture_wave{};                 ///< their wave vector k_1 [rad/m], in the tangent plane
  Vector texture_across{};               ///< k_2, of ripples in both directions
  Vector server_parts_N{};               ///< of `force`, that of the parts that are not handed over; no rows: zero
  bool texture_in_server_parts = false;  ///< the surface with the ripples is one of those
  /// Of `force`, that of effects that fade without a server; no rows: there are none. Not sent: it is for a client that
  /// runs the scene itself.
  Vector fading_N{};
  /// What of `server_parts_N` (where there is none, of `force`) a client can render itself until the next answer; may
  /// be empty. Unsound, it is not used, and its forces are held: local_model::is_sound.
  local_model::LocalModel model{};
  control::FollowerState follower = control::FollowerState::none;  ///< of a robot that is the environment
};

/// Whether a device of so many rows can be given it: all is finite, with that many rows or none, and neither depth nor
/// ripples are below zero. The model has a check of its own. Real time: noexcept, no allocation.
[[nodiscard]] bool is_sound(const Answer& answer, Eigen::Index rows) noexcept;

/// Where the ripples of an answer are felt, and what pushes there; all vectors have the rows of the answer's force.
struct RippledTouch {
  const Vector& answered_at;  ///< x_e [m], where the device was that the answer is for
  const Vector& position;     ///< x [m], of the device now
  const Vector& pushing_N;    ///< f_e: all of the answer's force, or of one that is felt in part that part
};

/// Ripples of the surface that an answer says is touched, of normal n and depth d. They are for the device to render at
/// its own position and rate, because a force that crosses the network is too late and too slow for them. Together with
/// what pushes they never pull:
///
///     f = n max(-f_e . n, A mean_i sin(k_i . x))    while d - n . (x - x_e) > 0,    else zero
///
/// Real time: noexcept, no allocation, O(rows).
[[nodiscard]] Vector ripples_N(const Answer& answer, const RippledTouch& touch) noexcept;

}  // namespace forcebound::answer
