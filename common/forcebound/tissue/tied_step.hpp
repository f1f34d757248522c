#pragma once

#include <optional>
#include <span>

#include "forcebound/tissue/body_relaxation.hpp"
#include "forcebound/tissue/corotational_options.hpp"
#include "forcebound/tissue/deformed_surface.hpp"
#include "forcebound/tissue/tissue_contact.hpp"

namespace forcebound::tissue {

/// One motion of a pointed probe that is tied to a tissue, see CorotationalTissue. Real time.
class TiedStep final : public BodyContact {
 public:
  /// @param others on the same tissue. All arguments must outlive this.
  TiedStep(const CorotationalSetting& setting, CorotationalBody& body, const scene::Point& probe_m,
           std::span<SurfaceTie> others) noexcept
      : setting_(setting), body_(body), probe_m_(probe_m), others_(others) {}

  TissueResult run(const TissueState& last) noexcept;

  [[nodiscard]] TissueState state() const noexcept;

 private:
  [[nodiscard]] double energy_J(const Eigen::VectorXd& displacement_m) const noexcept override;
  void add_forces(const Eigen::VectorXd& displacement_m, Eigen::VectorXd& force_N) const noexcept override;
  void linearise(const Eigen::VectorXd& displacement_m) noexcept override;
  void add_resistance(const Eigen::VectorXd& moved_m, Eigen::VectorXd& force_N) const noexcept override;

  [[nodiscard]] DeformedSurface surface() const noexcept { return {setting_.surface, body_.now.displacement_m}; }
  [[nodiscard]] double stiffness_N_per_m() const noexcept { return setting_.options.contact_stiffness_N_per_m; }

  template <typename Do>
  void for_each_tie(const Do& act) const noexcept;

  void find_shift(const TissueState& last) noexcept;
  void locate(const TissueState& last) noexcept;
  void slide() noexcept;
  bool let_go() noexcept;
  void conclude(BodyRelaxation& relaxation) noexcept;

  CorotationalSetting setting_;
  CorotationalBody& body_;
  scene::Point probe_m_;
  std::span<SurfaceTie> others_;
  scene::Point shift_m_ = scene::Point::Zero();
  std::optional<SurfaceTie> own_;
  TissueResult result_;
};

}  // namespace forcebound::tissue
