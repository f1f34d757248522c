#include "forcebound/client/ros2/topic_environment.hpp"

#include <algorithm>

namespace forcebound::ros2 {

void AnswerAges::add(record::ForcePolicy policy, Nanoseconds age) noexcept {
  counts_[static_cast<std::size_t>(policy)].fetch_add(1, std::memory_order_relaxed);
  age_.store(age.count(), std::memory_order_relaxed);
  newest_.store(policy, std::memory_order_relaxed);
}

AnswerAges::Counts AnswerAges::counts() const noexcept {
  Counts counts{};
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = counts_[i].load(std::memory_order_relaxed);
  return counts;
}

server::Answer TopicEnvironment::respond(const server::Motion& motion) noexcept {
  server::Answer answer{.force = Vector::Zero(motion.position.rows())};
  const std::optional<Wrench>& wrench = inbox_.newest();
  if (wrench) {
    const Nanoseconds age = std::max(Nanoseconds::zero(), motion.server_time - wrench->arrival);
    const double share = policy_.scale(age);
    const Eigen::Index translations = std::min<Eigen::Index>(answer.force.rows(), 3);
    answer.force.head(translations) = share * wrench->force_N.head(translations);
    if (shows_torque_) answer.torque_N_m = share * wrench->torque_N_m;
    ages_.add(policy_.verdict(age), age);
  } else {
    ages_.add(record::ForcePolicy::none, {});
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
