#pragma once

#include <array>
#include <string>
#include <vector>

#include "forcebound/control/vector.hpp"

namespace forcebound::lab {

using control::Vector;

/// Forces at the same states, one for each.
using Forces = std::vector<Vector>;

/// Root mean square of the norms [N]; of nothing, 0.
double rms(const Forces& forces);
double rms_difference(const Forces& a, const Forces& b);

/// The limit of a refinement, estimated from three levels.
struct Extrapolation {
  Forces forces{};
  double uncertainty = 0;  ///< of it, as a share of its RMS
  double order = 0;        ///< observed, > 0; 0: none
  std::string why{};       ///< how it was obtained, as text
};

/// Of three levels, coarse to fine.
using Spacings = std::array<double, 3>;

/// Richardson's extrapolation, the same for all states: the forces F2, F1, F0 of spacings h2 > h1 > h0 are off by C
/// h^p,
///
///     (h2^p - h1^p) / (h1^p - h0^p) = |F1 - F2| / |F0 - F1|,      F = F0 + (F0 - F1) / ((h1 / h0)^p - 1)
///
/// with |.| the RMS over the states. Its uncertainty is the whole step |F - F0|, or the
/// last one |F0 - F1| where that is longer. Where the levels do not converge (p is
/// not positive, or the second step leads back along the first), or their limit is half as far as the force is large (a
/// point on a continuum: there is none), the finest level is the reference, its uncertainty
/// |F0 - F1|, and `why` says so.
///
/// @param coarse,middle,fine of the same length
Extrapolation richardson(const Forces& coarse, const Forces& middle, const Forces& fine, const Spacings& spacings);

/// F - F0 over F0 - F1 for an order p.
double beyond_the_finest(const Spacings& spacings, double order);

}  // namespace forcebound::lab
