#pragma once

#include <Eigen/Core>

namespace forcebound::tissue {

/// Most contacts of a probe with one tissue at once.
inline constexpr int kContactsMax = 16;

using ContactVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kContactsMax, 1>;
using ContactMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kContactsMax, kContactsMax>;

struct Complementarity {
  ContactVector force_N;
  double residual_m = 0;  ///< the largest |min(force_N_k, gap_k)|, a force being measured by the gap that it opens at k
  int iterations = 0;     ///< small systems solved
};

/// Frictionless contact forces that push and never pull (Signorini):
///
///     f >= 0,   gap = A f + b >= 0,   f . gap = 0
///
/// by the active set of Lawson & Hanson: contacts enter by their depth and leave when they would pull, each set solved
/// directly by Cholesky. Exact after a few sets for A symmetric and positive definite; if the iterations run out
/// before, the last forces, all >= 0, and their residual are given.
///
/// @param compliance_m_per_N A
/// @param gap_m b, where no force acts
///
/// Real time: noexcept, no allocation, at most `iterations_max` systems of at most kContactsMax rows.
[[nodiscard]] Complementarity solve_contacts(const ContactMatrix& compliance_m_per_N, const ContactVector& gap_m,
                                             int iterations_max) noexcept;

}  // namespace forcebound::tissue
