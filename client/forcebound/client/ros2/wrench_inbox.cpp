#include "forcebound/client/ros2/wrench_inbox.hpp"

#include <algorithm>

namespace forcebound::ros2 {

Verdict WrenchInbox::judge(const Received& received) const noexcept {
  const Wrench& wrench = received.wrench;
  if (!wrench.force_N.allFinite() || !wrench.torque_N_m.allFinite()) return Verdict::not_finite;
  if (!received.frame.empty() && received.frame != frame_) return Verdict::in_another_frame;
  const bool another = publisher_ && *publisher_ != received.publisher;
  const bool held = wrench.arrival - taken_at_ < patience_;
  return another && held ? Verdict::of_another_publisher : Verdict::taken;
}

Verdict WrenchInbox::receive(const Received& received) noexcept {
  const Verdict verdict = judge(received);
  if (verdict == Verdict::in_another_frame) store_other_frame(received.frame);
  counts_[static_cast<std::size_t>(verdict)].fetch_add(1, std::memory_order_release);
  if (verdict != Verdict::taken) return verdict;
  publisher_ = received.publisher;
  taken_at_ = received.wrench.arrival;
  latest_.store(received.wrench);
  return verdict;
}

void WrenchInbox::store_other_frame(std::string_view frame) noexcept {
  if (other_frame_bytes_ > 0) return;
  other_frame_bytes_ = std::min(frame.size(), other_frame_.size());
  std::copy_n(frame.begin(), other_frame_bytes_, other_frame_.begin());
}

const std::optional<Wrench>& WrenchInbox::newest() noexcept {
  if (const Wrench* const wrench = latest_.take()) newest_ = *wrench;
  return newest_;
}

WrenchInbox::Counts WrenchInbox::counts() const noexcept {
  Counts counts{};
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = counts_[i].load(std::memory_order_acquire);
  return counts;
}

}  // namespace forcebound::ros2
