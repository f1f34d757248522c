#include "tests/tools/lab/trials/task.hpp"

#include <array>
#include <chrono>
#include <stdexcept>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/tick_rate.hpp"
#include "forcebound/text/names.hpp"
#include "tests/tools/data/recorded_data.hpp"
#include "tests/tools/lab/trials/experiment.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;

constexpr time::Nanoseconds kRealChoosing = 15us;

}  // namespace

Task task_of(const std::string& scene, const std::string& device) {
  static const std::vector<std::string> kScenes{"wall", "circle", "sphere"};
  for (const std::string& known : kScenes) {
    if (known != scene) continue;
    const Experiment paper = experiments(scene).front();
    Task task{.scene = scene, .device = paper.device, .hand = paper.hand};
    if (!device.empty()) task.device = device;
    return task;
  }
  throw std::invalid_argument("unknown scene '" + scene + "'" + text::suggestion(scene, kScenes));
}

std::string recorded_network(std::string_view words) {
  return words.starts_with(kTraceWord) ? std::string(words.substr(kTraceWord.size())) : std::string();
}

NamedNetwork network_of(const std::string& words) {
  NamedNetwork network{.name = words};
  if (words == "none") return network;
  if (words.starts_with(kTraceWord)) {
    network.settings.trace = netem::load_trace(recorded_network(words));
    return network;
  }
  network.settings.up = network.settings.down = netem::parse_netem(words);
  return network;
}

StandardNetworks standard_networks() {
  StandardNetworks standard;
  constexpr std::array kWords{"none",
                              "delay 1ms",
                              "delay 10ms",
                              "delay 50ms",
                              "delay 250ms",
                              "delay 20ms 10ms distribution normal",
                              "delay 10ms loss 10%",
                              "delay 10ms loss gemodel 2% 10%"};
  for (const char* const words : kWords) standard.networks.push_back(network_of(words));
  for (const char* const name : {"5g-urban-n8", "5g-rural-n8"}) {
    const auto file = recorded_data("network/" + std::string(name) + ".csv");
    if (!file) {
      standard.absent.emplace_back(name);
      continue;
    }
    standard.networks.push_back(network_of(std::string(kTraceWord) + file->string()));
    standard.networks.back().name = name;
  }
  return standard;
}

sim::ClosedLoop::Settings settings_of(const TrialSetup& setup) {
  const Experiment experiment{.name = setup.task.scene,
                              .device = setup.task.device,
                              .hand = setup.task.hand,
                              .stiffness_N_per_m = setup.stiffness_N_per_m,
                              .duration_s = setup.task.duration_s,
                              .settle_s = setup.task.settle_s};
  sim::ClosedLoop::Settings settings = experiment.settings(setup.law);
  settings.device = device::load_device(setup.task.device);
  control::DeviceFacts& facts = settings.device.facts;
  facts = device::at_tick_rate(facts, setup.rate_Hz);
  if (setup.conditions == Conditions::ideal) {
    facts.encoder_step.setZero();
    facts.actuator_step.setZero();
    facts.latency_s = 0;
  } else {
    facts.latency_s = kRealLatency_s;
    settings.timing = {.measured = setup.conditions == Conditions::real, .choosing_max = kRealChoosing};
  }
  settings.law_options.parameters = setup.parameters;
  settings.renders_locally = setup.renders_locally;
  settings.network = setup.network.settings;
  settings.network.seed = settings.seed = setup.seed;
  return settings;
}

}  // namespace forcebound::lab
