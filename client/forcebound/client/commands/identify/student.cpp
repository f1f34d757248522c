#include "forcebound/client/commands/identify/student.hpp"

#include <cmath>

namespace forcebound::client::commands::identify {
namespace {

/// The same of the normal distribution, by Newton's method on its tail.
double normal_quantile(double confidence) noexcept {
  constexpr int kSteps = 50;
  constexpr double kDensityAtZero = 0.3989422804014327;
  double z = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double above = 0.5 * std::erfc(z * std::sqrt(0.5));
    z += (above - (1 - confidence)) / (kDensityAtZero * std::exp(-0.5 * z * z));
  }
  return z;
}

}  // namespace

double student_quantile(double confidence, double degrees_of_freedom) noexcept {
  const double x = normal_quantile(confidence);
  const double n = degrees_of_freedom;
  const double x2 = x * x;
  const double g1 = x * (x2 + 1) / 4;
  const double g2 = x * ((5 * x2 + 16) * x2 + 3) / 96;
  const double g3 = x * (((3 * x2 + 19) * x2 + 17) * x2 - 15) / 384;
  const double g4 = x * ((((79 * x2 + 776) * x2 + 1482) * x2 - 1920) * x2 - 945) / 92160;
  return x + (g1 + (g2 + (g3 + g4 / n) / n) / n) / n;
}

}  // namespace forcebound::client::commands::identify
