#include "forcebound/control/diagonal_bound.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "forcebound/control/damping.hpp"

namespace forcebound::control {
namespace {

/// The function that is maximised at b, for unit diagonal; minus infinity outside.
double barrier(const Matrix& scaled, const Vector& b, double mu) noexcept {
  if (!(b.array() > 0).all()) return -HUGE_VAL;
  const Eigen::LLT<Matrix> rest(scaled - Matrix(b.asDiagonal()));
  if (rest.info() != Eigen::Success) return -HUGE_VAL;
  const double log_det = 2 * Matrix(rest.matrixL()).diagonal().array().log().sum();
  return b.array().log().sum() + mu * log_det;
}

/// One Newton step, shortened until it gains.
bool step(const Matrix& scaled, Vector& b, double mu) noexcept {
  const Eigen::LLT<Matrix> rest(scaled - Matrix(b.asDiagonal()));
  const Matrix inverse = rest.solve(Matrix::Identity(b.rows(), b.rows()));
  const Vector gradient = b.cwiseInverse() - mu * inverse.diagonal();
  Matrix curvature = mu * inverse.cwiseProduct(inverse);
  curvature.diagonal() += b.cwiseInverse().cwiseAbs2();
  const Vector way = Eigen::LLT<Matrix>(curvature).solve(gradient);
  const double gain = gradient.dot(way);
  constexpr double kEnough = 1e-14;
  if (!(gain > kEnough)) return false;
  const double before = barrier(scaled, b, mu);
  constexpr double kShortest = 1e-12;
  for (double length = 1; length > kShortest; length /= 2) {
    const Vector there = b + length * way;
    if (barrier(scaled, there, mu) < before + 0.1 * length * gain) continue;
    b = there;
    return true;
  }
  return false;
}

}  // namespace

Vector largest_diagonal_below(const Matrix& damping) noexcept {
  const Vector simple = diagonal_below(damping);
  if (damping.isDiagonal(0)) return simple;
  const Vector size = damping.diagonal().cwiseSqrt();
  const Vector shrink = size.cwiseInverse();
  const Matrix scaled = shrink.asDiagonal() * damping * shrink.asDiagonal();
  const Vector least = simple.cwiseProduct(shrink).cwiseProduct(shrink);
  Vector b = 0.5 * least;
  if (!std::isfinite(barrier(scaled, b, 1))) return simple;
  constexpr int kStepsMax = 50;
  constexpr double kLast = 1e-10;
  for (double mu = 1; mu > kLast; mu *= 0.1) {
    for (int i = 0; i < kStepsMax && step(scaled, b, mu); ++i) {
    }
  }
  // Rounding of the largest eigenvalue, which is at most the number of rows, may have gone the other way.
  constexpr double kRounding = 1e-13;
  b.array() -= kRounding;
  const bool better = (b.array() > 0).all() && b.array().log().sum() > least.array().log().sum();
  return better ? Vector(b.cwiseProduct(size).cwiseProduct(size)) : simple;
}

}  // namespace forcebound::control
