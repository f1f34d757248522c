#include "forcebound/server/runtime/worker_mail.hpp"

#include <algorithm>
#include <iterator>
#include <new>
#include <utility>

#include "forcebound/security/channel.hpp"
#include "forcebound/security/locked.hpp"

namespace forcebound::server {

WorkerMail::Put WorkerMail::put(const Datagram& datagram, SecureLink::Moving* keys) noexcept {
  Origin origin{.as_it_came = datagram.stage == Stage::as_it_came, .worker = datagram.worker};
  if (origin.as_it_came && security::is_record(datagram.bytes)) {
    origin.keys = security::session_of_record(datagram.bytes);
  }
  const std::lock_guard lock(guard_);
  if (datagram.bytes.size() > net::kDatagramBytesMax || !has_room_for(origin)) return Put::no_room;
  const std::size_t at = (first_ + count_) % kDatagramsMost;
  Handed& to = (*ring_)[at];
  origins_[at] = origin;
  to.from = datagram.from;
  to.stage = datagram.stage;
  to.length = datagram.bytes.size();
  std::ranges::copy(datagram.bytes, to.bytes.begin());
  if (keys != nullptr) to.keys.emplace(std::move(*keys));
  ++count_;
  waiting_.fetch_add(1, std::memory_order_release);
  return count_ == 1 ? Put::was_empty : Put::taken;
}

bool WorkerMail::has_room_for(const Origin& origin) const noexcept {
  if (count_ == kDatagramsMost) return false;
  if (!origin.as_it_came) return true;
  std::size_t all = 0;
  std::size_t of_worker = 0;
  std::size_t of_keys = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Origin& other = origins_[(first_ + i) % kDatagramsMost];
    if (!other.as_it_came) continue;
    ++all;
    of_worker += other.worker == origin.worker ? 1 : 0;
    of_keys += origin.keys != 0 && other.keys == origin.keys ? 1 : 0;
  }
  return all < kAsTheyCameMost && of_worker < kOfWorkerMost && of_keys < kOfKeysMost;
}

void WorkerMail::post_work(std::function<void(UdpServer&)> work) {
  const std::lock_guard lock(guard_);
  posted_.push_back(std::move(work));
  undone_.fetch_add(1, std::memory_order_release);
}

bool WorkerMail::take(Handed& to) noexcept {
  const std::lock_guard lock(guard_);
  if (count_ == 0) return false;
  Handed& oldest = (*ring_)[first_];
  to.from = oldest.from;
  to.stage = oldest.stage;
  to.length = oldest.length;
  std::ranges::copy(std::span(oldest.bytes).first(oldest.length), to.bytes.begin());
  to.keys = std::exchange(oldest.keys, std::nullopt);
  // It was sealed.
  if (to.keys) security::wipe(oldest.bytes.data(), oldest.length);
  first_ = (first_ + 1) % kDatagramsMost;
  --count_;
  waiting_.fetch_sub(1, std::memory_order_release);
  return true;
}

void WorkerMail::do_work(UdpServer& server) {
  try {
    {
      const std::lock_guard lock(guard_);
      doing_.reserve(doing_.size() + posted_.size());
      std::ranges::move(posted_, std::back_inserter(doing_));
      posted_.clear();
    }
    while (!doing_.empty()) {
      doing_.front()(server);
      doing_.erase(doing_.begin());
      undone_.fetch_sub(1, std::memory_order_release);
    }
  } catch (const std::bad_alloc&) {  // at the next turn
  }
}

}  // namespace forcebound::server
