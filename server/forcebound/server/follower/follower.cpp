#include "forcebound/server/follower/follower.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/exact_law.hpp"
#include "forcebound/server/follower/initial_energy.hpp"

namespace forcebound::server {
namespace {

// Readings lost in a row until the robot counts as one that refuses, or samples that its architecture needs.
constexpr int kLostMost = 50;
constexpr double kStill_m_per_s = 0.015;  // a tremor passes
// No hand is farther from its device's middle.
constexpr double kFarthest_m = 10;
constexpr double kAtRest = 0.02;  // of a joint [rad/s], [m/s]
// A tool or joint this much faster than its largest speed is stopped,
constexpr double kTooFast = 1.5;
// and a joint so far beyond its limits, whose springs did not keep it [rad], [m].
constexpr double kOutside = 0.1;
// How fast a lack of energy is noticed, and what it does.
constexpr double kShortage_s = 0.05;
constexpr double kTow_N_per_m = 1000;
constexpr double kTowSlack_m = 2e-3;
constexpr double kBegin_per_s = 5;  // the share of the reflection grows,
constexpr double kEnd_per_s = 20;   // and ends

void check_above_zero(const char* what, double value) {
  if (value > 0 && std::isfinite(value)) return;
  control::ClassicText text;
  text << what << " must be > 0, got " << value;
  throw std::invalid_argument(text.str());
}

double initial_J(const FollowerSettings& settings, const Robot& robot) {
  if (settings.law != "fba-exact") {
    if (settings.initial_J.value_or(0) == 0) return 0;
    throw std::invalid_argument(
        "law '" + settings.law +
        "' cannot begin with a store: --robot-store must be 0 or left out, or the law fba-exact");
  }
  const double most_J = std::min(largest_initial_J(robot.model()), settings.store_J);
  if (!settings.initial_J) return find_architecture(settings.architecture).initial_share * most_J;
  // The most as it is told below may be rounded up.
  if (*settings.initial_J >= 0 && *settings.initial_J <= most_J * (1 + 1e-5))
    return std::min(*settings.initial_J, most_J);
  control::ClassicText text;
  text << "--robot-store, with which robot '" << robot.facts().name << "' begins, must be 0 to " << most_J
       << " J, which its own mass has at its speed limit of " << robot.model().limits().tool_speed_m_per_s_max
       << " m/s, got " << *settings.initial_J;
  throw std::invalid_argument(text.str());
}

const FollowerSettings& checked(const FollowerSettings& settings, const Robot& robot) {
  check_above_zero("energy that the robot keeps [J]", settings.store_J);
  check_above_zero("largest speed of the tool's target [m/s]", settings.approach_m_per_s_max);
  check_above_zero("largest turning speed of the tool's target [rad/s]", settings.turn_rad_per_s_max);
  check_above_zero("largest contact force [N]", settings.contact_N_max);
  check_above_zero("silence until the robot holds its place [s]", time::to_seconds(settings.times.hold));
  check_above_zero("time for which a device is kept still [s]", time::to_seconds(settings.times.still));
  if (settings.times.stop < settings.times.hold) {
    throw std::invalid_argument("silence until the robot stops must be at least that until it holds its place");
  }
  for (const int button : {settings.clutch_button, settings.grip_button}) {
    if (button >= 0 && button < control::Handle::kButtons) continue;
    throw std::invalid_argument("buttons have the numbers 0 to 31, got " + std::to_string(button));
  }
  if (find_architecture(settings.architecture).needs_sensor && !robot.force_sensor()) {
    throw std::invalid_argument("architecture '" + settings.architecture + "' needs a force sensor, and robot '" +
                                robot.facts().name + "' has none: position-position needs none");
  }
  return settings;
}

std::unique_ptr<control::PassivityLaw> make_law(const FollowerSettings& settings, const control::LawRegistry& laws,
                                                const control::DeviceFacts& facts) {
  if (settings.law != "fba-exact") return laws.make(settings.law, facts);
  return std::make_unique<control::ExactLaw>(facts, control::EnergyMemory::capped,
                                             control::Spending{.memory_J_max = settings.store_J});
}

}  // namespace

Follower::Follower(std::unique_ptr<Robot> robot, const FollowerSettings& settings, const control::LawRegistry& laws,
                   const time::Clock& clock)
    : settings_(checked(settings, *robot)),
      robot_(std::move(robot)),
      clock_(clock),
      period_(time::from_seconds(robot_->facts().period_s)),
      needs_sensor_(find_architecture(settings_.architecture).needs_sensor),
      impedance_(robot_->model(), find_architecture(settings.architecture).impedance),
      architecture_(find_architecture(settings.architecture).make(impedance_.settings())),
      bounder_(robot_->facts(), make_law(settings, laws, robot_->facts())),
      times_(*robot_),
      engagement_(settings.times),
      map_(settings.workspace),
      target_(settings.approach_m_per_s_max, settings.turn_rad_per_s_max),
      energy_(
          {.power_scale = map_.power_scale(), .most_J = settings.store_J, .initial_J = initial_J(settings_, *robot_)}),
      bias_(robot_->force_sensor()),
      unanswered_(*robot_),
      given_(Vector::Zero(robot_->facts().joints())) {
  report_.map = map_;
  bounder_.receive_energy(energy_.initial_J());
}

void Follower::begin_leader() noexcept {
  leader_.reset();
  leader_speed_m_per_s_ = 0;
  leader_is_new_ = true;
  energy_.begin();
}

void Follower::receive(const LeaderMotion& motion) noexcept {
  if (motion.position.cwiseAbs().maxCoeff() > kFarthest_m) {
    ++totals_.motions_refused;
    return;
  }
  if (leader_ && leader_->position.rows() == motion.position.rows()) {
    const double passed_s = time::to_seconds(motion.arrived - leader_->arrived);
    // Of motions that arrive together the last one counts: a burst is no sign of haste.
    if (passed_s > 0) {
      constexpr double kSmooth_s = 0.02;
      const double speed = (motion.position - leader_->position).norm() / passed_s;
      leader_speed_m_per_s_ += (1 - std::exp(-passed_s / kSmooth_s)) * (speed - leader_speed_m_per_s_);
    }
  }
  leader_ = motion;
}

void Follower::tick(Nanoseconds now) noexcept {
  ++totals_.ticks;
  const device::Reading read = robot_->read(now);
  if (times_.is_held_on(read, now)) return;
  const device::Reading reading = device::usable_or_lost(read, robot_->facts(), now, std::max(now, clock_.now()));
  if (const auto audit = robot_->audit()) energy_.update(*audit);
  if (leader_) bounder_.receive_energy(energy_.receive(leader_->energy_given_J));
  times_.begin_choosing(std::max(now, clock_.now()));
  const control::Motion motion = times_.motion_at(reading);
  const bool usable = judge(reading, now);
  const Vector request = usable ? within_rate(torque(reading, now)) : Vector::Zero(reading.position.rows());
  const bool free = usable && !robot_->is_stopped();
  const Vector chosen = free ? bounder_.tick(motion, request) : bounder_.release(motion);
  const Nanoseconds commanded = std::max(now, clock_.now());
  const Vector given = bounder_.confirmed(chosen, times_.command_at(reading, commanded));
  robot_->apply(commanded, given);
  given_ = given;
  refused_in_a_row_ = robot_->write_failed() && !robot_->is_stopped() ? refused_in_a_row_ + 1 : 0;
  update_report(request, given, now);
  if (usable) picture(reading, now);
}

/// What the robot does on this tick. @return whether the reading can be used
bool Follower::judge(const device::Reading& reading, Nanoseconds now) noexcept {
  const bool usable = reading.status == device::Reading::Status::ok;
  ++totals_.readings[reading.status];
  lost_ = reading.status;
  update_bias(now);
  const auto sensed = bias_.without(robot_->sensed_force());
  if (robot_->is_stopped()) {
    unanswered_.restart();
  } else if (usable) {
    unanswered_.update(reading, given_, sensed);
  }
  const ImpedanceController::Report& tool = impedance_.report();
  const FollowerState before = engagement_.state();
  const bool opens = brakes_open(reading, usable, now);
  const bool is_led = leader_ && !std::exchange(leader_is_new_, false);
  const FollowerState state =
      engagement_.update({.now = now,
                          .silent = is_led ? std::optional(now - leader_->arrived) : std::nullopt,
                          .has_buttons = leader_ && leader_->handle.buttons.has_value(),
                          .clutch_pressed = leader_ && leader_->handle.pressed(settings_.clutch_button),
                          .leader_still = leader_speed_m_per_s_ < kStill_m_per_s,
                          .robot_ready = is_ready(usable, sensed.has_value()),
                          .robot_at_rest = tool.velocity.cwiseAbs().maxCoeff() < kAtRest,
                          .robot_stopped = robot_->is_stopped() && !opens,
                          .reading_usable = usable,
                          .exceeded = sensed && sensed->head<3>().norm() > settings_.contact_N_max
                                          ? "the contact force is beyond its limit"
                                          : exceeded_limit(reading, usable)});
  if (state == before) return usable;
  const bool is_to_stop = state == FollowerState::stopping || state == FollowerState::failed;
  const bool by_itself =
      state == FollowerState::stopped && before != FollowerState::stopping && before != FollowerState::failed;
  if (is_to_stop || by_itself) {
    ++totals_.stops;
    totals_.why_stopped = engagement_.why_stopped();
  }
  if (is_to_stop) robot_->soft_stop(now);
  if (engagement_.begins()) {
    if (robot_->is_stopped()) robot_->resume(now);
    if (robot_->is_stopped()) resumed_ = now;
    if (before == FollowerState::holding) {
      const ToolPose pose = robot_->model().pose(reading.position);
      totals_.offset_drift_m += (map_.tool_of(*leader_).position - pose.position).norm();
    }
    begin_following(reading);
    // After a silence it is the same operator, whose grip was his own meanwhile.
    if (before != FollowerState::holding) grip_.begin(robot_->gripper());
  }
  return usable;
}

std::string_view Follower::last_error() const noexcept {
  const bool by_robot = lost_ == device::Reading::Status::ok || lost_ == device::Reading::Status::failed;
  const std::string_view reason = robot_->last_error();
  return by_robot && !reason.empty() ? reason : control::why(lost_);
}

/// Whether it tells where it is and what it touches, and takes commands.
bool Follower::is_ready(bool usable, bool sensed) noexcept {
  lost_in_a_row_ = usable ? 0 : lost_in_a_row_ + 1;
  unsensed_in_a_row_ = sensed || !needs_sensor_ ? 0 : unsensed_in_a_row_ + 1;
  return std::max({lost_in_a_row_, refused_in_a_row_, unsensed_in_a_row_}) < kLostMost;
}

/// Which limit the tool or a joint is beyond; empty: none.
std::string_view Follower::exceeded_limit(const device::Reading& reading, bool usable) const noexcept {
  const RobotLimits& limits = robot_->model().limits();
  const ImpedanceController::Report& seen = impedance_.report();
  const auto too_fast = [](double speed, double largest) { return largest > 0 && speed > kTooFast * largest; };
  if (too_fast(seen.velocity.head<3>().norm(), limits.tool_speed_m_per_s_max)) return "the tool is too fast";
  if (impedance_.turns() && too_fast(seen.velocity.tail<3>().norm(), limits.tool_turn_rad_per_s_max))
    return "the tool turns too fast";
  for (Eigen::Index i = 0; i < seen.joint_velocity.rows(); ++i) {
    if (too_fast(std::abs(seen.joint_velocity[i]), limits.speed_max[i])) return "a joint is too fast";
  }
  const bool is_outside = usable && (((reading.joint - limits.highest).array() > kOutside).any() ||
                                     ((limits.lowest - reading.joint).array() > kOutside).any());
  if (is_outside) return "a joint is beyond its limits";
  return unanswered_.frozen() ? "no joint answers its torque: the readings are frozen" : "";
}

/// From where tool and leader are now, so that nothing jumps.
void Follower::begin_following(const device::Reading& reading) noexcept {
  const ToolPose pose = robot_->model().pose(reading.position);
  map_.engage(*leader_, pose);
  target_.restart(pose);
  architecture_->begin();
  impedance_.restart();
}

/// Whether its brakes are being opened, for somebody to follow; once they are open, it begins anew from there.
bool Follower::brakes_open(const device::Reading& reading, bool usable, Nanoseconds now) noexcept {
  if (!resumed_) return false;
  if (robot_->is_stopped()) {
    if (now - *resumed_ < kBrakesOpenWithin) return true;
    resumed_.reset();
    // Or they would open later, with nobody to hold the robot.
    robot_->soft_stop(now);
    return false;
  }
  if (!usable) return true;
  resumed_.reset();
  if (leader_) begin_following(reading);
  return false;
}

/// No torque changes faster than the robot lets it. What the law then takes away, it takes at once.
Vector Follower::within_rate(const Vector& torque) const noexcept {
  const Vector& fastest = robot_->model().limits().torque_rate_max;
  if (fastest.rows() != torque.rows()) return torque;
  const double period_s = time::to_seconds(period_);
  Vector limited = torque;
  for (Eigen::Index i = 0; i < torque.rows(); ++i) {
    if (!(fastest[i] > 0)) continue;
    const double most = fastest[i] * period_s;
    limited[i] = given_[i] + std::clamp(torque[i] - given_[i], -most, most);
  }
  return limited;
}

Vector Follower::torque(const device::Reading& reading, Nanoseconds now) noexcept {
  const FollowerState state = engagement_.state();
  if (robot_->is_stopped() || state == FollowerState::stopping) return impedance_.stopping_torque(reading);
  const double period_s = time::to_seconds(period_);
  const ToolPose tool = robot_->model().pose(reading.position);
  if (state == FollowerState::waiting) {
    if (!std::exchange(placed_, true)) {
      target_.restart(tool);
      map_.engage({.position = Vector::Zero(3)}, tool);  // for pictures, until somebody does
    }
    return impedance_.torque(reading, target_.rest(), tool);
  }
  if (state != FollowerState::following) return impedance_.torque(reading, target_.rest(), tool);
  grip(now);
  const ToolTarget& target = target_.move_to(map_.tool_of(*leader_), period_s);
  const ToolTarget asked = architecture_->ask({.now = now,
                                               .elapsed_s = period_s,
                                               .target = target,
                                               .tool = tool,
                                               .velocity = impedance_.report().velocity,
                                               .sensed = bias_.without(robot_->sensed_force())});
  return impedance_.torque(reading, asked, tool);
}

void Follower::grip(Nanoseconds now) noexcept {
  const control::Handle& handle = leader_->handle;
  std::optional<double> wanted = handle.gripper;
  if (!wanted && handle.buttons) wanted = handle.pressed(settings_.grip_button) ? 0.0 : 1.0;
  const auto opening = wanted ? grip_.follow(*wanted) : std::nullopt;
  if (opening) robot_->command_gripper(now, *opening);
}

void Follower::update_bias(Nanoseconds now) noexcept {
  const FollowerState state = engagement_.state();
  const auto opening = robot_->gripper();
  bias_.update({.now = now,
                .sensed = robot_->sensed_force(),
                .tool_m = impedance_.report().pose.position,
                .waits = state == FollowerState::waiting,
                .stands = state == FollowerState::stopped && robot_->is_stopped(),
                .holds = opening && grip_.holds(*opening)});
  report_.bias = bias_.status();
}

void Follower::update_report(const Vector& request, const Vector& given, Nanoseconds now) noexcept {
  constexpr double kShortened = 1e-6;
  const FollowerState state = engagement_.state();
  const bool follows = state == FollowerState::following;
  totals_.bounded += follows && (given - request).norm() > kShortened ? 1 : 0;
  if (follows) {
    totals_.lag_m = (target_.target().pose.position - impedance_.report().pose.position).norm();
    totals_.lag_m_max = std::max(totals_.lag_m_max, totals_.lag_m);
  }
  const double period_s = time::to_seconds(period_);
  report_.state = state;
  report_.share = std::clamp(report_.share + (follows ? kBegin_per_s : -kEnd_per_s) * period_s, 0.0, 1.0);
  const double missing = follows && request.norm() > 0 ? 1 - std::min(1.0, given.norm() / request.norm()) : 0;
  shortage_ += (1 - std::exp(-period_s / kShortage_s)) * (missing - shortage_);
  report_.reflection = architecture_->reflection();
  if (report_.reflection.tie_N_per_m == 0) {
    report_.reflection.tool_m = impedance_.report().pose.position;
    report_.reflection.tow_N_per_m = shortage_ * kTow_N_per_m;
    report_.reflection.tow_slack_m = kTowSlack_m;
  }
  report_.map = map_;
  report_.leader_lost = leader_ && now - leader_->arrived > settings_.times.stop;
}

std::optional<Nanoseconds> Follower::bias_age(Nanoseconds now) const noexcept {
  const auto& learned = bias_.status().learned;
  return learned ? std::optional(now - *learned) : std::nullopt;
}

void Follower::picture(const device::Reading& reading, Nanoseconds now) noexcept {
  const FollowerState state = engagement_.state();
  const Vector6 sensed = bias_.without(robot_->sensed_force()).value_or(Vector6::Zero());
  report_.picture = {.joint = reading.joint,
                     .opening = robot_->gripper().value_or(0),
                     .tool = impedance_.report().pose,
                     .block = robot_->block(),
                     .sensed_N = sensed.head<3>(),
                     .sensed_N_m = sensed.tail<3>(),
                     .leader_has_clutch = leader_ ? std::optional(leader_->handle.buttons.has_value()) : std::nullopt,
                     .lag_m = state == FollowerState::following ? totals_.lag_m : 0,
                     .drift_m = totals_.offset_drift_m,
                     .store_J = bounder_.law().energy_J(),
                     .received_J = energy_.received_J(),
                     .port = energy_.port(),
                     .grip_waits = state == FollowerState::following && grip_.waits(),
                     .bias_age = bias_age(now)};
}

FollowerTotals Follower::totals() const noexcept {
  FollowerTotals totals = totals_;
  totals.received_J = energy_.received_J();
  totals.initial_J = energy_.initial_J();
  ReceivedEnergy energy = energy_;
  if (const auto audit = robot_->audit()) {
    energy.update(*audit);
    totals.audited = true;
  }
  totals.port = energy.port();
  return totals;
}

}  // namespace forcebound::server
