#include "forcebound/server/session/session_table.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace forcebound::server {
namespace {

// Number of ended sessions remembered; searched for each motion of an unknown session.
constexpr std::size_t kEndedMax = 64;

}  // namespace

SessionTable::SessionTable(std::size_t most, Replies& replies, ServerCounters& counters, ServerObserver& observer)
    : replies_(replies), counters_(counters), observer_(observer), ended_(std::min(most, kEndedMax)) {
  sessions_.reserve(most);
}

Session* SessionTable::find(std::uint64_t number) noexcept {
  const auto found = sessions_.find(number);
  return found == sessions_.end() ? nullptr : &found->second;
}

Session* SessionTable::find(const net::Address& address, std::uint64_t nonce) noexcept {
  for (auto& [number, session] : sessions_) {
    if (session.nonce == nonce && session.info.address == address) return &session;
  }
  return nullptr;
}

SessionTable::Ended* SessionTable::find_ended(std::uint64_t number) noexcept {
  if (number == 0) return nullptr;
  const auto found =
      std::ranges::find_if(ended_, [&](const Ended& ended) { return ended.arrivals.counts.session == number; });
  return found == ended_.end() ? nullptr : &*found;
}

bool SessionTable::has_ended(const net::Address& address, std::uint64_t nonce) const noexcept {
  return std::ranges::any_of(ended_, [&](const Ended& ended) {
    return ended.arrivals.counts.session != 0 && ended.nonce == nonce && ended.address == address;
  });
}

bool SessionTable::is_of_another(const wire::Message& message, std::string_view client) const noexcept {
  const auto* const motion = std::get_if<wire::MotionSample>(&message);
  const auto* const bye = std::get_if<wire::Bye>(&message);
  if (motion == nullptr && bye == nullptr) return false;
  const auto found = sessions_.find(motion != nullptr ? motion->session : bye->session);
  return found != sessions_.end() && found->second.client != client;
}

std::size_t SessionTable::count_if(const std::function<bool(const Session&)>& condition) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(sessions_, [&](const auto& entry) { return condition(entry.second); }));
}

Session& SessionTable::open(Session session) {
  ++counters_.sessions_opened;
  const std::uint64_t number = session.info.session;
  return sessions_.emplace(number, std::move(session)).first->second;
}

void SessionTable::close(Session& session, CloseReason reason) {
  count(reason);
  const bool was_asked = reason == CloseReason::server_stops || reason == CloseReason::was_asked_to;
  if (was_asked || (reason != CloseReason::client_said_bye && session.has_sent_motion())) {
    replies_.send(session.arrivals.counts, session.proven_at);
  }
  counters_.add(session.made.environment->faults());
  counters_.motions_after_end += session.waiting.has_value();
  observer_.on_closed(session.info, reason, session.arrivals.counts);
  const std::uint64_t number = session.info.session;
  sessions_.erase(number);
}

std::size_t SessionTable::close_each(const std::function<std::optional<CloseReason>(const Session&)>& reason_to) {
  std::size_t closed = 0;
  for (auto next = sessions_.begin(); next != sessions_.end();) {
    Session& session = (next++)->second;
    if (const auto reason = reason_to(session)) {
      close(session, *reason);
      ++closed;
    }
  }
  return closed;
}

void SessionTable::close_by_client(const wire::Bye& bye, std::size_t bytes, const net::Address& from) {
  const auto answer = [&](const wire::Bye& counts, const net::Address& proven_at) {
    if (from == proven_at) {
      replies_.send(counts, from);
    } else {
      replies_.send_within(bytes, counts, from);
    }
  };
  if (Session* const session = find(bye.session)) {
    answer(session->arrivals.counts, session->proven_at);
    ended_[ended_next_++ % ended_.size()] = {session->nonce, session->proven_at, session->arrivals};
    close(*session, CloseReason::client_said_bye);
  } else if (const Ended* const ended = find_ended(bye.session)) {
    ++counters_.byes_repeated;
    answer(ended->arrivals.counts, ended->address);
  } else {
    ++counters_.byes_unknown;
  }
}

void SessionTable::count(CloseReason reason) noexcept {
  switch (reason) {
    case CloseReason::client_said_bye:
      ++counters_.sessions_ended;
      break;
    case CloseReason::idle:
      ++counters_.sessions_idle;
      break;
    case CloseReason::did_not_move:
      ++counters_.sessions_still;
      break;
    case CloseReason::was_asked_to:
      ++counters_.sessions_removed;
      break;
    case CloseReason::server_stops:
      break;
  }
}

}  // namespace forcebound::server
