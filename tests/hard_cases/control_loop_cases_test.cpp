// Cases 7 and 9 to 11: environments with extreme requests, on a device with a hand.
//
//     restless hand -- device -- client session ==( no delay )== environment -- server -- wall

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/tools/sim/closed_loop.hpp"
#include "tests/tools/sim/restless_hand.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

/// Checks every force commanded to the device.
class Forces final : public record::TickSink {
 public:
  Forces(double force_N_max, double actuator_step_N) : most_N_(force_N_max), step_N_(actuator_step_N) {}
  void on_tick(const record::TickRecord& tick) noexcept override {
    const double force_N = tick.applied[0];
    finite = finite && std::isfinite(force_N) && std::isfinite(tick.energy_J);
    within = within && std::abs(force_N) <= most_N_;
    at_most += std::abs(force_N) == most_N_;
    if (step_N_ > 0) whole = whole && std::abs(std::remainder(force_N, step_N_)) <= 1e-12;
    pushed += force_N != 0;
  }

  bool finite = true;
  bool within = true;
  bool whole = true;
  int at_most = 0;
  int pushed = 0;

 private:
  double most_N_;
  double step_N_;
};

class ControlLoopHardCase : public testing::TestWithParam<const char*> {
 protected:
  /// The published laws get an ideal encoder and immediate forces, as they assume; fba-exact a real device.
  ClosedLoop::Settings settings(double stiffness_N_per_m) const {
    ClosedLoop::Settings settings;
    settings.law = GetParam();
    settings.device = device::load_device("wall-1dof");
    const bool real = GetParam() == std::string("fba-exact");
    settings.device.facts.encoder_step.setConstant(real ? 55e-6 : 0);
    settings.device.facts.latency_s = real ? 100e-6 : 0;
    settings.make_hand = [] {
      return std::make_unique<RestlessHand>(
          RestlessHand::Settings{.seed = 7, .hand = {.mass_kg = 0.05, .stiffness_N_per_m = 300}, .duration_s = 4});
    };
    std::ostringstream toml;
    toml << "scene = { name = 'wall', description = 'a wall', degrees_of_freedom = 'any' }\n[[object]]\nname = 'wall'\n"
            "shape = { kind = 'half_space', through_m = [0], normal = [-1] }\neffects = ['surface']\n"
            "[object.surface]\nstiffness_N_per_m = "
         << stiffness_N_per_m << '\n';
    settings.scene = server::parse_scene(toml.str(), "hard case");
    return settings;
  }

  static EnvironmentSetting environment(const char* name, double force_N_max) {
    return {.name = name, .force_N_max = force_N_max};
  }

  Forces play(const ClosedLoop::Settings& settings) {
    Forces forces(settings.device.facts.force_N_max, settings.device.facts.actuator_step[0]);
    ClosedLoop loop(settings, {&forces});
    loop.run(4s);
    EXPECT_GE(loop.device().audit()->minimum_J, -1e-9);
    EXPECT_EQ(loop.session().state(), client::SessionState::active);
    EXPECT_TRUE(forces.finite);
    EXPECT_TRUE(forces.within);
    EXPECT_TRUE(forces.whole);
    EXPECT_GT(forces.pushed, 30) << "no force was ever applied";
    return forces;
  }
};

TEST_P(ControlLoopHardCase, Case07LargestForceOnEveryTickThroughAMotorOfTwelveBits) {
  auto settings = this->settings(1e3);
  settings.device.facts.force_N_max = 0.5;
  settings.device.facts.actuator_step.setConstant(0.5 / 2048);
  settings.environment = environment("bang-bang", 1e3);
  EXPECT_GT(play(settings).at_most, 100);
}

TEST_P(ControlLoopHardCase, Case09AMillionNewtonOneWayAndTheOther) {
  auto settings = this->settings(1e3);
  settings.environment = environment("switching", 1e6);
  (void)play(settings);
}

TEST_P(ControlLoopHardCase, Case10NegativeStiffnessAndNegativeDamping) {
  for (const char* name : {"negative-stiffness", "negative-damping"}) {
    SCOPED_TRACE(name);
    auto settings = this->settings(1e3);
    settings.environment = environment(name, 1e3);
    (void)play(settings);
  }
}

TEST_P(ControlLoopHardCase, Case11WallsUpToAThousandMillionNewtonPerMetre) {
  for (const double stiffness_N_per_m : {1e3, 1e5, 1e7, 1e9}) {
    SCOPED_TRACE(stiffness_N_per_m);
    (void)play(settings(stiffness_N_per_m));
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, ControlLoopHardCase, testing::Values("fba-less", "fba-more", "fba-exact"),
                         [](const auto& law) {
                           std::string name = law.param;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

}  // namespace
}  // namespace forcebound::sim
