#include "forcebound/client/commands/identify/energy_solution.hpp"

#include <Eigen/Cholesky>

namespace forcebound::client::commands::identify {

EnergySolution::EnergySolution(const std::vector<Equation>& equations, std::size_t slides) {
  for (const Equation& e : equations) {
    const double w = 1 / (e.error_J * e.error_J);
    matrix_ += w * e.row * e.row.transpose();
    right_ += w * e.row * e.energy_J;
    later_ += w * e.row * e.latency_J_per_s;
  }
  for (int i = 0; i < kCount; ++i) {
    if (!(matrix_(i, i) > 0)) matrix_(i, i) = 1;  // a place never seen
  }
  const Row scale = matrix_.diagonal().cwiseSqrt().cwiseInverse();
  const Square scaled = scale.asDiagonal() * matrix_ * scale.asDiagonal();
  inverse_ = scale.asDiagonal() * scaled.ldlt().solve(Square::Identity()) * scale.asDiagonal();
  found_ = inverse_ * right_;
  for (const Equation& e : equations) {
    per_share_ += (inverse_ * e.row * (e.energy_J / (e.error_J * e.error_J))).cwiseAbs();
  }
  scatter(equations, slides);
}

void EnergySolution::scatter(const std::vector<Equation>& equations, std::size_t slides) {
  std::vector<Row> scores(slides, Row::Zero());
  Square expected = Square::Zero();
  double shares = 0;
  double misfits = 0;
  for (const Equation& e : equations) {
    const double off = e.energy_J - e.row.dot(found_);
    const double w = 1 / (e.error_J * e.error_J);
    scores[e.slide] += w * off * e.row;
    expected += w * e.row * e.row.transpose();
    shares += off * off / (e.energy_J * e.energy_J);
    misfits += off * off * w;
  }
  Square seen = Square::Zero();
  for (const Row& score : scores) seen += score * score.transpose();
  const auto count = static_cast<double>(slides);
  const double few = count / std::max(1.0, count - kCount);
  // Where by chance the slides agree better than rounding lets them, rounding counts.
  const Square by_scatter = few * inverse_ * seen * inverse_;
  const Square by_rounding = inverse_ * expected * inverse_;
  covariance_ = by_scatter.cwiseMax(by_rounding);
  const auto count_of_equations = static_cast<double>(equations.size());
  residual_share_ = std::sqrt(shares / count_of_equations);
  misfit_ = std::sqrt(misfits / std::max(1.0, count_of_equations - kCount));
}

}  // namespace forcebound::client::commands::identify
