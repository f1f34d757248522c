#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "forcebound/control/law_registry.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::lab {

/// What the laws are compared on: a scene, the device and the hand that go with it.
struct Task {
  std::string scene;   ///< wall, circle or sphere: the paper's [Kim 2015, section VI]
  std::string device;  ///< name or file
  std::string hand;    ///< the operator's specification
  double duration_s = 4;
  double settle_s = 1;  ///< contact statistics begin this long after the first contact
};

/// @param device in place of the one that goes with the scene; empty: that one
/// @throws std::invalid_argument naming the known scenes
[[nodiscard]] Task task_of(const std::string& scene, const std::string& device = {});

/// A network between the two ends, as people name it.
struct NamedNetwork {
  std::string name;
  sim::SimulatedNetworkSettings settings{};
};

/// Both ways the same: "none"; netem's words, as "delay 10ms loss 5%"; or "trace:FILE".
/// @throws std::invalid_argument or std::runtime_error as the words' and the trace's readers
[[nodiscard]] NamedNetwork network_of(const std::string& words);

/// none; 1, 10, 50, 250 ms each way; jitter; a tenth lost; bursts of loss; and what was measured on a 5G network, where
/// the recordings are at hand (FORCEBOUND_DATA).
struct StandardNetworks {
  std::vector<NamedNetwork> networks;
  std::vector<std::string> absent;  ///< recordings that are not there
};
[[nodiscard]] StandardNetworks standard_networks();

/// How good the device is.
enum class Conditions : std::uint8_t {
  ideal,  ///< no encoder's step, no actuator's, punctual ticks, the force is there with its reading
  real,   ///< its own encoder and actuator, 100 us of latency, ticks as late as measured on a shared virtual machine
};

/// One law against one wall through one network.
struct Contest {
  Task task;
  double stiffness_N_per_m = 10e3;
  NamedNetwork network;
  Conditions conditions = Conditions::real;
  std::string law{};
  control::LawParameters parameters{};
  std::uint64_t seed = 1;
};

/// @throws what device, hand and scene refuse
[[nodiscard]] sim::ClosedLoop::Settings settings_of(const Contest& contest);

}  // namespace forcebound::lab
