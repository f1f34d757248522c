#include "forcebound/client/ros2/topic_environment.hpp"

#include <algorithm>

namespace forcebound::ros2 {

server::Answer TopicEnvironment::respond(const server::Motion& motion) noexcept {
  server::Answer answer{.force = Vector::Zero(motion.position.rows())};
  const std::optional<Wrench>& wrench = inbox_.newest();
  if (wrench) {
    const Nanoseconds age = std::max(Nanoseconds::zero(), motion.server_time - wrench->arrival);
    const double share = policy_.scale(age);
    const Eigen::Index translations = std::min<Eigen::Index>(answer.force.rows(), 3);
    answer.force.head(translations) = share * wrench->force_N.head(translations);
    if (shows_torque_) answer.torque_N_m = share * wrench->torque_N_m;
    ages_.add(
        {.device_time = motion.device_time, .policy = policy_.verdict(age), .arrival = wrench->arrival, .age = age});
  } else {
    ages_.add({.device_time = motion.device_time});
  }
  if (answered_ != nullptr) {
    answered_->push({.time = motion.server_time,
                     .position = motion.position,
                     .force_N = answer.force,
                     .torque_N_m = answer.torque_N_m,
                     .handle = motion.handle});
  }
  return answer;
}

}  // namespace forcebound::ros2
