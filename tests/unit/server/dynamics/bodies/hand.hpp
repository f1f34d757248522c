#pragma once

#include <cmath>

#include "forcebound/scene/dynamic_model.hpp"
#include "forcebound/server/dynamics/bodies/description.hpp"

namespace forcebound::server {

inline BodyDescription floor_plate() {
  return {.name = "floor", .size_m = {1, 1, 0.1}, .mass_kg = 0, .position_m = {0, 0, -0.05}};
}

inline BodyDescription cube(double mass_kg, const scene::Point& position_m) {
  return {.name = "cube", .size_m = {0.04, 0.04, 0.04}, .mass_kg = mass_kg, .position_m = position_m};
}

/// A device that goes where the test says, a motion every millisecond.
class Hand {
 public:
  explicit Hand(scene::DynamicModelState& state) : state_(state), seat_(state.join()) {}

  scene::ModelTouch to(const scene::Point& position_m) {
    const scene::Point velocity_m_per_s =
        moved_ ? scene::Point((position_m - last_m_) / 1e-3) : scene::Point(scene::Point::Zero());
    moved_ = true;
    last_m_ = position_m;
    state_.move(seat_, position_m, velocity_m_per_s);
    state_.advance(1e-3);
    return state_.touch(seat_);
  }

  /// In steps of at most 0.1 mm.
  scene::ModelTouch along(const scene::Point& from_m, const scene::Point& to_m) {
    const int steps = static_cast<int>(std::ceil((to_m - from_m).norm() / 1e-4));
    scene::ModelTouch touch;
    for (int i = 1; i <= steps; ++i) touch = to(from_m + (to_m - from_m) * (static_cast<double>(i) / steps));
    return touch;
  }

  scene::ModelTouch rest_at(const scene::Point& position_m, int milliseconds) {
    scene::ModelTouch touch;
    for (int i = 0; i < milliseconds; ++i) touch = to(position_m);
    return touch;
  }

 private:
  scene::DynamicModelState& state_;
  int seat_;
  bool moved_ = false;
  scene::Point last_m_ = scene::Point::Zero();
};

}  // namespace forcebound::server
