#include "forcebound/device/command_times.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include "forcebound/control/rotation.hpp"

namespace forcebound::device {

control::Motion CommandTimes::motion_at(const Reading& reading) const noexcept {
  control::Motion motion{.position = with_rotations(reading),
                         .joint = reading.joint,
                         .jacobian = reading.jacobian,
                         .damping = reading.damping};
  if (previous_reading_) {
    motion.interval_s = time::to_seconds(reading.latched - *previous_reading_);
    motion.latency_s = latency_s(*previous_command_ - *previous_reading_);
    if (const auto effective = device_.effective_at()) {
      motion.effect_s = time::to_seconds(*effective - *previous_reading_);
    }
    motion.write_failed = device_.write_failed();
    if (const auto released = device_.released_at()) {
      motion.held_s = time::to_seconds(*released - *previous_reading_) - motion.latency_s;
    }
  }
  motion.latency_s_max = latency_s(choosing_since_ - reading.latched + choosing_.allowed());
  return motion;
}

/// Each interval's rotation about the pose at its beginning: no angle of many turns, no chart that ends.
Vector CommandTimes::with_rotations(const Reading& reading) const noexcept {
  if (device_.facts().rotations == 0) return reading.position;
  Vector place(reading.position.rows() + turned_rad_.rows());
  place.head(reading.position.rows()) = reading.position;
  place.tail<3>() = turned_rad_;
  if (pose_ && reading.handle.orientation)
    place.tail<3>() += control::rotation_vector(*pose_, control::quaternion_of(*reading.handle.orientation));
  return place;
}

double CommandTimes::command_at(const Reading& reading, Nanoseconds now) noexcept {
  choosing_.add(now - choosing_since_);
  if (device_.facts().rotations > 0 && reading.handle.orientation) {
    turned_rad_ = with_rotations(reading).tail<3>();
    pose_ = control::quaternion_of(*reading.handle.orientation);
  }
  previous_reading_ = reading.latched;
  previous_command_ = now;
  return latency_s(now - reading.latched);
}

bool CommandTimes::is_held_on(const Reading& reading, Nanoseconds now) const noexcept {
  // What stands still for longer is felt, and the motion unknown.
  constexpr Nanoseconds kHeldOnMost = std::chrono::milliseconds{5};
  if (reading.status != Reading::Status::stale || !previous_command_) return false;
  const control::DeviceFacts& facts = device_.facts();
  // What never lets go of a force must have the next command within the time that the law has paid for.
  const double next_s = facts.releases ? 0 : facts.period_s + facts.latency_s;
  const Nanoseconds held = time::from_seconds(facts.hold_s_max - next_s);
  return now - *previous_command_ < std::min(held, kHeldOnMost);
}

Reading usable_or_lost(Reading reading, const control::DeviceFacts& facts, Nanoseconds now,
                       Nanoseconds latest) noexcept {
  reading.status = status_of(reading, facts.degrees_of_freedom(), facts.joints(), facts.rotations);
  if (reading.status == Reading::Status::ok && reading.latched > latest) reading.status = Reading::Status::future;
  if (reading.status == Reading::Status::ok) return reading;
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  reading.position = Vector::Constant(facts.translations(), unknown);
  reading.joint = Vector::Constant(facts.joints(), unknown);
  reading.jacobian = Matrix::Identity(facts.degrees_of_freedom(), facts.joints());
  reading.handle = {};
  reading.latched = now;
  return reading;
}

}  // namespace forcebound::device
