#include "tests/tools/lab/load/load_generator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "forcebound/handover/limits.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::lab {
namespace {

constexpr double kPeriod_s = 1e-3;
constexpr double kForceMost_N = 3;
constexpr double kTurns_per_s = 0.5;

}  // namespace

void LoadGenerator::grow(std::size_t clients) {
  virtual_clients_.reserve(clients);
  while (virtual_clients_.size() < clients) {
    const std::uint64_t number = virtual_clients_.size() + 1;
    virtual_clients_.push_back({.nonce = settings_.first_nonce + number,
                                .session = settings_.echo ? number : 0,
                                .sequence = 0,
                                .round_trip = {}});
  }
}

double LoadGenerator::Tally::answered_within_ns(double fraction) const noexcept {
  const double wanted = std::ceil(fraction * static_cast<double>(sent));
  const auto answers = static_cast<double>(arrived_ns.count());
  if (!(answers > 0) || wanted > answers) return std::numeric_limits<double>::infinity();
  return arrived_ns.percentile(wanted / answers);
}

std::span<const std::byte> LoadGenerator::hello(std::size_t client, Nanoseconds now) noexcept {
  return codec_.encode(wire::Hello{.client_nonce = virtual_clients_[client].nonce,
                                   .degrees_of_freedom = settings_.degrees_of_freedom,
                                   .device = "load",
                                   .period_s = kPeriod_s,
                                   .force_N_max = kForceMost_N,
                                   .scene = settings_.scene,
                                   .client_time = now,
                                   .round_trip = virtual_clients_[client].round_trip,
                                   .renders_locally = settings_.renders_locally});
}

std::span<const std::byte> LoadGenerator::motion(std::size_t client, Nanoseconds now) noexcept {
  VirtualClient& virtual_client = virtual_clients_[client];
  const double angle =
      2 * std::numbers::pi * (kTurns_per_s * time::to_seconds(now) + 0.1 * static_cast<double>(client));
  wire::MotionSample motion{
      .session = virtual_client.session, .sequence = ++virtual_client.sequence, .device_time = now};
  motion.position = control::Vector::Zero(settings_.degrees_of_freedom);
  motion.position[0] = settings_.radius_m * std::cos(angle);
  if (motion.position.rows() > 1) motion.position[1] = settings_.radius_m * std::sin(angle);
  if (motion.position.rows() > 2) motion.position[2] = settings_.height_m;
  if (virtual_client.pieces_missing > 0) motion.pieces = virtual_client.receipts.receipt(true);
  ++tally_.sent;
  return codec_.encode(motion);
}

std::span<const std::byte> LoadGenerator::bye(std::size_t client) noexcept {
  return codec_.encode(wire::Bye{.session = virtual_clients_[client].session});
}

void LoadGenerator::begin(Nanoseconds now) {
  begin_ = now;
  tally_ = {};
}

void LoadGenerator::on_datagram(std::span<const std::byte> datagram, Nanoseconds arrival, Nanoseconds now) {
  const auto decoded = codec_.decode(datagram);
  const auto* message = std::get_if<wire::Message>(&decoded);
  if (message == nullptr) {
    ++tally_.foreign;
  } else if (const auto* force = std::get_if<wire::EnvironmentForce>(message)) {
    if (on_answer(force->motion_device_time, arrival, now) && !force->answer.model.empty()) ++tally_.modelled;
  } else if (const auto* echoed = std::get_if<wire::MotionSample>(message)) {
    on_answer(echoed->device_time, arrival, now);
  } else if (const auto* welcome = std::get_if<wire::Welcome>(message)) {
    on_welcome(*welcome);
  } else if (const auto* piece = std::get_if<wire::ScenePiece>(message)) {
    on_piece(*piece);
  } else if (const auto* refused = std::get_if<wire::Refusal>(message)) {
    on_refusal(*refused, now);
  }
}

LoadGenerator::VirtualClient* LoadGenerator::virtual_client_of(std::uint64_t nonce) noexcept {
  const std::uint64_t number = nonce - settings_.first_nonce;
  return number >= 1 && number <= virtual_clients_.size() ? &virtual_clients_[number - 1] : nullptr;
}

void LoadGenerator::on_welcome(const wire::Welcome& welcome) {
  VirtualClient* const virtual_client = virtual_client_of(welcome.client_nonce);
  if (virtual_client == nullptr || virtual_client->session == welcome.session) return;
  virtual_client->session = welcome.session;
  client_of_session_[welcome.session] = static_cast<std::size_t>(virtual_client - virtual_clients_.data());
  // A client refuses a scene of more pieces.
  const bool wanted = settings_.renders_locally && welcome.offer.pieces <= handover::Limits{}.pieces;
  virtual_client->pieces.assign(wanted ? welcome.offer.pieces : 0, false);
  virtual_client->pieces_missing = virtual_client->pieces.size();
  virtual_client->receipts = {};
}

void LoadGenerator::on_piece(const wire::ScenePiece& piece) noexcept {
  const auto found = client_of_session_.find(piece.session);
  if (found == client_of_session_.end() || piece.number >= virtual_clients_[found->second].pieces.size()) {
    ++tally_.foreign;
    return;
  }
  VirtualClient& virtual_client = virtual_clients_[found->second];
  ++handed_over_.pieces;
  handed_over_.bytes += piece.content.size();
  virtual_client.receipts.add(piece.transmission);
  if (virtual_client.pieces[piece.number]) return;
  virtual_client.pieces[piece.number] = true;
  --virtual_client.pieces_missing;
}

void LoadGenerator::on_refusal(const wire::Refusal& refusal, Nanoseconds now) {
  if (refusal.reason != wire::RefusalReason::round_trip_wanted) {
    refused_for_now_ = refusal.reason == wire::RefusalReason::server_full;
    refusal_ = refusal.reason == wire::RefusalReason::unknown_session ? "the server does not know a session any more"
                                                                      : text::printable(refusal.text);
    return;
  }
  // Not a refusal: the next Hello carries the round trip measured here. Zero would mean unknown.
  VirtualClient* const virtual_client = virtual_client_of(refusal.client_nonce);
  const Nanoseconds round_trip = now - refusal.client_time;
  if (virtual_client != nullptr && round_trip >= Nanoseconds{0})
    virtual_client->round_trip = std::max(round_trip, Nanoseconds{1});
}

bool LoadGenerator::on_answer(Nanoseconds motion_time, Nanoseconds arrival, Nanoseconds now) noexcept {
  if (motion_time < begin_) {
    ++tally_.foreign;
    return false;
  }
  ++tally_.answered;
  tally_.arrived_ns.add((arrival - motion_time).count());
  tally_.read_ns.add((now - motion_time).count());
  return true;
}

}  // namespace forcebound::lab
