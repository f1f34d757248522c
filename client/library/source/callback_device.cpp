#include "library/source/callback_device.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace forcebound::library {

using device::Reading;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

CallbackDevice::CallbackDevice(device::RealDevice facts, const fb_device_callbacks& callbacks)
    : known_(std::move(facts)), callbacks_(callbacks), damping_(control::Damping::from_matrix(known_.facts.damping)) {}

/// Whether a callback did what it was asked for, in time.
template <class Call>
bool CallbackDevice::done(const char* failure, Call&& call) noexcept {
  const CallbackCounts::Called called = calls_.call(std::forward<Call>(call));
  if (!called.done) error_ = called.threw ? "a callback threw an exception" : failure;
  if (called.late) error_ = "a callback took more than 10 ms";
  return called.done && !called.late;
}

void CallbackDevice::start() {
  if (callbacks_.start == nullptr) return;
  fb_status status = FB_FAILED;
  try {
    status = callbacks_.start(callbacks_.user);
  } catch (...) {
    throw std::runtime_error("device '" + known_.facts.name + "': its callback 'start' threw an exception");
  }
  if (status == FB_OK) return;
  throw std::runtime_error("device '" + known_.facts.name + "': its callback 'start' returned " +
                           std::to_string(status) + ", accepted is FB_OK (0)");
}

Reading CallbackDevice::read(time::Nanoseconds now) noexcept {
  fb_reading told{};
  told.size = sizeof told;
  told.latched_ns = now.count();
  const bool did = done("the callback 'read' failed", [&] { return callbacks_.read(callbacks_.user, &told) == FB_OK; });
  return did ? reading_of(told, now) : without_reading(Reading::Status::failed);
}

Reading CallbackDevice::reading_of(const fb_reading& told, time::Nanoseconds now) noexcept {
  const control::DeviceFacts& facts = known_.facts;
  const time::Nanoseconds latched{told.latched_ns};
  const Reading::Status in_time = times_.judge(latched, now);
  if (in_time != Reading::Status::ok) return without_reading(in_time);
  Reading reading;
  reading.latched = latched;
  reading.position = Eigen::Map<const Eigen::VectorXd>(told.position_m, facts.translations());
  if (facts.cartesian) {
    reading.joint = reading.position;
    reading.jacobian = control::Matrix::Identity(facts.joints(), facts.joints());
  } else {
    reading.joint = Eigen::Map<const Eigen::VectorXd>(told.joint, facts.joints());
    reading.jacobian = Eigen::Map<const RowMajor>(told.jacobian, facts.degrees_of_freedom(), facts.joints());
    if (reading.jacobian.allFinite()) damping_ = control::Damping::from_joints(reading.jacobian, facts.damping);
  }
  reading.damping = &damping_;
  control::Handle handle;
  if ((told.has & FB_HAS_BUTTONS) != 0) handle.buttons = told.buttons;
  if ((told.has & FB_HAS_GRIPPER) != 0) handle.gripper = told.gripper;
  if ((told.has & FB_HAS_ORIENTATION) != 0) {
    std::ranges::copy(told.orientation, handle.orientation.emplace().begin());
  }
  const control::SoundHandle sound = control::sound(handle);
  reading.handle = sound.handle;
  counters_.handle_refused += static_cast<std::uint64_t>(sound.refused);
  const Reading::Status status =
      device::status_of(reading, facts.degrees_of_freedom(), facts.joints(), facts.rotations);
  if (status != Reading::Status::ok) {
    error_ = control::why(status);
    return without_reading(status);
  }
  times_.accept(latched);
  return reading;
}

Reading CallbackDevice::without_reading(Reading::Status status) const noexcept {
  const control::DeviceFacts& facts = known_.facts;
  return {.joint = control::Vector::Zero(facts.joints()),
          .position = control::Vector::Zero(facts.translations()),
          .jacobian = control::Matrix::Identity(facts.degrees_of_freedom(), facts.joints()),
          .damping = &damping_,
          .latched = times_.newest().value_or(time::Nanoseconds{0}),
          .status = status};
}

bool CallbackDevice::command(const control::Vector& force_N) noexcept {
  return done("the callback 'command' failed", [&] {
    return callbacks_.command(callbacks_.user, force_N.data(), static_cast<std::size_t>(force_N.rows())) == FB_OK;
  });
}

void CallbackDevice::apply(time::Nanoseconds /*now*/, const control::Vector& force_N) noexcept {
  write_failed_ = !command(force_N);
  if (write_failed_) ++counters_.failed_writes;
}

void CallbackDevice::stop(time::Nanoseconds /*now*/) noexcept {
  if (callbacks_.stop == nullptr) {
    (void)command(control::Vector::Zero(known_.facts.degrees_of_freedom()));
    return;
  }
  calls_.call([&] {
    callbacks_.stop(callbacks_.user);
    return true;
  });
}

}  // namespace forcebound::library
