#pragma once

#include "forcebound/tissue/linear_tissue.hpp"
#include "forcebound/tissue/tissue_probe.hpp"

namespace forcebound::tissue {

class OtherContacts;

/// A spherical or pointed probe against a linearly elastic body, without friction and quasi-static.
///
/// The force is the gradient of an elastic energy in the probe's position c, so that a closed path returns no more
/// energy than it took. The places of contact, the only other variables, change only so that the energy falls.
///
/// *A point* sticks to a place s of the surface, and slides along the surface to the place of least energy, where the
/// force is normal to the deformed surface:
///
///     E(s; c) = 1/2 d' (C_s + I/k)^-1 d,   d = c - X_s,   C_s = sum over corners w_a C_ab w_b,   F = -dE/dc
///
/// with the surface's compliance C, weights w of the corners and contact stiffness k. The place is where the probe
/// entered or slid to since (a god object), never simply the nearest: so the probe does not pop through thin tissue. A
/// slide never raises E, so it only dissipates, whatever the number of iterations. When the force would pull, contact
/// ends.
///
/// *A sphere* meets places q fixed on the surface, half a radius apart, each pushed against a direction m, the normal
/// of the surface where contact began:
///
///     E(c) = max over f >= 0   f'b - 1/2 f'(A + I/k) f,   A_qp = m' w_q C w_p' m
///     b_q(c) = (X_q - c).m + r - rho^2 / 2r,   F = sum of f_q (m + rho_q / r)
///
/// where rho is c - X_q across m: the sphere counts as the paraboloid that touches it at its tip, as in Hertz's law, so
/// it is a good approximation down to a depth of about its radius, and the force follows the surface's slope.
/// Between places it may sink by r/24. Only places that face the sphere count, and those above its centre only where
/// the surface leads there from the last contacts: so it does not pop through thin tissue. Where the surface has
/// another normal, m becomes that normal as soon as this does not raise E.
///
/// *Several probes* on one tissue have one energy; each step lowers it over that probe's own variables, see
/// OtherContacts. A probe without contact is tested against the tissue as displaced by the others: its position is
/// mapped back to the tissue at rest.
///
/// Real time: `step` is noexcept, allocates nothing, and takes bounded time. Immutable: sessions share a model, each
/// with a state. A model's memory is essentially that of its LinearTissue.
class TissueModel {
 public:
  /// @throws std::invalid_argument for options that `check` refuses
  /// @throws std::runtime_error `NAME: ...` for a sphere so small beside the triangles that it needs a point's model.
  TissueModel(LinearTissue tissue, const ProbeOptions& options);

  [[nodiscard]] const LinearTissue& tissue() const noexcept { return tissue_; }
  [[nodiscard]] const ProbeOptions& options() const noexcept { return options_; }

  /// Predicted time of a step, of a probe that comes and goes.
  [[nodiscard]] double step_ns() const noexcept;

  /// @param state of this model; changed.
  [[nodiscard]] TissueResult step(TissueState& state, const scene::Point& probe_m) const noexcept {
    return step_among(nullptr, state, probe_m);
  }

  /// @param others on the same tissue; they respond to the step.
  [[nodiscard]] TissueResult step(TissueState& state, const scene::Point& probe_m,
                                  OtherContacts& others) const noexcept;

 private:
  TissueResult step_among(OtherContacts* others, TissueState& state, const scene::Point& probe_m) const noexcept;
  scene::Point shift_near(OtherContacts& others, const TissueState& state, const scene::Point& probe_m) const noexcept;

  LinearTissue tissue_;
  ProbeOptions options_;
  double tolerance_m_ = 0;
  int divisions_ = 1;  // of each triangle's edges, into a sphere's places
};

}  // namespace forcebound::tissue
