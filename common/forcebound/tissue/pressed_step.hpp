#pragma once

#include <span>

#include "forcebound/tissue/body_relaxation.hpp"
#include "forcebound/tissue/corotational_options.hpp"
#include "forcebound/tissue/deformed_surface.hpp"
#include "forcebound/tissue/sphere_pressure.hpp"
#include "forcebound/tissue/tissue_contact.hpp"

namespace forcebound::tissue {

/// One motion of a spherical probe that presses on a tissue, see CorotationalTissue. Real time.
class PressedStep final : public BodyContact {
 public:
  /// @param others_m centres of the other spheres on the same tissue. All arguments must outlive this.
  PressedStep(const CorotationalSetting& setting, const SpherePressure& pressure, CorotationalBody& body,
              const scene::Point& probe_m, std::span<const scene::Point> others_m) noexcept
      : setting_(setting), pressure_(pressure), body_(body), probe_m_(probe_m), others_m_(others_m) {}

  TissueResult run(const TissueState& last) noexcept;

  [[nodiscard]] TissueState state() const noexcept;

 private:
  [[nodiscard]] double energy_J(const Eigen::VectorXd& displacement_m) const noexcept override;
  void add_forces(const Eigen::VectorXd& displacement_m, Eigen::VectorXd& force_N) const noexcept override;
  void linearise(const Eigen::VectorXd& displacement_m) noexcept override;
  void add_resistance(const Eigen::VectorXd& moved_m, Eigen::VectorXd& force_N) const noexcept override;

  [[nodiscard]] DeformedSurface surface() const noexcept { return {setting_.surface, body_.now.displacement_m}; }
  [[nodiscard]] bool arrived() const noexcept { return center_m_ == probe_m_; }

  template <typename Do>
  void for_each_sphere(const Do& act) const noexcept;

  [[nodiscard]] scene::Point outside() const noexcept;
  bool advance() noexcept;
  void relax() noexcept;
  void conclude(BodyRelaxation& relaxation) noexcept;

  CorotationalSetting setting_;
  const SpherePressure& pressure_;
  CorotationalBody& body_;
  scene::Point probe_m_;
  std::span<const scene::Point> others_m_;
  scene::Point center_m_ = scene::Point::Zero();  // of the sphere, which follows the probe
  TissueResult result_;
};

}  // namespace forcebound::tissue
