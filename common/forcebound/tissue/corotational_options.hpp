#pragma once

#include "forcebound/tissue/corotational_elasticity.hpp"
#include "forcebound/tissue/elasticity.hpp"
#include "forcebound/tissue/held_stiffness.hpp"
#include "forcebound/tissue/tissue_surface.hpp"

namespace forcebound::tissue {

struct CorotationalOptions {
  /// Stiffer ties converge too slowly to show their stiffness.
  static constexpr double kContactStiffnessMost_N_per_m = 1e4;

  /// A sphere's skin, in units of the tissue's own E / (1 - poisson^2) / radius: the default, which yields by some 2 %
  /// of a depth of one radius and 4 % of a quarter of it; and the maximum.
  static constexpr double kSkin = 20;
  static constexpr double kSkinMost = 200;

  double contact_stiffness_N_per_m = 1e3;  ///< of a point, between it and the place where it touches, > 0
  double radius_m = 0;                     ///< of a spherical probe; 0: a point
  double contact_stiffness_Pa_per_m = 0;   ///< of a sphere's skin; 0: the default
  int iterations_max = 4;                  ///< of Newton's method in one step, >= 1
  int linear_iterations_max = 15;          ///< of conjugate gradients in each, >= 1
  double tolerance = 1e-4;                 ///< residual accepted, as a share of the surface's mean edge

  /// @throws std::invalid_argument unless all are within the bounds above.
  void check(const ElasticMaterial& material) const;

  /// Of a sphere.
  [[nodiscard]] double skin_Pa_per_m(const ElasticMaterial& material) const noexcept;
};

/// The parts of a tissue that a step needs.
struct CorotationalSetting {
  const TissueSurface& surface;
  const CorotationalElasticity& elasticity;
  const StiffnessFactors& factors;
  const CorotationalOptions& options;
  double tolerance_m;
};

}  // namespace forcebound::tissue
