#pragma once

#include "forcebound/control/vector.hpp"

namespace forcebound::control {

/// A diagonal b that is not above the damping D and as large as one can be: of all with D - diag(b) positive
/// semidefinite, the one with the largest product of its entries. Where D is diagonal, D itself.
///
/// The product makes the choice independent of the joints' units. Never less than `diagonal_below` in it, and more
/// where some joints are coupled and others are not. By Newton's method on
///
///     maximise  sum_i log b_i + mu log det(D - diag(b)),   mu falling to zero          (concave)
///
/// For the start: O(dof^3) for each of some hundred steps. Within 1e-9 of the largest; always above zero.
[[nodiscard]] Vector largest_diagonal_below(const Matrix& damping) noexcept;

}  // namespace forcebound::control
