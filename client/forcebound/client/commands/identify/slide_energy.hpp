#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "forcebound/client/commands/identify/release_fit.hpp"
#include "forcebound/client/commands/identify/slide.hpp"

namespace forcebound::client::commands::identify {

// The energy of one slide, linear in what is sought of its joint.

/// Parts of the workspace, each with a friction of its own.
inline constexpr int kPlaces = 3;

// Unknowns.
inline constexpr int kDamping = 0;
inline constexpr int kMass = 1;
inline constexpr int kWeight = 2;
inline constexpr int kFirstPlace = 3;
inline constexpr int kCount = kFirstPlace + kPlaces;
using Row = Eigen::Matrix<double, kCount, 1>;
using Square = Eigen::Matrix<double, kCount, kCount>;

/// row . unknowns = energy, up to this error.
struct Equation {
  Row row = Row::Zero();
  double energy_J = 0;
  double error_J = 0;          ///< standard deviation
  double latency_J_per_s = 0;  ///< change of what is left, if the release was later
  std::size_t slide = 0;
};

/// Of a slide, from its beginning to its release and to its end.
struct SlideEquations {
  Equation at_release;
  Equation at_end;
};

/// @param from where the places begin, from the joint's middle
/// @param to where they end
[[nodiscard]] SlideEquations equations_of(const Slide& slide, const ReleaseFit& fit, const ReleaseState& state,
                                          double step, double from, double to);

}  // namespace forcebound::client::commands::identify
