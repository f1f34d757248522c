#pragma once

#include <optional>
#include <span>

/// Polynomials c[0] + c[1] s + c[2] s^2 + ... on 0 <= s <= 1, the form in which a simulated device holds its motion
/// between two events.
///
/// Both searches are exhaustive: an interval is left out only where a bound of the curvature proves that it
/// contains no root or minimum. Real time: noexcept, no allocation, bounded work.
namespace forcebound::device::polynomial {

[[nodiscard]] double value(std::span<const double> c, double s) noexcept;

/// The first s in [0, 1] at which the polynomial is negative, to 2^-50; a dip that ends within 2^-50 may be missed.
[[nodiscard]] std::optional<double> first_negative(std::span<const double> c) noexcept;

/// The lesser of `floor` and the polynomial's minimum on [0, end], to 1e-16 of its largest curvature.
[[nodiscard]] double least(std::span<const double> c, double end, double floor) noexcept;

}  // namespace forcebound::device::polynomial
