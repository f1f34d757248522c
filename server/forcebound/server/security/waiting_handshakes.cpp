#include "forcebound/server/security/waiting_handshakes.hpp"

namespace forcebound::server {

bool WaitingHandshakes::put(const Waiting& waiting) noexcept {
  if (count_ == kMost) return false;
  std::size_t of_one = 0;
  for (std::size_t i = 0; i < count_; ++i) of_one += ring_[(first_ + i) % kMost].who == waiting.who ? 1 : 0;
  if (of_one == kOfOneMost) return false;
  ring_[(first_ + count_++) % kMost] = waiting;
  return true;
}

std::optional<WaitingHandshakes::Waiting> WaitingHandshakes::take() noexcept {
  if (count_ == 0) return std::nullopt;
  const Waiting& oldest = ring_[first_];
  first_ = (first_ + 1) % kMost;
  --count_;
  return oldest;
}

}  // namespace forcebound::server
