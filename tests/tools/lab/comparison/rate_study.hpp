#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "tests/tools/lab/comparison/stable_stiffness.hpp"

/// The stiffest wall over the rate of the device's loop.
namespace forcebound::lab {

struct RateSettings {
  std::vector<std::string> devices;  ///< Cartesian, see `theory_limits`
  std::vector<std::string> laws;
  std::vector<double> rates_Hz;
};

/// What is displayed of walls under one law, of all that were tried the one displayed as the stiffest at rest.
struct ShownWall {
  double shown_N_per_m = 0;  ///< 0: none came to rest
  double asked_N_per_m = 0;
  double least_P_J = 0;  ///< over all walls tried
};

/// One law on one device at one rate.
struct AtRate {
  std::string device;
  std::string law;
  double rate_Hz = 0;
  double passive_N_per_m = 0;  ///< 2b/T: no hand makes a wall ring that no law bounds [Colgate 1994]
  double late_N_per_m = 0;     ///< b/(T/2 + latency): the same behind the latency of `own`
  StableStiffness stable{};    ///< asked, on an ideal device
  ShownWall ideal{};           ///< no encoder steps, punctual ticks, no latency
  ShownWall own{};             ///< its own encoder, 100 us of latency, punctual ticks
};

/// Presses walls from half of 2b/T to 16 times it, all without a network; each law on each device at each rate. The
/// hand is `press`, softer on a device with less force, which it would otherwise overpower.
/// @throws std::invalid_argument for a device that `theory_limits` refuses, or a rate outside of its bounds
[[nodiscard]] std::vector<AtRate> run_rate_study(const RateSettings& settings,
                                                 const std::function<void(std::size_t, std::size_t)>& progress);

/// A row for each, for the figure.
[[nodiscard]] std::string rate_csv(const std::vector<AtRate>& results);

}  // namespace forcebound::lab
