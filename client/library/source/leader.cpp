#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <span>
#include <utility>

#include "forcebound/control/force_bounded_leader.hpp"
#include "library/source/errors.hpp"
#include "library/source/structs.hpp"

/// What fb_leader points at.
struct fb_leader {
  forcebound::control::ForceBoundedLeader leader;
  std::uint64_t calls_refused = 0;
};

namespace forcebound::library {
namespace {

constexpr std::size_t kJointLeast = sizeof(std::size_t);
constexpr std::size_t kJointsMost = 1000;  // beyond is no number of joints but rubbish

control::LeaderJoint joint_of(const fb_leader_joint& given) {
  control::LeaderJoint joint{.name = text_of(given.name),
                             .damping_N_m_s_per_rad = given.damping_N_m_s_per_rad,
                             .friction_N_m = given.friction_N_m,
                             .encoder_step_rad = given.encoder_step_rad,
                             .backlash_rad = given.backlash_rad,
                             .torque_N_m_max = given.torque_N_m_max,
                             .torque_step_N_m = given.torque_step_N_m,
                             .torque_gain_share = given.torque_gain_share,
                             .torque_ripple_share = given.torque_ripple_share,
                             .speed_rad_per_s_max = given.speed_rad_per_s_max,
                             .goal_stiffness_N_m_per_rad = given.goal_stiffness_N_m_per_rad};
  if (given.goal_rad_least == 0 && given.goal_rad_most == 0) return joint;
  joint.goal_rad_least = given.goal_rad_least;
  joint.goal_rad_most = given.goal_rad_most;
  return joint;
}

/// The loop without its joints; zeros stand for the standard value.
control::LeaderFacts facts_of(const fb_leader_settings& given) {
  control::LeaderFacts facts;
  if (given.period_s != 0) facts.period_s = given.period_s;
  facts.latency_s_max = given.latency_s_max;
  facts.read_s_max = given.read_s_max;
  facts.hold_s_max = given.hold_s_max;
  facts.watchdog_s_least = given.watchdog_s_least;
  if (given.clock_share != 0) facts.clock_share = given.clock_share;
  if (given.memory_J != 0) facts.memory_J = given.memory_J;
  return facts;
}

fb_status create(const fb_leader_joint* joints, std::size_t count, const fb_leader_settings* settings,
                 fb_leader** leader) {
  constexpr const char* kFunction = "fb_leader_create";
  control::LeaderFacts facts;
  if (settings != nullptr) {
    const Given<fb_leader_settings> given(kFunction, "fb_leader_settings", settings, sizeof(std::size_t));
    if (given.status() != FB_OK) return given.status();
    facts = facts_of(*given);
  }
  const fb_status status = take_each(kFunction, "fb_leader_joint", joints, count, kJointLeast,
                                     [&](const fb_leader_joint& joint) { facts.joints.push_back(joint_of(joint)); });
  if (status != FB_OK) return status;
  *leader = std::make_unique<fb_leader>(fb_leader{control::ForceBoundedLeader(std::move(facts))}).release();
  return FB_OK;
}

/// FB_OK where the arrays are as many numbers as the arm has joints.
fb_status expect_joints(const char* function, const fb_leader& leader, std::size_t joints) noexcept {
  if (joints == leader.leader.joints()) return FB_OK;
  std::array<char, 128> why{};
  (void)std::snprintf(why.data(), why.size(), "joints must be %zu, as the leader has, got %zu", leader.leader.joints(),
                      joints);
  return refused(function, why.data());
}

}  // namespace
}  // namespace forcebound::library

using namespace forcebound;  // NOLINT(google-build-using-namespace)

fb_status fb_leader_create(const fb_leader_joint* joints, size_t count, const fb_leader_settings* settings,
                           fb_leader** leader) {
  constexpr const char* kFunction = "fb_leader_create";
  if (joints == nullptr || leader == nullptr) return library::refused(kFunction, "joints or leader is null");
  if (count < 1 || count > library::kJointsMost) return library::refused(kFunction, "count must be 1 to 1000");
  return library::guarded(kFunction, [&] { return library::create(joints, count, settings, leader); });
}

void fb_leader_destroy(fb_leader* leader) { delete leader; }

fb_status fb_leader_step(fb_leader* leader, const double* position_rad, const double* feedback_N_m, double interval_s,
                         double* torque_N_m, size_t joints) {
  constexpr const char* kFunction = "fb_leader_step";
  if (torque_N_m != nullptr) std::fill_n(torque_N_m, std::min(joints, library::kJointsMost), 0.0);
  if (leader == nullptr) return library::refused(kFunction, "leader is null");
  fb_status status = library::expect_joints(kFunction, *leader, joints);
  if (status == FB_OK && (position_rad == nullptr || torque_N_m == nullptr)) {
    status = library::refused(kFunction, "position_rad or torque_N_m is null");
  }
  if (status != FB_OK) {
    ++leader->calls_refused;
    leader->leader.lose(interval_s);
    return status;
  }
  const std::span<const double> feedback(feedback_N_m, feedback_N_m == nullptr ? 0 : joints);
  leader->leader.step({position_rad, joints}, feedback, interval_s, {torque_N_m, joints});
  return FB_OK;
}

fb_status fb_leader_write_failed(fb_leader* leader) {
  if (leader == nullptr) return library::refused("fb_leader_write_failed", "leader is null");
  leader->leader.report_failed_write();
  return FB_OK;
}

fb_status fb_leader_goals(const fb_leader* leader, double* goal_rad, size_t joints) {
  constexpr const char* kFunction = "fb_leader_goals";
  if (leader == nullptr || goal_rad == nullptr) return library::refused(kFunction, "leader or goal_rad is null");
  const fb_status status = library::expect_joints(kFunction, *leader, joints);
  if (status != FB_OK) return status;
  for (std::size_t i = 0; i < joints; ++i) goal_rad[i] = leader->leader.goal_rad(i);
  return FB_OK;
}

fb_status fb_leader_look(const fb_leader* leader, fb_leader_state* state) {
  if (leader == nullptr) return library::refused("fb_leader_look", "leader is null");
  const control::ForceBoundedLeader::Counts counts = leader->leader.counts();
  fb_leader_state now{};
  now.energy_J_least = leader->leader.energy_J(0);
  for (std::size_t i = 1; i < leader->leader.joints(); ++i) {
    now.energy_J_least = std::min(now.energy_J_least, leader->leader.energy_J(i));
  }
  now.readings_lost = counts.readings_lost;
  now.feedback_not_finite = counts.feedback_not_finite;
  now.saturated = counts.saturated;
  now.intervals_impossible = counts.intervals_impossible;
  now.late = counts.late;
  now.writes_failed = counts.writes_failed;
  now.calls_refused = leader->calls_refused;
  return library::give("fb_leader_look", "fb_leader_state", now, state, offsetof(fb_leader_state, readings_lost));
}
