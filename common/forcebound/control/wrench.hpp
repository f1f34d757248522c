#pragma once

#include <algorithm>
#include <limits>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/vector.hpp"

namespace forcebound::control {

/// What a device may be asked for: a force [N], and where its tip turns a torque in the rows below [N m]. Each has a
/// limit of its own, as lengths of both together would add newtons to newton metres.
///
/// Real time: noexcept, no allocation.
class WrenchLimits {
 public:
  explicit WrenchLimits(const DeviceFacts& facts) noexcept
      : rotations_(facts.rotations), force_N_max_(facts.force_N_max), torque_N_m_max_(facts.torque_N_m_max) {}

  /// The largest s for which s `wrench` is within both; infinite: any is.
  [[nodiscard]] double longest_along(const Vector& wrench) const noexcept {
    if (rotations_ == 0) return share(wrench.stableNorm(), force_N_max_);
    return std::min(share(wrench.head(wrench.rows() - rotations_).stableNorm(), force_N_max_),
                    share(wrench.tail(rotations_).stableNorm(), torque_N_m_max_));
  }

 private:
  [[nodiscard]] static double share(double length, double most) noexcept {
    return length > 0 ? most / length : std::numeric_limits<double>::infinity();
  }

  Eigen::Index rotations_;
  double force_N_max_;
  double torque_N_m_max_;
};

/// A wrench of a force [N] and, where the device has rotations, a torque [N m], of which absent rows are zero. Real
/// time.
[[nodiscard]] inline Vector wrench_of(const Vector& force_N, const Eigen::Vector3d& torque_N_m,
                                      int rotations) noexcept {
  Vector wrench(force_N.rows() + rotations);
  wrench.head(force_N.rows()) = force_N;
  wrench.tail(rotations) = torque_N_m.head(rotations);
  return wrench;
}

}  // namespace forcebound::control
