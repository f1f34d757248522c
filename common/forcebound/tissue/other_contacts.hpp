#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "forcebound/tissue/linear_tissue.hpp"
#include "forcebound/tissue/tissue_probe.hpp"

namespace forcebound::tissue {

/// Effect of the other probes on a tissue during one probe's step.
///
/// Each of their contacts is a spring of 1/k along one direction e (a sphere's) or three (a point's), between a place
/// of the surface and its probe, with extension d when the tissue is at rest. All probes on a tissue together have one
/// energy,
///
///     E = max over f, p   f'b + p'd - 1/2 (f, p)' (A + I/k) (f, p)
///
/// f being the forces of the probe that steps and p those of the others. With L L' the others' rows of A + I/k, y =
/// L^-1 d and z_k = L^-1 A_k the p are eliminated, exactly: what remains is a tissue whose surface the others alone
/// have moved by z_k . y, and whose compliance is less by z_k . z_l. So one probe's step minimises the energy of all,
/// with the others' places and the set of their contacts held.
///
/// drop_pulling removes contacts that would pull, and the step is repeated without them until none pulls
/// (LinearTissueWorld stops after four repetitions). Removing a spring lowers E, so energy is only lost. A removed
/// contact is not tested again within the step, although it might push after the removal of others. If so, it returns
/// with the next step and adds energy to E that no hand has put in: at most k/2 times the square of its probe's depth.
/// Contacts beyond the maximum are counted, and have neither force nor energy.
///
/// Real time: all but the constructor is noexcept and allocates nothing. Scratch memory, for one thread at a time.
class OtherContacts {
 public:
  /// Room for: eight spheres with eight contacts each, or 21 points.
  static constexpr int kRowsMax = 64;

  using Row = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kRowsMax, 1>;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kRowsMax, 3>;

  /// Directions of one contact, in columns.
  using Directions = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>;

  /// @param tissue must outlive it
  OtherContacts(const LinearTissue& tissue, const ProbeOptions& options);

  /// Memory of one instance, for a tissue with `surface_nodes` nodes on its surface.
  [[nodiscard]] static std::size_t memory_bytes(int surface_nodes) noexcept {
    return sizeof(OtherContacts) + static_cast<std::size_t>(surface_nodes) * sizeof(Moved);
  }

  void clear() noexcept;

  /// The contacts of one more probe. @returns the number of contacts beyond the maximum.
  int add(const TissueState& probe) noexcept;

  [[nodiscard]] bool empty() const noexcept { return contact_count_ == 0; }

  /// Removes the contacts that pull under the forces of the last `respond`, or under no forces if there was none.
  /// @returns whether any was removed. If so, the state is as before `respond`.
  bool drop_pulling() noexcept;

  /// z, one column for each unit direction at a place.
  [[nodiscard]] Rows coupled(const SurfacePlace& place, const Directions& directions) const noexcept;

  /// The others' forces become those under the stepping probe's forces.
  /// @param pushed sum of z_k f_k
  void respond(const Row& pushed) noexcept;
  void respond_to_none() noexcept { yielded_N_.setZero(); }

  /// How far the others alone have moved a node of the surface, or a place.
  [[nodiscard]] scene::Point moved_m(int node) noexcept;
  [[nodiscard]] scene::Point moved_m(const SurfacePlace& place) noexcept;

  /// How much farther a node has moved since the others yielded to the stepping probe.
  [[nodiscard]] scene::Point yielded_m(int node) const noexcept { return moved_under(yielded_N_, node); }

  /// Upper bound of the displacement of any node by the others alone.
  [[nodiscard]] double reach_m() const noexcept;

  /// Elastic energy of the tissue and the others' contacts without the stepping probe.
  [[nodiscard]] double energy_J() const noexcept { return 0.5 * drive_.squaredNorm(); }

 private:
  [[nodiscard]] Eigen::Index rows() const noexcept { return drive_.size(); }

  struct Contact {
    SurfacePlace place{};
    Directions directions{};
    scene::Point depth_m = scene::Point::Zero();  // along the directions
    int first_row = 0;
  };

  void put_in(Contact& contact) noexcept;
  [[nodiscard]] Row solved_upward(Row right) const noexcept;
  [[nodiscard]] scene::Point force_of(const Contact& contact, const Row& force_N) const noexcept;
  [[nodiscard]] bool pulls(const Contact& contact, const Row& force_N) const noexcept;
  [[nodiscard]] scene::Point moved_under(const Row& force_N, int node) const noexcept;
  void begin_alone() noexcept;

  const LinearTissue& tissue_;
  double radius_m_;
  double yield_m_per_N_;
  double compliance_m_per_N_max_ = 0;

  std::array<Contact, kRowsMax> contacts_;
  int contact_count_ = 0;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kRowsMax, kRowsMax> factor_;  // L
  Row drive_;                                                                                          // y
  Row alone_N_;
  Row yielded_N_;

  struct Moved {
    scene::Point by_m = scene::Point::Zero();
    std::uint64_t as_of = 0;
  };
  std::vector<Moved> moved_;  // per node, computed on first use
  std::uint64_t now_ = 1;
};

}  // namespace forcebound::tissue
