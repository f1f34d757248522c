#include "forcebound/server/follower/workspace_map.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <stdexcept>

namespace forcebound::server {
namespace {

LeaderMotion at(std::initializer_list<double> place) {
  LeaderMotion motion;
  motion.position.resize(static_cast<Eigen::Index>(place.size()));
  std::copy(place.begin(), place.end(), motion.position.data());
  return motion;
}

TEST(WorkspaceMap, TurnsTheUsersAxesIntoTheRobots) {
  WorkspaceMap map({.motion_scale = 2});
  map.engage(at({0.01, 0.02, 0.03}), {.position = {0.5, 0, 0.3}});
  EXPECT_TRUE(map.tool_of(at({0.01, 0.02, 0.03})).position.isApprox(Eigen::Vector3d(0.5, 0, 0.3))) << "no jump";
  // y is away from the user, x of the world away from the robot's base; x is to the right, which is -y.
  EXPECT_TRUE(map.tool_of(at({0.01, 0.03, 0.03})).position.isApprox(Eigen::Vector3d(0.52, 0, 0.3)));
  EXPECT_TRUE(map.tool_of(at({0.02, 0.02, 0.03})).position.isApprox(Eigen::Vector3d(0.5, -0.02, 0.3)));
  EXPECT_TRUE(map.tool_of(at({0.01, 0.02, 0.04})).position.isApprox(Eigen::Vector3d(0.5, 0, 0.32)));
}

TEST(WorkspaceMap, HasTheLeadersFrameInTheRobotsWorld) {
  WorkspaceMap map({.motion_scale = 3});
  map.engage(at({0.01, 0.02, 0.03}), {.position = {0.5, 0, 0.3}});
  const LeaderMotion leader = at({-0.02, 0.05, 0.01});
  const Eigen::Vector3d place = map.leader_frame() * Eigen::Vector3d(3 * leader.position);
  EXPECT_TRUE(place.isApprox(map.tool_of(leader).position, 1e-12));
}

TEST(WorkspaceMap, PlaceForceAndPowerBelongTogether) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int i = 0; i < 100; ++i) {
    WorkspaceMap map({.motion_scale = std::exp(number(random)), .force_scale = std::exp(number(random))});
    map.engage(at({number(random), number(random), number(random)}), {.position = Eigen::Vector3d::Random()});
    const LeaderMotion leader = at({number(random), number(random), number(random)});
    const Eigen::Vector3d tool = map.tool_of(leader).position;
    EXPECT_TRUE(map.leader_place_m(tool).isApprox(Eigen::Vector3d(leader.position), 1e-9));
    // A step of the device under a force of the world: the same energy, but for the scale.
    const Eigen::Vector3d step = Eigen::Vector3d::Random();
    LeaderMotion moved = leader;
    moved.position += step;
    const Eigen::Vector3d world_N = Eigen::Vector3d::Random();
    const double at_robot_J = world_N.dot(map.tool_of(moved).position - tool);
    EXPECT_NEAR(map.power_scale() * map.to_leader_N(world_N).dot(step), at_robot_J, 1e-9);
    // A spring of the world, felt at the device.
    const double stiffness = 3;
    EXPECT_NEAR(map.to_leader_N(stiffness * (map.tool_of(moved).position - tool)).norm(),
                map.leader_stiffness_N_per_m(stiffness) * step.norm(), 1e-9);
  }
}

TEST(WorkspaceMap, TheToolTurnsAsTheHandleDoes) {
  WorkspaceMap map({.rotation = Eigen::Matrix3d::Identity()});
  LeaderMotion leader = at({0, 0, 0});
  const auto told = [](const Eigen::Quaterniond& q) {
    return control::Handle::Orientation{q.w(), q.x(), q.y(), q.z()};
  };
  const Eigen::Quaterniond start(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()));
  const Eigen::Quaterniond tool(Eigen::AngleAxisd(1, Eigen::Vector3d(1, 1, 0).normalized()));
  leader.handle.orientation = told(start);
  map.engage(leader, {.orientation = tool});
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  leader.handle.orientation = told(turn * start);
  EXPECT_NEAR(map.tool_of(leader).orientation.angularDistance(turn * tool), 0, 1e-9);
  leader.handle.orientation.reset();
  EXPECT_NEAR(map.tool_of(leader).orientation.angularDistance(tool), 0, 1e-9) << "it stays as it was";
}

TEST(WorkspaceMap, ALeaderOfOneAxisMovesAlongIt) {
  WorkspaceMap map({.rotation = Eigen::Matrix3d::Identity()});
  map.engage(at({0.01}), {.position = {1, 2, 3}});
  EXPECT_TRUE(map.tool_of(at({0.02})).position.isApprox(Eigen::Vector3d(1.01, 2, 3)));
}

TEST(WorkspaceMap, RefusesScalesAndRotationsThatAreNone) {
  EXPECT_THROW(WorkspaceMap({.motion_scale = 0}), std::invalid_argument);
  EXPECT_THROW(WorkspaceMap({.force_scale = 1e9}), std::invalid_argument);
  EXPECT_THROW(WorkspaceMap({.motion_scale = std::numeric_limits<double>::quiet_NaN()}), std::invalid_argument);
  EXPECT_THROW(WorkspaceMap({.rotation = 2 * Eigen::Matrix3d::Identity()}), std::invalid_argument);
  EXPECT_THROW(WorkspaceMap({.rotation = -Eigen::Matrix3d::Identity()}), std::invalid_argument) << "a mirror";
}

}  // namespace
}  // namespace forcebound::server
