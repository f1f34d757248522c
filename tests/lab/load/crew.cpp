#include "tests/lab/load/crew.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "forcebound/text/printable.hpp"

namespace forcebound::lab {
namespace {

constexpr double kPeriod_s = 1e-3;
constexpr double kForceMost_N = 3;
constexpr double kTurns_per_s = 0.5;

}  // namespace

void Crew::grow(std::size_t clients) {
  members_.reserve(clients);
  while (members_.size() < clients) {
    const std::uint64_t number = members_.size() + 1;
    members_.push_back({.nonce = settings_.first_nonce + number,
                        .session = settings_.echo ? number : 0,
                        .sequence = 0,
                        .round_trip = {}});
  }
}

double Crew::Tally::answered_within_ns(double fraction) const noexcept {
  const double wanted = std::ceil(fraction * static_cast<double>(sent));
  const auto answers = static_cast<double>(arrived_ns.count());
  if (!(answers > 0) || wanted > answers) return std::numeric_limits<double>::infinity();
  return arrived_ns.percentile(wanted / answers);
}

std::span<const std::byte> Crew::hello(std::size_t client, Nanoseconds now) noexcept {
  return codec_.encode(wire::Hello{.client_nonce = members_[client].nonce,
                                   .degrees_of_freedom = settings_.degrees_of_freedom,
                                   .device = "load",
                                   .period_s = kPeriod_s,
                                   .force_N_max = kForceMost_N,
                                   .scene = settings_.scene,
                                   .client_time = now,
                                   .round_trip = members_[client].round_trip});
}

std::span<const std::byte> Crew::motion(std::size_t client, Nanoseconds now) noexcept {
  Member& member = members_[client];
  const double angle =
      2 * std::numbers::pi * (kTurns_per_s * time::to_seconds(now) + 0.1 * static_cast<double>(client));
  wire::MotionSample motion{.session = member.session, .sequence = ++member.sequence, .device_time = now};
  motion.position = control::Vector::Zero(settings_.degrees_of_freedom);
  motion.position[0] = settings_.radius_m * std::cos(angle);
  if (motion.position.rows() > 1) motion.position[1] = settings_.radius_m * std::sin(angle);
  ++tally_.sent;
  return codec_.encode(motion);
}

std::span<const std::byte> Crew::bye(std::size_t client) noexcept {
  return codec_.encode(wire::Bye{.session = members_[client].session});
}

void Crew::begin(Nanoseconds now) {
  begin_ = now;
  tally_ = {};
}

void Crew::on_datagram(std::span<const std::byte> datagram, Nanoseconds arrival, Nanoseconds now) {
  const auto decoded = codec_.decode(datagram);
  const auto* message = std::get_if<wire::Message>(&decoded);
  if (message == nullptr) {
    ++tally_.foreign;
  } else if (const auto* force = std::get_if<wire::EnvironmentForce>(message)) {
    on_answer(force->motion_device_time, arrival, now);
  } else if (const auto* echoed = std::get_if<wire::MotionSample>(message)) {
    on_answer(echoed->device_time, arrival, now);
  } else if (const auto* welcome = std::get_if<wire::Welcome>(message)) {
    if (Member* const member = member_of(welcome->client_nonce)) member->session = welcome->session;
  } else if (const auto* refused = std::get_if<wire::Refusal>(message)) {
    on_refusal(*refused, now);
  }
}

Crew::Member* Crew::member_of(std::uint64_t nonce) noexcept {
  const std::uint64_t number = nonce - settings_.first_nonce;
  return number >= 1 && number <= members_.size() ? &members_[number - 1] : nullptr;
}

void Crew::on_refusal(const wire::Refusal& refusal, Nanoseconds now) {
  if (refusal.reason != wire::RefusalReason::round_trip_wanted) {
    refusal_ = refusal.reason == wire::RefusalReason::unknown_session ? "the server does not know a session any more"
                                                                      : text::printable(refusal.text);
    return;
  }
  // No refusal of anything: the next Hello says what this one tells. Zero would say that it is not known.
  Member* const member = member_of(refusal.client_nonce);
  const Nanoseconds round_trip = now - refusal.client_time;
  if (member != nullptr && round_trip >= Nanoseconds{0}) member->round_trip = std::max(round_trip, Nanoseconds{1});
}

void Crew::on_answer(Nanoseconds motion_time, Nanoseconds arrival, Nanoseconds now) noexcept {
  if (motion_time < begin_) {
    ++tally_.foreign;
    return;
  }
  ++tally_.answered;
  tally_.arrived_ns.add((arrival - motion_time).count());
  tally_.read_ns.add((now - motion_time).count());
}

}  // namespace forcebound::lab
