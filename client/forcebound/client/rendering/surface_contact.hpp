#pragma once

#include "forcebound/local_model/device_point.hpp"
#include "forcebound/scene/effects/bristle.hpp"

namespace forcebound::client {

using local_model::DevicePoint;
using local_model::ModelAge;
using local_model::Point;

/// Renders a local_model::Surface at the device's own place and rate.
///
/// The surface goes on by the velocity and acceleration told, the acceleration by the share of the age that is certain:
/// where the age is a guess, its square is twice as wrong. What relaxes and where it sticks belong to the client, and
/// go on when another answer tells of the same surface.
///
/// Real time: noexcept, no allocation.
class SurfaceContact {
 public:
  /// Another answer tells of a surface, of the same one if it has the same id.
  void update(const local_model::Surface& told, const DevicePoint& device, const ModelAge& age) noexcept;

  [[nodiscard]] bool is(std::uint32_t id) const noexcept { return there_ && reported_.id == id; }

  /// There is none in the newest answer.
  void forget() noexcept { *this = {}; }

  /// Relaxation and friction go on for the time since the last tick.
  void advance(const DevicePoint& device, const ModelAge& age, double elapsed_s) noexcept;

  /// Force on the device, without regard to the radius.
  [[nodiscard]] Point force_N(const DevicePoint& device, const ModelAge& age) const noexcept;

  /// How much it counts: by the distance across the normal, and by the depth.
  [[nodiscard]] double weight(const DevicePoint& device, const ModelAge& age) const noexcept;

  /// It does not move by itself, and nobody else moves it.
  [[nodiscard]] bool stands() const noexcept {
    return !reported_.others_move_it && reported_.velocity_m_per_s.isZero(0) &&
           reported_.acceleration_m_per_s2.isZero(0);
  }

  /// What the held force has in its place.
  [[nodiscard]] const Point& held_N() const noexcept { return reported_.force_N; }

 private:
  void let_go() noexcept;
  void drag(const DevicePoint& device, const ModelAge& age, double elapsed_s) noexcept;
  [[nodiscard]] Point surface_m_per_s(const ModelAge& age) const noexcept;
  /// Without friction; zero, or it pushes out of the surface.
  [[nodiscard]] Point pushed_N(const DevicePoint& device, const ModelAge& age) const noexcept;
  [[nodiscard]] Point away_m(const DevicePoint& device, const ModelAge& age) const noexcept;
  [[nodiscard]] double depth_m(const DevicePoint& device, const ModelAge& age) const noexcept;

  local_model::Surface reported_{};
  bool there_ = false;
  double relaxed_N_ = 0;  // g
  double depth_m_ = 0;    // on the last tick, >= 0
  scene::Bristle bristle_{};
  Point slid_m_ = Point::Zero();      // of the device along the surface, since it touched
  Point friction_N_ = Point::Zero();  // as of the last tick
};

}  // namespace forcebound::client
