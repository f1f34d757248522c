#include "forcebound/server/session/replies.hpp"

#include <cstdint>
#include <new>

#include "forcebound/server/session/session.hpp"

namespace forcebound::server {
namespace {

using wire::RefusalReason;

wire::ServerParts server_parts_of(scene::Rendering least) noexcept {
  if (least == scene::Rendering::held) return wire::ServerParts::held;
  return least == scene::Rendering::modelled ? wire::ServerParts::modelled : wire::ServerParts::none;
}

}  // namespace

bool Replies::send(std::span<const std::byte> datagram, const net::Address& to) noexcept {
  const bool sent = link_.send(datagram, to);
  if (!sent) ++counters_.sends_failed;
  return sent;
}

void Replies::send_within(std::size_t bytes, const wire::Message& message, const net::Address& to) noexcept {
  const std::span<const std::byte> datagram = codec_.encode(message);
  if (datagram.size() <= bytes) send(datagram, to);
}

void Replies::welcome(const Session& session, bool repeated) {
  const MadeEnvironment& made = session.made;
  const std::string simulated = (made.choice.empty() ? "" : made.choice + "; ") + made.simulated;
  wire::SceneOffer offer;
  if (session.sender) {
    const handover::Announcement& announced = session.sender->scene().announcement();
    offer = {.manifest_sha256 = announced.hash,
             .manifest_bytes = static_cast<std::uint32_t>(announced.manifest_bytes),
             .pieces = static_cast<std::uint32_t>(announced.pieces)};
  }
  send(wire::Welcome{.client_nonce = session.nonce,
                     .session = session.info.session,
                     .scene_hash = made.hash,
                     .scene = session.info.scene,
                     .simulated = simulated,
                     .offer = offer,
                     .server_parts =
                         session.wants_models ? server_parts_of(made.least_rendering) : wire::ServerParts::held,
                     .takes_energy = made.takes_energy,
                     .tool_m = made.tool_m},
       session.info.address);
  if (repeated) return;
  try {
    observer_.on_opened(session.info);
  } catch (const std::bad_alloc&) {  // it stays open, without a line in the log
  }
}

void Replies::refuse(const wire::Hello& hello, const net::Address& from, const Refused& refused) {
  ++counters_.hellos_refused;
  wire::Refusal refusal{.client_nonce = hello.client_nonce, .reason = refused.reason, .text = refused.text};
  if (refused.reason == RefusalReason::version_mismatch) refusal.protocol_version = wire::kProtocolVersion;
  send(refusal, from);
  observer_.on_refused(from, refused.text);
}

void Replies::refuse_for_lack_of_memory(const wire::Hello& hello, const net::Address& from) noexcept {
  ++counters_.hellos_out_of_memory;
  try {
    refuse(hello, from, {RefusalReason::server_full, std::string("the server has ") + kNoMemory});
  } catch (const std::bad_alloc&) {  // the client repeats its Hello
  }
}

void Replies::ask_for_round_trip(const wire::Hello& hello, const net::Address& from) {
  ++counters_.hellos_to_measure;
  send(wire::Refusal{.client_nonce = hello.client_nonce,
                     .reason = RefusalReason::round_trip_wanted,
                     .text = "send Hello again, with the round trip measured by this answer",
                     .client_time = hello.client_time},
       from);
}

}  // namespace forcebound::server
