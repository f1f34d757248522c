#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>

#include "forcebound/device/load_device.hpp"
#include "tests/tools/lab/soak/soak.hpp"
#include "tests/tools/lab/soak/soak_case.hpp"
#include "tests/tools/sim/restless_hand.hpp"

// Hostile runs with a tool in the hand, on devices that show torques.
//
//   restless hand that turns -- six axes -- client session ==( drawn network )== hostile environment -- peg or blade
namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;

TEST(SoakWithTools, DrawsEverySceneAndDeviceAndOnlyLawsThatTakeThem) {
  std::set<std::string> scenes;
  std::set<std::string> devices;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const SoakCase drawn = draw_soak_case(seed, law_of(seed, SoakTip::tool), SoakTip::tool);
    scenes.insert(drawn.settings.scene->facts().name);
    devices.insert(drawn.settings.device.facts.name);
    EXPECT_EQ(drawn.settings.device.facts.rotations, 3);
  }
  EXPECT_EQ(scenes, (std::set<std::string>{"blade", "peg_in_hole"}));
  EXPECT_EQ(devices, (std::set<std::string>{"arm-6dof", "premium-6dof"}));
  EXPECT_THROW((void)draw_soak_case(1, "vc", SoakTip::tool), std::invalid_argument);
}

TEST(SoakWithTools, FindsTheExactLawPassiveAndNoLawNot) {
  double leaked_J = 0;
  int promised = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const SoakResult bounded = soak(seed, "fba-exact", SoakTip::tool);
    EXPECT_EQ(bounded.broken, "") << "again: forcebound-lab soak --tools --law fba-exact --seeds 1 --from " << seed;
    if (bounded.passive) {
      EXPECT_GE(bounded.least_P_J, -1e-9) << seed;
    }
    promised += bounded.passive ? 1 : 0;
    const SoakResult free = soak(seed, "none", SoakTip::tool);
    EXPECT_EQ(free.broken, "") << seed;
    leaked_J = std::min(leaked_J, free.least_P_J);
  }
  EXPECT_GT(promised, 0);
  EXPECT_LT(leaked_J, -0.1);
}

/// What is applied at most.
class Largest final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    force_N = std::max(force_N, tick.applied.norm());
    torque_N_m = std::max(torque_N_m, tick.applied_torque_N_m.norm());
    least_P_J = std::min(least_P_J, tick.audit_minimum_J);
  }

  double force_N = 0;
  double torque_N_m = 0;
  double least_P_J = 0;
};

/// A hand that turns a tool far from all surfaces, against an environment that does little but turn it along: P counts
/// what torques return, or there is next to nothing to count.
Largest turned_alone(const std::string& law) {
  SoakCase drawn = draw_soak_case(1, law, SoakTip::tool);
  sim::ClosedLoop::Settings& settings = drawn.settings;
  settings.device = device::load_device("premium-6dof");
  settings.flaws = {};
  settings.timing = {};
  settings.faults.clear();
  settings.network = {};
  settings.renders_locally = false;
  settings.handed_over = nullptr;
  settings.make_hand = [] {
    control::Vector above_m(3);
    above_m << 0, 0, 0.08;
    return std::make_unique<sim::RestlessHand>(
        sim::RestlessHand::Settings{.seed = 3,
                                    .degrees_of_freedom = 3,
                                    .hand = {.mass_kg = 0.1,
                                             .stiffness_N_per_m = 1000,
                                             .damping_N_s_per_m = 5,
                                             .inertia_kg_m2 = 5e-4,
                                             .rotation_stiffness_N_m_per_rad = 1,
                                             .rotation_damping_N_m_s_per_rad = 0.01},
                                    .reach_m = 0,
                                    .duration_s = 3,
                                    .turn_rad = 0.1,
                                    .middle_m = above_m});
  };
  settings.environment = sim::EnvironmentSetting{.name = "bang-bang", .force_N_max = 1e-3, .lever_m = 1e3};
  Largest largest;
  sim::ClosedLoop loop(settings, {&largest});
  loop.run(3s);
  return largest;
}

TEST(SoakWithTools, CountsWhatTorquesReturn) {
  const Largest free = turned_alone("none");
  EXPECT_LT(free.force_N, 0.05) << "of 8.5";
  EXPECT_GT(free.torque_N_m, 0.1);
  EXPECT_LT(free.least_P_J, -0.01);
  const Largest bounded = turned_alone("fba-exact");
  EXPECT_GT(bounded.torque_N_m, 1e-3) << "or nothing was shown";
  EXPECT_GE(bounded.least_P_J, -1e-9);
}

}  // namespace
}  // namespace forcebound::lab
