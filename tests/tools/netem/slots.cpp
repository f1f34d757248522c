#include "tests/tools/netem/slots.hpp"

#include <algorithm>

namespace forcebound::netem {

Nanoseconds Slots::pass(Nanoseconds ready, std::size_t bytes, Random& random) noexcept {
  if (slot_.longest.count() == 0) return ready;
  // After a long time without packets, whole longest slots pass at once, so that the work stays bounded.
  const auto unused_slots = (ready - opens_) / slot_.longest;
  if (unused_slots > 1) {
    opens_ += (unused_slots - 1) * slot_.longest;
    packets_used_ = bytes_used_ = 0;
  }
  while (opens_ < ready || !has_room(bytes)) open_next(random);
  ++packets_used_;
  bytes_used_ += bytes;
  return opens_;
}

void Slots::open_next(Random& random) noexcept {
  const auto spread = static_cast<std::uint64_t>((slot_.longest - slot_.shortest).count());
  std::uint64_t extra = 0;
  // Split as the product of a day in nanoseconds and a draw does not fit 64 bits.
  if (spread != 0) {
    const std::uint64_t draw = random.draw();
    extra = (spread >> 16U) * draw / 0x10000U + ((spread & 0xffffU) * draw >> 32U);
  }
  // Slots of length zero would never advance.
  opens_ += std::max(Nanoseconds{1}, slot_.shortest + Nanoseconds{static_cast<std::int64_t>(extra)});
  packets_used_ = bytes_used_ = 0;
}

bool Slots::has_room(std::size_t bytes) const noexcept {
  if (packets_used_ == 0) return true;
  return (slot_.packets == 0 || packets_used_ < slot_.packets) &&
         (slot_.bytes == 0 || bytes_used_ + bytes <= slot_.bytes);
}

Nanoseconds DeliveryOpportunities::current() const noexcept { return cycle_begin_ + trace_.opportunities()[index_]; }

Nanoseconds DeliveryOpportunities::pass(Nanoseconds ready, std::size_t bytes) noexcept {
  if (current() < ready) skip_to(ready);
  while (bytes > bytes_left_) {
    bytes -= bytes_left_;
    advance();
  }
  bytes_left_ -= bytes;
  return current();
}

void DeliveryOpportunities::skip_to(Nanoseconds ready) noexcept {
  const auto& times = trace_.opportunities();
  // The last opportunity of a cycle is at the time at which the next cycle begins, and comes first.
  cycle_begin_ += (ready - cycle_begin_ - Nanoseconds{1}) / trace_.period() * trace_.period();
  const auto next = std::lower_bound(times.begin(), times.end(), ready - cycle_begin_);
  index_ = static_cast<std::size_t>(next - times.begin());
  bytes_left_ = DeliveryTrace::kOpportunityBytes;
}

void DeliveryOpportunities::advance() noexcept {
  if (++index_ == trace_.opportunities().size()) {
    index_ = 0;
    cycle_begin_ += trace_.period();
  }
  bytes_left_ = DeliveryTrace::kOpportunityBytes;
}

}  // namespace forcebound::netem
