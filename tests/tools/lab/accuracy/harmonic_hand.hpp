#pragma once

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

/// Stiff enough to follow the motion against soft objects: 0.1 kg, 1000 N/m, 5 N s/m.
std::unique_ptr<const device::Operator> make_harmonic_hand(const HarmonicMotion& motion, int degrees_of_freedom);

}  // namespace forcebound::lab
