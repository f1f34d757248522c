#include "forcebound/client/rendering/foresight.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::client {
namespace {

// After a pause one answer does not decide alone.
constexpr double kCountsMost_s = 0.01;

}  // namespace

void Foresight::compare(Nanoseconds then, const Point& told_N) noexcept {
  const std::size_t later = ticks_.later_than(then);
  if (later == ticks_.size()) return;
  const Tick& tick = ticks_.at(later);
  if (!tick.modelled) return;
  const double modelled_N2 = (tick.modelled_N - told_N).squaredNorm();
  const double held_N2 = (tick.held_N - told_N).squaredNorm();
  if (!std::isfinite(modelled_N2) || !std::isfinite(held_N2)) return;
  const double elapsed_s = std::clamp(time::to_seconds(then - compared_), 0.0, kCountsMost_s);
  compared_ = std::max(compared_, then);
  const double kept = std::exp(-elapsed_s / kForget_s);
  modelled_N2_ = kept * modelled_N2_ + (1 - kept) * modelled_N2;
  held_N2_ = kept * held_N2_ + (1 - kept) * held_N2;
  const double worse = std::sqrt(modelled_N2_ / (held_N2_ + kAgrees_N * kAgrees_N));
  trust_ = std::clamp(2 * (1 - worse), 0.0, 1.0);
}

}  // namespace forcebound::client
