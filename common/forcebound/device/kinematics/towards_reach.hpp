#pragma once

#include "forcebound/control/vector.hpp"

namespace forcebound::device {

/// The place nearest to `wanted` on the line to it from the scene's origin that `reaches(place)`: `wanted` itself, if
/// that does. For mechanisms whose workspace has no closed form. @param reaches true for the origin
template <class Reaches>
control::Vector towards_reach(const control::Vector& wanted, const Reaches& reaches) noexcept {
  if (reaches(wanted)) return wanted;
  constexpr int kHalvings = 52;  // of a share, to a double's last digit
  double inside = 0;
  double outside = 1;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    (reaches(control::Vector(middle * wanted)) ? inside : outside) = middle;
  }
  return inside * wanted;
}

}  // namespace forcebound::device
