#include "forcebound/server/app/led_follower.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include "forcebound/server/follower/follower_environment.hpp"
#include "forcebound/server/robot/robot_kinds.hpp"
#include "forcebound/server/robot/task.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::server {
namespace {

// Of the sensor's noise and bias: each run of a server has the same.
constexpr std::uint64_t kSeed = 1;

std::string duration_text(Nanoseconds duration) {
  const double s = time::to_seconds(duration);
  return s < 1 ? fmt::format("{:.0f} ms", s * 1e3) : text::rounded(s) + " s";
}

std::string timer_text(const record::IdleTimer& timer) {
  if (timer.wake_ups == 0) return "not measured";
  return text::rounded(timer.p50_us, 4) + " us median, " + text::rounded(timer.p99_us, 4) + " p99, " +
         text::rounded(timer.max_us, 4) + " max; " + std::to_string(timer.late) + " late";
}

std::string millijoules(double energy_J) {
  const std::string number = text::rounded(energy_J * 1e3);
  return (number == "-0" ? "0" : number) + " mJ";
}

std::string port_text(const FollowerTotals& totals) {
  if (!totals.audited) return "not audited: this robot does not measure P";
  return "least P and store " + millijoules(totals.port.minimum_J) + ", final " + millijoules(totals.port.energy_J) +
         "; store at the start " + millijoules(totals.initial_J) + "; received from the leader's law " +
         millijoules(totals.received_J);
}

std::string states_text(const FollowerThread::Outcome& outcome) {
  std::string text;
  for (std::uint8_t i = 0; i < control::kFollowerStates; ++i) {
    const Nanoseconds time = outcome.in_state.at(i);
    if (time == Nanoseconds{0}) continue;
    text +=
        (text.empty() ? "" : ", ") + std::string(name_of(static_cast<FollowerState>(i))) + " " + duration_text(time);
  }
  return text;
}

std::string task_text(const Task& task, const TaskRobot& robot) {
  const TaskProgress progress = robot.progress();
  std::string text = task.measure + ": " + text::rounded(progress.measure) + " of " + text::rounded(progress.goal);
  text += progress.succeeded ? ", reached after " + text::rounded(progress.succeeded_s) + " s" : ", not reached";
  return text + "; largest contact force " + text::rounded(progress.peak_N) + " N";
}

spdlog::level::level_enum level_of(FollowerState state) noexcept {
  using enum FollowerState;
  if (state == failed) return spdlog::level::err;
  return state == holding || state == stopping ? spdlog::level::warn : spdlog::level::info;
}

}  // namespace

std::string in_words(const StateChange& change) {
  using enum FollowerState;
  std::string text = std::string(name_of(change.from)) + " -> " + std::string(name_of(change.to)) + " after " +
                     duration_text(change.lasted);
  if (change.to == stopping || change.by_robot()) text += ": " + std::string(change.why_stopped);
  if (change.by_robot() && change.robot_error.front() != '\0')
    text += ": " + text::printable(change.robot_error.data());
  if (change.to == holding || change.to == stopping) {
    text += change.silent ? "; the leader was last heard " + duration_text(*change.silent) + " ago"
                          : std::string("; nobody leads");
  }
  if (change.to == stopped) text += "; it follows again once its leader engages";
  if (change.to != following) return text;
  if (change.bias_age) text += "; its sensor's bias was learned " + duration_text(*change.bias_age) + " ago";
  if (change.grip_waits) text += "; the gripper stays until its leader's own grip has met where it stands";
  return text;
}

std::string in_words(const SensorBias::Status& bias) {
  const std::string off = text::rounded(bias.off_N) + " N ";
  std::string text = "its sensor's bias " + std::string(words_of(bias.answer));
  if (bias.answer == SensorBias::Answer::learned) text += ", " + off + "from before";
  if (bias.answer == SensorBias::Answer::touches) text += " (" + off + "more than untouched)";
  return text;
}

std::string in_words(const FollowerThread::Outcome& outcome) {
  const FollowerTotals& totals = outcome.totals;
  std::string text = "  passivity: " + port_text(totals) + "\n";
  const double ticks = std::max<double>(1, static_cast<double>(totals.ticks));
  text += "  law: shortened the torques on " + text::rounded(1e2 * static_cast<double>(totals.bounded) / ticks) +
          " % of " + text::counted(totals.ticks, "tick") + "\n";
  text += "  lag: the tool " + text::rounded(totals.lag_m_max * 1e3) +
          " mm behind its leader at most; offset taken anew by " + text::rounded(totals.offset_drift_m * 1e3) +
          " mm after pauses\n";
  text += "  states: " + states_text(outcome) + "\n";
  text += "  stops: " + std::to_string(totals.stops) +
          (totals.stops > 0 ? ", the last because " + std::string(totals.why_stopped) : "") + "; at the end " +
          (outcome.at_rest ? "at rest" : "NOT AT REST, its brakes are on") + "\n";
  text += "  period: " + timer_text(outcome.loop) + ", " + std::to_string(outcome.missed_ticks) + " missed\n";
  text += "  idle timer: " + timer_text(outcome.idle) + "\n";
  for (const control::ReadingStatusRow& row : control::kReadingStatuses) {
    const std::uint64_t count = row.status == control::ReadingStatus::ok ? 0 : totals.readings[row.status];
    if (count > 0) text += "  faults: " + std::to_string(count) + " " + (count == 1 ? row.one : row.many) + "\n";
  }
  if (outcome.allocations > 0) {
    text += "  faults: " + text::counted(outcome.allocations, "allocation") + " in the robot's loop\n";
  }
  return text;
}

std::string loss_in_words(const RobotGuard& guard, const std::string& robot) {
  if (const std::string_view crash = guard.crash(); !crash.empty()) {
    return robot + ": " + text::printable(crash) + "; the server ends";
  }
  return "the driver of robot " + robot + " has not returned from a call for 2 s; " +
         (guard.stopped() ? "the robot was stopped" : "its stop does not return either, so that a torque may be left") +
         "; the server ends";
}

namespace {

/// Set up by the command line.
class LedFollower final : public LedRobot {
 public:
  LedFollower(FollowerOptions options, const control::LawRegistry& laws, const time::Clock& clock,
              std::optional<int> priority);

  [[nodiscard]] EnvironmentKind environment() const override;
  [[nodiscard]] std::string summary() const override;
  [[nodiscard]] const view::Description& appearance() const noexcept override { return *appearance_->description(); }
  [[nodiscard]] std::size_t sample(std::size_t group, std::span<float> to) noexcept override {
    return appearance_->sample(thread_->newest(), group, 0, to);
  }
  void log_changes() override;
  void learn_bias() noexcept override { thread_->learn_bias(); }
  void stop() override;
  [[nodiscard]] bool is_lost() const noexcept override { return thread_->is_lost(); }
  [[nodiscard]] bool has_crashed() const noexcept override {
    return thread_->trouble() == RobotGuard::Trouble::crashed;
  }
  [[nodiscard]] std::string totals() const override;

 private:
  /// "robot at task", or the robot alone: by its own name, for the settings of its driver are nobody else's business.
  [[nodiscard]] std::string at_work() const;

  FollowerOptions options_;
  std::optional<Task> task_;  ///< none: the robot has work of its own
  std::string name_{};        ///< of the robot
  bool reported_lost_ = false;
  std::uint64_t bias_answers_ = 0;  ///< logged
  std::shared_ptr<FollowerThread> thread_;
  std::shared_ptr<const FollowerAppearance> appearance_;
};

LedFollower::LedFollower(FollowerOptions options, const control::LawRegistry& laws, const time::Clock& clock,
                         std::optional<int> priority)
    : options_(std::move(options)) {
  std::unique_ptr<Robot> robot;
  if (is_driven(options_.robot)) {
    robot = make_driven(options_.robot);
    spdlog::info("robot: {}", robot->facts_in_words());
    name_ = robot->facts().name;
  } else {
    task_ = load_task(options_.task);
    name_ = options_.robot;
    robot = find_robot(options_.robot).make(*task_, kSeed);
  }
  auto follower = std::make_unique<Follower>(std::move(robot), options_.settings, laws, clock);
  appearance_ = std::make_shared<const FollowerAppearance>(follower->robot().model(), task_ ? &*task_ : nullptr,
                                                           options_.settings, follower->robot().audit().has_value());
  thread_ =
      std::make_shared<FollowerThread>(std::move(follower), clock, FollowerThread::Settings{.priority = priority});
  if (priority) spdlog::info("robot's loop: {}", thread_->grant());
}

EnvironmentKind LedFollower::environment() const {
  constexpr int kDegreesOfFreedom = 3;  // of what a robot's tool does unless it is known
  return follower_environment(task_ ? task_->name : "robot", summary(),
                              task_ ? task_->degrees_of_freedom : kDegreesOfFreedom, thread_, appearance_);
}

std::string LedFollower::summary() const {
  return "robot " + (task_ ? at_work() + " (" + task_->summary + ")" : at_work()) + ", " +
         options_.settings.architecture + ", law " + options_.settings.law;
}

std::string LedFollower::at_work() const { return task_ ? name_ + " at " + task_->name : name_; }

void LedFollower::log_changes() {
  while (const auto change = thread_->take_change()) spdlog::log(level_of(change->to), "robot: {}", in_words(*change));
  const SensorBias::Status& bias = thread_->newest().bias;
  if (bias.answers != std::exchange(bias_answers_, bias.answers)) {
    const bool learned = bias.answer == SensorBias::Answer::learned;
    spdlog::log(learned ? spdlog::level::info : spdlog::level::warn, "robot: {}", in_words(bias));
  }
  if (!is_lost() || std::exchange(reported_lost_, true)) return;
  spdlog::error("robot: {}", loss_in_words(*thread_->guard(), at_work()));
}

void LedFollower::stop() {
  const FollowerThread::Outcome& outcome = thread_->stop();
  log_changes();
  if (!outcome.at_rest && !is_lost()) spdlog::error("robot: not at rest at the end; its brakes are on");
}

std::string LedFollower::totals() const {
  if (is_lost()) return "robot: " + loss_in_words(*thread_->guard(), at_work()) + "\n";
  std::string text = "robot: " + at_work() + ", " + options_.settings.architecture + ", law " + options_.settings.law +
                     "\n" + in_words(thread_->stop());
  if (const auto* const robot = dynamic_cast<const TaskRobot*>(&std::as_const(*thread_).follower().robot());
      robot != nullptr && task_) {
    text += "  task: " + task_text(*task_, *robot) + "\n";
  }
  return text;
}

}  // namespace

std::unique_ptr<LedRobot> start_follower(const FollowerOptions& options, const control::LawRegistry& laws,
                                         const time::Clock& clock, std::optional<int> priority) {
  return std::make_unique<LedFollower>(options, laws, clock, priority);
}

}  // namespace forcebound::server
