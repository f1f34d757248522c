#pragma once

#include <string>

namespace forcebound::server {

/// How a part of a scene could make a device ring.
struct Ringing {
  double stiffness_N_per_m = 0;    ///< K, at the surface
  double stiffening_N_per_m2 = 0;  ///< how much more for each metre of depth
  double damping_N_s_per_m = 0;    ///< B
  double age_s = 0;                ///< of the newest force, at most, without a network
  bool drives = false;             ///< puts in energy of its own

  /// The damping b [N s/m] that a device of period T needs to be passive without a law, when a motion's force is at
  /// the device a delay later:
  ///
  ///     b = K (T/2 + age + delay) + B    [Colgate and Schenkel 1997; the delay after Kim, Baek, Ryu 2015]
  ///
  /// @param depth_m adds what the spring has stiffened by there
  [[nodiscard]] double damping_needed_N_s_per_m(double delay_s, double depth_m = 0) const noexcept;

  /// Both at one place: what is stiff adds up, and the older force counts.
  [[nodiscard]] Ringing with(const Ringing& other) const noexcept;
};

/// A device for which margins are said.
struct RingingDevice {
  double damping_N_s_per_m = 1;  ///< its own, > 0
  double round_trip_s = 0;       ///< between it and the server
};

/// What the device needs, and how far that device is from it, in lines without a last end of line; those after the
/// first begin with `indent`.
std::string stability_text(const Ringing& part, const RingingDevice& device, const std::string& indent);

}  // namespace forcebound::server
