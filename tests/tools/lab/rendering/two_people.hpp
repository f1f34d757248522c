#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/device/simulated/operator.hpp"
#include "forcebound/scene/scene.hpp"

namespace forcebound::lab {

/// A weightless block of 0.22 kg with a handle at each end, at x = -20 and 20 mm, for one person each. Nothing else
/// touches it. @throws std::runtime_error if built without MuJoCo
[[nodiscard]] std::shared_ptr<const scene::Scene> block_with_two_handles();

/// Of the couplings between device and handle.
inline constexpr double kHandleStiffness_N_per_m = 600;

/// A hand that holds a handle, and moves it along x from 3 s on: once, to and fro, or both.
struct HandleMotion {
  double at_m = 0;          ///< where the handle is at first
  double by_m = 0;          ///< how far it goes once, in half a second
  double amplitude_m = 0;   ///< to and fro
  double frequency_Hz = 1;  ///< of that
};

/// 0.1 kg, 1000 N/m, 5 N s/m.
[[nodiscard]] std::function<std::unique_ptr<const device::Operator>()> handle_hand(const HandleMotion& motion);

/// What one person felt in a run.
struct HandleFigures {
  double force_N = 0;      ///< RMS of what was applied along x
  double error = 0;        ///< RMS of the difference from a run without a network, over the RMS there
  double minimum_J = 0;    ///< of P
  double deviation_m = 0;  ///< the farthest that the block at the client was from where the server had it
};

/// One rendering: means over the seeds, but for the least P and the largest deviation.
struct TwoPeopleRow {
  bool local = false;
  std::array<HandleFigures, 2> people{};
  double impulse = 0;  ///< the sum of both people's, over the sum of their magnitudes: a block at rest leaves none
};

struct TwoPeopleSettings {
  std::string law = "fba-exact";
  std::uint64_t seeds = 3;
};

/// Two people move one block to and fro, at 2 and at 1.3 Hz, behind 10 and 80 ms (round trip, 10 % of jitter, 5 % of
/// loss): rendered remotely, and locally.
[[nodiscard]] std::vector<TwoPeopleRow> study_two_people(const TwoPeopleSettings& settings);

[[nodiscard]] std::string two_people_table(const TwoPeopleSettings& settings, const std::vector<TwoPeopleRow>& rows);

}  // namespace forcebound::lab
