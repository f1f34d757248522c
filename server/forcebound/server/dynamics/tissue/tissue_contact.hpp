#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "forcebound/server/dynamics/tissue/complementarity.hpp"
#include "forcebound/server/dynamics/tissue/linear_tissue.hpp"
#include "forcebound/server/dynamics/tissue/tissue_surface.hpp"

namespace forcebound::server {

class OtherContacts;

/// The shape of the probe that touches a tissue, and how its contacts are solved.
struct ProbeOptions {
  double radius_m = 0;  ///< of the spherical probe; 0: a point
  /// Of each contact, in series with the tissue: what is felt where the tissue is held.
  double contact_stiffness_N_per_m = 1e5;
  int contacts_max = 8;     ///< 1 to kContactsMax
  int iterations_max = 20;  ///< in one step, >= 1
  double tolerance = 1e-6;  ///< residual accepted, as a share of the surface's mean edge

  /// @throws std::invalid_argument unless all are as said above.
  void check() const;
};

/// What a tissue remembers of a probe from step to step. Trivially copyable; all zero: nothing has happened yet.
struct TissueState {
  struct Contact {
    std::int64_t triangle;
    std::array<double, 3> weight;  ///< of the triangle's corners
  };

  std::uint32_t started;                      ///< 0: `probe_m` means nothing yet
  std::uint32_t contacts;                     ///< how many of `contact` hold
  std::array<double, 3> probe_m;              ///< where the probe was, or its sphere that is behind it
  std::array<double, 3> shift_m;              ///< how far other probes had moved the surface near it
  std::array<double, 3> direction;            ///< unit, along which a sphere is held off; meaningless without contact
  std::array<Contact, kContactsMax> contact;  ///< those that push
};
static_assert(std::is_trivially_copyable_v<TissueState> && std::is_trivial_v<TissueState>);

// Queries that every tissue model makes of the surface at rest; probe positions are mapped back to the undeformed
// tissue. Real time.

/// The contact point of a contact that goes on.
[[nodiscard]] SurfacePlace place_of(const TissueState::Contact& contact) noexcept;

/// Point where the probe entered from outside since the last step, if it did.
[[nodiscard]] std::optional<SurfacePlace> came_in(const TissueSurface& surface, const TissueState& last,
                                                  const scene::Point& probe_m) noexcept;

/// The contact point: where it was, where the probe entered since, or the nearest one if the probe begins inside.
[[nodiscard]] std::optional<SurfacePlace> touched_place(const TissueSurface& surface, const TissueState& last,
                                                        const scene::Point& probe_m) noexcept;

/// Whether the motion since the last step is out of reach of every surface.
[[nodiscard]] bool is_way_clear(const TissueSurface& surface, const TissueState& last, const scene::Point& probe_m,
                                double reach_m) noexcept;

/// What a step says.
struct TissueResult {
  scene::Point force_N = scene::Point::Zero();  ///< on the probe
  scene::Point normal = scene::Point::Zero();   ///< unit, along the force; zero without contact
  double depth_m = 0;                           ///< of the probe below the surface without it, at the deepest contact
  double energy_J = 0;                          ///< elastic, of tissue and contacts, those of other probes too
  double residual_m = 0;                        ///< how far the contacts are yet from where they belong
  int contacts = 0;                             ///< that push; of a sphere under large motion, places
  int contacts_left_out = 0;                    ///< would push, but are beyond contacts_max: an error to report
  int iterations = 0;
  bool converged = true;  ///< the residual is within the tolerance
  bool finite = true;     ///< false: the probe's position was not, or the force; force 0, state unchanged
};

/// A spherical or pointed probe against a linearly elastic body, without friction and quasi-static.
///
/// The force is the gradient of an elastic energy in the probe's position c, so that going round in a circle returns no
/// more than it took; what changes beside c, the places of contact, is chosen so that the energy falls.
///
/// *A point* sticks to a place s of the surface, and slides along the surface to where that takes least energy, which
/// is where the force is normal to the surface as it is deformed:
///
///     E(s; c) = 1/2 d' (C_s + I/k)^-1 d,   d = c - X_s,   C_s = sum over corners w_a C_ab w_b,   F = -dE/dc
///
/// with the surface's compliance C, weights w of the corners and contact stiffness k. The place is where the probe came
/// in or slid to since (a god object), never simply the nearest: thin tissue does not let the probe pop through. A
/// slide never raises E, so it only takes energy, whatever the number of iterations. When the force would pull, the
/// probe is let go.
///
/// *A sphere* meets places q fixed on the surface, half a radius apart, each pushed against a direction m, the normal
/// of the surface where contact began:
///
///     E(c) = max over f >= 0   f'b - 1/2 f'(A + I/k) f,   A_qp = m' w_q C w_p' m
///     b_q(c) = (X_q - c).m + r - rho^2 / 2r,   F = sum of f_q (m + rho_q / r)
///
/// where rho is c - X_q across m: the sphere counts as the paraboloid that touches it at its tip, as in Hertz's law, so
/// it is felt as blunt as a sphere no deeper than about its radius, and the force turns with the surface that it meets.
/// Between places it may sink by r/24. Only places that face the sphere count, and those above its centre only where
/// the surface leads there from the last contacts: thin tissue does not let it pop through. Where the surface has
/// another normal, that is the new m, as soon as that does not raise E.
///
/// *Several probes* on one tissue have one energy; each step lowers it over what is its own, see OtherContacts. The
/// places where a probe may touch are those of the tissue as the others have moved it: a probe without contact counts
/// as where it would be beside the tissue at rest.
///
/// Real time: `step` is noexcept, allocates nothing, and takes bounded time. Immutable: sessions share a model, each
/// with a state. A model takes the memory of its LinearTissue and little more.
class TissueModel {
 public:
  /// @throws std::invalid_argument for options that `check` refuses
  /// @throws std::runtime_error `NAME: ...` for a sphere so small beside the triangles that it needs a point's model.
  TissueModel(LinearTissue tissue, const ProbeOptions& options);

  [[nodiscard]] const LinearTissue& tissue() const noexcept { return tissue_; }
  [[nodiscard]] const ProbeOptions& options() const noexcept { return options_; }
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

}  // namespace forcebound::server
