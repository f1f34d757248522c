#include "tests/tools/lab/trials/measures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "forcebound/control/rotation.hpp"
#include "forcebound/control/translation.hpp"

namespace forcebound::lab {
namespace {

constexpr double kWindow_s = 20e-3;
constexpr double kShare = 0.2;

}  // namespace

void RingingMeter::on_tick(const record::TickRecord& tick) noexcept {
  if (force_N_.empty() && !tick.contact) return;
  force_N_.push_back(tick.applied.norm());
  time_s_.push_back(time::to_seconds(tick.time));
}

std::optional<double> RingingMeter::ringing_s() const {
  if (force_N_.empty()) return std::nullopt;
  const auto steady_begin = force_N_.end() - static_cast<std::ptrdiff_t>((force_N_.size() + 3) / 4);
  const double steady_N =
      std::accumulate(steady_begin, force_N_.end(), 0.0) / static_cast<double>(force_N_.end() - steady_begin);
  // Backwards: the last window that is not calm ends the ringing.
  std::size_t end = force_N_.size();
  for (std::size_t begin = force_N_.size(); begin-- > 0;) {
    while (time_s_[end - 1] - time_s_[begin] > kWindow_s) --end;
    const auto [low, high] = std::minmax_element(force_N_.begin() + static_cast<std::ptrdiff_t>(begin),
                                                 force_N_.begin() + static_cast<std::ptrdiff_t>(end));
    if (*high - *low >= std::max(kShare * steady_N, unfelt_N_) && *high > *low)
      return time_s_[end - 1] - time_s_.front();
  }
  return 0.0;
}

void DirectionMeter::on_tick(const record::TickRecord& tick) noexcept {
  const double requested = tick.request.stableNorm();
  const double applied = tick.applied.stableNorm();
  if (!(requested > 0) || !(applied > 0)) return;
  ++samples_;
  // Through the chord: exact for small angles, where the cosine is blind.
  const double chord = (tick.request / requested - tick.applied / applied).norm();
  error_rad_max_ = std::max(error_rad_max_, 2 * std::asin(std::min(1.0, chord / 2)));
}

void RotationalStiffness::on_tick(const record::TickRecord& tick) noexcept {
  if (!tick.contact || tick.applied_torque_N_m.rows() == 0 || !tick.handle.orientation) return;
  const Eigen::Vector3d torque_N_m = control::translation_of(tick.applied_torque_N_m);
  const Eigen::Vector3d turned_rad =
      control::rotation_vector(Eigen::Quaterniond::Identity(), control::quaternion_of(*tick.handle.orientation));
  ++ticks_;
  torque_ += torque_N_m;
  turned_ += turned_rad;
  torque_turned_ += torque_N_m.dot(turned_rad);
  turned_squared_ += turned_rad.squaredNorm();
}

std::optional<double> RotationalStiffness::stiffness_N_m_per_rad() const {
  constexpr double kLeast_rad = 1e-3;
  if (ticks_ == 0) return std::nullopt;
  const double spread_rad2 = turned_squared_ - turned_.squaredNorm() / ticks_;
  if (spread_rad2 < kLeast_rad * kLeast_rad * ticks_) return std::nullopt;
  return -(torque_turned_ - torque_.dot(turned_) / ticks_) / spread_rad2;
}

}  // namespace forcebound::lab
