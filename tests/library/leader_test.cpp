#include <forcebound.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "forcebound/control/force_bounded_leader.hpp"
#include "tests/library/handles.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::library {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;

using Leader = Owned<fb_leader>;

fb_leader_joint servo(const char* name = "elbow") {
  fb_leader_joint joint = FB_INIT(fb_leader_joint);
  joint.name = name;
  joint.damping_N_m_s_per_rad = 0.15;
  joint.friction_N_m = 0.03;
  joint.encoder_step_rad = 0.0015339807878856;
  joint.torque_N_m_max = 1;
  return joint;
}

fb_leader_settings at_200_Hz() {
  fb_leader_settings settings = FB_INIT(fb_leader_settings);
  settings.period_s = 0.005;
  settings.latency_s_max = 0.001;
  return settings;
}

Leader make(const std::vector<fb_leader_joint>& joints, const fb_leader_settings& settings = at_200_Hz()) {
  fb_leader* leader = nullptr;
  EXPECT_EQ(fb_leader_create(joints.data(), joints.size(), &settings, &leader), FB_OK) << fb_last_error();
  return Leader(leader);
}

fb_leader_state state_of(const Leader& leader) {
  fb_leader_state state = FB_INIT(fb_leader_state);
  EXPECT_EQ(fb_leader_look(leader.get(), &state), FB_OK) << fb_last_error();
  return state;
}

TEST(LibraryLeader, GivesTheTorquesOfTheLeaderInCpp) {
  const Leader leader = make(std::vector<fb_leader_joint>(6, servo()));
  control::ForceBoundedLeader expected(
      {.joints = std::vector<control::LeaderJoint>(6, {.damping_N_m_s_per_rad = 0.15,
                                                       .friction_N_m = 0.03,
                                                       .encoder_step_rad = 0.0015339807878856,
                                                       .torque_N_m_max = 1}),
       .period_s = 0.005,
       .latency_s_max = 0.001});
  std::mt19937 random(1);  // NOLINT(cert-msc51-cpp,cert-msc32-c)
  std::normal_distribution<double> drawn;
  std::array<double, 6> position{}, feedback{}, torque{}, wanted{};
  int felt = 0;
  for (int n = 0; n < 300; ++n) {
    for (std::size_t i = 0; i < 6; ++i) {
      position[i] += 3e-3 * drawn(random);
      feedback[i] = -2 * position[i] + 0.2 * drawn(random);
    }
    ASSERT_EQ(fb_leader_step(leader.get(), position.data(), feedback.data(), 0.005, torque.data(), 6), FB_OK);
    expected.step(position, feedback, 0.005, wanted);
    ASSERT_EQ(torque, wanted);
    felt += torque[0] != 0 ? 1 : 0;
  }
  EXPECT_GT(felt, 100);
}

TEST(LibraryLeader, RefusesFactsInOneLineThatNamesTheJoint) {
  std::vector<fb_leader_joint> joints{servo("shoulder"), servo("elbow")};
  fb_leader* leader = nullptr;
  const auto refusal = [&](const fb_leader_settings* settings = nullptr) {
    EXPECT_EQ(fb_leader_create(joints.data(), joints.size(), settings, &leader), FB_INVALID);
    return std::string(fb_last_error());
  };
  joints[1].torque_N_m_max = 0;
  EXPECT_EQ(refusal(), "fb_leader_create: leader: joint 'elbow': torque_N_m_max must be > 0, got 0");
  joints[1] = servo();
  joints[1].goal_stiffness_N_m_per_rad = 100;
  EXPECT_THAT(refusal(), AllOf(HasSubstr("'elbow': goal_stiffness_N_m_per_rad must be at most"), HasSubstr("got 100")));
  joints[1] = servo();
  joints[1].size = 3;
  EXPECT_THAT(refusal(), HasSubstr("fb_leader_joint.size is 3"));
  joints[1] = servo();
  fb_leader_settings settings = at_200_Hz();
  settings.hold_s_max = 0.001;
  EXPECT_THAT(refusal(&settings), HasSubstr("hold_s_max must be at least period_s and latency_s_max together"));
  EXPECT_EQ(fb_leader_create(joints.data(), 0, nullptr, &leader), FB_INVALID);
  EXPECT_THAT(fb_last_error(), HasSubstr("count must be 1 to 1000"));
  EXPECT_EQ(fb_leader_create(nullptr, 1, nullptr, &leader), FB_INVALID);
  EXPECT_EQ(leader, nullptr);
}

TEST(LibraryLeader, AfterAWrongCallTorquesAreZeroAndTheReadingsLost) {
  const Leader leader = make({servo(), servo()});
  std::array<double, 3> position{}, torque{9, 9, 9};
  const std::array<double, 3> feedback{-1, -1, -1};
  for (int n = 0; n < 100; ++n) {
    position.fill(0.005 * n);
    ASSERT_EQ(fb_leader_step(leader.get(), position.data(), feedback.data(), 0.005, torque.data(), 2), FB_OK);
  }
  EXPECT_LT(torque[0], 0);
  const double energy_J = state_of(leader).energy_J_least;
  EXPECT_EQ(fb_leader_step(leader.get(), position.data(), feedback.data(), 0.005, torque.data(), 3), FB_INVALID);
  EXPECT_THAT(fb_last_error(), HasSubstr("joints must be 2, as the leader has, got 3"));
  EXPECT_THAT(torque, Each(0));
  EXPECT_EQ(fb_leader_step(leader.get(), nullptr, feedback.data(), 0.005, torque.data(), 2), FB_INVALID);
  EXPECT_EQ(fb_leader_step(leader.get(), position.data(), feedback.data(), 0.005, nullptr, 2), FB_INVALID);
  EXPECT_EQ(fb_leader_step(nullptr, position.data(), feedback.data(), 0.005, torque.data(), 2), FB_INVALID);
  EXPECT_EQ(state_of(leader).calls_refused, 3U);
  EXPECT_EQ(state_of(leader).readings_lost, 6U);
  EXPECT_LT(state_of(leader).energy_J_least, energy_J);
  ASSERT_EQ(fb_leader_step(leader.get(), position.data(), feedback.data(), 0.005, torque.data(), 2), FB_OK);
  EXPECT_LT(torque[0], 0) << "what was saved is not lost";
}

TEST(LibraryLeader, CountsWhatIsWrongAtRunTime) {
  const Leader leader = make({servo()});
  double torque_N_m = 9;
  const auto step = [&](double position_rad, const double* feedback_N_m, double interval_s) {
    EXPECT_EQ(fb_leader_step(leader.get(), &position_rad, feedback_N_m, interval_s, &torque_N_m, 1), FB_OK);
    EXPECT_EQ(torque_N_m, 0);
  };
  const double much_N_m = 100;
  step(0, nullptr, 0);
  step(test::kNaN, &much_N_m, 0.005);
  step(0, &test::kNaN, 0.005);
  step(0, nullptr, 1);
  step(0, nullptr, -1);
  EXPECT_EQ(fb_leader_write_failed(leader.get()), FB_OK);
  const fb_leader_state state = state_of(leader);
  EXPECT_EQ(state.readings_lost, 1U);
  EXPECT_EQ(state.feedback_not_finite, 1U);
  EXPECT_EQ(state.late, 1U);
  EXPECT_EQ(state.intervals_impossible, 1U);
  EXPECT_EQ(state.writes_failed, 1U);
}

TEST(LibraryLeader, GivesGoalsToServosThatTakeThem) {
  fb_leader_joint joint = servo();
  joint.goal_stiffness_N_m_per_rad = 0.5;
  joint.speed_rad_per_s_max = 30;
  const Leader leader = make({joint, servo()});
  std::array<double, 2> position{}, torque{}, goal{9, 9};
  const std::array<double, 2> feedback{-1, -1};
  for (int n = 0; n < 200; ++n) {
    position.fill(0.005 * n);
    ASSERT_EQ(fb_leader_step(leader.get(), position.data(), feedback.data(), 0.005, torque.data(), 2), FB_OK);
  }
  ASSERT_EQ(fb_leader_goals(leader.get(), goal.data(), 2), FB_OK);
  EXPECT_LT(torque[0], 0);
  EXPECT_DOUBLE_EQ(goal[0], position[0] + torque[0] / 0.5);
  EXPECT_TRUE(std::isnan(goal[1]));
  EXPECT_EQ(fb_leader_goals(leader.get(), goal.data(), 1), FB_INVALID);
}

TEST(LibraryLeader, AStepDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const Leader leader = make(std::vector<fb_leader_joint>(6, servo()));
  std::array<double, 6> position{}, torque{};
  const std::array<double, 6> feedback{1, -1, 1, -1, 1, -1};
  fb_leader_state state = FB_INIT(fb_leader_state);
  const test::AllocationGuard guard;
  for (int n = 0; n < 100; ++n) {
    position.fill(1e-3 * n);
    (void)fb_leader_step(leader.get(), position.data(), n % 7 == 0 ? nullptr : feedback.data(), 0.005, torque.data(),
                         6);
    (void)fb_leader_look(leader.get(), &state);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::library
