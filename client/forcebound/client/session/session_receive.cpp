// What a session takes from its server: each datagram by its kind.

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <variant>

#include "forcebound/client/session/session.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/wire/version_mismatch.hpp"

namespace forcebound::client {
namespace {

// A burst of more than this waits for the next tick: the tick's work is bounded.
constexpr int kDatagramsPerTickMax = 64;
// Those that are dropped by their address or heading cost little. If they counted, a flood of them would make all that
// are not dropped wait.
constexpr int kDroppedPerTickMax = 512;

}  // namespace

void Session::receive_all(Nanoseconds now) noexcept {
  int dropped = 0;
  for (int taken = 0; taken < kDatagramsPerTickMax && dropped < kDroppedPerTickMax;) {
    const auto received = link_.receive(buffer_);
    if (!received) return;
    const Nanoseconds read_at = clock_.now();
    if (received->from != options_.server) {
      ++counts_.foreign_session;
      ++dropped;
      continue;
    }
    const auto datagram = std::span(buffer_).first(std::min(received->bytes, buffer_.size()));
    // Waited until now, which is later than the tick's time by the reading and the sending.
    ++(receive(datagram, now, read_at - received->waited) ? taken : dropped);
  }
}

bool Session::receive(std::span<const std::byte> datagram, Nanoseconds now, Nanoseconds arrival) noexcept {
  const auto heading = wire::heading_of(datagram);
  if (const auto* reason = std::get_if<wire::Malformed>(&heading)) {
    ++counts_.malformed[static_cast<std::size_t>(*reason)];
    return false;
  }
  const auto& known = std::get<wire::Heading>(heading);
  if (known.is<wire::Hello>() || known.is<wire::MotionSample>()) {
    ++counts_.malformed[static_cast<std::size_t>(wire::Malformed::unreadable)];
    return false;
  }
  if (known.kind < std::variant_size_v<wire::Message> && !connection_.is_for_us(known)) {
    ++counts_.foreign_session;
    return false;
  }
  const auto decoded = codec_.decode(datagram, known);
  if (const auto* reason = std::get_if<wire::Malformed>(&decoded)) {
    ++counts_.malformed[static_cast<std::size_t>(*reason)];
  } else {
    receive(std::get<wire::Message>(decoded), now, arrival);
  }
  return true;
}

void Session::receive(const wire::Message& message, Nanoseconds now, Nanoseconds arrival) noexcept {
  if (const auto* force = std::get_if<wire::EnvironmentForce>(&message)) {
    receive_force(*force, now, arrival);
  } else if (const auto* welcome = std::get_if<wire::Welcome>(&message)) {
    if (!connection_.on_welcome(*welcome)) {
      counts_.foreign_session += welcome->session != connection_.session();
      return;
    }
    forces_.begin_session(welcome->session);
    clocks_.forget();
    controller_.begin_server_side();
    server_parts_ = welcome->server_parts;
    energy_taken_ = welcome->takes_energy;
    tool_.take(welcome->tool_m);
    follower_ = control::FollowerState::none;
    scene_offered_ = welcome->offer.manifest_bytes > 0;
    if (options_.local != nullptr) options_.local->begin(welcome->session, welcome->offer);
    silent_since_ = now;
    scene_.assign(welcome->scene);
    simulated_.assign(welcome->simulated);
    text::make_printable(scene_);
    text::make_printable(simulated_);
    tell(Event::Kind::welcomed, now, simulated_);
  } else if (const auto* refusal = std::get_if<wire::Refusal>(&message)) {
    receive_refusal(*refusal, now, arrival);
  } else if (const auto* piece = std::get_if<wire::ScenePiece>(&message)) {
    if (options_.local != nullptr) options_.local->take(*piece);
  } else if (const auto* view = std::get_if<wire::ViewPiece>(&message)) {
    if (sinks_.view != nullptr && view->session == connection_.session()) sinks_.view->on_view(*view);
  } else if (const auto* bye = std::get_if<wire::Bye>(&message)) {
    receive_bye(*bye, now);
  } else {
    ++counts_.malformed[static_cast<std::size_t>(wire::Malformed::unreadable)];
  }
}

void Session::receive_refusal(const wire::Refusal& refusal, Nanoseconds now, Nanoseconds arrival) noexcept {
  switch (connection_.on_refusal(refusal, arrival)) {
    case Connection::Refused::not_us:
      ++counts_.foreign_session;
      break;
    case Connection::Refused::session:
      tell(Event::Kind::session_unknown, now, refusal.text);
      break;
    case Connection::Refused::hello:
      ++counts_.refusals;
      tell_refused(refusal, now);
      break;
    case Connection::Refused::for_now:
      break;
  }
}

void Session::tell_refused(const wire::Refusal& refusal, Nanoseconds now) noexcept {
  // Version 1 did not say which it is, nor what to do.
  const std::uint32_t version = std::max(refusal.protocol_version, 1U);
  if (refusal.reason != wire::RefusalReason::version_mismatch || version == wire::kProtocolVersion) {
    tell(Event::Kind::refused, now, refusal.text);
    return;
  }
  const wire::VersionMismatch mismatch(version, wire::kProtocolVersion);
  tell(Event::Kind::refused, now, mismatch.text());
}

void Session::receive_force(const wire::EnvironmentForce& force, Nanoseconds now, Nanoseconds arrival) noexcept {
  switch (forces_.accept(force, arrival)) {
    case ForceStream::Verdict::newest:
      silent_since_ = now;
      newest_arrived_ = arrival;
      outages_.on_force(now, forces_.progress());
      controller_.hear(force.server_law_numbers);
      note_follower(force.follower, now);
      [[fallthrough]];
    case ForceStream::Verdict::reordered:
      clocks_.note({.read = ForceStream::reading_time(force),
                    .received = force.server_receive_time,
                    .answered = force.server_send_time,
                    .arrived = arrival});
      note_news(now);
      write_down(force, arrival);
      break;
    case ForceStream::Verdict::duplicate:
    case ForceStream::Verdict::foreign:
    case ForceStream::Verdict::implausible:
      break;  // counted there
  }
}

void Session::receive_bye(const wire::Bye& bye, Nanoseconds now) noexcept {
  const Progress before = forces_.final_progress();
  // The first copy ended the session; a further one must not end the next.
  if (bye.session != connection_.session() || !forces_.accept(bye)) {
    ++counts_.foreign_session;
    return;
  }
  // While closing no forces come any more, which is no blackout.
  if (closing_) {
    outages_.on_bye(last_tick_, forces_.final_progress(), OutageDetector::Bye::answers_ours);
  } else {
    outages_.on_bye(now, forces_.final_progress(), OutageDetector::Bye::of_the_server);
  }
  if (!closing_) {
    connection_.on_bye();
    rendering_.end(bye.session);
    tell(Event::Kind::server_left, now, {});
  } else if (forces_.final_progress() == before) {
    ++answers_without_news_;
  } else {
    note_news(now);
  }
}

void Session::note_news(Nanoseconds now) noexcept {
  answers_without_news_ = 0;
  last_news_ = now;
}

void Session::note_follower(control::FollowerState state, Nanoseconds now) noexcept {
  if (state == std::exchange(follower_, state)) return;
  event_.follower = state;
  tell(Event::Kind::follower_changed, now,
       buttons_sent_ ? "press and release the clutch" : "keep the device still for a moment");
}

}  // namespace forcebound::client
