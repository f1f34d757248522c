// Whom the server lets in: its limits on Hellos, sessions and load, and sessions that end to make room.

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "forcebound/server/session/server.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

using text::printable;
using wire::RefusalReason;

std::string refusal_of_server_law(const control::LawRegistry& laws, std::string_view law) {
  std::string known;
  for (const std::string& name : laws.names()) {
    if (laws.find(name).make_server_side) known += (known.empty() ? "" : ", ") + name;
  }
  return "this server has no server-side law '" + printable(law) + "'" +
         (known.empty() ? " (known: none)" : " (known: " + known + ")");
}

std::string refusal_of_dof(const EnvironmentKind& kind, const wire::Hello& hello) {
  return "scene '" + kind.name + "' accepts devices with " + kind.accepted_degrees_of_freedom() +
         " degrees of freedom, device '" + printable(hello.device) + "' has " +
         std::to_string(hello.degrees_of_freedom);
}

}  // namespace

std::optional<Server::Refused> Server::refusal_of(const wire::Hello& hello, const EnvironmentKind& kind,
                                                  const Guest& guest, Nanoseconds now) {
  if (!kind.accepts(hello.degrees_of_freedom)) {
    return Refused{RefusalReason::wrong_degrees_of_freedom, refusal_of_dof(kind, hello)};
  }
  if (!hello.server_law.empty() &&
      !options_.laws.make_server_side(hello.server_law, static_cast<int>(hello.degrees_of_freedom))) {
    return Refused{RefusalReason::unknown_server_law, refusal_of_server_law(options_.laws, hello.server_law)};
  }
  if (options_.sessions_per_address > 0 && sessions_of(guest.address) >= options_.sessions_per_address) {
    return Refused{RefusalReason::server_full, "this server takes " + std::to_string(options_.sessions_per_address) +
                                                   " sessions at once from each address, end one or try again later"};
  }
  if (auto refusal = refusal_of_client(guest.rights, now)) return refusal;
  if (std::string busy = refusal_of_load(kind, now); !busy.empty()) {
    return Refused{RefusalReason::server_full, std::move(busy)};
  }
  const auto in_scene = [&](const Session& session) { return session.kind.get() == &kind; };
  if (kind.sessions_max > 0 && sessions_among(in_scene) >= kind.sessions_max && !evict_one(now, in_scene)) {
    return Refused{RefusalReason::server_full, "all " + std::to_string(kind.sessions_max) +
                                                   " places in the shared scene '" + kind.name +
                                                   "' are taken, try again later"};
  }
  if (sessions_of_all() >= options_.sessions_max && !evict_one(now, {})) {
    return Refused{RefusalReason::server_full,
                   "all " + std::to_string(options_.sessions_max) + " sessions are taken, try again later",
                   asks_others_for_place(std::nullopt)};
  }
  return std::nullopt;
}

std::optional<Server::Refused> Server::refusal_of_client(const ClientRights& rights, Nanoseconds now) {
  if (rights.key.empty()) return std::nullopt;
  const auto of_client = [&](const Session& session) { return session.client == rights.key; };
  const std::size_t has = sessions_of(rights.key);
  const bool may = rights.sessions_max ? has < *rights.sessions_max
                                       : has == 0 || is_fair_share(has, sessions_of_all(), options_.sessions_max);
  if (may || evict_one(now, of_client)) return std::nullopt;
  const std::string most = rights.sessions_max
                               ? "as many sessions as it may, " + std::to_string(*rights.sessions_max)
                               : "its share of this server's " + std::to_string(options_.sessions_max) + " sessions, " +
                                     std::to_string(has) + " (sessions_max in the list of clients gives more)";
  return Refused{RefusalReason::server_full,
                 "client '" + printable(rights.name) + "' has " + most + ": end one or try again later",
                 asks_others_for_place(rights.key)};
}

bool Server::hello_is_over_rate(const Guest& guest, Nanoseconds now) noexcept {
  if (guest.judged) return false;
  SharedLimits* const limits = options_.worker.limits;
  return limits != nullptr ? !limits->take_hello(guest.rights.key, guest.address, now)
                           : !hellos_.take(guest.rights.key, guest.address, now);
}

SharedLimits::Place Server::place_for(std::uint64_t session, const Guest& guest) {
  if (options_.worker.limits == nullptr) return {};
  auto place = options_.worker.limits->take(
      {.session = session, .address = guest.address, .client = std::string(guest.rights.key)},
      {.all = options_.sessions_max,
       .of_address = options_.sessions_per_address,
       .of_client = guest.rights.sessions_max ? std::optional<std::size_t>(*guest.rights.sessions_max) : std::nullopt});
  if (!place) throw std::runtime_error("others have just taken the last session, try again later");
  return std::move(*place);
}

std::size_t Server::sessions_of_all() const noexcept {
  return options_.worker.limits != nullptr ? options_.worker.limits->sessions() : sessions_.size();
}

std::size_t Server::sessions_of(std::string_view client) const noexcept {
  if (options_.worker.limits != nullptr) return options_.worker.limits->sessions_of(client);
  return static_cast<std::size_t>(
      std::ranges::count_if(sessions_, [&](const auto& entry) { return entry.second.client == client; }));
}

std::size_t Server::sessions_of(const net::Address& address) const noexcept {
  if (options_.worker.limits != nullptr) return options_.worker.limits->sessions_of(address);
  return static_cast<std::size_t>(std::count_if(
      sessions_.begin(), sessions_.end(), [&](const auto& entry) { return entry.second.proven_at.ip == address.ip; }));
}

/// Another session will take as much as those in the same scene do on average; and as much of what belongs to no scene.
std::string Server::refusal_of_load(const EnvironmentKind& kind, Nanoseconds now) {
  if (sessions_.empty()) return {};
  double all = 0;
  double of_kind = 0;
  int there = 0;
  for (auto& [id, session] : sessions_) {
    const double share = session.compute.share(now);
    all += share;
    if (session.kind.get() != &kind) continue;
    of_kind += share;
    ++there;
  }
  const double load = std::max(all, busy_);
  // Those that the load is of may have left.
  const auto sharing = static_cast<double>(std::max(sessions_.size(), busy_with_));
  const double expected = std::max(there > 0 ? of_kind / there : 0, (load - all) / sharing);
  if (load + expected <= options_.load_max) return {};
  const auto percent = [](double share) { return std::to_string(std::lround(share * 1e2)) + " %"; };
  return "this server is busy: its sessions take " + percent(load) +
         " of its processor's time, and one more would take " + percent(expected) + ", of " +
         percent(options_.load_max) + " at most; try again later";
}

std::size_t Server::sessions_among(const Among& among) const {
  return static_cast<std::size_t>(
      std::count_if(sessions_.begin(), sessions_.end(), [&](const auto& entry) { return among(entry.second); }));
}

std::optional<Nanoseconds> Server::idle_since(const Session& session, Nanoseconds now,
                                              bool places_are_few) const noexcept {
  // A real client sends motion at once; one that never did may have a forged address.
  constexpr Nanoseconds kProofTime = std::chrono::seconds{1};
  const bool unproven = session.arrivals.counts.motions_received == 0 && now - session.last_heard > kProofTime;
  const bool absent = places_are_few && now - session.last_heard > options_.presence_timeout;
  if (unproven || absent) return session.last_heard;
  const bool still = places_are_few && now - session.last_moved > options_.stillness_timeout;
  return still ? std::optional(session.last_moved) : std::nullopt;
}

bool Server::evict_one(Nanoseconds now, const Among& among) {
  auto oldest = sessions_.end();
  Nanoseconds since = now;
  for (auto it = sessions_.begin(); it != sessions_.end(); ++it) {
    if (among && !among(it->second)) continue;
    const auto idle = idle_since(it->second, now, static_cast<bool>(among));
    if (!idle || *idle >= since) continue;
    since = *idle;
    oldest = it;
  }
  if (oldest == sessions_.end()) return false;
  give_up_place(oldest->second, now);
  sessions_.erase(oldest);
  return true;
}

void Server::give_up_place(const Session& session, Nanoseconds now) {
  const bool has_moved = session.arrivals.counts.motions_received > 0;
  const bool is_there = has_moved && now - session.last_heard <= options_.presence_timeout;
  ++(is_there ? counters_.sessions_still : counters_.sessions_idle);
  if (has_moved) send(session.arrivals.counts, session.proven_at);
  close(session, is_there ? CloseReason::did_not_move : CloseReason::idle);
}

bool Server::asks_others_for_place(std::optional<std::string_view> client) noexcept {
  return options_.worker.limits != nullptr && options_.worker.limits->ask_for_place(client);
}

bool Server::is_wanted_elsewhere(const Session& session, Nanoseconds now) noexcept {
  if (options_.worker.limits == nullptr) return false;
  return options_.worker.limits->note(session.info.session, {.for_anybody = idle_since(session, now, false),
                                                             .for_its_client = idle_since(session, now, true)});
}

}  // namespace forcebound::server
