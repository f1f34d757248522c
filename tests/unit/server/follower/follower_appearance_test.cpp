#include "forcebound/server/follower/follower_appearance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "forcebound/server/robot/task_world.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/gantry_robot.hpp"

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

/// The simulated arm at a task, after one tick.
class ArmAppearance : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_simulated_robots()) GTEST_SKIP() << "built without MuJoCo";
  }

  void put_at(const std::string& task) {
    task_ = load_task(task);
    follower_ =
        std::make_unique<Follower>(make_robot(task_, 1), FollowerSettings{}, control::force_bounding_laws(), clock_);
    follower_->start();
    appearance_ = std::make_unique<FollowerAppearance>(follower_->robot().model(), &task_, follower_->settings(), true);
    follower_->tick(0ns);
  }

  [[nodiscard]] Json description() const { return Json::parse(appearance_->description()->text); }

  /// Numbers of the solid whose name begins so.
  [[nodiscard]] std::vector<float> numbers_of(const std::string& name) const {
    const auto& names = appearance_->description()->moving.front().names;
    const auto found = std::ranges::find_if(names, [&](const std::string& one) { return one.starts_with(name); });
    std::vector<float> numbers(scene::kNumbersOfSolid);
    EXPECT_EQ(appearance_->sample(follower_->report(), FollowerAppearance::kSolids,
                                  static_cast<std::size_t>(found - names.begin()), numbers),
              numbers.size());
    return numbers;
  }

  test::FakeClock clock_;
  Task task_;
  std::unique_ptr<Follower> follower_;
  std::unique_ptr<FollowerAppearance> appearance_;
};

TEST_F(ArmAppearance, HasTheArmItsToolAndTheSurroundingsOfEachTask) {
  for (const std::string& task : task_names()) {
    SCOPED_TRACE(task);
    put_at(task);
    const auto received = view::read_description(appearance_->description()->text);
    ASSERT_TRUE(received) << "a client takes it";
    const auto& names = received->moving.front().names;
    EXPECT_EQ(std::set(names.begin(), names.end()).size(), names.size()) << "each has a name of its own";
    EXPECT_LE(names.size() * scene::kNumbersOfSolid, view::kNumbersMost) << "all that moves fits a piece";
    for (const WorldObject& object : task_.world->objects) {
      EXPECT_NE(appearance_->description()->text.find("\"" + object.name), std::string::npos) << object.name;
    }
    const Json robot = description()["robot"];
    EXPECT_EQ(robot["architecture"], "position-force");
    EXPECT_EQ(robot["motion_scale"], 1);
  }
}

TEST_F(ArmAppearance, PutsTheToolWhereTheModelHasItAndTheFingersBesideIt) {
  put_at("plug");
  const ToolPose pose = follower_->robot().model().pose(follower_->report().picture.joint);
  const std::vector<float> tool = numbers_of("tool ");
  const double behind_m = task_.world->tool.length_m / 2;
  const Eigen::Vector3d middle = pose.position - pose.orientation * Eigen::Vector3d(0, 0, behind_m);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(tool[i], middle[static_cast<Eigen::Index>(i)], 1e-6);
  const std::vector<float> left = numbers_of("finger_left");
  const Eigen::Vector3d finger(left[0], left[1], left[2]);
  EXPECT_GT((finger - middle).norm(), task_.world->tool.radius_m) << "it does not stick in the plug";
  EXPECT_LT((finger - middle).norm(), 0.05);
}

TEST_F(ArmAppearance, PutsTheBlockWhereItIs) {
  put_at("block");
  const std::vector<float> block = numbers_of("block ");
  EXPECT_NEAR(block[0], 0.48, 1e-3);
  EXPECT_NEAR(block[2], 0.03, 1e-3);
}

TEST_F(ArmAppearance, HasALeadersFrameThatPutsItsTipOnTheToolBeforeAnybodyLeads) {
  put_at("plug");
  const std::vector<float> frame = numbers_of("leader");
  const Eigen::Vector3d& tool = follower_->report().picture.tool.position;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(frame[i], tool[static_cast<Eigen::Index>(i)], 1e-6);
}

TEST_F(ArmAppearance, GivesValuesByTheirNames) {
  put_at("plug");
  const std::vector<std::string> names = FollowerAppearance::value_names(true);
  std::vector<float> values(names.size());
  ASSERT_EQ(appearance_->sample(follower_->report(), FollowerAppearance::kValues, 0, values), names.size());
  const auto value = [&](const char* name) {
    return values.at(static_cast<std::size_t>(std::ranges::find(names, name) - names.begin()));
  };
  EXPECT_EQ(value("state"), static_cast<float>(FollowerState::waiting));
  EXPECT_NEAR(value("tool_x_m"), 0.502, 1e-3);
  EXPECT_GT(follower_->totals().initial_J, 0);
  EXPECT_FLOAT_EQ(value("least_passivity_J"), static_cast<float>(follower_->totals().initial_J));
  EXPECT_EQ(value("leader_has_clutch"), -1) << "nobody leads";
}

TEST_F(ArmAppearance, DoesNotAllocateWhereItIsSampled) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  put_at("block");
  std::vector<float> numbers(view::kNumbersMost);
  const test::AllocationGuard guard;
  for (const std::size_t group : {FollowerAppearance::kSolids, FollowerAppearance::kValues}) {
    EXPECT_GT(appearance_->sample(follower_->report(), group, 0, numbers), 0U);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(FollowerAppearance, OfARobotThatNobodyCanDrawIsItsNumbersAlone) {
  const test::GantryModel model({});
  const FollowerAppearance appearance(model, nullptr, {}, false);
  EXPECT_TRUE(view::read_description(appearance.description()->text));
  std::vector<float> numbers(view::kNumbersMost);
  EXPECT_EQ(appearance.sample({}, FollowerAppearance::kSolids, 0, numbers), 0U) << "before the first reading";
  FollowerReport report;
  report.picture.joint = Vector::Zero(3);
  EXPECT_EQ(appearance.sample(report, FollowerAppearance::kSolids, 0, numbers), scene::kNumbersOfSolid)
      << "the leader's frame";
  EXPECT_EQ(appearance.sample(report, FollowerAppearance::kValues, 0, numbers),
            FollowerAppearance::value_names(false).size());
  EXPECT_EQ(appearance.sample(report, 2, 0, numbers), 0U);
}

}  // namespace
}  // namespace forcebound::server
