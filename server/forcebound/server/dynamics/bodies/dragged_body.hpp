#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "forcebound/local_model/local_model.hpp"
#include "forcebound/server/dynamics/bodies/body_contacts.hpp"
#include "forcebound/server/dynamics/bodies/body_mobility.hpp"
#include "forcebound/server/dynamics/bodies/coupling.hpp"
#include "forcebound/server/dynamics/bodies/mujoco.hpp"

namespace forcebound::server {

/// A body that a device drags, after a step of MuJoCo.
struct DraggedBody {
  int body = -1;
  int held = -1;  ///< welded to it; -1: nothing
  /// On the device, in that step.
  scene::Point force_N = scene::Point::Zero();
  /// Between the positions that MuJoCo's step began with and now.
  double since_s = 0;
};

/// Tells of a dragged body what a client needs to move it by itself: how it answers, and the nearest of what it touches
/// or, within kNear_m, may touch next, with what gives way there. Real time: noexcept, no allocation.
class DraggedBodies {
 public:
  /// Farther than most hands go in the time of an answer.
  static constexpr double kNear_m = 0.05;

  DraggedBodies(const mjModel_& model, const Coupling& coupling);

  /// Nothing of what its joints hold altogether.
  [[nodiscard]] std::optional<local_model::Mass> describe(const mjModel_& model, const mjData_& data,
                                                          const DraggedBody& dragged) noexcept;

  /// Estimate for one `describe` [ns].
  [[nodiscard]] static double predicted_cost_ns(const mjModel_& model) noexcept;

 private:
  static constexpr std::size_t kAheadMost = 64;

  void look_ahead(const mjModel_& model, const mjData_& data, const DraggedBody& dragged) noexcept;

  Coupling coupling_;
  BodyMobility mobility_;
  RecentContacts recent_;
  std::vector<mjContact_> ahead_;
  std::vector<mjContact_> found_;  // of two geometries
};

}  // namespace forcebound::server
