#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/control/law_registry.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::lab {

/// A task on which laws are compared: a scene, with its device and hand.
struct Task {
  std::string scene;   ///< wall, circle or sphere: the paper's [Kim 2015, section VI]
  std::string device;  ///< name or file
  std::string hand;    ///< the operator's specification
  double duration_s = 4;
  double settle_s = 1;  ///< contact statistics begin this long after the first contact
};

/// @param device replaces the scene's own; empty: the scene's own
/// @throws std::invalid_argument naming the known scenes
[[nodiscard]] Task task_of(const std::string& scene, const std::string& device = {});

/// A network between the two ends, with its name.
struct NamedNetwork {
  std::string name;
  sim::SimulatedNetworkSettings settings{};
};

inline constexpr std::string_view kTraceWord = "trace:";

/// Both ways the same: "none"; netem's words, as "delay 10ms loss 5%"; or "trace:FILE".
/// @throws std::invalid_argument or std::runtime_error as the parsers of netem's words and of traces
[[nodiscard]] NamedNetwork network_of(const std::string& words);

/// The file of a recorded network, "trace:FILE"; empty for any other.
[[nodiscard]] std::string recorded_network(std::string_view words);

/// none; 1, 10, 50, 250 ms each way; jitter; a tenth lost; bursts of loss; and recorded 5G networks, if the recordings
/// are in FORCEBOUND_DATA.
struct StandardNetworks {
  std::vector<NamedNetwork> networks;
  std::vector<std::string> absent;  ///< recordings that were not found
};
[[nodiscard]] StandardNetworks standard_networks();

/// From command to force, of a device that is not ideal.
inline constexpr double kRealLatency_s = 100e-6;

/// The quality of the device.
enum class Conditions : std::uint8_t {
  ideal,     ///< no encoder or actuator steps, punctual ticks, no latency
  punctual,  ///< its own encoder and actuator, 100 us of latency, punctual ticks
  real,      ///< the same with ticks as late as measured on a shared virtual machine
};

/// Settings of a trial: one law on one task with one wall's stiffness through one network.
struct TrialSetup {
  Task task;
  double stiffness_N_per_m = 10e3;
  NamedNetwork network;
  Conditions conditions = Conditions::real;
  std::string law{};
  control::LawParameters parameters{};
  bool renders_locally = false;  ///< what can be at the client
  std::uint64_t seed = 1;
  double rate_Hz = 0;  ///< ticks per second; 0: the device's own
};

/// @throws what device, hand and scene refuse
[[nodiscard]] sim::ClosedLoop::Settings settings_of(const TrialSetup& setup);

}  // namespace forcebound::lab
