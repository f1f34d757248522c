#pragma once

#include "forcebound/local_model/device_point.hpp"

namespace forcebound::client {

using local_model::DevicePoint;
using local_model::Point;

/// A local_model::Field at the device's place: f_0 + J (x - x_0). Real time.
[[nodiscard]] inline Point force_N(const local_model::Field& field, const DevicePoint& device) noexcept {
  return field.force_N + field.jacobian_N_per_m * (device.place_m - field.place_m);
}

[[nodiscard]] inline double weight(const local_model::Field& field, const DevicePoint& device) noexcept {
  return local_model::weight_at((device.place_m - field.place_m).norm(), field.radius_m);
}

}  // namespace forcebound::client
