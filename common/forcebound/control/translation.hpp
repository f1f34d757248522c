#pragma once

#include <algorithm>

#include "forcebound/control/vector.hpp"

namespace forcebound::control {

/// Of a position or force with the rows of a device; zero on axes that it lacks. Real time.
[[nodiscard]] inline Eigen::Vector3d translation_of(const Vector& vector) noexcept {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  const Eigen::Index rows = std::min<Eigen::Index>(vector.rows(), 3);
  translation.head(rows) = vector.head(rows);
  return translation;
}

}  // namespace forcebound::control
