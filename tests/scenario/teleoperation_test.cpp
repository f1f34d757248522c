// Two bounded ports and any network between them (server/forcebound/server/follower/README.md):
//
//     restless hand - device - client ==( delay, jitter, loss, reordering, blackouts )== server - gantry | wall
//                        ledger, gives energy up -------------------------------------> ledger, spends it

#include <gtest/gtest.h>

#include <memory>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/server/follower/follower_environment.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/gantry_robot.hpp"
#include "tests/tools/lab/trials/task.hpp"
#include "tests/tools/sim/closed_loop.hpp"
#include "tests/tools/sim/draw.hpp"
#include "tests/tools/sim/firm_device.hpp"
#include "tests/tools/sim/restless_hand.hpp"

namespace forcebound {
namespace {

using namespace std::chrono_literals;
using time::Nanoseconds;

struct Ports {
  double hand_J = 0;   ///< least P_L
  double given_J = 0;  ///< A_L at the end
  double kept_J = 0;   ///< least P_L - A_L
  double robot_J = 0;  ///< least P_F
  double received_J = 0;
  std::uint64_t followed_ms = 0;
};

Ports play(std::uint64_t seed, const std::string& law) {
  sim::Draw draw(seed);
  test::FakeClock clock;
  clock.time = Nanoseconds::min();
  server::FollowerSettings follower_settings{
      .architecture = std::string(
          draw.one_of<const char*>({"position-position", "position-force", "position-force-damped", "model-mediated"})),
      .law = law,
      .workspace = {.motion_scale = draw.number(0.5, 2), .force_scale = draw.number(0.5, 2)}};
  follower_settings.workspace.rotation.setIdentity();
  const auto follower = std::make_shared<server::Follower>(
      std::make_unique<test::GantryRobot>(test::GantrySettings{.wall_m = draw.number(0, 0.02)}), follower_settings,
      baselines::shipped_laws(), clock);
  const auto runner = std::make_shared<server::StepwiseRunner>(follower, Nanoseconds{0});

  sim::ClosedLoop::Settings settings{
      .device = sim::firm_device(),
      .hand = {},
      .make_hand =
          [&] {
            return std::make_unique<sim::RestlessHand>(sim::RestlessHand::Settings{
                .seed = seed,
                .degrees_of_freedom = 3,
                .hand = {.mass_kg = 0.2, .stiffness_N_per_m = 1000, .damping_N_s_per_m = 10},
                .reach_m = 0.03,
                .duration_s = 10});
          },
      .law = law,
      .scene = nullptr,
      .network =
          lab::network_of(draw.one_of<const char*>({"none", "delay 10ms 5ms loss 10%", "delay 50ms 20ms reorder 20%",
                                                    "delay 100ms duplicate 10%", "delay 5ms loss 40%"}))
              .settings,
      .seed = seed,
      .own_environment = server::follower_environment("gantry", "a gantry before a wall", 3, runner),
      .renders_locally = follower_settings.architecture == "model-mediated"};
  settings.network.seed = seed;
  using Kind = sim::ClosedLoop::Fault::Kind;
  for (int fault = 0; fault < 2; ++fault) {
    settings.faults.push_back({.kind = draw.one_of({Kind::stall, Kind::blackout_up, Kind::blackout_down, Kind::blackout,
                                                    Kind::server_killed}),
                               .at = draw.duration(2, 9),
                               .length = draw.duration(0.05, 1.5)});
  }
  sim::ClosedLoop loop(std::move(settings));
  Ports ports;
  while (loop.time() < 10s) {
    loop.run(1ms);
    runner->live_until(loop.time());
    ports.kept_J = std::min(ports.kept_J, loop.device().audit()->energy_J - loop.session().law().energy_given_J());
    ports.followed_ms += follower->report().state == control::FollowerState::following ? 1 : 0;
  }
  ports.hand_J = loop.device().audit()->minimum_J;
  ports.given_J = loop.session().law().energy_given_J();
  ports.robot_J = follower->totals().port.minimum_J;
  ports.received_J = follower->totals().received_J /
                     (follower_settings.workspace.motion_scale / follower_settings.workspace.force_scale);
  return ports;
}

TEST(TwoPorts, AreBothPassiveWhateverTheNetworkDoes) {
  double received_J = 0;
  std::uint64_t followed_ms = 0;
  // Unoptimised, a seed takes many times as long.
  constexpr std::uint64_t kSeeds = FORCEBOUND_SOAK_SEEDS >= 600 ? 40 : 8;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Ports ports = play(seed, "fba-exact");
    EXPECT_GE(ports.hand_J, -1e-9);
    EXPECT_GE(ports.kept_J, -1e-9) << "it gave what it had not";
    EXPECT_GE(ports.robot_J, -1e-9);
    EXPECT_LE(ports.received_J, ports.given_J + 1e-9) << "more arrived than was sent";
    received_J += ports.received_J;
    followed_ms += ports.followed_ms;
  }
  EXPECT_GT(received_J, 0.02 * kSeeds) << "nothing was at stake";
  EXPECT_GT(followed_ms, kSeeds * 1000U);
}

TEST(TwoPorts, LeakWithoutALaw) {
  double hand_J = 0;
  double robot_J = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Ports ports = play(seed, "none");
    hand_J = std::min(hand_J, ports.hand_J);
    robot_J = std::min(robot_J, ports.robot_J);
  }
  EXPECT_LT(hand_J, -1e-3);
  EXPECT_LT(robot_J, -1e-3);
}

}  // namespace
}  // namespace forcebound
