#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "tests/tools/lab/accuracy/device_error.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::lab {

/// A run of the closed loop, recorded at the device.
struct DeviceRun {
  std::vector<DeviceTick> ticks{};       ///< `reference` and `own` not yet filled in
  std::vector<Vector> true_positions{};  ///< of the tip, at each tick's reading [m]
  double passivity_minimum_J = 0;        ///< P of the audit
  std::uint64_t law_faults = 0;          ///< ticks without a force of the law's, or one that is not finite
  double turns_missed = 0;               ///< share of the motions that the server skipped
  nlohmann::json summary{};              ///< as the client writes it, of ticks and forces
};

/// @param settings with the server's computing time and the network
/// @param sinks see every tick as well
DeviceRun run_device(sim::ClosedLoop::Settings settings, double duration_s, std::vector<record::TickSink*> sinks = {});

/// Fills in what the scene would have answered at the device's true position, `own`, if some tick was rendered at the
/// client.
void fill_in_own(DeviceRun& run, const std::shared_ptr<const scene::Scene>& scene);

}  // namespace forcebound::lab
