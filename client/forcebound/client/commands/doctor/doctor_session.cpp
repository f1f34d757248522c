#include "forcebound/client/commands/doctor/doctor_session.hpp"

#include <algorithm>
#include <variant>

#include "forcebound/client/commands/doctor/padded.hpp"
#include "forcebound/handover/limits.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::client::commands {
namespace {

constexpr double kDoctorPeriod_s = 1e-3;
// Of the device that the Hello tells of: nothing renders it.
constexpr double kDoctorForce_N_max = 3;

}  // namespace

DoctorSession::DoctorSession(const Settings& settings, net::DatagramLink& link, const time::Clock& clock)
    : settings_(settings),
      link_(link),
      clock_(clock),
      connection_({.device = "doctor",
                   .scene = settings.scene,
                   .degrees_of_freedom = settings.degrees_of_freedom,
                   .period_s = kDoctorPeriod_s,
                   .force_N_max = kDoctorForce_N_max,
                   .renders_locally = settings.renders_locally},
                  settings.seed),
      forces_(settings.degrees_of_freedom) {
  answers_.reserve(settings.answers);
}

void DoctorSession::keep_connected() noexcept {
  const Nanoseconds now = clock_.now();
  if (connection_.hello_due(now)) {
    if (handshake_.hellos == 0) first_hello_ = now;
    if (handshake_.sessions == 0) ++handshake_.hellos;
    link_.send(codec_.encode(connection_.hello(now)), settings_.server);
  }
  receive();
}

void DoctorSession::tick() noexcept {
  if (!connected()) return keep_connected();
  if (!link_.send(codec_.encode(next_motion()), settings_.server)) forces_.uncount_sent();
  receive();
}

wire::MotionSample DoctorSession::next_motion() noexcept {
  const Nanoseconds now = clock_.now();
  wire::MotionSample motion{.session = connection_.session(), .sequence = forces_.count_sent(now), .device_time = now};
  motion.position = control::Vector::Zero(settings_.degrees_of_freedom);
  if (pieces_missing_ > 0) motion.pieces = receipts_.receipt(true);
  return motion;
}

std::uint64_t DoctorSession::send_motion(std::size_t bytes) {
  if (!connected()) return 0;
  const wire::MotionSample motion = next_motion();
  const std::span<const std::byte> datagram = codec_.encode(motion);
  const auto longer = padded(datagram, bytes == 0 ? datagram.size() : bytes);
  if (longer && link_.send(*longer, settings_.server)) return motion.sequence;
  forces_.uncount_sent();
  return 0;
}

void DoctorSession::receive() noexcept {
  while (const auto received = link_.receive(buffer_)) {
    const Nanoseconds arrival = clock_.now() - received->waited;
    largest_bytes_ = std::max(largest_bytes_, received->bytes);
    const auto decoded = codec_.decode(std::span(buffer_).first(std::min(received->bytes, buffer_.size())));
    if (const auto* const message = std::get_if<wire::Message>(&decoded)) {
      receive(*message, arrival);
    } else {
      ++malformed_;
    }
  }
}

void DoctorSession::receive(const wire::Message& message, Nanoseconds arrival) noexcept {
  if (const auto* const force = std::get_if<wire::EnvironmentForce>(&message)) {
    receive(*force, arrival);
  } else if (const auto* const piece = std::get_if<wire::ScenePiece>(&message)) {
    receive(*piece);
  } else if (const auto* const welcome = std::get_if<wire::Welcome>(&message)) {
    receive(*welcome, arrival);
  } else if (const auto* const refusal = std::get_if<wire::Refusal>(&message)) {
    receive(*refusal, arrival);
  } else if (const auto* const bye = std::get_if<wire::Bye>(&message)) {
    receive(*bye, arrival);
  }
}

void DoctorSession::receive(const wire::Welcome& welcome, Nanoseconds arrival) noexcept {
  if (!connection_.on_welcome(welcome)) return;
  forces_.begin_session(welcome.session);
  // Another server may have another clock.
  clocks_.forget();
  answers_.clear();
  newest_answered_ = 0;
  newest_arrived_ = Nanoseconds{0};
  if (handshake_.sessions == 0) handshake_.took = arrival - first_hello_;
  handshake_.sessions = connection_.sessions();
  handshake_.scene = text::printable(welcome.scene);
  handshake_.simulated = text::printable(welcome.simulated);
  handshake_.server_parts = welcome.server_parts;
  handshake_.pieces_offered = welcome.offer.manifest_bytes > 0 ? welcome.offer.pieces : 0;
  // A client refuses a scene of more pieces.
  const bool wanted = settings_.renders_locally && handshake_.pieces_offered <= handover::Limits{}.pieces;
  pieces_.assign(wanted ? handshake_.pieces_offered : 0, false);
  pieces_missing_ = pieces_.size();
  receipts_ = {};
}

void DoctorSession::receive(const wire::Refusal& refusal, Nanoseconds arrival) noexcept {
  if (connection_.on_refusal(refusal, arrival) != client::Connection::Refused::hello) return;
  handshake_.refused_for = refusal.reason;
  handshake_.refusal = text::printable(refusal.text);
}

void DoctorSession::receive(const wire::EnvironmentForce& force, Nanoseconds arrival) noexcept {
  using Arrived = client::ForceStream::Verdict;
  const Arrived verdict = forces_.accept(force, arrival);
  if (verdict != Arrived::newest && verdict != Arrived::reordered) return;
  const client::ClockOffset::Exchange times{.read = client::ForceStream::reading_time(force),
                                            .received = force.server_receive_time,
                                            .answered = force.server_send_time,
                                            .arrived = arrival};
  clocks_.update(times);
  newest_answered_ = std::max(newest_answered_, force.motion_sequence);
  if (answers_.size() < answers_.capacity())
    answers_.push_back({.motion = force.motion_sequence, .times = times, .compute = force.compute_time});
  if (verdict != Arrived::newest) return;
  // After the last motion there is nothing to wait for.
  if (newest_arrived_ != Nanoseconds{0} && !closing_.begun())
    longest_gap_ = std::max(longest_gap_, arrival - newest_arrived_);
  newest_arrived_ = arrival;
}

void DoctorSession::receive(const wire::ScenePiece& piece) noexcept {
  if (piece.session != connection_.session() || piece.number >= pieces_.size()) return;
  ++pieces_received_;
  piece_bytes_ += piece.content.size();
  receipts_.add(piece.transmission);
  if (pieces_[piece.number]) return;
  pieces_[piece.number] = true;
  --pieces_missing_;
}

void DoctorSession::receive(const wire::Bye& bye, Nanoseconds arrival) noexcept {
  const client::Progress before = forces_.final_progress();
  if (bye.session != connection_.session() || !forces_.accept(bye)) return;
  if (!closing_.begun()) return connection_.on_bye();
  if (forces_.final_progress() == before) {
    closing_.on_answer_without_news(arrival);
  } else {
    closing_.on_news(arrival);
  }
}

bool DoctorSession::close() noexcept {
  const Nanoseconds now = clock_.now();
  closing_.begin(now);
  receive();
  if (!connected() || closing_.has_final_counts(forces_.longest_delay())) return true;
  if (closing_.bye_due(now)) link_.send(codec_.encode(wire::Bye{.session = connection_.session()}), settings_.server);
  return false;
}

}  // namespace forcebound::client::commands
