#include "forcebound/server/session/shared_limits.hpp"

#include <algorithm>
#include <functional>

namespace forcebound::server {

HelloRate::HelloRate(int per_s_max, time::Nanoseconds now, std::uint64_t key)
    : of_sources_(time::Nanoseconds{std::chrono::seconds{1}} / std::max(1, per_s_max), std::max(1, per_s_max), now,
                  key),
      of_clients_(time::Nanoseconds{std::chrono::seconds{1}} / std::max(1, per_s_max), std::max(1, per_s_max)) {}

bool HelloRate::take(std::string_view client, const net::Address& from, time::Nanoseconds now) noexcept {
  if (client.empty()) return of_sources_.take(from, now);
  return of_clients_.take(std::hash<std::string_view>{}(client), now);
}

SharedLimits::SharedLimits(int hellos_per_s_max, time::Nanoseconds now, std::uint64_t key)
    : hellos_(hellos_per_s_max, now, key) {}

bool SharedLimits::take_hello(std::string_view client, const net::Address& from, time::Nanoseconds now) noexcept {
  const std::lock_guard lock(guard_);
  return hellos_.take(client, from, now);
}

std::optional<SharedLimits::Place> SharedLimits::take(Asking asking, const Most& most) {
  const std::lock_guard lock(guard_);
  if (places_.size() >= most.all || places_.contains(asking.session)) return std::nullopt;
  if (most.of_address > 0 && count_of(asking.address) >= most.of_address) return std::nullopt;
  const std::size_t has = asking.client.empty() ? 0 : count_of(std::string_view(asking.client));
  if (most.of_client ? has >= *most.of_client : !is_fair_share(has, places_.size(), most.all)) return std::nullopt;
  places_.emplace(asking.session, Entry{.address = asking.address, .client = std::move(asking.client)});
  return Place(*this, asking.session);
}

std::size_t SharedLimits::sessions() const noexcept {
  const std::lock_guard lock(guard_);
  return places_.size();
}

bool SharedLimits::has(std::uint64_t session) const noexcept {
  const std::lock_guard lock(guard_);
  return places_.contains(session);
}

bool SharedLimits::has(std::uint64_t session, std::string_view client) const noexcept {
  const std::lock_guard lock(guard_);
  const auto found = places_.find(session);
  return found != places_.end() && found->second.client == client;
}

bool SharedLimits::report_idle(std::uint64_t session, const Idle& idle) noexcept {
  const std::lock_guard lock(guard_);
  const auto found = places_.find(session);
  if (found == places_.end()) return false;
  Entry& entry = found->second;
  entry.idle = idle;
  const bool by_anybody = std::exchange(entry.wanted_by_anybody, false);
  const bool by_client = std::exchange(entry.wanted_by_client, false);
  return (by_anybody && idle.for_anybody) || (by_client && idle.for_its_client);
}

bool SharedLimits::ask_for_place(std::optional<std::string_view> client) noexcept {
  const auto idle = client ? &Idle::for_its_client : &Idle::for_anybody;
  const auto wanted = client ? &Entry::wanted_by_client : &Entry::wanted_by_anybody;
  const std::lock_guard lock(guard_);
  Entry* longest = nullptr;
  for (auto& [session, entry] : places_) {
    if (client && entry.client != *client) continue;
    if (entry.*wanted) return true;
    const auto& since = entry.idle.*idle;
    if (since && (longest == nullptr || *since < *(longest->idle.*idle))) longest = &entry;
  }
  if (longest != nullptr) longest->*wanted = true;
  return longest != nullptr;
}

std::size_t SharedLimits::sessions_of(const net::Address& address) const noexcept {
  const std::lock_guard lock(guard_);
  return count_of(address);
}

std::size_t SharedLimits::sessions_of(std::string_view client) const noexcept {
  const std::lock_guard lock(guard_);
  return count_of(client);
}

void SharedLimits::give_back(std::uint64_t session) noexcept {
  const std::lock_guard lock(guard_);
  places_.erase(session);
}

std::size_t SharedLimits::count_of(const net::Address& address) const noexcept {
  return static_cast<std::size_t>(
      std::ranges::count_if(places_, [&](const auto& entry) { return entry.second.address.ip == address.ip; }));
}

std::size_t SharedLimits::count_of(std::string_view client) const noexcept {
  return static_cast<std::size_t>(
      std::ranges::count_if(places_, [&](const auto& entry) { return entry.second.client == client; }));
}

// FNV-1a [Fowler, Noll and Vo]: by the name alone, so that no worker has to ask another.
std::size_t WorkerPlace::home_of(std::string_view scene) const noexcept {
  constexpr std::uint64_t kBasis = 0xcbf29ce484222325;
  constexpr std::uint64_t kPrime = 0x100000001b3;
  std::uint64_t hash = kBasis;
  for (const char letter : scene) hash = (hash ^ static_cast<unsigned char>(letter)) * kPrime;
  return static_cast<std::size_t>(hash % workers);
}

}  // namespace forcebound::server
