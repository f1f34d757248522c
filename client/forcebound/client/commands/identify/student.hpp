#pragma once

namespace forcebound::client::commands::identify {

/// The number that a Student-t variable with `degrees_of_freedom` exceeds with probability `1 - confidence`
/// [Abramowitz, Stegun, Handbook of Mathematical Functions, 26.7.5, four terms]: within 1 % for 5 degrees and more.
/// @param confidence above 0.5 and below 1
[[nodiscard]] double student_quantile(double confidence, double degrees_of_freedom) noexcept;

}  // namespace forcebound::client::commands::identify
