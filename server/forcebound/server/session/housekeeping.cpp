#include "forcebound/server/session/housekeeping.hpp"

namespace forcebound::server {

void Housekeeping::on_timer(Nanoseconds now) {
  table_.close_each([&](const Session& session) -> std::optional<CloseReason> {
    if (is_wanted_elsewhere(session, now)) return reason_to_evict(session, now);
    if (now - session.last_received < options_.idle_timeout) return std::nullopt;
    return CloseReason::idle;
  });
}

bool Housekeeping::evict_one(Nanoseconds now, const Among& among) {
  Session* oldest = nullptr;
  Nanoseconds since = now;
  for (auto& [number, session] : table_.all()) {
    if (among && !among(session)) continue;
    const auto idle = idle_since(session, now, static_cast<bool>(among));
    if (!idle || *idle >= since) continue;
    since = *idle;
    oldest = &session;
  }
  if (oldest == nullptr) return false;
  table_.close(*oldest, reason_to_evict(*oldest, now));
  return true;
}

std::optional<Nanoseconds> Housekeeping::idle_since(const Session& session, Nanoseconds now,
                                                    bool places_are_few) const noexcept {
  constexpr Nanoseconds kProofTime = std::chrono::seconds{1};
  const bool unproven = !session.has_sent_motion() && now - session.last_received > kProofTime;
  const bool absent = places_are_few && now - session.last_received > options_.presence_timeout;
  if (unproven || absent) return session.last_received;
  const bool still = places_are_few && now - session.last_moved > options_.stillness_timeout;
  return still ? std::optional(session.last_moved) : std::nullopt;
}

CloseReason Housekeeping::reason_to_evict(const Session& session, Nanoseconds now) const noexcept {
  const bool is_there = session.has_sent_motion() && now - session.last_received <= options_.presence_timeout;
  return is_there ? CloseReason::did_not_move : CloseReason::idle;
}

bool Housekeeping::is_wanted_elsewhere(const Session& session, Nanoseconds now) const noexcept {
  if (options_.worker.limits == nullptr) return false;
  return options_.worker.limits->report_idle(session.info.session, {.for_anybody = idle_since(session, now, false),
                                                                    .for_its_client = idle_since(session, now, true)});
}

}  // namespace forcebound::server
