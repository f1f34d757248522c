#include "forcebound/server/follower/follower_environment.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/fake_clock.hpp"
#include "tests/support/gantry_robot.hpp"

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using control::FollowerState;
using test::GantryRobot;

TEST(FollowerEnvironment, HasOneLeaderAtATime) {
  test::FakeClock clock;
  auto follower = std::make_shared<Follower>(std::make_unique<GantryRobot>(), FollowerSettings{},
                                             control::force_bounding_laws(), clock);
  const EnvironmentKind kind =
      follower_environment("wall", "a gantry", 3, std::make_shared<StepwiseRunner>(follower, 0ns));
  EXPECT_EQ(kind.degrees_of_freedom, std::vector<std::uint32_t>{3});
  MadeEnvironment first = kind.make({.device = "omni"});
  EXPECT_TRUE(first.takes_energy);
  try {
    (void)kind.make({.device = "falcon"});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("led by 'omni'"), std::string::npos) << error.what();
  }
  first.environment.reset();
  EXPECT_NO_THROW((void)kind.make({.device = "falcon"}));
}

/// Reports what it is given.
class SilentRunner final : public FollowerRunner {
 public:
  void begin_leader() noexcept override {}
  void leave() noexcept override {}
  const FollowerReport& exchange(const LeaderMotion& /*motion*/) noexcept override { return report; }
  const FollowerReport& newest() noexcept override { return report; }

  FollowerReport report{.state = FollowerState::following, .share = 0.5};
};

TEST(FollowerEnvironment, ShowsTorqueToWhoCanFeelIt) {
  const auto runner = std::make_shared<SilentRunner>();
  runner->report.map = WorkspaceMap({.motion_scale = 2, .force_scale = 0.5});
  runner->report.reflection.torque_N_m = {0.1, -0.2, 0.4};
  runner->report.reflection.torque_N_m_max = 1;
  const EnvironmentKind kind = follower_environment("wall", "a gantry", 3, runner);
  const Vector position = Vector::Zero(3);
  const auto torque_of = [&](bool shows_torque, bool has_orientation) {
    Motion motion{.position = position};
    if (has_orientation) motion.handle.orientation = {1, 0, 0, 0};
    return kind.make({.device = "omni", .shows_torque = shows_torque}).environment->respond(motion).torque_N_m;
  };
  const Vector shown = torque_of(true, true);
  ASSERT_EQ(shown.rows(), 3);
  const Eigen::Vector3d whole = runner->report.map.to_leader_N_m(runner->report.reflection.torque_N_m);
  EXPECT_GT(whole.norm(), 0);
  EXPECT_TRUE(shown.isApprox(0.5 * whole)) << "the share that is shown so far";
  EXPECT_EQ(torque_of(false, true).rows(), 0);
  EXPECT_EQ(torque_of(true, false).rows(), 0);
  runner->report.reflection.torque_N_m_max = 0;
  EXPECT_EQ(torque_of(true, true).rows(), 0) << "of an architecture that shows none";
}

TEST(FollowerEnvironment, SaysThatAnotherDeviceTookTheRobot) {
  test::FakeClock clock;
  auto follower = std::make_shared<Follower>(std::make_unique<GantryRobot>(), FollowerSettings{},
                                             control::force_bounding_laws(), clock);
  const auto runner = std::make_shared<StepwiseRunner>(follower, 0ns);
  const EnvironmentKind kind = follower_environment("wall", "a gantry", 3, runner);
  MadeEnvironment first = kind.make({.device = "omni"});
  Motion motion{.position = Vector::Zero(3)};
  const auto state_after = [&motion](MadeEnvironment& leader, Nanoseconds silent) {
    motion.server_time += silent;
    return leader.environment->respond(motion).follower;
  };
  EXPECT_EQ(state_after(first, 1ms), FollowerState::waiting);
  runner->live_until(1s);
  EXPECT_TRUE(runner->newest().leader_lost);
  MadeEnvironment second = kind.make({.device = "falcon"});
  EXPECT_EQ(state_after(second, 1s), FollowerState::waiting);
  EXPECT_EQ(state_after(first, 1ms), FollowerState::taken);
  second.environment.reset();
  EXPECT_EQ(state_after(first, 1ms), FollowerState::waiting) << "its again";
}

}  // namespace
}  // namespace forcebound::server
