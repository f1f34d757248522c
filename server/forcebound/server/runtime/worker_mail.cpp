#include "forcebound/server/runtime/worker_mail.hpp"

#include <algorithm>
#include <utility>

namespace forcebound::server {

WorkerMail::Put WorkerMail::put(std::span<const std::byte> datagram, const net::Address& from,
                                std::optional<SecureLink::Moving> keys) noexcept {
  const std::lock_guard lock(guard_);
  if (count_ == kDatagramsMost || datagram.size() > net::kDatagramBytesMax) return Put::no_room;
  Handed& to = (*ring_)[(first_ + count_) % kDatagramsMost];
  to.from = from;
  to.length = datagram.size();
  std::ranges::copy(datagram, to.bytes.begin());
  to.keys = std::move(keys);
  ++count_;
  waiting_.fetch_add(1, std::memory_order_release);
  return count_ == 1 ? Put::taken_first : Put::taken;
}

void WorkerMail::ask(std::function<void(UdpServer&)> work) {
  const std::lock_guard lock(guard_);
  work_.push_back(std::move(work));
  waiting_.fetch_add(1, std::memory_order_release);
}

bool WorkerMail::take(Handed& to) noexcept {
  const std::lock_guard lock(guard_);
  if (count_ == 0) return false;
  Handed& oldest = (*ring_)[first_];
  to.from = oldest.from;
  to.length = oldest.length;
  std::ranges::copy(std::span(oldest.bytes).first(oldest.length), to.bytes.begin());
  to.keys = std::exchange(oldest.keys, std::nullopt);
  first_ = (first_ + 1) % kDatagramsMost;
  --count_;
  waiting_.fetch_sub(1, std::memory_order_release);
  return true;
}

std::vector<std::function<void(UdpServer&)>> WorkerMail::take_work() {
  const std::lock_guard lock(guard_);
  waiting_.fetch_sub(work_.size(), std::memory_order_release);
  return std::exchange(work_, {});
}

}  // namespace forcebound::server
