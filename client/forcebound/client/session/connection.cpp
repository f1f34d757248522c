#include "forcebound/client/session/connection.hpp"

#include <algorithm>
#include <utility>

namespace forcebound::client {
namespace {

constexpr Nanoseconds kPauseFirst = std::chrono::milliseconds{100};
constexpr Nanoseconds kPauseMax = std::chrono::seconds{2};
// A Hello with the round trip that is not answered within twice that and this time failed: the server may be compiling.
constexpr Nanoseconds kAnswerMost = std::chrono::seconds{10};

}  // namespace

Connection::Connection(Facts facts, std::uint64_t seed)
    : facts_(std::move(facts)), random_(seed), nonce_(random_()), pause_(kPauseFirst) {}

void Connection::on_blackout(Nanoseconds blackout, Nanoseconds hold, Nanoseconds drop) noexcept {
  if (session_ == 0) return;
  const SessionState before = state_;
  if (blackout <= hold) {
    state_ = SessionState::active;
  } else {
    state_ = blackout < drop ? SessionState::stale : SessionState::reconnecting;
  }
  if (state_ == before) return;
  pause_ = kPauseFirst;
  if (state_ == SessionState::reconnecting) forget_round_trip();
}

bool Connection::is_for_us(const wire::Heading& heading) const noexcept {
  if (heading.is<wire::Welcome>()) return heading.client_nonce == nonce_;
  const bool our_session = heading.session != 0 && (heading.session == session_ || heading.session == lost_);
  if (heading.is<wire::Refusal>()) return heading.client_nonce == nonce_ || our_session;
  return our_session;
}

bool Connection::on_welcome(const wire::Welcome& welcome) noexcept {
  if (welcome.client_nonce != nonce_ || welcome.session == 0 || welcome.session == session_) return false;
  // A late copy of a Welcome must not bring back a session that the server has forgotten since.
  if (welcome.session == replaced_) return false;
  replaced_ = session_;
  session_ = welcome.session;
  ++sessions_;
  state_ = SessionState::active;
  pause_ = kPauseFirst;
  return true;
}

Connection::Refused Connection::on_refusal(const wire::Refusal& refusal, Nanoseconds now) noexcept {
  if (refusal.reason == wire::RefusalReason::unknown_session) {
    if (session_ == 0 || refusal.session != session_) return Refused::not_us;
    lose_session();
    return Refused::session;
  }
  if (refusal.client_nonce != nonce_) return Refused::not_us;
  if (refusal.reason != wire::RefusalReason::round_trip_wanted) {
    if (session_ != 0) return Refused::not_us;
    forget_round_trip();
    return Refused::hello;
  }
  const auto round_trip = round_trip_of(refusal.client_time, now);
  if (!round_trip) return Refused::not_us;
  // Only the first refusal measures the round trip: later ones answer Hellos already sent.
  if (round_trip_ != Nanoseconds{0}) return Refused::for_now;
  round_trip_ = std::max(*round_trip, Nanoseconds{1});  // zero would say that it is not known
  measured_ = now;
  next_hello_ = Nanoseconds::min();
  return Refused::for_now;
}

void Connection::lose_session() noexcept {
  lost_ = session_;
  session_ = 0;
  replaced_ = 0;
  nonce_ = random_();
  state_ = SessionState::reconnecting;
  next_hello_ = Nanoseconds::min();
  pause_ = kPauseFirst;
  forget_round_trip();
}

void Connection::forget_round_trip() noexcept { round_trip_ = Nanoseconds{0}; }

std::optional<Nanoseconds> Connection::round_trip_of(Nanoseconds client_time, Nanoseconds now) const noexcept {
  if (std::find(hellos_.begin(), hellos_.end(), client_time) == hellos_.end()) return std::nullopt;
  const Nanoseconds round_trip = now - client_time;
  if (round_trip < Nanoseconds{0} || round_trip > kRoundTripMost) return std::nullopt;
  return round_trip;
}

bool Connection::hello_due(Nanoseconds now) noexcept {
  const bool wanted = session_ == 0 || state_ == SessionState::reconnecting;
  if (!wanted || now < next_hello_) return false;
  next_hello_ = now + pause_;
  pause_ = std::min(pause_ + pause_ / 2, kPauseMax);
  return true;
}

wire::Hello Connection::hello(Nanoseconds now) noexcept {
  if (round_trip_ != Nanoseconds{0} && now - measured_ > 2 * round_trip_ + kAnswerMost) forget_round_trip();
  hellos_[hellos_next_++ % kHellosKept] = now;
  return {.client_nonce = nonce_,
          .degrees_of_freedom = static_cast<std::uint32_t>(facts_.degrees_of_freedom),
          .device = facts_.device,
          .period_s = facts_.period_s,
          .force_N_max = facts_.force_N_max,
          .scene = facts_.scene,
          .client_time = now,
          .round_trip = round_trip_,
          .server_law = facts_.server_law,
          .renders_locally = facts_.renders_locally,
          .shows_scene = facts_.shows_scene,
          .shows_torque = facts_.shows_torque};
}

}  // namespace forcebound::client
