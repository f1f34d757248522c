#pragma once

#include "forcebound/local_model/local_model.hpp"

namespace forcebound::local_model {

/// The device's point on a tick.
struct DevicePoint {
  Point place_m = Point::Zero();
  Point velocity_m_per_s = Point::Zero();  ///< mean since the tick before
};

/// How long ago the state was that an answer tells of.
struct ModelAge {
  double s = 0;            ///< most likely
  double uncertain_s = 0;  ///< it may be that much more or less

  /// The share of the age that is certain.
  [[nodiscard]] double certainty() const noexcept { return s > uncertain_s ? 1 - uncertain_s / s : 0; }
};

/// How much a local model counts at a distance from its place: all of it within half of its radius, then less and less,
/// and nothing beyond the radius. Continuous, so that a device that leaves feels no step.
[[nodiscard]] inline double weight_at(double away_m, double radius_m) noexcept {
  const double left = 2 * (1 - away_m / radius_m);
  return left >= 1 ? 1 : left > 0 ? left : 0;
}

}  // namespace forcebound::local_model
