#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/tools/lab/teleoperation/teleoperation_run.hpp"

namespace forcebound::lab {

/// Which runs: each task with each architecture and law through each network, once for each seed.
struct TeleoperationStudy {
  std::vector<std::string> tasks;
  std::vector<std::string> architectures;
  std::vector<std::string> laws{"fba-exact", "none"};
  std::vector<NamedNetwork> networks;
  std::uint64_t seeds = 3;
  std::string device = "firm-3dof";
  server::FollowerSettings follower{};
};

/// One run and what it came to.
struct TeleoperationRow {
  std::string task;
  std::string architecture;
  std::string law;
  std::string network;
  std::uint64_t seed = 0;
  TeleoperationMeasures measures{};
};

/// No network; 10 and 50 ms each way; and the recorded networks that are in FORCEBOUND_DATA.
[[nodiscard]] StandardNetworks teleoperation_networks();

[[nodiscard]] TeleoperationSetup setup_of(const TeleoperationStudy& study, const std::string& task,
                                          const std::string& architecture, const std::string& law,
                                          const NamedNetwork& network, std::uint64_t seed);

/// @param progress gets the share done
/// @throws what tasks, devices, architectures and laws refuse, before the first run
[[nodiscard]] std::vector<TeleoperationRow> study_teleoperation(const TeleoperationStudy& study,
                                                                const std::function<void(double)>& progress);

}  // namespace forcebound::lab
