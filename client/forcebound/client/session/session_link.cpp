#include "forcebound/client/session/session_link.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <variant>

#include "forcebound/wire/version_mismatch.hpp"

namespace forcebound::client {

SessionLink::SessionLink(Options options, net::DatagramLink& datagrams, const time::Clock& clock, EventReporter& events)
    : options_(std::move(options)),
      clock_(clock),
      events_(events),
      messages_(datagrams, clock, options_.server),
      // A client that was killed and starts again with the same seed is not the one before: its motions count from one.
      connection_(options_.facts, options_.seed + static_cast<std::uint64_t>(clock.now().count())),
      forces_(options_.facts.degrees_of_freedom),
      outages_(options_.policy.hold),
      schedule_(options_.send_rate, time::from_seconds(options_.facts.period_s)) {
  const Nanoseconds interval = options_.send_rate.interval(time::from_seconds(options_.facts.period_s));
  if (interval > Nanoseconds::zero() && !options_.facts.server_law.empty()) {
    throw std::invalid_argument("law '" + options_.facts.server_law +
                                "' exchanges numbers with its server-side law on each tick: no other rate of motions "
                                "is accepted");
  }
}

bool SessionLink::is_motion_due(const device::Reading& reading, const Vector& place) noexcept {
  last_reading_ = reading.latched;
  if (!reading.position.allFinite()) return false;
  // However rare motions are: a short press must not fall between two of them.
  if (reading.handle.buttons != buttons_sent_) schedule_.send_at_once();
  return schedule_.is_due(reading.latched) && connection_.session() != 0 && place.allFinite();
}

std::uint64_t SessionLink::send(wire::MotionSample motion) noexcept {
  buttons_sent_ = motion.handle.buttons;
  motion.session = connection_.session();
  motion.sequence = forces_.count_sent(motion.device_time);
  // What the server asks for to prove this address.
  const auto& newest = forces_.newest();
  motion.challenge = newest && newest->session == motion.session ? newest->challenge : 0;
  if (!takes_energy_) motion.energy_given_J = 0;
  if (!messages_.send(motion)) forces_.uncount_sent();
  return motion.sequence;
}

std::optional<SessionLink::Arrival> SessionLink::receive(Nanoseconds now, MessageLink::Received& in_tick) noexcept {
  while (const auto message = messages_.receive(connection_, in_tick)) {
    Arrival arrival{.message = message->message, .at = message->at};
    if (accept(arrival, now)) return arrival;
  }
  return std::nullopt;
}

bool SessionLink::accept(Arrival& arrival, Nanoseconds now) noexcept {
  const wire::Message& message = arrival.message;
  if (const auto* force = std::get_if<wire::EnvironmentForce>(&message)) return accept(*force, arrival, now);
  if (const auto* welcome = std::get_if<wire::Welcome>(&message)) return accept(*welcome, now);
  if (const auto* bye = std::get_if<wire::Bye>(&message)) return accept(*bye, now);
  if (const auto* view = std::get_if<wire::ViewPiece>(&message)) return view->session == connection_.session();
  if (const auto* refusal = std::get_if<wire::Refusal>(&message)) receive(*refusal, now, arrival.at);
  return std::holds_alternative<wire::ScenePiece>(message);
}

bool SessionLink::accept(const wire::Welcome& welcome, Nanoseconds now) noexcept {
  if (!connection_.on_welcome(welcome)) {
    if (welcome.session != connection_.session()) messages_.count_foreign();
    return false;
  }
  forces_.begin_session(welcome.session);
  clocks_.forget();
  takes_energy_ = welcome.takes_energy;
  follower_ = control::FollowerState::none;
  silent_since_ = now;
  return true;
}

bool SessionLink::accept(const wire::EnvironmentForce& force, Arrival& arrival, Nanoseconds now) noexcept {
  switch (forces_.accept(force, arrival.at)) {
    case ForceStream::Verdict::newest:
      arrival.newest = true;
      silent_since_ = now;
      outages_.on_force(now, forces_.progress());
      report_follower(force.answer.follower, now);
      [[fallthrough]];
    case ForceStream::Verdict::reordered:
      clocks_.update({.read = ForceStream::reading_time(force),
                      .received = force.server_receive_time,
                      .answered = force.server_send_time,
                      .arrived = arrival.at});
      closing_.on_news(now);
      return true;
    case ForceStream::Verdict::duplicate:
    case ForceStream::Verdict::foreign:
    case ForceStream::Verdict::implausible:
      break;  // counted there
  }
  return false;
}

bool SessionLink::accept(const wire::Bye& bye, Nanoseconds now) noexcept {
  const Progress before = forces_.final_progress();
  // The first copy ended the session; a further one must not end the next.
  if (bye.session != connection_.session() || !forces_.accept(bye)) {
    messages_.count_foreign();
    return false;
  }
  const Progress after = forces_.final_progress();
  if (closing_.begun()) {
    // No forces come any more, which is no blackout.
    outages_.on_bye(last_reading_, after, OutageDetector::Bye::answers_ours);
    if (after == before) {
      closing_.on_answer_without_news(now);
    } else {
      closing_.on_news(now);
    }
    return false;
  }
  outages_.on_bye(now, after, OutageDetector::Bye::of_the_server);
  connection_.on_bye();
  events_.report(Event::Kind::server_left, now);
  return true;
}

void SessionLink::receive(const wire::Refusal& refusal, Nanoseconds now, Nanoseconds arrival) noexcept {
  switch (connection_.on_refusal(refusal, arrival)) {
    case Connection::Refused::not_us:
      messages_.count_foreign();
      break;
    case Connection::Refused::session:
      events_.report(Event::Kind::session_unknown, now, refusal.text);
      break;
    case Connection::Refused::hello:
      ++refusals_;
      report_refusal(refusal, now);
      break;
    case Connection::Refused::for_now:
      break;
  }
}

void SessionLink::report_refusal(const wire::Refusal& refusal, Nanoseconds now) noexcept {
  // Version 1 did not say which it is, nor what to do.
  const std::uint32_t version = std::max(refusal.protocol_version, 1U);
  if (refusal.reason != wire::RefusalReason::version_mismatch || version == wire::kProtocolVersion) {
    events_.report(Event::Kind::refused, now, refusal.text);
    return;
  }
  const wire::VersionMismatch mismatch(version, wire::kProtocolVersion);
  events_.report(Event::Kind::refused, now, mismatch.text());
}

void SessionLink::report_follower(control::FollowerState state, Nanoseconds now) noexcept {
  if (state == std::exchange(follower_, state)) return;
  events_.report_follower(state, now,
                          buttons_sent_ ? "press and release the clutch" : "keep the device still for a moment");
}

void SessionLink::keep_connected(Nanoseconds now) noexcept {
  connection_.on_blackout(now - silent_since_, options_.policy.hold, options_.policy.drop);
  if (messages_.ready() && connection_.hello_due(now)) (void)messages_.send(connection_.hello(clock_.now()));
}

bool SessionLink::close(Nanoseconds now) noexcept {
  if (connection_.session() == 0 || closing_.has_final_counts(forces_.longest_delay())) return true;
  if (closing_.bye_due(now)) (void)messages_.send(wire::Bye{.session = connection_.session()});
  return false;
}

void SessionLink::add_to(record::RunTotals& totals, Nanoseconds now) const {
  const ForceStream::Counts network = forces_.counts(now);
  totals.malformed = messages_.counts().malformed;
  totals.malformed[wire::Malformed::unreadable] += network.implausible;
  totals.foreign_session = messages_.counts().foreign + network.foreign;
  totals.refusals = refusals_;
  totals.send_failures = messages_.counts().send_failures;
  totals.sent = network.sent;
  totals.received = network.received;
  totals.lost_up = network.lost_up;
  totals.lost_down = network.lost_down;
  totals.in_flight = network.in_flight;
  totals.unanswered = network.unanswered;
  totals.duplicated = network.duplicated + network.motions_duplicated;
  totals.reordered = network.reordered + network.motions_reordered;
  totals.longest_blackout = outages_.longest(last_reading_);
  if (totals.longest_blackout.duration > Nanoseconds::zero()) {
    const std::string& server = options_.server_in_words;
    totals.notes.push_back(
        record::words_of(totals.longest_blackout, server.empty() ? net::to_string(options_.server) : server));
  }
  if (clocks_.known()) {
    totals.server_ahead = clocks_.ahead();
    totals.server_ahead_off = clocks_.uncertainty(last_reading_);
  }
  totals.reconnects = connection_.sessions() > 0 ? connection_.sessions() - 1 : 0;
}

}  // namespace forcebound::client
