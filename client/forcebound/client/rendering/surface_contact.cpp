#include "forcebound/client/rendering/surface_contact.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace forcebound::client {

void SurfaceContact::update(const local_model::Surface& told, const DevicePoint& device, const ModelAge& age) noexcept {
  const bool same = there_ && told.id == reported_.id;
  reported_ = told;
  there_ = true;
  if (!same) {
    relaxed_N_ = told.relaxed_N;
    let_go();
  }
  // Another answer may have the surface elsewhere: that is no motion to relax from.
  depth_m_ = std::max(0.0, depth_m(device, age));
  // Within the friction of now at once, so that what changes is known to whoever fades it.
  if (same) drag(device, age, 0);
}

void SurfaceContact::advance(const DevicePoint& device, const ModelAge& age, double elapsed_s) noexcept {
  const double before_m = std::exchange(depth_m_, std::max(0.0, depth_m(device, age)));
  if (!(depth_m_ > 0) || !(reported_.relaxing_N_per_m > 0)) {
    relaxed_N_ = 0;
  } else {
    relaxed_N_ += reported_.relaxing_N_per_m * (depth_m_ - before_m);
    relaxed_N_ *= std::exp(-elapsed_s / reported_.relaxation_s);
  }
  drag(device, age, elapsed_s);
}

void SurfaceContact::drag(const DevicePoint& device, const ModelAge& age, double elapsed_s) noexcept {
  const double most_N = reported_.friction * pushed_N(device, age).dot(reported_.normal);
  const double stiffness_N_per_m = reported_.normal.dot(reported_.stiffness_N_per_m * reported_.normal);
  if (!(most_N > 0) || !(stiffness_N_per_m > 0)) {
    let_go();
    return;
  }
  // By velocities: another answer may have the surface's place elsewhere, which is no slip.
  slid_m_ += elapsed_s * (device.velocity_m_per_s - surface_m_per_s(age));
  friction_N_ = -bristle_.move({.stiffness_N_per_m = stiffness_N_per_m}, {.sticking_N = most_N, .slipping_N = most_N},
                               {.position_m = slid_m_, .normal = reported_.normal, .interval_s = elapsed_s});
}

void SurfaceContact::let_go() noexcept {
  bristle_ = {};
  slid_m_.setZero();
  friction_N_.setZero();
}

Point SurfaceContact::away_m(const DevicePoint& device, const ModelAge& age) const noexcept {
  const Point gone_m =
      age.s * (reported_.velocity_m_per_s + 0.5 * age.s * age.certainty() * reported_.acceleration_m_per_s2);
  return device.place_m - reported_.place_m - gone_m;
}

double SurfaceContact::depth_m(const DevicePoint& device, const ModelAge& age) const noexcept {
  return -reported_.normal.dot(away_m(device, age));
}

Point SurfaceContact::surface_m_per_s(const ModelAge& age) const noexcept {
  return reported_.velocity_m_per_s + age.s * age.certainty() * reported_.acceleration_m_per_s2;
}

Point SurfaceContact::force_N(const DevicePoint& device, const ModelAge& age) const noexcept {
  const Point pushed = pushed_N(device, age);
  return pushed.isZero(0) ? pushed : Point(pushed + friction_N_);
}

Point SurfaceContact::pushed_N(const DevicePoint& device, const ModelAge& age) const noexcept {
  const Point apart_m = away_m(device, age);
  if (!(reported_.normal.dot(apart_m) < 0)) return Point::Zero();
  const double nearing_m_per_s = -reported_.normal.dot(device.velocity_m_per_s - surface_m_per_s(age));
  const Point elastic_N = -(reported_.stiffness_N_per_m * apart_m);
  const Point pushed = elastic_N + (reported_.damping_N_s_per_m * nearing_m_per_s + relaxed_N_) * reported_.normal;
  return pushed.dot(reported_.normal) > 0 ? pushed : Point(Point::Zero());
}

double SurfaceContact::weight(const DevicePoint& device, const ModelAge& age) const noexcept {
  Point apart_m = away_m(device, age);
  const double height_m = reported_.normal.dot(apart_m);
  // Above the surface there is no force to be wrong about, however far.
  if (height_m > 0) apart_m -= height_m * reported_.normal;
  return local_model::weight_at(apart_m.norm(), reported_.radius_m);
}

}  // namespace forcebound::client
