#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <tuple>

#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/sim/closed_loop.hpp"
#include "tests/tools/sim/restless_hand.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

/// Results of a run.
class Watch final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    finite = finite && tick.applied.allFinite() && tick.position.allFinite() && std::isfinite(tick.energy_J);
    most_N = std::max(most_N, tick.applied.norm());
    displayed_N = tick.displayed_N;
    penetration_m = tick.penetration_m;
    least_J = tick.audit_minimum_J;
    position = tick.position;
  }
  void on_force(const record::ForceRecord& force) noexcept override { place = force.force.position; }

  bool finite = true;
  double most_N = 0;
  double displayed_N = 0;
  double penetration_m = 0;
  double least_J = 0;
  control::Vector position;
  control::Vector place;  ///< where the environment was asked last
};

ClosedLoop::Settings pressing(const std::string& law, const std::string& device, const std::string& netem) {
  const auto way = netem::parse_netem(netem);
  return {.device = device::load_device(device),
          .hand = "press",
          .law = law,
          .scene = server::load_scene("wall"),
          .network = {.up = way, .down = way, .trace = {}, .seed = 11}};
}

//   device, press -- law ==( 0 or 50 ms each way )== server-side law -- server, wall
class TwoPortLawsInTheLoop : public testing::TestWithParam<std::tuple<std::string, std::string, std::string>> {};

TEST_P(TwoPortLawsInTheLoop, MakeContactStayFiniteAndWithinTheLargestForce) {
  const auto& [law, device, netem] = GetParam();
  SCOPED_TRACE(law + " on " + device + ", " + netem);
  Watch watch;
  ClosedLoop loop(pressing(law, device, netem), {&watch});
  loop.run(5s);
  EXPECT_TRUE(watch.finite);
  EXPECT_GT(watch.most_N, 0.1) << "contact; a wave of b_w 0.5 N s/m, 50 ms long, is a spring of 10 N/m at 20 mm";
  EXPECT_LE(watch.most_N, device::load_device(device).facts.force_N_max * (1 + 1e-12));
  EXPECT_EQ(loop.session().state(), client::SessionState::active);
  const auto report = [](const char* what, double value) { RecordProperty(what, std::to_string(value)); };
  report("passivity_minimum_mJ", watch.least_J * 1e3);
  report("most_N", watch.most_N);
  report("displayed_N", watch.displayed_N);
  report("depth_mm", watch.penetration_m * 1e3);
  report("drift_mm", (watch.place - watch.position).norm() * 1e3);
}

TEST_P(TwoPortLawsInTheLoop, GoOnWithAServerThatRestarted) {
  const auto& [law, device, netem] = GetParam();
  SCOPED_TRACE(law + " on " + device + ", " + netem);
  Watch watch;
  ClosedLoop loop(pressing(law, device, netem), {&watch});
  loop.run(2s);
  loop.kill_server();
  loop.run(300ms);
  loop.start_server();
  loop.run(3s);
  EXPECT_EQ(loop.session().state(), client::SessionState::active);
  EXPECT_EQ(loop.totals().reconnects, 1U);
  EXPECT_TRUE(watch.finite);
}

std::string name_of(const testing::TestParamInfo<TwoPortLawsInTheLoop::ParamType>& run) {
  constexpr std::array kNetworks{"near", "far", "far_and_lossy"};
  const auto& [law, device, netem] = run.param;
  std::string name = law + "_" + device + "_" + kNetworks.at(run.index % kNetworks.size());
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, TwoPortLawsInTheLoop,
                         testing::Combine(testing::Values("pspm", "tdpa-2port", "tdpa-er", "tla", "wave"),
                                          testing::Values("wall-1dof", "cartesian-3dof"),
                                          testing::Values("delay 0ms", "delay 50ms",
                                                          "delay 50ms 10ms loss 5% duplicate 2%")),
                         name_of);

//   ideal device, restless hand -- pspm ==( late, lost, doubled; the server dies )== any environment
TEST(SetPositionModulationInTheLoop, KeepsItsClaimWhateverEnvironmentAndNetworkDo) {
  for (const std::string& environment : environment_names()) {
    for (const char* device : {"wall-1dof", "cartesian-3dof"}) {
      SCOPED_TRACE(environment + " on " + device);
      auto settings = pressing("pspm", device, "delay 20ms 10ms loss 10% duplicate 10%");
      auto& facts = settings.device.facts;
      facts.encoder_step.setZero();
      facts.actuator_step.setZero();
      facts.latency_s = 0;
      const int dof = facts.degrees_of_freedom();
      settings.make_hand = [dof] {
        return std::make_unique<RestlessHand>(RestlessHand::Settings{
            .seed = 3, .degrees_of_freedom = dof, .hand = {.mass_kg = 0.05, .stiffness_N_per_m = 300}});
      };
      settings.environment = EnvironmentSetting{.name = environment, .seed = 4, .force_N_max = facts.force_N_max};
      settings.faults = {{.kind = ClosedLoop::Fault::Kind::server_killed, .at = 2s, .length = 200ms}};
      Watch watch;
      ClosedLoop loop(settings, {&watch});
      loop.run(5s);
      EXPECT_GE(watch.least_J, -1e-9);
      EXPECT_GT(watch.most_N, 0.1);
      EXPECT_EQ(loop.totals().reconnects, 1U);
    }
  }
}

}  // namespace
}  // namespace forcebound::sim
