#include "tests/tools/netem/delay_distribution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace forcebound::netem {
namespace {

constexpr double kTableLimit_sigma = 4;  // range of 16 bits

/// Inverse of the normal distribution function by Newton's method. From 0 it runs monotonically down to a root left of
/// it, because the function is convex there.
double inverse_normal(double u) {
  if (u > 0.5) return -inverse_normal(1 - u);
  if (u <= 0) return -kTableLimit_sigma;
  double x = 0;
  for (int i = 0; i < 60; ++i) {
    const double excess = 0.5 * std::erfc(-x / std::numbers::sqrt2) - u;
    const double density = std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi);
    const double step = excess / density;
    x -= step;
    if (std::abs(step) < 1e-14) break;
  }
  return x;
}

double pareto(double u) { return 4.0 / 3.0 * (1 / std::cbrt(1 - u) - 1.5); }

double inverse(DelayShape shape, double u) {
  switch (shape) {
    case DelayShape::normal:
      return inverse_normal(u);
    case DelayShape::pareto:
      return pareto(u);
    case DelayShape::paretonormal:
      return (inverse_normal(u) + 3 * pareto(u)) / 4;
    case DelayShape::uniform:
      break;
  }
  throw std::invalid_argument("a uniform delay has no table: expected normal, pareto or paretonormal");
}

}  // namespace

DelayTable make_delay_table(DelayShape shape) {
  DelayTable table;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double u = static_cast<double>(i) / static_cast<double>(table.size());
    const double value = std::round(inverse(shape, u) * kDelayTableSigma);
    table[i] = static_cast<std::int16_t>(std::clamp(value, -32768.0, 32767.0));
  }
  return table;
}

DelayDistribution::DelayDistribution(const Delay& delay, Random& random)
    : delay_(delay), draw_(delay.correlation, random) {
  if (delay.shape != DelayShape::uniform) table_ = make_delay_table(delay.shape);
}

Nanoseconds DelayDistribution::next(Random& random) noexcept {
  if (delay_.jitter.count() == 0) return delay_.mean;
  const std::uint32_t draw = draw_.next(random);
  const std::int64_t deviation = delay_.shape == DelayShape::uniform ? uniform(draw) : shaped(draw);
  return delay_.mean + Nanoseconds{deviation};
}

std::int64_t DelayDistribution::uniform(std::uint32_t draw) const noexcept {
  const auto jitter = static_cast<std::uint64_t>(delay_.jitter.count());
  const std::uint64_t width = 2 * jitter;
  // The remainder, as in netem; therefore correlation has hardly any effect on jitter, there as here. A width beyond
  // one draw (4.3 s) is cut by netem and scaled here.
  constexpr std::uint64_t kDraws = std::uint64_t{1} << 32U;
  const std::uint64_t offset = width <= kDraws ? draw % width : (draw * (width >> 16U)) >> 16U;
  return static_cast<std::int64_t>(offset) - static_cast<std::int64_t>(jitter);
}

std::int64_t DelayDistribution::shaped(std::uint32_t draw) const noexcept {
  const std::int64_t scaled = delay_.jitter.count() * table_[draw % table_.size()];
  const std::int64_t half = kDelayTableSigma / 2;
  return (scaled + (scaled >= 0 ? half : -half)) / kDelayTableSigma;
}

}  // namespace forcebound::netem
