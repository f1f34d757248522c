#include "tests/tools/lab/teleoperation/teleoperation_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "forcebound/control/translation.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/server/follower/follower_environment.hpp"
#include "tests/tools/lab/teleoperation/last_tick.hpp"
#include "tests/tools/lab/teleoperation/lurch_meter.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;
using time::Nanoseconds;

/// Slope of force over depth, by least squares.
class Slope {
 public:
  void add(double depth_m, double force_N) noexcept {
    ++count_;
    depth_ += depth_m;
    force_ += force_N;
    squares_ += depth_m * depth_m;
    products_ += depth_m * force_N;
  }
  [[nodiscard]] double stiffness_N_per_m() const noexcept {
    const double spread = squares_ - depth_ * depth_ / count_;
    constexpr double kSpreadLeast = 1e-9;  // of depths: less tells nothing
    if (count_ < 50 || spread / count_ < kSpreadLeast) return std::numeric_limits<double>::quiet_NaN();
    return (products_ - depth_ * force_ / count_) / spread;
  }

 private:
  double count_ = 0;
  double depth_ = 0;
  double force_ = 0;
  double squares_ = 0;
  double products_ = 0;
};

/// Milliseconds that a leader's motion needs to reach the tool at the most, through a recording in general.
std::size_t reach_ms(const sim::SimulatedNetworkSettings& network) {
  constexpr Nanoseconds kTool = 100ms;  // its own, behind its target
  constexpr Nanoseconds kRecorded = 100ms;
  const Nanoseconds way = network.trace ? kRecorded : network.up.delay.mean + 2 * network.up.delay.jitter;
  return static_cast<std::size_t>((kTool + way) / 1ms);
}

class Measuring {
 public:
  Measuring(const TeleoperationSetup& setup, const server::Follower& follower, const server::TaskRobot& robot)
      : setup_(setup), follower_(follower), robot_(robot), lurch_(reach_ms(setup.network.settings)) {
    measures_.leader_kept_minimum_J = 0;
  }

  TeleoperationMoment measure(sim::ClosedLoop& loop, Nanoseconds time, const record::TickRecord& tick) {
    const server::FollowerReport& report = follower_.report();
    const server::TaskProgress progress = robot_.progress();
    const server::WorkspaceMap& map = report.map;
    TeleoperationMoment now{.time_s = time::to_seconds(time), .state = report.state};
    const control::Vector leader = loop.device().truth().position;
    now.leader_m = map.tool_of({.position = leader}).position;
    now.tool_m = progress.tool.position;
    now.tool_speed_m_per_s = progress.tool_velocity.head<3>().norm();
    now.contact_N = progress.force_N.norm();
    const Eigen::Vector3d applied = control::translation_of(tick.applied);
    now.shown_N = applied.norm();
    const Eigen::Vector3d shown_in_world = map.settings().rotation * applied / map.settings().force_scale;
    now.shown_in_world_N = shown_in_world;
    now.shown_along_N = shown_in_world.dot(setup_.task.normal);
    const double kept_J = loop.device().audit()->energy_J - loop.session().law().energy_given_J();
    measures_.leader_kept_minimum_J = std::min(measures_.leader_kept_minimum_J, kept_J);
    if (report.state != control::FollowerState::following) return now;
    const server::FollowerTotals totals = follower_.totals();
    lurch_.add({.leader_m_per_s = map.settings().motion_scale * loop.device().truth().velocity.norm(),
                .tool_m_per_s = now.tool_speed_m_per_s,
                .lag_m = totals.lag_m,
                .withheld = totals.bounded > bounded_});
    bounded_ = totals.bounded;
    ++following_;
    tracking_ += (now.leader_m - now.tool_m).squaredNorm();
    if (progress.in_contact || now.shown_N > kFelt_N) {
      ++in_contact_;
      force_ += (shown_in_world + progress.force_N).squaredNorm();
    }
    // The depth of the hand's own place, as it is felt: what a person judges stiffness by.
    if (progress.in_contact && now.shown_along_N > kFelt_N) {
      slope_.add(-now.leader_m.dot(setup_.task.normal), now.shown_along_N);
    }
    return now;
  }

  TeleoperationMeasures finish(const sim::ClosedLoop& loop) {
    const server::TaskProgress progress = robot_.progress();
    const server::FollowerTotals totals = follower_.totals();
    measures_.leader_minimum_J = loop.device().audit()->minimum_J;
    measures_.follower_minimum_J = totals.port.minimum_J;
    measures_.given_J = loop.session().law().energy_given_J();
    measures_.received_J = totals.received_J;
    measures_.tracking_rms_m = following_ > 0 ? std::sqrt(tracking_ / following_) : kUnknown;
    measures_.force_error_rms_N = in_contact_ > 0 ? std::sqrt(force_ / in_contact_) : kUnknown;
    measures_.stiffness_ratio =
        setup_.task.stiffness_N_per_m > 0 ? slope_.stiffness_N_per_m() / setup_.task.stiffness_N_per_m : kUnknown;
    measures_.peak_N = progress.peak_N;
    measures_.succeeded = progress.succeeded;
    measures_.completed_s = progress.succeeded ? progress.succeeded_s - ScriptOperator::kRest_s : kUnknown;
    measures_.measure = progress.measure;
    measures_.goal = progress.goal;
    measures_.stops = totals.stops;
    measures_.why_stopped = totals.why_stopped;
    measures_.bounded_share =
        totals.ticks > 0 ? static_cast<double>(totals.bounded) / static_cast<double>(totals.ticks) : 0;
    measures_.lag_m_max = totals.lag_m_max;
    measures_.lurch_m_per_s = lurch_.excess_m_per_s();
    return measures_;
  }

 private:
  static constexpr double kFelt_N = 0.3;
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  const TeleoperationSetup& setup_;
  const server::Follower& follower_;
  const server::TaskRobot& robot_;
  TeleoperationMeasures measures_;
  Slope slope_;
  LurchMeter lurch_;
  std::uint64_t bounded_ = 0;
  double following_ = 0;
  double tracking_ = 0;
  double in_contact_ = 0;
  double force_ = 0;
};

/// Virtual time: choosing takes none.
class StoppedClock final : public time::Clock {
 public:
  [[nodiscard]] Nanoseconds now() const noexcept override { return Nanoseconds::min(); }
};

}  // namespace

TeleoperationMeasures run_teleoperation(const TeleoperationSetup& setup, std::vector<TeleoperationMoment>* moments) {
  const StoppedClock clock;
  auto robot = std::make_unique<FlawedRobot>(server::make_robot(setup.task, setup.seed), setup.flaws);
  const server::TaskRobot& at_work = *robot;
  server::FollowerSettings settings = setup.follower;
  settings.law = setup.law;
  if (setup.law != "fba-exact") settings.initial_J.reset();
  const control::LawRegistry laws = law_plugin::known_laws();
  const auto follower = std::make_shared<server::Follower>(std::move(robot), settings, laws, clock);
  const auto runner = std::make_shared<server::StepwiseRunner>(follower, Nanoseconds{0});

  ScriptOperator::Settings hand{.workspace = settings.workspace,
                                .degrees_of_freedom = setup.device.facts.degrees_of_freedom(),
                                .seed = setup.seed};
  if (setup.hand.stiffness_N_per_m > 0) hand.hand = setup.hand;
  const double script_s = ScriptOperator(setup.task, hand).duration_s();
  LastTick last;
  sim::ClosedLoop::Settings loop_settings{
      .device = setup.device,
      .hand = {},
      .make_hand = [&]() -> std::unique_ptr<const device::Operator> {
        if (setup.make_hand) return setup.make_hand();
        return std::make_unique<ScriptOperator>(setup.task, hand);
      },
      .law = setup.law,
      .scene = nullptr,
      .network = setup.network.settings,
      .seed = setup.seed,
      .own_environment =
          server::follower_environment(setup.task.name, setup.task.summary, setup.task.degrees_of_freedom, runner),
      .faults = setup.faults,
      .renders_locally = settings.architecture == "model-mediated",
      .force_slew_N_per_s = setup.force_slew_N_per_s};
  loop_settings.network.seed = setup.seed;
  sim::ClosedLoop loop(std::move(loop_settings), {&last});
  Measuring measuring(setup, *follower, at_work);
  const double duration_s = setup.duration_s > 0 ? setup.duration_s : script_s + 1;
  Nanoseconds robots{0};
  for (const Nanoseconds end = time::from_seconds(duration_s); loop.time() < end;) {
    loop.run(1ms);
    // A client that stalls does not stop the robot.
    for (; robots <= loop.time(); robots += 1ms) {
      runner->live_until(robots);
      const TeleoperationMoment moment = measuring.measure(loop, robots, last.tick());
      if (moments != nullptr) moments->push_back(moment);
    }
  }
  return measuring.finish(loop);
}

}  // namespace forcebound::lab
