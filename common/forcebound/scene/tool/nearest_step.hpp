#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace forcebound::scene {

/// The step nearest to the one wanted that breaks no constraint:
///
///     minimise |x - wanted|^2    so that    a_i . x + g_i >= 0
///
/// by the dual active set method [Goldfarb, Idnani, "A numerically stable dual method for solving strictly convex
/// quadratic programs", Mathematical Programming 27, 1983], which is exact and ends after a few rows have been taken in
/// or left, of however many. It begins with those that had a multiplier, so that among rows that say the same those
/// stay that were. A row that contradicts the others is left out.
///
/// Real time: noexcept, no allocation; at most kStepsMost times O(rows).
class NearestStep {
 public:
  using Twist = Eigen::Matrix<double, 6, 1>;

  struct Row {
    Twist direction = Twist::Zero();  ///< a
    double gap_m = 0;                 ///< g
    double share_m = 0;               ///< the multiplier, >= 0: x - wanted = sum of share_i a_i
    bool left_out = false;
  };

  /// @param rows their shares are where it begins and, afterwards, the multipliers
  [[nodiscard]] Twist solve(const Twist& wanted, std::vector<Row>& rows) noexcept;

 private:
  static constexpr int kStepsMost = 200;
  static constexpr std::size_t kMost = 6;

  void begin(const Twist& wanted, std::vector<Row>& rows) noexcept;
  /// False: the row contradicts those that hold.
  [[nodiscard]] bool take_in(Row& row, Twist& step) noexcept;
  /// False: it says what others say.
  bool append(Row& row) noexcept;
  void leave(std::size_t which) noexcept;
  [[nodiscard]] Twist step_on(const Twist& wanted) noexcept;
  [[nodiscard]] std::array<double, kMost> in_terms_of(const Twist& along) const noexcept;

  // Of the rows that hold: a_i = sum over j <= i of q_j r_ji.
  std::array<Row*, kMost> holding_{};
  std::array<Twist, kMost> q_{};
  std::array<std::array<double, kMost>, kMost> r_{};
  std::size_t count_ = 0;
};

}  // namespace forcebound::scene
