#include "tests/tools/lab/rendering/true_force_meter.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::lab {
namespace {

constexpr double kFelt_N = 0.01;

}  // namespace

double displayed_over(const RenderingFigures& run, const RenderingFigures& without_network) {
  return std::isfinite(without_network.stiffness_N_per_m) ? run.stiffness_N_per_m / without_network.stiffness_N_per_m
                                                          : run.true_share / without_network.true_share;
}

void TrueForceMeter::on_tick(const record::TickRecord& tick) noexcept {
  const bool here = tick.rendering != record::ForceOrigin::held;
  if (!first_) first_ = tick.time;
  if (here) ready_s_ = std::min(ready_s_, time::to_seconds(tick.time - *first_));
  const bool counts = time::to_seconds(tick.time - *first_) >= from_s_;
  if (counts && tick.applied.norm() > kFelt_N) felt_tick_ = std::min(felt_tick_, static_cast<double>(tick.tick));
  const scene::Answer truth = truth_.answer(place_of(), tick.time, {}, false, tick.handle);
  touched_ = touched_ || truth.penetration_m > 0 || truth.force.norm() > kFelt_N;
  if (!touched_ || !counts) return;
  ++ticks_;
  if (const double passed_ms = 1e3 * time::to_seconds(tick.interval); last_applied_.rows() > 0 && passed_ms > 0)
    change_N_per_ms_ = std::max(change_N_per_ms_, (tick.applied - last_applied_).norm() / passed_ms);
  last_applied_ = tick.applied;
  at_client_ += here ? 1 : 0;
  error_ += (tick.applied - truth.force).squaredNorm();
  along_ += tick.applied.dot(truth.force);
  reference_ += truth.force.squaredNorm();
  if (!(truth.penetration_m > 0)) return;
  force_by_depth_ += tick.applied.dot(truth.contact_normal) * truth.penetration_m;
  depth_squared_ += truth.penetration_m * truth.penetration_m;
}

RenderingFigures TrueForceMeter::figures() const {
  return {.error = std::sqrt(error_ / reference_),
          .stiffness_N_per_m = force_by_depth_ / depth_squared_,
          .true_share = along_ / reference_,
          .change_N_per_ms = change_N_per_ms_,
          .felt_tick = felt_tick_,
          .at_client = static_cast<double>(at_client_) / static_cast<double>(ticks_),
          .ready_s = ready_s_};
}

}  // namespace forcebound::lab
