#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "forcebound/tissue/complementarity.hpp"
#include "forcebound/tissue/tissue_surface.hpp"

namespace forcebound::tissue {

/// The shape of the probe that touches a tissue, and how its contacts are solved.
struct ProbeOptions {
  double radius_m = 0;  ///< of the spherical probe; 0: a point
  /// Stiffness of each contact, in series with the tissue; felt alone where the tissue is fixed.
  double contact_stiffness_N_per_m = 1e5;
  int contacts_max = 8;     ///< 1 to kContactsMax
  int iterations_max = 20;  ///< in one step, >= 1
  double tolerance = 1e-6;  ///< residual accepted, as a share of the surface's mean edge

  /// @throws std::invalid_argument unless all are in these ranges.
  void check() const;
};

/// A tissue's state of one probe between steps. Trivially copyable; all zero: before the first step.
struct TissueState {
  struct Contact {
    std::int64_t triangle;
    std::array<double, 3> weight;  ///< of the triangle's corners
  };

  std::uint32_t started;            ///< 0: `probe_m` is not set yet
  std::uint32_t contacts;           ///< number of valid elements of `contact`
  std::array<double, 3> probe_m;    ///< the probe at the last step; of a sphere that lags behind its probe, the sphere
  std::array<double, 3> shift_m;    ///< displacement of the surface near it by other probes
  std::array<double, 3> direction;  ///< unit, along which a sphere is held off; meaningless without contact
  std::array<Contact, kContactsMax> contact;  ///< contacts that push
};
static_assert(std::is_trivially_copyable_v<TissueState> && std::is_trivial_v<TissueState>);

/// How far a probe may go: one that leaps in one motion over more than the tissue's size, or goes that far away from
/// it, lets go of it. That is no hand, and would drag the tissue along for all others.
class TissueExtent {
 public:
  explicit TissueExtent(const TetrahedralMesh& mesh);

  /// Real time.
  [[nodiscard]] bool lets_go(const TissueState& state, const scene::Point& probe_m) const noexcept;

 private:
  scene::Point middle_m_;
  double size_m_;  // from corner to corner
};

// Queries that every tissue model makes of the surface at rest; probe positions are mapped back to the undeformed
// tissue. Real time.

/// The place of a contact of the last step.
[[nodiscard]] SurfacePlace place_of(const TissueState::Contact& contact) noexcept;

/// Where the probe entered from outside since the last step; none: it did not.
[[nodiscard]] std::optional<SurfacePlace> came_in(const TissueSurface& surface, const TissueState& last,
                                                  const scene::Point& probe_m) noexcept;

/// The contact point: that of the last step, else the point of entry since, else the nearest point if the probe begins
/// inside.
[[nodiscard]] std::optional<SurfacePlace> touched_place(const TissueSurface& surface, const TissueState& last,
                                                        const scene::Point& probe_m) noexcept;

/// Whether the motion since the last step stays farther than `reach_m` from the surface.
[[nodiscard]] bool is_way_clear(const TissueSurface& surface, const TissueState& last, const scene::Point& probe_m,
                                double reach_m) noexcept;

/// Result of a step.
struct TissueResult {
  scene::Point force_N = scene::Point::Zero();  ///< on the probe
  scene::Point normal = scene::Point::Zero();   ///< unit, along the force; zero without contact
  double depth_m = 0;     ///< of the probe below the surface as it would be without it, at the deepest contact
  double energy_J = 0;    ///< elastic, of the tissue and all contacts, other probes' included
  double residual_m = 0;  ///< distance of the contacts from equilibrium
  /// With which each of the state's contacts pushes, along the state's direction, in a linear tissue under a sphere.
  std::array<double, kContactsMax> push_N{};
  int contacts = 0;           ///< contacts that push; of a sphere under large motion, places
  int contacts_left_out = 0;  ///< contacts that would push, but exceed contacts_max: an error to report
  int iterations = 0;
  bool converged = true;  ///< the residual is within the tolerance
  bool finite = true;     ///< false: the probe's position or the force is not finite; force 0, state unchanged
};

}  // namespace forcebound::tissue
