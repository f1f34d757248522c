#include "forcebound/client/ros2/answer_ages.hpp"

#include <algorithm>

namespace forcebound::ros2 {

void AnswerAges::add(const Answered& answered) noexcept {
  counts_[static_cast<std::size_t>(answered.policy)].fetch_add(1, std::memory_order_relaxed);
  age_.store(answered.age.count(), std::memory_order_relaxed);
  newest_.store(answered.policy, std::memory_order_relaxed);
  (void)under_way_.push(answered);  // full where no tick is here
}

void AnswerAges::on_force(const record::ForceRecord& force) noexcept {
  const Nanoseconds motion = force.force.motion_device_time;
  while (under_way_.read_available() > 0 && under_way_.front().device_time <= motion) under_way_.pop(here_);
  if (here_.device_time == motion) sequence_ = force.force.motion_sequence;
}

void AnswerAges::amend(record::TickRecord& tick) noexcept {
  if (tick.force_sequence == 0 || tick.force_sequence != sequence_) return;
  if (here_.policy == record::ForcePolicy::none) {
    tick.policy = record::ForcePolicy::none;
    tick.force_sequence = 0;
    tick.force_age = {};
    return;
  }
  tick.policy = std::max(tick.policy, here_.policy);
  tick.force_age = std::max(Nanoseconds::zero(), tick.force_age + here_.device_time - here_.arrival);
}

AnswerAges::Counts AnswerAges::counts() const noexcept {
  Counts counts{};
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = counts_[i].load(std::memory_order_relaxed);
  return counts;
}

}  // namespace forcebound::ros2
