#include "tests/support/adversary.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

namespace forcebound::test {
namespace {

/// Hand and environment against a law: requests any force and moves so as to extract the most energy.
class Adversary {
 public:
  Adversary(std::uint64_t seed, int degrees_of_freedom) : random_(seed), size_(degrees_of_freedom) {}

  /// From 0 to 1e6 N, in any direction.
  control::Vector request() {
    switch (choice(6)) {
      case 0:
        return control::Vector::Zero(size_);
      case 1:
        return 1e6 * any_vector();
      case 2:
        return -last_request_;
      default:
        last_request_ = std::pow(10.0, number(-4, 2)) * any_vector();
        return last_request_;
    }
  }

  /// The motion under `force_N` for a tick with `damping`: mostly the one that returns the most, T b^-1 f / 2.
  control::Vector motion(const control::Vector& force_N, const control::Matrix& damping, double period_s) {
    const control::Vector greedy = 0.5 * period_s * damping.ldlt().solve(force_N);
    switch (choice(6)) {
      case 0:
        return 1e-4 * any_vector();
      case 1:
        return number(0, 2) * greedy;
      case 2:
        return control::Vector::Zero(size_);
      default:
        return greedy;
    }
  }

 private:
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int choice(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  control::Vector any_vector() {
    return control::Vector::NullaryExpr(size_, [this](Eigen::Index) { return number(-1, 1); });
  }

  std::mt19937_64 random_;
  Eigen::Index size_;
  control::Vector last_request_ = control::Vector::Zero(size_);
};

}  // namespace

Extraction play(const AdversaryRun& run) {
  using Exact = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
  Adversary adversary(run.seed, run.degrees_of_freedom);
  Extraction result;
  control::Vector position = control::Vector::Zero(run.degrees_of_freedom);
  for (int tick = 0; tick < run.ticks; ++tick) {
    const control::Matrix damping = run.dampings(tick);
    const control::Vector force = run.law(position, adversary.request(), damping);
    const control::Vector before = position;
    position += adversary.motion(force, damping, run.period_s);

    const Exact d = position.cast<long double>() - before.cast<long double>();
    const long double taken = d.dot(damping.cast<long double>() * d) / static_cast<long double>(run.period_s);
    const long double returned = force.cast<long double>().dot(d);
    result.balance_J += taken - returned;
    result.least_J = std::min(result.least_J, result.balance_J);
    result.turnover_J += std::abs(taken) + std::abs(returned);
  }
  return result;
}

}  // namespace forcebound::test
