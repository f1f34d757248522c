#pragma once

#include <array>
#include <cstdint>

#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/netem/random.hpp"

namespace forcebound::netem {

/// The inverse of a distribution function at i/4096, in units of sigma/8192, as netem keeps it.
using DelayTable = std::array<std::int16_t, 4096>;
inline constexpr std::int32_t kDelayTableSigma = 8192;

/// The table of one shape, computed from its formula and clamped to 16 bits:
///
///     normal         inverse normal of u
///     pareto         4/3 ((1 - u)^(-1/3) - 1.5)
///     paretonormal   (normal + 3 pareto) / 4
///
/// @throws std::invalid_argument for the uniform shape, which needs none.
DelayTable make_delay_table(DelayShape shape);

/// Draws the delay of each packet. May be negative: the packet leaves at once.
///
/// Allocates nothing after construction.
class DelayDistribution {
 public:
  DelayDistribution(const Delay& delay, Random& random);

  Nanoseconds next(Random& random) noexcept;

 private:
  [[nodiscard]] std::int64_t uniform(std::uint32_t draw) const noexcept;
  [[nodiscard]] std::int64_t shaped(std::uint32_t draw) const noexcept;

  Delay delay_;
  CorrelatedDraw draw_;
  DelayTable table_{};
};

}  // namespace forcebound::netem
