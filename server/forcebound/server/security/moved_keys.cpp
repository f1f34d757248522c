#include "forcebound/server/security/moved_keys.hpp"

#include <algorithm>
#include <new>

#include "forcebound/server/session/shared_limits.hpp"

namespace forcebound::server {

MovedKeys::MovedKeys(std::size_t most, std::size_t workers) : most_(most), workers_(workers) {
  workers_of_.reserve(most);
}

std::optional<std::size_t> MovedKeys::worker_of(std::uint32_t keys) const noexcept {
  if (count_.load(std::memory_order_acquire) == 0) return std::nullopt;
  const std::lock_guard lock(guard_);
  const auto found = workers_of_.find(keys);
  return found == workers_of_.end() ? std::nullopt : std::optional(found->second);
}

bool MovedKeys::note(std::uint32_t keys, std::size_t worker) noexcept {
  const std::lock_guard lock(guard_);
  if (WorkerPlace::owner_of(keys, workers_) == worker) {
    workers_of_.erase(keys);
  } else if (const auto found = workers_of_.find(keys); found != workers_of_.end()) {
    found->second = worker;
  } else {
    if (workers_of_.size() >= most_) return false;
    try {
      workers_of_.emplace(keys, worker);
    } catch (const std::bad_alloc&) {
      return false;
    }
  }
  count_.store(workers_of_.size(), std::memory_order_release);
  return true;
}

void MovedKeys::forget(std::uint32_t keys) noexcept {
  if (count_.load(std::memory_order_acquire) == 0) return;
  const std::lock_guard lock(guard_);
  workers_of_.erase(keys);
  count_.store(workers_of_.size(), std::memory_order_release);
}

std::size_t MovedKeys::away_from(std::size_t worker) const noexcept {
  const std::lock_guard lock(guard_);
  return static_cast<std::size_t>(std::ranges::count_if(
      workers_of_, [&](const auto& entry) { return WorkerPlace::owner_of(entry.first, workers_) == worker; }));
}

}  // namespace forcebound::server
