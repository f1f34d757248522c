#pragma once

#include <span>
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

/// What a refinement tends to, as far as three levels can tell.
struct Extrapolation {
  Forces forces{};
  double uncertainty = 0;  ///< of it, as a share of its RMS
  double order = 0;        ///< observed, > 0; 0: none
  std::string why{};       ///< how it was had, for people
};

/// Richardson's extrapolation, the same for all states: of spacing r^2 h, r h, h the forces F2, F1, F0 differ as h^p,
///
///     p = log(|F1 - F2| / |F0 - F1|) / log r,      F = F0 + (F0 - F1) / (r^p - 1)
///
/// with |.| the RMS over the states. Its uncertainty is the whole step |F - F0|. Where the levels do not converge (p is
/// not positive, or the second step leads back along the first), or their limit is half as far as the force is large (a
/// point on a continuum: there is none), the finest level is the reference, its uncertainty
/// |F0 - F1|, and `why` says so.
///
/// @param coarse,middle,fine of the same length
/// @param ratio r > 1
Extrapolation richardson(const Forces& coarse, const Forces& middle, const Forces& fine, double ratio);

}  // namespace forcebound::lab
