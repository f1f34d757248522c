#include "forcebound/server/robot/driver_robot.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

// Brakes that are not open by then stay closed.
constexpr Nanoseconds kOpensWithin = std::chrono::seconds{2};
// A joint so far beyond its limits has an encoder that is wrong.
constexpr double kBeyond_rad = 0.5;

/// @throws std::runtime_error in one line
void expect_to_match(const RobotDescription& file, const forcebound_robot& told, const driver::DriverRequest& request) {
  const auto refuse = [&](const std::string& what, double got, const std::string& but, double theirs) {
    throw std::runtime_error(request.facts_file + ": " + what + " " + text::to_text(got) +
                             ", but the robot of driver '" + text::printable(request.name) + "' has " + but +
                             text::to_text(theirs));
  };
  if (file.facts.joints() != told.joints) refuse("joints:", file.facts.joints(), "", told.joints);
  if (file.facts.period_s < told.period_s) refuse("period_s =", file.facts.period_s, "at least ", told.period_s);
  for (int i = 0; i < told.joints; ++i) {
    const std::string joint = " of joint " + std::to_string(i + 1) + " =";
    const double torque = told.torque_max[i];
    if (torque > 0 && file.chain.limits.torque_max[i] > torque) {
      refuse("torque_N_m_max" + joint, file.chain.limits.torque_max[i], "at most ", torque);
    }
    const double speed = told.speed_max[i];
    if (speed > 0 && file.chain.limits.speed_max[i] > speed) {
      refuse("speed_rad_per_s_max" + joint, file.chain.limits.speed_max[i], "at most ", speed);
    }
  }
}

RobotDescription described(const driver::OpenedDriver& opened, const driver::DriverRequest& request,
                           std::optional<RobotDescription> own) {
  forcebound_robot told{};
  told.size = sizeof told;
  const std::string name = opened.functions().name;
  if (opened.functions().describe_robot(opened.device(), &told) != FORCEBOUND_OK) {
    throw std::runtime_error("driver '" + name + "' does not describe its robot");
  }
  if (!own) return description_of(told, name);
  expect_to_match(*own, told, request);
  return std::move(*own);
}

}  // namespace

DriverRobot::DriverRobot(std::shared_ptr<const driver::DriverLibrary> library, const driver::DriverRequest& request,
                         std::optional<RobotDescription> own)
    : opened_(std::move(library), request),
      about_(described(opened_, request, std::move(own))),
      chain_(about_.chain),
      damping_(control::Damping::from_matrix(about_.facts.damping)),
      place_(about_.chain.rest) {}

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
  take_stop_from_outside();
  forcebound_robot_reading told{};
  told.size = sizeof told;
  const int result = opened_.call(table().read_robot, now.count(), &told);
  if (result == FORCEBOUND_OK || result == FORCEBOUND_STALE) note_reports(told, now);
  if (result == FORCEBOUND_OK) return reading_of(told, now);
  if (result == FORCEBOUND_STALE) return without_reading(device::Reading::Status::stale);
  note_failure(result, "no reading");
  return without_reading(device::Reading::Status::failed);
}

void DriverRobot::note_failure(int result, std::string_view what) noexcept {
  const bool unplugged = result == FORCEBOUND_UNPLUGGED;
  if (!opened_.note_failure(unplugged ? "the robot is unplugged" : what) && !unplugged) ++counters_.unexplained;
}

device::Reading DriverRobot::reading_of(const forcebound_robot_reading& told, Nanoseconds now) noexcept {
  using Verdict = driver::ReadingTimes::Verdict;
  const Nanoseconds latched{told.latched_ns};
  const Verdict verdict = times_.judge(latched, now);
  if (verdict == Verdict::same) return without_reading(device::Reading::Status::stale);
  if (verdict != Verdict::newer) {
    ++counters_.times_refused;
    return refused(driver::ReadingTimes::in_words(verdict));
  }
  const int joints = about_.facts.joints();
  const Vector place = Eigen::Map<const Eigen::VectorXd>(told.position_rad, joints);
  if (!place.allFinite()) return refused("its reading has numbers that are not finite");
  const RobotLimits& limits = chain_.limits();
  if (((place - limits.highest).array() > kBeyond_rad).any() || ((limits.lowest - place).array() > kBeyond_rad).any()) {
    return refused("a joint is far beyond its limits");
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
void DriverRobot::note_reports(const forcebound_robot_reading& told, Nanoseconds now) noexcept {
  if ((told.has & FORCEBOUND_HAS_EFFECTIVE) != 0 && !stopped_) {
    effective_at_ = told.effective_ns > 0 ? std::optional(Nanoseconds{told.effective_ns}) : std::nullopt;
    released_at_ = told.released_ns > 0 ? std::optional(Nanoseconds{told.released_ns}) : std::nullopt;
  }
  if ((told.has & FORCEBOUND_HAS_GRIPPER) != 0 && told.gripper >= 0 && told.gripper <= 1) gripper_ = told.gripper;
  const Eigen::Map<const Eigen::Vector3d> force(told.force_N);
  const Eigen::Map<const Eigen::Vector3d> torque(told.torque_N_m);
  if ((told.has & FORCEBOUND_HAS_SENSED) != 0 && about_.sensor && force.allFinite() && torque.allFinite()) {
    sensed_ = SensedForce{.force_N = force, .torque_N_m = torque, .sampled = Nanoseconds{told.sensed_ns}};
  }
  const bool energy = std::isfinite(told.energy_J) && std::isfinite(told.energy_J_least);
  if ((told.has & FORCEBOUND_HAS_ENERGY) != 0 && energy) {
    audit_ = control::PassivityAudit{.energy_J = told.energy_J, .minimum_J = told.energy_J_least};
  }
  if ((told.has & FORCEBOUND_IS_STOPPED) != 0) {
    if (!stopped_) opened_.note_error("the robot stopped itself");
    if (!stopped_) released_at_ = now;
    stopped_ = true;
    if (resumed_ && now - *resumed_ > kOpensWithin) resumed_.reset();
  } else if (resumed_) {
    stopped_ = false;
    resumed_.reset();
  }
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

device::Reading DriverRobot::refused(std::string_view why) noexcept {
  opened_.note_error(why);
  return without_reading(device::Reading::Status::failed);
}

void DriverRobot::apply(Nanoseconds now, const Vector& torque) noexcept {
  take_stop_from_outside();
  if (stopped_) {
    write_failed_ = true;
    ++counters_.failed_writes;
    return;
  }
  forcebound_robot_command command{};
  command.size = sizeof command;
  command.at_ns = now.count();
  const int joints = about_.facts.joints();
  Vector given = Vector::Zero(joints);
  if (torque.rows() == joints && torque.allFinite()) {
    given = torque;
  } else {
    ++counters_.faulty_commands;
  }
  const double excess = given.cwiseQuotient(chain_.limits().torque_max).cwiseAbs().maxCoeff();
  if (excess > 1) given /= excess;
  if (!about_.compensates_gravity) given += chain_.gravity(place_);
  std::copy_n(given.data(), joints, command.torque_N_m);
  if (opening_) {
    command.has = FORCEBOUND_HAS_GRIPPER;
    command.gripper = *opening_;
  }
  effective_at_.reset();
  released_at_.reset();
  const int result = opened_.call(table().command_robot, static_cast<const forcebound_robot_command*>(&command));
  write_failed_ = result != FORCEBOUND_OK;
  if (!write_failed_) return;
  ++counters_.failed_writes;
  note_failure(result, "the command failed");
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
  const int result = opened_.call(table().resume);
  if (result == FORCEBOUND_OK) {
    resumed_ = now;
  } else {
    (void)opened_.note_failure("its brakes do not open");
  }
}

void DriverRobot::stop(Nanoseconds /*now*/) noexcept {
  stopped_from_outside_.store(true, std::memory_order_release);
  (void)opened_.stop();
}

void DriverRobot::take_stop_from_outside() noexcept {
  if (!stopped_from_outside_.exchange(false, std::memory_order_acq_rel)) return;
  opened_.note_error("its driver did not return from a call for as long as the robot holds a torque");
  stopped_ = true;
  resumed_.reset();
  write_failed_ = true;
  effective_at_.reset();
  // When the torque ended is not known exactly: the law takes the hold time.
  released_at_.reset();
}

}  // namespace forcebound::server
