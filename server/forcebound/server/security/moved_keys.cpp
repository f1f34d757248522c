#include "forcebound/server/security/moved_keys.hpp"

#include <algorithm>
#include <utility>

#include "forcebound/server/session/shared_limits.hpp"

namespace forcebound::server {

MovedKeys::MovedKeys(std::size_t most, std::size_t workers) : most_(most), workers_(workers) {
  moved_.reserve(most);
  unused_.reserve(most);
  while (unused_.size() < most) {
    moved_.emplace(0U, Entry{});
    unused_.push_back(moved_.extract(0U));
  }
}

std::optional<std::size_t> MovedKeys::worker_of(std::uint32_t keys) const noexcept {
  if (count_.load(std::memory_order_acquire) == 0) return std::nullopt;
  const std::lock_guard lock(guard_);
  const auto found = moved_.find(keys);
  return found == moved_.end() ? std::nullopt : std::optional(found->second.worker);
}

bool MovedKeys::store(std::uint32_t keys, std::size_t worker, const security::PublicKey* client) noexcept {
  const std::lock_guard lock(guard_);
  if (WorkerPlace::owner_of(keys, workers_) == worker) {
    remove(keys);
  } else if (const auto found = moved_.find(keys); found != moved_.end()) {
    found->second.worker = worker;
  } else {
    if (!may_add(client)) return false;
    auto node = std::move(unused_.back());
    unused_.pop_back();
    node.key() = keys;
    node.mapped() = {.worker = worker, .client = client == nullptr ? std::nullopt : std::optional(*client)};
    moved_.insert(std::move(node));
  }
  count_.store(moved_.size(), std::memory_order_release);
  return true;
}

void MovedKeys::remove(std::uint32_t keys) noexcept {
  if (const auto found = moved_.find(keys); found != moved_.end()) unused_.push_back(moved_.extract(found));
}

bool MovedKeys::may_add(const security::PublicKey* client) const noexcept {
  if (moved_.size() >= most_) return false;
  if (client == nullptr) return true;
  const auto has = std::ranges::count_if(moved_, [&](const auto& entry) { return entry.second.client == *client; });
  return static_cast<std::size_t>(has) < most_ - moved_.size();
}

void MovedKeys::forget(std::uint32_t keys) noexcept {
  if (count_.load(std::memory_order_acquire) == 0) return;
  const std::lock_guard lock(guard_);
  remove(keys);
  count_.store(moved_.size(), std::memory_order_release);
}

}  // namespace forcebound::server
