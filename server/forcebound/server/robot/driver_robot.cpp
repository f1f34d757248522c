#include "forcebound/server/robot/driver_robot.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

// A joint so far beyond its limits has an encoder that is wrong.
constexpr double kBeyond_rad = 0.5;
constexpr int kPeriodsOfASample = 10;

/// A user's file beside what the driver tells: it may be stricter, and claims nothing that is not there.
class FileCheck {
 public:
  FileCheck(const RobotDescription& file, const forcebound_robot& told, const driver::DriverRequest& request)
      : file_(file), told_(told), request_(request) {}

  /// @throws std::runtime_error in one line
  void expect_to_match() const {
    if (file_.facts.joints() != told_.joints) refuse("joints:", file_.facts.joints(), "", told_.joints);
    at_least("period_s =", file_.facts.period_s, told_.period_s);
    at_least("hold_s_max =", file_.facts.hold_s_max, told_.hold_s_max);
    at_least("latency_s =", file_.facts.latency_s, told_.latency_s);
    at_least("stamp_s_most =", file_.facts.uncertainty.stamp_s.most, told_.stamp_s_most);
    const RobotLimits& limits = file_.chain.limits;
    at_most("tool_speed_m_per_s_max =", limits.tool_speed_m_per_s_max, told_.tool_speed_m_per_s_max);
    at_most("tool_turn_rad_per_s_max =", limits.tool_turn_rad_per_s_max, told_.tool_turn_rad_per_s_max);
    for (int i = 0; i < told_.joints; ++i) expect_joint_to_match(i);
    expect_equipment();
  }

 private:
  [[noreturn]] void refuse(const std::string& what, const std::string& but) const {
    throw std::runtime_error(request_.facts_file + ": " + what + ", but the robot of driver '" +
                             text::printable(request_.name) + "' " + but);
  }
  [[noreturn]] void refuse(const std::string& what, double got, const std::string& but, double theirs) const {
    refuse(what + " " + text::to_text(got), "has " + but + text::to_text(theirs));
  }
  /// Of two that mean the same, one may be rounded otherwise.
  static bool is_below(double value, double other) noexcept {
    constexpr double kRounding = 1e-9;
    return value < other - kRounding * std::abs(other);
  }
  void at_least(const std::string& what, double got, double theirs) const {
    if (is_below(got, theirs)) refuse(what, got, "at least ", theirs);
  }
  /// @param theirs 0: the driver does not tell
  void at_most(const std::string& what, double got, double theirs) const {
    if (theirs > 0 && is_below(theirs, got)) refuse(what, got, "at most ", theirs);
  }

  void expect_joint_to_match(int i) const {
    const std::string joint = " of joint " + std::to_string(i + 1) + " =";
    const RobotLimits& limits = file_.chain.limits;
    at_most("torque_N_m_max" + joint, limits.torque_max[i], told_.torque_max[i]);
    at_most("speed_rad_per_s_max" + joint, limits.speed_max[i], told_.speed_max[i]);
    const double rate = limits.torque_rate_max[i];
    if (told_.torque_rate_max[i] > 0 && !(rate > 0)) {
      refuse("torque_N_m_per_s_max" + joint, rate, "at most ", told_.torque_rate_max[i]);
    }
    at_most("torque_N_m_per_s_max" + joint, rate, told_.torque_rate_max[i]);
    if (!(told_.lowest_rad[i] < told_.highest_rad[i])) return;  // the driver does not tell
    at_least("lowest_rad" + joint, limits.lowest[i], told_.lowest_rad[i]);
    if (is_below(told_.highest_rad[i], limits.highest[i])) {
      refuse("highest_rad" + joint, limits.highest[i], "at most ", told_.highest_rad[i]);
    }
  }

  void expect_equipment() const {
    if (file_.compensates_gravity && told_.gravity != 0) {
      refuse("compensates_gravity = true", "leaves its weight to the program");
    }
    if (!file_.compensates_gravity && told_.gravity == 0) {
      refuse("compensates_gravity = false", "compensates its weight itself");
    }
    if (file_.brakes && told_.brakes == 0) refuse("brakes = true", "has none");
    if (file_.sensor && !(told_.sensor_period_s > 0)) refuse("[sensor] is there", "has no force sensor");
  }

  const RobotDescription& file_;
  const forcebound_robot& told_;
  const driver::DriverRequest& request_;
};

RobotDescription described(driver::OpenedDriver& opened, const driver::DriverRequest& request,
                           std::optional<RobotDescription> own) {
  forcebound_robot told{};
  told.size = sizeof told;
  const std::string name = opened.functions().name;
  if (opened.call("describe_robot", opened.functions().describe_robot, &told) != FORCEBOUND_OK) {
    throw std::runtime_error("driver '" + name + "' does not describe its robot");
  }
  if (!own) return description_of(told, name);
  FileCheck(*own, told, request).expect_to_match();
  return std::move(*own);
}

}  // namespace

DriverRobot::DriverRobot(std::shared_ptr<const driver::DriverLibrary> library, const driver::DriverRequest& request,
                         std::optional<RobotDescription> own)
    : opened_(std::move(library), request),
      about_(described(opened_, request, std::move(own))),
      chain_(about_.chain),
      damping_(control::Damping::from_matrix(about_.facts.damping)),
      place_(about_.chain.rest) {
  const Nanoseconds loop = time::from_seconds(about_.facts.period_s);
  if (about_.sensor) sample_counts_ = kPeriodsOfASample * std::max(about_.sensor->period, loop);
}

std::string DriverRobot::facts_in_words() const {
  const auto range = [](const Vector& rows) {
    return text::rounded(rows.minCoeff()) + " to " + text::rounded(rows.maxCoeff());
  };
  const control::DeviceFacts& facts = about_.facts;
  return facts.name + ": " + std::to_string(facts.joints()) + " joints, damping " + range(facts.damping.diagonal()) +
         " N m s/rad, largest torque " + range(chain_.limits().torque_max) + " N m, period " +
         text::rounded(1e3 * facts.period_s) + " ms, holds a torque for " + text::rounded(1e3 * facts.hold_s_max) +
         " ms" + (about_.identified ? "" : "; bounds not identified: guesses");
}

device::Reading DriverRobot::read(Nanoseconds now) noexcept {
  apply_stop_from_outside();
  forcebound_robot_reading told{};
  told.size = sizeof told;
  const int result = opened_.call("read_robot", table().read_robot, now.count(), &told);
  if (result == FORCEBOUND_OK || result == FORCEBOUND_STALE) store_reports(told, now);
  forget_old_sample(now);
  if (result == FORCEBOUND_OK) return reading_of(told, now);
  if (result == FORCEBOUND_STALE) return without_reading(device::Reading::Status::stale);
  store_failure(result, "no reading");
  return without_reading(device::Reading::Status::failed);
}

void DriverRobot::store_failure(int result, std::string_view what) noexcept {
  const bool unplugged = result == FORCEBOUND_UNPLUGGED;
  if (!opened_.store_failure(unplugged ? "the robot is unplugged" : what) && !unplugged) ++counters_.unexplained;
}

device::Reading DriverRobot::reading_of(const forcebound_robot_reading& told, Nanoseconds now) noexcept {
  const Nanoseconds latched{told.latched_ns};
  const device::Reading::Status in_time = times_.judge(latched, now);
  if (in_time == device::Reading::Status::stale) return without_reading(in_time);
  if (in_time != device::Reading::Status::ok) return refused(in_time, control::why(in_time));
  const int joints = about_.facts.joints();
  const Vector place = Eigen::Map<const Eigen::VectorXd>(told.position_rad, joints);
  constexpr auto kIncomplete = device::Reading::Status::incomplete;
  if (!place.allFinite()) return refused(kIncomplete, control::why(kIncomplete));
  const RobotLimits& limits = chain_.limits();
  if (((place - limits.highest).array() > kBeyond_rad).any() || ((limits.lowest - place).array() > kBeyond_rad).any()) {
    return refused(device::Reading::Status::failed, "a joint is far beyond its limits");
  }
  times_.accept(latched);
  place_ = place;
  device::Reading reading;
  reading.joint = place_;
  reading.position = place_;
  reading.jacobian = Matrix::Identity(joints, joints);
  reading.damping = &damping_;
  reading.latched = latched;
  reading.handle.gripper = gripper_;
  return reading;
}

/// What else it tells, as far as that can be true.
void DriverRobot::store_reports(const forcebound_robot_reading& told, Nanoseconds now) noexcept {
  if ((told.has & FORCEBOUND_HAS_EFFECTIVE) != 0 && !stopped_) {
    effective_at_ = told.effective_ns > 0 ? std::optional(Nanoseconds{told.effective_ns}) : std::nullopt;
    released_at_ = told.released_ns > 0 ? std::optional(Nanoseconds{told.released_ns}) : std::nullopt;
  }
  if ((told.has & FORCEBOUND_HAS_GRIPPER) != 0 && told.gripper >= 0 && told.gripper <= 1) gripper_ = told.gripper;
  if ((told.has & FORCEBOUND_HAS_SENSED) != 0 && about_.sensor) store_sensed(told, now);
  const bool energy = std::isfinite(told.energy_J) && std::isfinite(told.energy_J_least);
  if ((told.has & FORCEBOUND_HAS_ENERGY) != 0 && energy) {
    audit_ = control::PassivityAudit{.energy_J = told.energy_J, .minimum_J = told.energy_J_least};
  }
  if ((told.has & FORCEBOUND_IS_STOPPED) != 0) {
    apply_stop(now);
  } else if (resumed_) {
    stopped_ = false;
    resumed_.reset();
  }
}

void DriverRobot::store_sensed(const forcebound_robot_reading& told, Nanoseconds now) noexcept {
  const Eigen::Map<const Eigen::Vector3d> force(told.force_N);
  const Eigen::Map<const Eigen::Vector3d> torque(told.torque_N_m);
  const Nanoseconds sampled{told.sensed_ns};
  const bool possible = now - sampled <= sample_counts_ && sampled <= now + driver::ReadingTimes::kAhead;
  if (!possible || !force.allFinite() || !torque.allFinite()) return;
  // A sample out of turn says less than the one that is there.
  if (sensed_ && sampled < sensed_->sampled) return;
  sensed_ = SensedForce{.force_N = force, .torque_N_m = torque, .sampled = sampled};
}

/// A sensor that tells nothing new is as good as none.
void DriverRobot::forget_old_sample(Nanoseconds now) noexcept {
  if (!sensed_ || now - sensed_->sampled <= sample_counts_) return;
  sensed_.reset();
  opened_.store_error("its force sensor tells nothing new");
}

void DriverRobot::apply_stop(Nanoseconds now) noexcept {
  if (!stopped_) {
    opened_.store_error("the robot stopped itself");
    write_failed_ = true;
    // When it began to release the torque, as it tells; else until now at most.
    if (!released_at_) released_at_ = now;
  }
  stopped_ = true;
  if (!resumed_ || now - *resumed_ <= kBrakesOpenWithin) return;
  resumed_.reset();
  // Or they would open later, with nobody to hold the arm.
  (void)opened_.stop();
}

device::Reading DriverRobot::without_reading(device::Reading::Status status) const noexcept {
  const int joints = about_.facts.joints();
  return {.joint = place_,
          .position = place_,
          .jacobian = Matrix::Identity(joints, joints),
          .damping = &damping_,
          .latched = times_.newest().value_or(Nanoseconds{0}),
          .status = status};
}

device::Reading DriverRobot::refused(device::Reading::Status status, std::string_view why) noexcept {
  opened_.store_error(why);
  return without_reading(status);
}

void DriverRobot::apply(Nanoseconds now, const Vector& torque) noexcept {
  apply_stop_from_outside();
  if (stopped_) {
    write_failed_ = true;
    const bool opens = resumed_ && times_.newest();
    if (opens && !about_.compensates_gravity) (void)command(now, Vector::Zero(about_.facts.joints()));
    return;
  }
  if (!times_.newest()) {
    // Where it is, and so what would hold it, is not known.
    write_failed_ = true;
    return;
  }
  const int joints = about_.facts.joints();
  Vector given = Vector::Zero(joints);
  if (torque.rows() == joints && torque.allFinite()) {
    given = torque;
  } else {
    ++counters_.faulty_commands;
  }
  const double excess = given.cwiseQuotient(chain_.limits().torque_max).cwiseAbs().maxCoeff();
  if (excess > 1) given /= excess;
  effective_at_.reset();
  released_at_.reset();
  write_failed_ = !command(now, given);
}

/// Beyond gravity. @return whether the driver took it
bool DriverRobot::command(Nanoseconds now, const Vector& torque) noexcept {
  forcebound_robot_command command{};
  command.size = sizeof command;
  command.at_ns = now.count();
  Vector given = torque;
  if (!about_.compensates_gravity) given += chain_.gravity(place_);
  std::copy_n(given.data(), given.rows(), command.torque_N_m);
  if (opening_) {
    command.has = FORCEBOUND_HAS_GRIPPER;
    command.gripper = *opening_;
  }
  const int result =
      opened_.call("command_robot", table().command_robot, static_cast<const forcebound_robot_command*>(&command));
  if (result == FORCEBOUND_OK) return true;
  ++counters_.failed_writes;
  store_failure(result, "the command failed");
  return false;
}

void DriverRobot::command_gripper(Nanoseconds /*now*/, double opening) noexcept {
  if (std::isfinite(opening)) opening_ = std::clamp(opening, 0.0, 1.0);
}

void DriverRobot::soft_stop(Nanoseconds now) noexcept {
  if (stopped_ && !resumed_) return;
  stopped_ = true;
  resumed_.reset();
  write_failed_ = true;
  effective_at_.reset();
  // The torque has ended once this has returned, which takes less than a tick.
  if (opened_.stop()) released_at_ = now + time::from_seconds(about_.facts.period_s);
}

void DriverRobot::resume(Nanoseconds now) noexcept {
  if (!stopped_) return;
  const int result = opened_.call("resume", table().resume);
  if (result == FORCEBOUND_OK) {
    resumed_ = now;
  } else {
    (void)opened_.store_failure("its brakes do not open");
    // Or they might open later, with nobody to hold the arm.
    (void)opened_.stop();
  }
}

void DriverRobot::stop(Nanoseconds /*now*/) noexcept {
  stopped_from_outside_.store(true, std::memory_order_release);
  (void)opened_.stop();
}

void DriverRobot::apply_stop_from_outside() noexcept {
  if (!stopped_from_outside_.exchange(false, std::memory_order_acq_rel)) return;
  opened_.store_error(
      "its driver did not return from a call, or its loop got no time, for as long as the robot holds a torque");
  // The call that was in progress may have ended after that stop, with a torque or open brakes.
  (void)opened_.stop();
  stopped_ = true;
  resumed_.reset();
  write_failed_ = true;
  effective_at_.reset();
  // When the torque ended is not known exactly: the law takes the hold time.
  released_at_.reset();
}

}  // namespace forcebound::server
