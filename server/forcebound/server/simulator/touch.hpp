#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "forcebound/local_model/local_model.hpp"

namespace forcebound::server {

using local_model::Point;

/// The ball with which each device touches what a simulator steps: a mass on a virtual coupling K, B to the device.
struct ProbeFacts {
  double radius_m = 0;
  double mass_kg = 0.03;
  double stiffness_N_per_m = 2000;
  double damping_N_s_per_m = 8;
};

/// What a simulator knows of a place that a probe touches or may soon meet, in the scene's frame. Between two steps of
/// the simulator the place goes on by
///
///     z'' = W (f + f_o - k z - c z' + d),    |d| <= F, against z'
///
/// from where it was at the step's end, f being the probe's force on it.
struct Touch {
  std::uint32_t body = 0;                                     ///< as the simulator calls it
  Point place_m = Point::Zero();                              ///< of the surface, nearest to the probe's centre
  Point normal = Point::UnitX();                              ///< unit, out of the surface
  Point velocity_m_per_s = Point::Zero();                     ///< of the surface there
  Eigen::Matrix3d mobility_per_kg = Eigen::Matrix3d::Zero();  ///< W; zero: it stands
  Point others_N = Point::Zero();                             ///< f_o: of all but the probe and c, at that place
  double spring_N_per_m = 0;                                  ///< k
  double damper_N_s_per_m = 0;                                ///< c
  double dry_friction_N = 0;                                  ///< F
  double friction = 0;                                        ///< of the probe along the surface
  double radius_m = std::numeric_limits<double>::infinity();  ///< the surface goes on so far
};

inline constexpr double kDeepest_m = 0.001;
inline constexpr std::size_t kTouchesMost = local_model::Mass::kContactsMax;
using Touches = std::array<Touch, kTouchesMost>;

/// The acceleration by what else acts on a place, bounded. Real time.
[[nodiscard]] Point bias_m_per_s2(const Eigen::Matrix3d& mobility_per_kg, const Point& others_N) noexcept;

/// A probe where a report is for: what is met, as a model to go on with. A place deeper in the probe than kDeepest_m is
/// taken for as deep, so that what jumps pushes the probe out at 0.13 m/s at most.
///
/// @param place_m, velocity_m_per_s of the probe then
/// Real time: noexcept, no allocation.
[[nodiscard]] local_model::Mass mass_of(const ProbeFacts& probe, const Point& place_m, const Point& velocity_m_per_s,
                                        std::span<const Touch> touches) noexcept;

/// @throws std::invalid_argument naming the field and what would be accepted, if a touch is not what it has to be
void expect_sound(std::span<const Touch> touches);

/// Likewise.
void expect_sound(const ProbeFacts& probe);

}  // namespace forcebound::server
