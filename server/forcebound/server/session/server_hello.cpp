// The server's answers to Hellos: admission of clients, or refusal with the reason.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>
#include <variant>

#include "forcebound/server/session/server.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/wire/version_mismatch.hpp"

namespace forcebound::server {
namespace {

using text::printable;
using wire::RefusalReason;

// Limits on the motion rate that a client can promise.
constexpr double kPeriodLeast_s = 100e-6;
constexpr double kPeriodMost_s = 1;

// Of a session: a client repeats its Hello no faster, and a network may hold some up and deliver them together.
constexpr Nanoseconds kRepeatedHelloInterval = std::chrono::milliseconds{50};
constexpr int kRepeatedHellosAtOnce = 20;

double believed_period_s(const wire::Hello& hello) { return std::clamp(hello.period_s, kPeriodLeast_s, kPeriodMost_s); }

// A server-side law exchanges the environment's force through the network: it needs all of it from here.
bool renders_locally(const wire::Hello& hello) noexcept { return hello.renders_locally && hello.server_law.empty(); }

/// @throws std::exception with the reason if the environment cannot be made
MadeEnvironment make_for(const wire::Hello& hello, const EnvironmentKind& kind) {
  MadeEnvironment made = kind.make({.device = printable(hello.device),
                                    .degrees_of_freedom = hello.degrees_of_freedom,
                                    .period_s = believed_period_s(hello),
                                    .force_N_max = hello.force_N_max,
                                    .round_trip = hello.round_trip,
                                    .renders_locally = renders_locally(hello),
                                    .shows_torque = hello.shows_torque});
  if (!made.environment) throw std::runtime_error("its maker returned none");
  return made;
}

// Burst: one second's worth of motion may arrive at once after a network delay.
int burst(double period_s) { return std::max(16, static_cast<int>(1 / period_s)); }

wire::ServerParts server_parts_of(scene::Rendering least) noexcept {
  if (least == scene::Rendering::held) return wire::ServerParts::held;
  return least == scene::Rendering::modelled ? wire::ServerParts::modelled : wire::ServerParts::none;
}

constexpr const char* kNoMemory = "not enough memory for another session, try again later";

/// What a session needs once it is open is less than this, so that there is memory for it and for those that are.
constexpr std::size_t kSpareBytes = std::size_t{4} << 20U;

/// @throws std::bad_alloc if less is left
void expect_spare_memory() {
  const std::unique_ptr<char[]> spare(new char[kSpareBytes]);
  // Written to, lest the compiler leave it out.
  static_cast<volatile char*>(spare.get())[0] = 0;
}

std::string refusal_of_rights(const ClientRights& rights, std::string_view scene) {
  std::string allowed;
  for (const std::string& name : rights.scenes) allowed += (allowed.empty() ? "" : ", ") + printable(name);
  return "client '" + printable(rights.name) + "' may not use scene '" + printable(scene) + "' (allowed: " + allowed +
         ")";
}

/// The least time between motions that are answered, in the mean [s].
double answered_every_s(double period_s, double motions_per_promised, const ClientRights& rights) {
  constexpr double kMost_s = 3600;  // so that a token bucket can count it
  const double interval_s = period_s / motions_per_promised;
  if (!rights.motions_per_s_max) return interval_s;
  return std::max(interval_s, std::min(1 / *rights.motions_per_s_max, kMost_s));
}

/// A server-side law accounts for the tip's motion. At the client the force acts at the grip, and its torque about that
/// takes up the difference only where there are motors for it.
bool is_law_of_wrong_point(const wire::Hello& hello, const MadeEnvironment& made) noexcept {
  return !hello.server_law.empty() && made.tool_m.rows() > 0 && !hello.shows_torque;
}

std::string refusal_of_law(const wire::Hello& hello, const std::string& scene) {
  return "scene '" + scene + "' has a tool in the hand (tool_m), for which the law '" + printable(hello.server_law) +
         "' needs a device that shows torque: use a law without a server-side law, or a scene without a tool";
}

std::string refusal_for_now(const std::string& scene, std::string_view why) {
  return "scene '" + scene + "' is not available at the moment: " + std::string(why);
}

}  // namespace

void Server::on_hello(const wire::Hello& hello, const Guest& guest, Nanoseconds now) {
  const net::Address& from = guest.address;
  // A client with a session is answered even while untrusted clients use up the rate.
  if (Session* session = find(from, hello.client_nonce)) {
    if (!session->hellos.take(now)) {
      ++counters_.hellos_over_rate;
      return;
    }
    ++counters_.hellos_repeated;
    welcome(*session);
    return;
  }
  if (hello_is_over_rate(guest, now)) {
    ++counters_.hellos_over_rate;
    return;
  }
  const bool late = std::any_of(ended_.begin(), ended_.end(), [&](const Ended& ended) {
    return ended.arrivals.counts.session != 0 && ended.nonce == hello.client_nonce && ended.address == from;
  });
  if (late) {
    ++counters_.hellos_after_bye;
    return;
  }
  if (hello.protocol_version != wire::kProtocolVersion) {
    ++counters_.hellos_of_other_versions;
    const wire::VersionMismatch mismatch(wire::kProtocolVersion, hello.protocol_version);
    refuse(hello, from, {RefusalReason::version_mismatch, std::string(mismatch.text())});
    return;
  }
  if (!admits_none_.empty()) {
    refuse(hello, from, {RefusalReason::server_full, admits_none_});
    return;
  }
  // Before it would be compiled.
  if (!is_allowed(hello.scene)) {
    refuse(hello, from, {RefusalReason::unknown_scene, refusal_of_scene(hello.scene)});
    return;
  }
  const std::string_view scene = hello.scene.empty() ? std::string_view{options_.scene} : hello.scene;
  if (!guest.rights.may_use(scene)) {
    refuse(hello, from, {RefusalReason::unknown_scene, refusal_of_rights(guest.rights, scene)});
    return;
  }
  auto wanted = environments_.request(scene);
  if (wanted.coming) {
    // Compiling here would delay the answers of other sessions; the client repeats its Hello.
    ++counters_.hellos_too_early;
    return;
  }
  if (!wanted.why_not.empty()) {
    refuse(hello, from, {RefusalReason::server_full, refusal_for_now(printable(hello.scene), wanted.why_not)});
    return;
  }
  if (!wanted.kind) {
    refuse(hello, from, {RefusalReason::unknown_scene, environments_.unknown_text(printable(hello.scene))});
    return;
  }
  if (const std::size_t home = options_.worker.home_of(wanted.kind->name);
      wanted.kind->sessions_max > 0 && home != options_.worker.number) {
    elsewhere_ = home;
    return;
  }
  if (const auto refusal = refusal_of(hello, *wanted.kind, guest, now)) {
    if (refusal->place_soon) {
      ++counters_.hellos_too_early;
      return;
    }
    refuse(hello, from, *refusal);
    return;
  }
  if (wanted.kind->wants_round_trip && hello.round_trip <= Nanoseconds{0}) {
    ++counters_.hellos_to_measure;
    send(wire::Refusal{.client_nonce = hello.client_nonce,
                       .reason = RefusalReason::round_trip_wanted,
                       .text = "send Hello again, with the round trip measured by this answer",
                       .client_time = hello.client_time},
         from);
    return;
  }
  let_in(hello, std::move(wanted.kind), guest, now);
}

void Server::let_in(const wire::Hello& hello, std::shared_ptr<const EnvironmentKind> kind, const Guest& guest,
                    Nanoseconds now) {
  const net::Address& from = guest.address;
  const std::string name = kind->name;
  const Session* session = nullptr;
  const auto refuse_for_memory = [&](const MemoryBudget::Refusal& too_much) {
    refuse(hello, from, {too_much.for_now ? RefusalReason::server_full : RefusalReason::unknown_scene, too_much.text});
  };
  try {
    std::unique_lock<std::mutex> making;
    if (options_.worker.limits != nullptr && memory_.measures()) {
      making = options_.worker.limits->try_making();
      if (!making) {  // waiting for another worker's scene would delay the answers of other sessions
        ++counters_.hellos_too_early;
        return;
      }
    }
    if (const auto too_much = memory_.refusal_of(name); !too_much.text.empty()) return refuse_for_memory(too_much);
    const std::size_t before = memory_.in_use();
    MadeEnvironment made = make_for(hello, *kind);
    if (is_law_of_wrong_point(hello, made))
      return refuse(hello, from, {RefusalReason::unknown_server_law, refusal_of_law(hello, name)});
    expect_spare_memory();
    if (const auto too_much = memory_.refusal_of_made(name, before); !too_much.text.empty())
      return refuse_for_memory(too_much);
    session = &open(hello, std::move(kind), std::move(made), guest, now);
  } catch (const std::bad_alloc&) {
    refuse(hello, from, {RefusalReason::server_full, refusal_for_now(name, kNoMemory)});
    return;
  } catch (const std::exception& error) {
    refuse(hello, from, {RefusalReason::server_full, refusal_for_now(name, error.what())});
    return;
  }
  welcome(*session);
  try {
    observer_.on_opened(session->info);
  } catch (const std::bad_alloc&) {  // it stays open, without a line in the log
  }
}

void Server::refuse_for_lack_of_memory(const wire::Hello& hello, const net::Address& from) noexcept {
  ++counters_.hellos_out_of_memory;
  try {
    refuse(hello, from, {RefusalReason::server_full, std::string("the server has ") + kNoMemory});
  } catch (const std::bad_alloc&) {  // the client repeats its Hello
  }
}

void Server::refuse(const wire::Hello& hello, const net::Address& from, const Refused& refused) {
  ++counters_.hellos_refused;
  wire::Refusal refusal{.client_nonce = hello.client_nonce, .reason = refused.reason, .text = refused.text};
  if (refused.reason == RefusalReason::version_mismatch) refusal.protocol_version = wire::kProtocolVersion;
  send(refusal, from);
  observer_.on_refused(from, refused.text);
}

void Server::refuse_hello(std::span<const std::byte> datagram, const net::Address& from, std::string_view why) {
  const auto decoded = codec_.decode(datagram);
  const auto* const message = std::get_if<wire::Message>(&decoded);
  const auto* const hello = message == nullptr ? nullptr : std::get_if<wire::Hello>(message);
  if (hello == nullptr) return;
  try {
    refuse(*hello, from, {RefusalReason::server_full, std::string(why)});
  } catch (const std::bad_alloc&) {
    refuse_for_lack_of_memory(*hello, from);
  }
}

bool Server::is_allowed(std::string_view scene) const {
  return options_.scenes.empty() || scene.empty() || scene == options_.scene ||
         std::ranges::find(options_.scenes, scene) != options_.scenes.end();
}

std::string Server::refusal_of_scene(std::string_view scene) const {
  std::string known = options_.scene;
  for (const std::string& name : options_.scenes) {
    if (name != options_.scene) known += ", " + name;
  }
  return "this server does not offer scene '" + printable(scene) + "' (offered: " + known + ")";
}

std::uint64_t Server::new_session_number() {
  std::uint64_t number = session_ids_();
  // Zero means "no session" on the wire.
  while (number == 0 || !options_.worker.owns(number) || sessions_.contains(number)) number = session_ids_();
  return number;
}

Server::Session* Server::find(const net::Address& address, std::uint64_t nonce) noexcept {
  for (auto& [id, session] : sessions_) {
    if (session.nonce == nonce && session.info.address == address) return &session;
  }
  return nullptr;
}

Server::Session& Server::open(const wire::Hello& hello, std::shared_ptr<const EnvironmentKind> kind,
                              MadeEnvironment made, const Guest& guest, Nanoseconds now) {
  const std::uint64_t id = new_session_number();
  SharedLimits::Place place = place_for(id, guest);
  const double period_s = believed_period_s(hello);
  const double interval_s = answered_every_s(period_s, options_.motions_per_promised, guest.rights);
  SessionInfo info{.session = id,
                   .address = guest.address,
                   .device = printable(hello.device),
                   .degrees_of_freedom = hello.degrees_of_freedom,
                   .scene = kind->name,
                   .client = printable(guest.rights.name),
                   .choice = made.choice};
  Session session{.info = std::move(info),
                  .nonce = hello.client_nonce,
                  .kind = std::move(kind),
                  .made = std::move(made),
                  .place = std::move(place),
                  .server_side = {.law = options_.laws.make_server_side(hello.server_law,
                                                                        static_cast<int>(hello.degrees_of_freedom))},
                  .rate = time::TokenBucket(time::from_seconds(interval_s), burst(std::max(period_s, interval_s)), now),
                  .hellos = time::TokenBucket(kRepeatedHelloInterval, kRepeatedHellosAtOnce, now),
                  .last_heard = now,
                  .last_moved = now,
                  .proven_at = guest.address,
                  .compute = ComputeShare(options_.session_compute_max, now)};
  session.arrivals.counts.session = id;
  // What it may send is not what is answered: its numbers go on meanwhile.
  session.arrivals.motions_per_s_max = options_.motions_per_promised / period_s;
  session.client = guest.rights.key;
  session.wants_models = renders_locally(hello);
  if (session.wants_models && session.made.packed)
    session.sender = std::make_unique<SceneSender>(session.made.packed, options_.handover, now);
  if (hello.shows_scene) {
    auto looks = session.made.environment->looks(session.sender ? view::Which::not_handed_over : view::Which::all);
    if (looks) session.view = std::make_unique<ViewSender>(std::move(looks), options_.view, now);
  }
  ++counters_.sessions_opened;
  Session& opened = sessions_.emplace(id, std::move(session)).first->second;
  sessions_since_noted_ = std::max(sessions_since_noted_, sessions_.size());
  return opened;
}

void Server::welcome(const Session& session) {
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
}

}  // namespace forcebound::server
