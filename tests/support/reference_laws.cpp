#include "tests/support/reference_laws.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cstddef>

namespace forcebound::test {
namespace {

using Real = boost::multiprecision::cpp_bin_float_100;
using RealVector = std::vector<Real>;
using RealMatrix = std::vector<RealVector>;

RealVector exact(const std::vector<double>& values) { return {values.begin(), values.end()}; }

std::vector<double> rounded(const RealVector& values) {
  std::vector<double> result;
  for (const Real& value : values) result.push_back(static_cast<double>(value));
  return result;
}

Real dot(const RealVector& a, const RealVector& b) {
  Real sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

RealVector scaled(RealVector v, const Real& factor) {
  for (Real& value : v) value *= factor;
  return v;
}

RealVector difference(RealVector a, const RealVector& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

/// The lower triangular C with C C' = b / T.
RealMatrix cholesky_factor(const std::vector<std::vector<double>>& damping, double period_s) {
  const std::size_t n = damping.size();
  RealMatrix factor(n, RealVector(n, Real(0)));
  for (std::size_t column = 0; column < n; ++column) {
    for (std::size_t row = column; row < n; ++row) {
      Real rest = Real(damping[row][column]) / Real(period_s);
      for (std::size_t k = 0; k < column; ++k) rest -= factor[row][k] * factor[column][k];
      factor[row][column] = row == column ? Real(sqrt(rest)) : Real(rest / factor[column][column]);
    }
  }
  return factor;
}

/// C' v.
RealVector transpose_times(const RealMatrix& factor, const RealVector& v) {
  RealVector result(v.size(), Real(0));
  for (std::size_t i = 0; i < v.size(); ++i) {
    for (std::size_t k = i; k < v.size(); ++k) result[i] += factor[k][i] * v[k];
  }
  return result;
}

/// C^-1 v.
RealVector forward_solve(const RealMatrix& factor, RealVector v) {
  for (std::size_t i = 0; i < v.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) v[i] -= factor[i][k] * v[k];
    v[i] /= factor[i][i];
  }
  return v;
}

/// f'B^-1 f.
Real mobility(const RealMatrix& factor, const RealVector& force) {
  const RealVector z = forward_solve(factor, force);
  return dot(z, z);
}

RealVector saturated(const std::vector<double>& request_N, double force_N_max) {
  RealVector request = exact(request_N);
  const Real length = sqrt(dot(request, request));
  if (force_N_max > 0 && length > force_N_max) return scaled(request, force_N_max / length);
  return request;
}

/// The state of both laws.
struct Held {
  RealVector position;
  RealVector force;
  RealMatrix factor;  // C of the present interval

  static Held none(std::size_t degrees_of_freedom) { return {{}, RealVector(degrees_of_freedom, Real(0)), {}}; }
  [[nodiscard]] bool begun() const { return !position.empty(); }
};

}  // namespace

std::vector<ReferenceAnswer> less_conservative_reference(const std::vector<ReferenceTick>& ticks,
                                                         const ReferenceSetting& setting) {
  std::vector<ReferenceAnswer> answers;
  if (ticks.empty()) return answers;
  Held held = Held::none(ticks.front().position_m.size());
  Real energy = 0;
  for (const ReferenceTick& tick : ticks) {
    const RealVector position = exact(tick.position_m);
    if (held.begun()) {
      const RealVector d = difference(position, held.position);
      const RealVector root = transpose_times(held.factor, d);
      energy += dot(root, root) - dot(held.force, d);
    }
    held.position = position;
    held.factor = cholesky_factor(tick.damping_N_s_per_m, setting.period_s);

    const RealVector request = saturated(tick.request_N, setting.force_N_max);
    const Real allowed = energy > 0 ? Real(4 * energy) : Real(0);
    const Real wanted = mobility(held.factor, request);
    held.force = wanted > allowed ? scaled(request, sqrt(allowed / wanted)) : request;
    answers.push_back({rounded(held.force), static_cast<double>(energy), 1.0});
  }
  return answers;
}

std::vector<ReferenceAnswer> more_conservative_reference(const std::vector<ReferenceTick>& ticks,
                                                         const ReferenceSetting& setting) {
  std::vector<ReferenceAnswer> answers;
  if (ticks.empty()) return answers;
  Held held = Held::none(ticks.front().position_m.size());
  Real xi = 1;
  for (const ReferenceTick& tick : ticks) {
    const RealVector position = exact(tick.position_m);
    Real available = 0;
    if (held.begun()) {
      const RealVector d = difference(position, held.position);
      const RealVector phi = difference(scaled(transpose_times(held.factor, d), 2 * xi),  //
                                        forward_solve(held.factor, held.force));
      available = dot(phi, phi) / (4 * xi);
    }
    held.position = position;
    held.factor = cholesky_factor(tick.damping_N_s_per_m, setting.period_s);

    const RealVector request = saturated(tick.request_N, setting.force_N_max);
    const Real needed = mobility(held.factor, request) / 4;
    if (needed > available) {
      held.force = scaled(request, sqrt(available / needed));
      xi = 1;
    } else {
      held.force = request;
      xi = needed > 0 ? Real(needed / available) : Real(1);
    }
    answers.push_back({rounded(held.force), static_cast<double>(available), static_cast<double>(xi)});
  }
  return answers;
}

}  // namespace forcebound::test
