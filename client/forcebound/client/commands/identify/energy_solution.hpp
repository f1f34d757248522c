#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "forcebound/client/commands/identify/slide_energy.hpp"

namespace forcebound::client::commands::identify {

/// Least squares with errors from the scatter of slides.
class EnergySolution {
 public:
  /// @param slides that the equations are of; each has its number among them
  EnergySolution(const std::vector<Equation>& equations, std::size_t slides);

  [[nodiscard]] double value(int unknown) const noexcept { return found_[unknown]; }
  [[nodiscard]] double error(int unknown) const noexcept { return std::sqrt(covariance_(unknown, unknown)); }
  [[nodiscard]] double energy_J(const Row& row) const noexcept { return row.dot(found_); }
  [[nodiscard]] double energy_error_J(const Row& row) const noexcept {
    return std::sqrt(std::max(row.dot(covariance_ * row), 0.0));
  }
  /// Change of what is found if all releases were later.
  [[nodiscard]] double per_latency(int unknown) const noexcept { return std::abs((inverse_ * later_)[unknown]); }
  /// Change of what is found if each energy is wrong by this share, all to the worse.
  [[nodiscard]] double per_share(int unknown) const noexcept { return per_share_[unknown]; }
  /// What the equations leave, in expected errors and as a share of the energies; root mean square.
  [[nodiscard]] double misfit() const noexcept { return misfit_; }
  [[nodiscard]] double residual_share() const noexcept { return residual_share_; }

 private:
  void scatter(const std::vector<Equation>& equations, std::size_t slides);

  Square matrix_ = Square::Zero();
  Row right_ = Row::Zero();
  Row later_ = Row::Zero();
  Square inverse_ = Square::Zero();
  Row found_ = Row::Zero();
  Row per_share_ = Row::Zero();
  Square covariance_ = Square::Zero();
  double misfit_ = 0;
  double residual_share_ = 0;
};

}  // namespace forcebound::client::commands::identify
