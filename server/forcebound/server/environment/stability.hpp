#pragma once

#include <string>

#include "forcebound/scene/scene.hpp"

namespace forcebound::server {

/// Quantities of a part of a scene that decide whether a device oscillates on it.
struct Ringing {
  double stiffness_N_per_m = 0;    ///< K, at the surface
  double stiffening_N_per_m2 = 0;  ///< increase of K per metre of depth
  double damping_N_s_per_m = 0;    ///< B
  double age_s = 0;                ///< largest age of the newest force without a network
  bool drives = false;             ///< an energy source

  /// The damping b [N s/m] that a device of period T needs to be passive without a law, when a motion's force is at
  /// the device a delay later:
  ///
  ///     b = K (T/2 + age + delay) + B    [Colgate and Schenkel 1997; the delay after Kim, Baek, Ryu 2015]
  ///
  /// @param depth_m at which K is taken
  [[nodiscard]] double damping_needed_N_s_per_m(double delay_s, double depth_m = 0) const noexcept;

  /// Both at one place: stiffnesses and dampings add up, and the larger age applies.
  [[nodiscard]] Ringing with(const Ringing& other) const noexcept;
};

/// Of one part: the sum over its effects.
[[nodiscard]] Ringing ringing_of(const scene::SceneObject& part);
[[nodiscard]] Ringing ringing_of(const scene::DynamicModelFacts& facts);

/// Of all parts of a scene, as if they were at one place.
[[nodiscard]] Ringing ringing_of(const scene::Scene& scene);

/// The device for which margins are given.
struct RingingDevice {
  double damping_N_s_per_m = 1;  ///< its own, > 0
  double round_trip_s = 0;       ///< between it and the server
};

/// The damping needed and the device's margin, in lines without a final newline; all but the first begin with
/// `indent`.
std::string stability_text(const Ringing& part, const RingingDevice& device, const std::string& indent);

}  // namespace forcebound::server
