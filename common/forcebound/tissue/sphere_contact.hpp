#pragma once

#include "forcebound/tissue/other_contacts.hpp"
#include "forcebound/tissue/tissue_probe.hpp"

namespace forcebound::tissue {

/// TissueModel::step for a spherical probe: pushes fixed places of the surface along one direction.
///
/// Real time: noexcept, no allocation, bounded.
class SphereContact {
 public:
  /// Largest number of parts of a triangle's edge.
  static constexpr int kDivisionsMax = 8;

  struct Setting {
    const LinearTissue& tissue;
    const ProbeOptions& options;
    OtherContacts* others = nullptr;  // may be null
    double tolerance_m = 0;
    int divisions = 1;  // of a triangle's edges
  };

  /// Uses the direction of the last step, or another one if that fits the surface better and does not raise the
  /// energy.
  /// @param shift_m displacement by others of the surface near the probe
  static TissueResult step(const Setting& setting, TissueState& state, const scene::Point& probe_m,
                           const scene::Point& shift_m) noexcept;

 private:
  // Position of a sphere, and the place where contact may begin if there was none.
  struct Begin {
    scene::Point probe_m;
    scene::Point shift_m;
    SurfacePlace first;
  };

  // @param direction unit, along which the sphere is held off
  SphereContact(const Setting& setting, const TissueState& last, const Begin& begin,
                const scene::Point& direction) noexcept;

  TissueResult solve_all() noexcept;
  void put_into(TissueState& state) const noexcept;
  void load_others() const noexcept;

  // A place that the sphere may push, and the sphere's depth there at zero force.
  struct Pushed {
    SurfacePlace place;
    double depth_m = 0;
    double below_m = 0;    // the sphere's centre, along the direction
    scene::Point aside_m;  // the centre, across it
    int group = 0;         // index of its triangle's Group
  };

  // Displacements of a triangle's corners, in columns.
  struct Group {
    int triangle = 0;
    Eigen::Matrix3d moved_m = Eigen::Matrix3d::Zero();
  };

  static constexpr int kPoolMax = 256;

  [[nodiscard]] Pushed pushed_at(const SurfacePlace& place) const noexcept;
  void find_anchors(const SurfacePlace& first) noexcept;
  void fill_pool() noexcept;
  void fill_pool_from(int triangle) noexcept;
  void keep(const Pushed& one) noexcept;
  [[nodiscard]] bool owns(int triangle, const std::array<int, 3>& parts) const noexcept;
  [[nodiscard]] scene::Point mean_normal() const noexcept;
  [[nodiscard]] bool is_reached(const Pushed& one) const noexcept;
  void restore_working_set() noexcept;
  void solve() noexcept;
  void couple() noexcept;
  [[nodiscard]] double yield(const Pushed& k, const Pushed& l) const noexcept;
  void deform() noexcept;
  [[nodiscard]] double gap(int candidate) const noexcept;
  [[nodiscard]] int deepest_beside() const noexcept;
  [[nodiscard]] int deepest_at_rest() const noexcept;
  void remember(int candidate, TissueState& state) const noexcept;
  [[nodiscard]] bool is_working(int candidate) const noexcept;
  void conclude(TissueResult& result) const noexcept;

  const LinearTissue& tissue_;
  const TissueSurface& surface_;
  const ProbeOptions& options_;
  OtherContacts* others_;
  const TissueState& last_;
  scene::Point probe_m_;
  scene::Point beside_rest_m_;  // the probe's position relative to the tissue at rest, without the others' displacement
  scene::Point direction_;
  double tolerance_m_;
  int divisions_;

  // Places of the last contact, or where contact may begin: the search along the surface starts there.
  std::array<Pushed, kContactsMax + 1> anchors_;
  int anchor_count_ = 0;
  double deepest_m_ = 0;

  std::array<Pushed, kPoolMax> pool_;
  int pool_count_ = 0;
  int pool_left_out_ = 0;
  std::array<Group, kPoolMax> groups_;
  int group_count_ = 0;

  std::array<int, kContactsMax> working_{};  // indices into the pool
  int working_count_ = 0;
  int pending_ = -1;  // candidate left over at the iteration limit; the next step starts with it
  ContactVector force_N_;
  ContactMatrix compliance_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, OtherContacts::kRowsMax, kContactsMax> coupled_;
};

}  // namespace forcebound::tissue
