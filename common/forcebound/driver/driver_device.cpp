#include "forcebound/driver/driver_device.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "forcebound/device/tick_rate.hpp"
#include "forcebound/driver/driver_facts.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::driver {
namespace {

constexpr int kTranslationsMost = 3;

forcebound_facts facts_reported_by(OpenedDriver& opened) {
  forcebound_facts told{};
  told.size = sizeof told;
  if (opened.call("describe", opened.functions().describe, &told) != FORCEBOUND_OK) {
    throw std::runtime_error("driver '" + std::string(opened.functions().name) + "' does not describe its device");
  }
  return told;
}

control::Handle handle_of(const forcebound_reading& told) noexcept {
  control::Handle handle;
  if ((told.has & FORCEBOUND_HAS_BUTTONS) != 0) handle.buttons = told.buttons;
  if ((told.has & FORCEBOUND_HAS_GRIPPER) != 0) handle.gripper = told.gripper;
  if ((told.has & FORCEBOUND_HAS_ORIENTATION) != 0)
    std::ranges::copy(told.orientation, handle.orientation.emplace().begin());
  return handle;
}

std::string axes_in_words(const control::DeviceFacts& facts) {
  const std::string of_tip = std::to_string(facts.degrees_of_freedom()) + " axes of the tip";
  if (facts.cartesian) return of_tip;
  return std::to_string(facts.joints()) + " joints" + (facts.tip_axes > 0 ? " for " + of_tip : "");
}

void expect_same_axes(const control::DeviceFacts& file, const control::DeviceFacts& told,
                      const DriverRequest& request) {
  if (file.joints() == told.joints() && file.tip_axes == told.tip_axes && file.cartesian == told.cartesian) return;
  throw std::runtime_error(request.facts_file + ": has " + axes_in_words(file) + ", but the device of driver '" +
                           request.name + "' has " + axes_in_words(told));
}

/// Limits of a user's file. One that does not say what the motors may give for ever leaves it to the driver, which may
/// know it.
device::Safety own_safety(const device::RealDevice& own, const forcebound_facts& told) {
  device::Safety safety = own.safety;
  const bool unsaid = safety.rms_force_N_max == device::Safety::of_a_person(own.facts).rms_force_N_max;
  if (unsaid && told.force_N_continuous > 0) safety.rms_force_N_max = told.force_N_continuous;
  return safety;
}

}  // namespace

DriverDevice::DriverDevice(std::shared_ptr<const DriverLibrary> library, const DriverRequest& request,
                           std::optional<device::RealDevice> own)
    : opened_(std::move(library), request) {
  const forcebound_facts told = facts_reported_by(opened_);
  identified_ = told.identified != 0;
  facts_ = facts_of(told, driver().name);
  safety_ = safety_of(told, facts_, driver().name);
  if (own) {
    expect_same_axes(own->facts, facts_, request);
    safety_ = own_safety(*own, told);
    own->facts.name = std::move(facts_.name);  // the file's own name says nothing
    facts_ = std::move(own->facts);
    identified_ = own->identified;
    guessed_by_ = "its file";
  }
  if (facts_.translations() > kTranslationsMost) {
    throw std::runtime_error("driver '" + std::string(driver().name) + "': a device of " +
                             std::to_string(facts_.degrees_of_freedom()) +
                             " axes needs a file of facts, facts=FILE.toml, which is a chain: at most " +
                             std::to_string(kTranslationsMost) + " of its axes are positions");
  }
  damping_ = control::Damping::from_matrix(facts_.damping);
}

void DriverDevice::run_at(double rate_Hz) {
  const double own_Hz = 1 / facts_.period_s;
  constexpr double kRounding = 1e-9;
  // Ticks between two readings would have none, and no force.
  if (rate_Hz > own_Hz * (1 + kRounding)) {
    throw std::invalid_argument("driver '" + std::string(driver().name) + "' reads its device " +
                                text::rounded(own_Hz) + " times a second: at most so many ticks are accepted, got " +
                                text::rounded(rate_Hz));
  }
  facts_ = device::at_tick_rate(facts_, rate_Hz);
}

std::string DriverDevice::facts_in_words() const {
  return HapticDevice::facts_in_words() + (identified_ ? "" : "; bounds not identified: guesses of " + guessed_by_);
}

device::Reading DriverDevice::read(Nanoseconds now) noexcept {
  forcebound_reading told{};
  told.size = sizeof told;
  const int result = opened_.call("read", driver().read, now.count(), &told);
  if (result == FORCEBOUND_OK || result == FORCEBOUND_STALE) store_reports(told);
  if (result == FORCEBOUND_OK) return reading_of(told, now);
  if (result == FORCEBOUND_STALE) return without_reading(device::Reading::Status::stale);
  const bool unplugged = result == FORCEBOUND_UNPLUGGED;
  const bool explained = opened_.store_failure(unplugged ? "the device is unplugged" : "no reading");
  if (!explained && !unplugged) ++counters_.unexplained;
  return without_reading(device::Reading::Status::failed);
}

device::Reading DriverDevice::reading_of(const forcebound_reading& told, Nanoseconds now) noexcept {
  const int dof = facts_.degrees_of_freedom();
  const Nanoseconds latched{told.latched_ns};
  const device::Reading::Status in_time = times_.judge(latched, now);
  if (in_time != device::Reading::Status::ok) return without_reading(in_time);
  device::Reading reading;
  reading.latched = latched;
  reading.position = Eigen::Map<const Eigen::VectorXd>(told.position_m, facts_.translations());
  if (facts_.cartesian) {
    reading.joint = reading.position;
    reading.jacobian = Matrix::Identity(dof, dof);
  } else {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    reading.joint = Eigen::Map<const Eigen::VectorXd>(told.joint, dof);
    reading.jacobian = Eigen::Map<const RowMajor>(told.jacobian, dof, dof);
    if (reading.jacobian.allFinite()) damping_ = control::Damping::from_joints(reading.jacobian, facts_.damping);
  }
  reading.damping = &damping_;
  const control::SoundHandle handle = control::sound(handle_of(told));
  reading.handle = handle.handle;
  if (handle.refused > 0) {
    counters_.handle_refused += static_cast<std::uint64_t>(handle.refused);
    opened_.store_error("its orientation is no unit quaternion, or its gripper is not within 0 to 1");
  }
  const device::Reading::Status status = device::status_of(reading, dof, facts_.joints(), facts_.rotations);
  if (status != device::Reading::Status::ok) return without_reading(status);
  times_.accept(latched);
  return reading;
}

/// Reports of the last command, as far as they can be true.
void DriverDevice::store_reports(const forcebound_reading& told) noexcept {
  if ((told.has & FORCEBOUND_HAS_EFFECTIVE) == 0) return;
  effective_at_ = told.effective_ns > 0 ? std::optional(Nanoseconds{told.effective_ns}) : std::nullopt;
  released_at_ = told.released_ns > 0 ? std::optional(Nanoseconds{told.released_ns}) : std::nullopt;
}

device::Reading DriverDevice::without_reading(device::Reading::Status status) noexcept {
  const bool told = status == device::Reading::Status::stale || status == device::Reading::Status::failed;
  if (!told) opened_.store_error(control::why(status));
  const int dof = facts_.degrees_of_freedom();
  return {.joint = Vector::Zero(dof),
          .position = Vector::Zero(facts_.translations()),
          .jacobian = Matrix::Identity(dof, dof),
          .damping = &damping_,
          .latched = times_.newest().value_or(Nanoseconds{0}),
          .status = status};
}

void DriverDevice::apply(Nanoseconds now, const Vector& force_N) noexcept {
  const int dof = facts_.degrees_of_freedom();
  forcebound_command command{};
  command.size = sizeof command;
  command.at_ns = now.count();
  if (force_N.size() == dof && force_N.allFinite()) {
    Eigen::Map<Eigen::VectorXd>(command.force_N, facts_.translations()) = force_N.head(facts_.translations());
    Eigen::Map<Eigen::VectorXd>(command.torque_N_m, facts_.rotations) = force_N.tail(facts_.rotations);
  } else {
    ++counters_.faulty_commands;
  }
  effective_at_.reset();
  released_at_.reset();
  const int result = opened_.call("command", driver().command, static_cast<const forcebound_command*>(&command));
  write_failed_ = result != FORCEBOUND_OK;
  if (!write_failed_) return;
  ++counters_.failed_writes;
  const bool explained = opened_.store_failure("the command failed");
  if (!explained && result != FORCEBOUND_UNPLUGGED) ++counters_.unexplained;
}

}  // namespace forcebound::driver
