#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "forcebound/device/simulated/operator.hpp"

namespace forcebound::lab {

/// A hand that moves as a sine, on a surface across one of the axes.
struct HarmonicMotion {
  enum class Kind : std::uint8_t {
    press,  ///< up and down between clearance above the surface and depth below it
    slide,  ///< back and forth by `length` along the surface, at `depth` below it
  };
  Kind kind = Kind::press;
  double frequency_Hz = 3;
  double depth_m = 0.006;
  double clearance_m = 0.002;
  double length_m = 0.03;
  Eigen::Vector3d on_surface_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d out = Eigen::Vector3d::UnitZ();  ///< unit, along an axis: out of the surface
};

/// Stiff enough to follow a motion against soft objects; it turns a tip as a relaxed wrist does.
inline constexpr device::Hand kFollowingHand = [] {
  device::Hand hand = device::kRelaxedWrist;
  hand.mass_kg = 0.1;
  hand.stiffness_N_per_m = 1000;
  hand.damping_N_s_per_m = 5;
  return hand;
}();

/// By `kFollowingHand`.
std::unique_ptr<const device::Operator> make_harmonic_hand(const HarmonicMotion& motion, int degrees_of_freedom);

}  // namespace forcebound::lab
