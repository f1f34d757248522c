#include "tests/lab/accuracy/richardson.hpp"

#include <cmath>

#include "forcebound/text/numbers.hpp"

namespace forcebound::lab {
namespace {

/// p <= this is no convergence that one could extrapolate.
constexpr double kOrderLeast = 0.3;
// Farther from the finest level than that share of it nothing is extrapolated.
constexpr double kFarthest = 0.5;

double steps_along(const Forces& coarse, const Forces& middle, const Forces& fine) {
  double sum = 0;
  for (std::size_t i = 0; i < fine.size(); ++i) sum += (middle[i] - coarse[i]).dot(fine[i] - middle[i]);
  return sum;
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

Extrapolation richardson(const Forces& coarse, const Forces& middle, const Forces& fine, double ratio) {
  const double first = rms_difference(coarse, middle);
  const double second = rms_difference(middle, fine);
  const double size = rms(fine);
  Extrapolation reference{.forces = fine};
  if (!(second > 0)) {
    reference.why = "the finest level: it does not differ from the one before";
    return reference;
  }
  const double order = std::log(first / second) / std::log(ratio);
  if (!(order > kOrderLeast) || !(steps_along(coarse, middle, fine) > 0)) {
    reference.uncertainty = size > 0 ? second / size : 0;
    reference.why = "the finest level, since the levels do not converge monotonically: steps of " +
                    text::rounded(first) + " and " + text::rounded(second) + " N, observed order " +
                    text::rounded(order);
    return reference;
  }
  const double further = 1 / (std::pow(ratio, order) - 1);
  if (further * second > kFarthest * size) {
    reference.uncertainty = further * second / size;
    reference.why = "the finest level, since the limit lies too far beyond it to be told (observed order " +
                    text::rounded(order) + "): does the force of this contact have a limit?";
    return reference;
  }
  for (std::size_t i = 0; i < fine.size(); ++i) reference.forces[i] += further * (fine[i] - middle[i]);
  reference.order = order;
  reference.uncertainty = further * second / rms(reference.forces);
  reference.why = "Richardson's extrapolation of three levels, observed order " + text::rounded(order);
  return reference;
}

}  // namespace forcebound::lab
