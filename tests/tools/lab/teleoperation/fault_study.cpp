#include "tests/tools/lab/teleoperation/fault_study.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "forcebound/results/summary_cells.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;
using control::FollowerState;
using Kind = sim::ClosedLoop::Fault::Kind;

constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();
// While the hand of the task presses.
constexpr auto kFrom = 6s;
constexpr auto kLength = 2s;
constexpr double kDuration_s = 12;

struct NamedFault {
  std::string name;
  std::function<void(TeleoperationSetup&)> inject;
};

std::function<void(TeleoperationSetup&)> network_fault(Kind kind) {
  return [kind](TeleoperationSetup& setup) { setup.faults.push_back({.kind = kind, .at = kFrom, .length = kLength}); };
}

std::vector<NamedFault> faults() {
  return {
      {"none", [](TeleoperationSetup& /*setup*/) {}},
      {"client stalls", network_fault(Kind::stall)},
      {"server killed", network_fault(Kind::server_killed)},
      {"way up dead", network_fault(Kind::blackout_up)},
      {"way down dead", network_fault(Kind::blackout_down)},
      {"both ways dead", network_fault(Kind::blackout)},
      {"robot unplugged",
       [](TeleoperationSetup& setup) { setup.flaws = {.unplugged_from = kFrom, .unplugged_until = kFrom + kLength}; }},
      {"readings freeze",
       [](TeleoperationSetup& setup) { setup.flaws = {.frozen_from = kFrom, .frozen_until = kFrom + kLength}; }},
      {"hand too deep", [](TeleoperationSetup& setup) {
         constexpr double kTooDeep_m = 0.04;
         const Eigen::Vector3d start = setup.task.target(0).position;
         for (server::ToolWaypoint& waypoint : setup.task.script) {
           const bool at_wall = (waypoint.position - start).dot(setup.task.normal) < -kTooDeep_m;
           if (at_wall) waypoint.position -= kTooDeep_m * setup.task.normal;
         }
       }}};
}

FaultRow row_of(const std::string& name, const std::vector<TeleoperationMoment>& moments,
                const TeleoperationMeasures& measures) {
  const double from_s = time::to_seconds(kFrom);
  const double until_s = from_s + time::to_seconds(kLength);
  FaultRow row{.fault = name,
               .holding_s = kNoTime,
               .stopping_s = kNoTime,
               .stopped_s = kNoTime,
               .hand_free_s = kNoTime,
               .following_s = kNoTime,
               .leader_minimum_J = measures.leader_minimum_J,
               .follower_minimum_J = measures.follower_minimum_J};
  const auto first = [](double& at, double since_s) { at = std::isnan(at) ? since_s : at; };
  double before_N = kNoTime;
  bool left = false;
  for (const TeleoperationMoment& now : moments) {
    if (now.time_s < from_s) {
      before_N = now.shown_N;
      continue;
    }
    const double since_s = now.time_s - from_s;
    left = left || now.state != FollowerState::following;
    if (now.state == FollowerState::holding) first(row.holding_s, since_s);
    if (now.state == FollowerState::stopping || now.state == FollowerState::failed) first(row.stopping_s, since_s);
    if (now.state == FollowerState::stopped) first(row.stopped_s, since_s);
    if (now.time_s < until_s && now.shown_N < 0.1) first(row.hand_free_s, since_s);
    if (left && now.time_s >= until_s && now.state == FollowerState::following) {
      first(row.following_s, now.time_s - until_s);
    }
    row.step_N_per_ms = std::max(row.step_N_per_ms, std::abs(now.shown_N - before_N));
    row.speed_m_per_s = std::max(row.speed_m_per_s, now.tool_speed_m_per_s);
    row.contact_N_max = std::max(row.contact_N_max, now.contact_N);
    before_N = now.shown_N;
  }
  return row;
}

std::string milliseconds(double seconds) { return std::isfinite(seconds) ? text::fixed(1e3 * seconds, 0) : "-"; }

}  // namespace

std::vector<FaultRow> study_faults(const TeleoperationStudy& study) {
  std::vector<FaultRow> rows;
  for (const NamedFault& fault : faults()) {
    TeleoperationSetup setup = setup_of(study, study.tasks.front(), study.architectures.front(), study.laws.front(),
                                        study.networks.front(), 1);
    setup.duration_s = kDuration_s;
    fault.inject(setup);
    std::vector<TeleoperationMoment> moments;
    const TeleoperationMeasures measures = run_teleoperation(setup, &moments);
    rows.push_back(row_of(fault.name, moments, measures));
  }
  return rows;
}

std::string fault_text(const std::vector<FaultRow>& rows) {
  text::Table table({{"fault"},
                     {"hold", "ms"},
                     {"stop", "ms"},
                     {"rest", "ms"},
                     {"free", "ms"},
                     {"again", "ms"},
                     {"step", "N/ms"},
                     {"speed", "mm/s"},
                     {"contact", "N"},
                     {"P", "mJ"}});
  for (const FaultRow& row : rows) {
    table.add({row.fault, milliseconds(row.holding_s), milliseconds(row.stopping_s), milliseconds(row.stopped_s),
               milliseconds(row.hand_free_s), milliseconds(row.following_s), text::fixed(row.step_N_per_ms, 2),
               text::fixed(1e3 * row.speed_m_per_s, 0), text::fixed(row.contact_N_max, 1),
               results::millijoules(std::min(row.leader_minimum_J, row.follower_minimum_J))});
  }
  return table.to_text() +
         "\n  The fault lasts from 6 to 8 s, while the tool presses on the wall; a hand\n"
         "  too deep asks for 40 mm more, beyond the robot's largest force, all the time.\n"
         "  hold, stop, rest  after its beginning the robot holds its place, is being\n"
         "                    stopped, is at rest; free: the hand feels less than 0.1 N\n"
         "  again             after its end the robot follows again: both ends agreed\n"
         "  step, speed, contact  largest from the fault on: change of the force on the\n"
         "                    hand within a millisecond, speed of the tool, contact force\n"
         "  P                 least of both sides\n";
}

}  // namespace forcebound::lab
