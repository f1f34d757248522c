#include "forcebound/scene/tool/nearest_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace forcebound::scene {
namespace {

constexpr double kConverged_m = 1e-11;
// Of what a row says that others do not say, as a share of its square.
constexpr double kNew = 1e-10;

}  // namespace

NearestStep::Twist NearestStep::solve(const Twist& wanted, std::vector<Row>& rows) noexcept {
  begin(wanted, rows);
  Twist step = step_on(wanted);
  for (int i = 0; i < kStepsMost; ++i) {
    Row* worst = nullptr;
    double least_m = -kConverged_m;
    for (Row& row : rows) {
      const double left_m = row.direction.dot(step) + row.gap_m;
      if (left_m < least_m && !row.left_out) {
        least_m = left_m;
        worst = &row;
      }
    }
    if (worst == nullptr) break;
    worst->left_out = !take_in(*worst, step);
  }
  // Without what rounding has added up.
  return step_on(wanted);
}

void NearestStep::begin(const Twist& wanted, std::vector<Row>& rows) noexcept {
  count_ = 0;
  for (Row& row : rows) {
    const bool held = std::exchange(row.share_m, 0) > 0;
    if (held && count_ < kMost) (void)append(row);
  }
  while (count_ > 0) {
    (void)step_on(wanted);
    std::size_t least = 0;
    for (std::size_t i = 1; i < count_; ++i) {
      if (holding_.at(i)->share_m < holding_.at(least)->share_m) least = i;
    }
    if (holding_.at(least)->share_m >= 0) break;
    leave(least);
  }
}

bool NearestStep::take_in(Row& row, Twist& step) noexcept {
  for (std::size_t i = 0; i <= kMost; ++i) {
    const std::array<double, kMost> others = in_terms_of(row.direction);
    Twist alone = row.direction;
    for (std::size_t j = 0; j < count_; ++j) alone -= q_.at(j).dot(row.direction) * q_.at(j);
    double to_leave = std::numeric_limits<double>::infinity();
    std::size_t leaves = 0;
    for (std::size_t j = 0; j < count_; ++j) {
      const double until = holding_.at(j)->share_m / others.at(j);
      if (!(others.at(j) > 0) || !(until < to_leave)) continue;
      to_leave = until;
      leaves = j;
    }
    const double squared = alone.squaredNorm();
    const bool is_new = squared > kNew * row.direction.squaredNorm();
    const double missing_m = -(row.direction.dot(step) + row.gap_m);
    const double to_hold = is_new ? missing_m / squared : std::numeric_limits<double>::infinity();
    const double length = std::min(to_leave, to_hold);
    if (!std::isfinite(length)) {
      row.share_m = 0;
      return false;
    }
    if (is_new) step += length * alone;
    for (std::size_t j = 0; j < count_; ++j)
      holding_.at(j)->share_m = std::max(0.0, holding_.at(j)->share_m - length * others.at(j));
    row.share_m += length;
    if (length == to_hold) return append(row);
    leave(leaves);
  }
  return false;
}

bool NearestStep::append(Row& row) noexcept {
  Twist alone = row.direction;
  std::array<double, kMost> column{};
  // Twice, so that it is square to the others to the last digit.
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t j = 0; j < count_; ++j) {
      const double along = q_.at(j).dot(alone);
      column.at(j) += along;
      alone -= along * q_.at(j);
    }
  }
  const double squared = alone.squaredNorm();
  if (count_ == kMost || !(squared > kNew * row.direction.squaredNorm())) return false;
  const double length = std::sqrt(squared);
  column.at(count_) = length;
  for (std::size_t j = 0; j <= count_; ++j) r_.at(j).at(count_) = column.at(j);
  q_.at(count_) = alone / length;
  holding_.at(count_++) = &row;
  return true;
}

void NearestStep::leave(std::size_t which) noexcept {
  holding_.at(which)->share_m = 0;
  const std::size_t before = std::exchange(count_, which);
  for (std::size_t j = which + 1; j < before; ++j) {
    Row& row = *holding_.at(j);
    if (!append(row)) row.share_m = 0;
  }
}

/// Where the rows that hold have no gap, and their shares.
NearestStep::Twist NearestStep::step_on(const Twist& wanted) noexcept {
  // x = wanted + A u with A' x = -g, A = Q R: R' R u = -g - A' wanted
  std::array<double, kMost> u{};
  for (std::size_t i = 0; i < count_; ++i) {
    double left = -holding_.at(i)->gap_m - holding_.at(i)->direction.dot(wanted);
    for (std::size_t j = 0; j < i; ++j) left -= r_.at(j).at(i) * u.at(j);
    u.at(i) = left / r_.at(i).at(i);
  }
  Twist step = wanted;
  for (std::size_t i = 0; i < count_; ++i) step += u.at(i) * q_.at(i);
  for (std::size_t i = count_; i-- > 0;) {
    for (std::size_t j = i + 1; j < count_; ++j) u.at(i) -= r_.at(i).at(j) * u.at(j);
    u.at(i) /= r_.at(i).at(i);
    holding_.at(i)->share_m = u.at(i);
  }
  return step;
}

/// R^-1 Q' along
std::array<double, NearestStep::kMost> NearestStep::in_terms_of(const Twist& along) const noexcept {
  std::array<double, kMost> terms{};
  for (std::size_t i = count_; i-- > 0;) {
    terms.at(i) = q_.at(i).dot(along);
    for (std::size_t j = i + 1; j < count_; ++j) terms.at(i) -= r_.at(i).at(j) * terms.at(j);
    terms.at(i) /= r_.at(i).at(i);
  }
  return terms;
}

}  // namespace forcebound::scene
