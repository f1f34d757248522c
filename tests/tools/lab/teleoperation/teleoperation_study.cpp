#include "tests/tools/lab/teleoperation/teleoperation_study.hpp"

#include "forcebound/device/load_device.hpp"

namespace forcebound::lab {

StandardNetworks teleoperation_networks() {
  StandardNetworks all = standard_networks();
  std::vector<NamedNetwork> chosen{network_of("none"), network_of("delay 10ms"), network_of("delay 50ms")};
  for (NamedNetwork& network : all.networks) {
    if (network.settings.trace) chosen.push_back(std::move(network));
  }
  all.networks = std::move(chosen);
  return all;
}

TeleoperationSetup setup_of(const TeleoperationStudy& study, const std::string& task, const std::string& architecture,
                            const std::string& law, const NamedNetwork& network, std::uint64_t seed) {
  TeleoperationSetup setup{.task = server::load_task(task),
                           .device = device::load_device(study.device),
                           .law = law,
                           .follower = study.follower,
                           .network = network,
                           .seed = seed};
  setup.follower.architecture = architecture;
  return setup;
}

std::vector<TeleoperationRow> study_teleoperation(const TeleoperationStudy& study,
                                                  const std::function<void(double)>& progress) {
  std::vector<TeleoperationRow> rows;
  const std::size_t all = study.tasks.size() * study.architectures.size() * study.laws.size() * study.networks.size() *
                          static_cast<std::size_t>(study.seeds);
  rows.reserve(all);
  for (const std::string& task : study.tasks) {
    for (const NamedNetwork& network : study.networks) {
      for (const std::string& architecture : study.architectures) {
        for (const std::string& law : study.laws) {
          for (std::uint64_t seed = 1; seed <= study.seeds; ++seed) {
            rows.push_back({.task = task,
                            .architecture = architecture,
                            .law = law,
                            .network = network.name,
                            .seed = seed,
                            .measures = run_teleoperation(setup_of(study, task, architecture, law, network, seed))});
            progress(static_cast<double>(rows.size()) / static_cast<double>(all));
          }
        }
      }
    }
  }
  return rows;
}

}  // namespace forcebound::lab
