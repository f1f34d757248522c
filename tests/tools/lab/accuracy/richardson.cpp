#include "tests/tools/lab/accuracy/richardson.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/text/numbers.hpp"

namespace forcebound::lab {
namespace {

/// With p <= this, convergence is too slow to extrapolate.
constexpr double kOrderLeast = 0.3;
constexpr double kOrderMost = 20;
constexpr int kHalvings = 60;
// Largest distance of the limit from the finest level, as a share of it.
constexpr double kFarthest = 0.5;

double steps_along(const Forces& coarse, const Forces& middle, const Forces& fine) {
  double sum = 0;
  for (std::size_t i = 0; i < fine.size(); ++i) sum += (middle[i] - coarse[i]).dot(fine[i] - middle[i]);
  return sum;
}

/// How much longer the first step is than the second, to the order p.
double steps_ratio(const Spacings& h, double order) {
  const double coarse = std::pow(h[0] / h[1], order);
  const double fine = std::pow(h[2] / h[1], order);
  return (coarse - 1) / (1 - fine);
}

/// The order p at which steps have that ratio, which grows with it; at most kOrderMost.
double order_of(const Spacings& h, double ratio) {
  double below = 0;
  double above = kOrderMost;
  for (int halving = 0; halving < kHalvings; ++halving) {
    const double middle = 0.5 * (below + above);
    (steps_ratio(h, middle) < ratio ? below : above) = middle;
  }
  return below;
}

}  // namespace

double rms(const Forces& forces) {
  if (forces.empty()) return 0;
  double sum = 0;
  for (const Vector& force : forces) sum += force.squaredNorm();
  return std::sqrt(sum / static_cast<double>(forces.size()));
}

double rms_difference(const Forces& a, const Forces& b) {
  if (a.empty()) return 0;
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

Extrapolation richardson(const Forces& coarse, const Forces& middle, const Forces& fine, const Spacings& spacings) {
  const double first = rms_difference(coarse, middle);
  const double second = rms_difference(middle, fine);
  const double size = rms(fine);
  Extrapolation reference{.forces = fine};
  if (!(second > 0)) {
    reference.why = "the finest level: it does not differ from the one before";
    return reference;
  }
  const double order = order_of(spacings, first / second);
  if (!(order > kOrderLeast) || !(steps_along(coarse, middle, fine) > 0)) {
    reference.uncertainty = size > 0 ? second / size : 0;
    reference.why = "the finest level, since the levels do not converge monotonically: steps of " +
                    text::rounded(first) + " and " + text::rounded(second) + " N, observed order " +
                    text::rounded(order);
    return reference;
  }
  const double further = beyond_the_finest(spacings, order);
  if (further * second > kFarthest * size) {
    reference.uncertainty = further * second / size;
    reference.why = "the finest level, since the limit lies too far beyond it to be extrapolated (observed order " +
                    text::rounded(order) + "): does the force of this contact have a limit?";
    return reference;
  }
  for (std::size_t i = 0; i < fine.size(); ++i) reference.forces[i] += further * (fine[i] - middle[i]);
  reference.order = order;
  // Before the asymptotic range the limit may seem near; then the last step is the better estimate.
  reference.uncertainty = std::max(further, 1.0) * second / rms(reference.forces);
  reference.why = "Richardson's extrapolation of three levels, observed order " + text::rounded(order);
  return reference;
}

double beyond_the_finest(const Spacings& spacings, double order) {
  return 1 / (std::pow(spacings[1] / spacings[2], order) - 1);
}

}  // namespace forcebound::lab
