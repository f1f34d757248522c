#include "forcebound/server/session/capacity.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "forcebound/text/printable.hpp"

namespace forcebound::server {

using text::printable;

std::optional<Capacity::NoRoom> Capacity::refusal_of(const EnvironmentKind& kind, const Sender& sender,
                                                     Nanoseconds now) {
  if (options_.sessions_per_address > 0 && sessions_of(sender.address) >= options_.sessions_per_address) {
    return NoRoom{"this server takes " + std::to_string(options_.sessions_per_address) +
                  " sessions at once from each address, end one or try again later"};
  }
  if (auto refusal = refusal_of_client(sender.rights, now)) return refusal;
  if (std::string busy = refusal_of_load(kind, now); !busy.empty()) return NoRoom{std::move(busy)};
  const auto in_scene = [&](const Session& session) { return session.kind.get() == &kind; };
  if (kind.sessions_max > 0 && table_.count_if(in_scene) >= kind.sessions_max &&
      !housekeeping_.evict_one(now, in_scene)) {
    return NoRoom{"all " + std::to_string(kind.sessions_max) + " places in the shared scene '" + kind.name +
                  "' are taken, try again later"};
  }
  if (sessions_of_all() >= options_.sessions_max && !housekeeping_.evict_one(now, {})) {
    return NoRoom{"all " + std::to_string(options_.sessions_max) + " sessions are taken, try again later",
                  asks_others_for_place(std::nullopt)};
  }
  return std::nullopt;
}

std::optional<Capacity::NoRoom> Capacity::refusal_of_client(const ClientRights& rights, Nanoseconds now) {
  if (rights.key.empty()) return std::nullopt;
  const auto of_client = [&](const Session& session) { return session.client == rights.key; };
  const std::size_t has = sessions_of(rights.key);
  const bool may = rights.sessions_max ? has < *rights.sessions_max
                                       : has == 0 || is_fair_share(has, sessions_of_all(), options_.sessions_max);
  if (may || housekeeping_.evict_one(now, of_client)) return std::nullopt;
  const std::string most = rights.sessions_max
                               ? "as many sessions as it may, " + std::to_string(*rights.sessions_max)
                               : "its share of this server's " + std::to_string(options_.sessions_max) + " sessions, " +
                                     std::to_string(has) + " (sessions_max in the list of clients gives more)";
  return NoRoom{"client '" + printable(rights.name) + "' has " + most + ": end one or try again later",
                asks_others_for_place(rights.key)};
}

/// Another session will take as much as those in the same scene do on average; and as much of what belongs to no scene.
std::string Capacity::refusal_of_load(const EnvironmentKind& kind, Nanoseconds now) {
  if (table_.size() == 0) return {};
  double all = 0;
  double of_kind = 0;
  int there = 0;
  for (auto& [number, session] : table_.all()) {
    const double share = session.compute.share(now);
    all += share;
    if (session.kind.get() != &kind) continue;
    of_kind += share;
    ++there;
  }
  const double load = std::max(all, busy_);
  // Those that the load is of may have left.
  const auto sharing = static_cast<double>(std::max(table_.size(), busy_with_));
  const double expected = std::max(there > 0 ? of_kind / there : 0, (load - all) / sharing);
  if (load + expected <= options_.load_max) return {};
  const auto percent = [](double share) { return std::to_string(std::lround(share * 1e2)) + " %"; };
  return "this server is busy: its sessions take " + percent(load) +
         " of its processor's time, and one more would take " + percent(expected) + ", of " +
         percent(options_.load_max) + " at most; try again later";
}

SharedLimits::Place Capacity::place_for(std::uint64_t session, const Sender& sender) const {
  if (options_.worker.limits == nullptr) return {};
  auto place = options_.worker.limits->take(
      {.session = session, .address = sender.address, .client = std::string(sender.rights.key)},
      {.all = options_.sessions_max,
       .of_address = options_.sessions_per_address,
       .of_client =
           sender.rights.sessions_max ? std::optional<std::size_t>(*sender.rights.sessions_max) : std::nullopt});
  if (!place) throw std::runtime_error("others have just taken the last session, try again later");
  return std::move(*place);
}

void Capacity::count_opened() noexcept { sessions_since_stored_ = std::max(sessions_since_stored_, table_.size()); }

void Capacity::store_busy(double share, std::uint64_t datagrams) noexcept {
  const std::uint64_t before = std::exchange(motions_when_stored_, counters_.motions_received);
  const double motions = static_cast<double>(counters_.motions_received - before);
  busy_ = share * std::min(1.0, motions / static_cast<double>(std::max<std::uint64_t>(1, datagrams)));
  busy_with_ = std::exchange(sessions_since_stored_, table_.size());
}

bool Capacity::asks_others_for_place(std::optional<std::string_view> client) const noexcept {
  return options_.worker.limits != nullptr && options_.worker.limits->ask_for_place(client);
}

std::size_t Capacity::sessions_of(const net::Address& address) const noexcept {
  if (options_.worker.limits != nullptr) return options_.worker.limits->sessions_of(address);
  return table_.count_if([&](const Session& session) { return session.proven_at.ip == address.ip; });
}

std::size_t Capacity::sessions_of(std::string_view client) const noexcept {
  if (options_.worker.limits != nullptr) return options_.worker.limits->sessions_of(client);
  return table_.count_if([&](const Session& session) { return session.client == client; });
}

std::size_t Capacity::sessions_of_all() const noexcept {
  return options_.worker.limits != nullptr ? options_.worker.limits->sessions() : table_.size();
}

}  // namespace forcebound::server
