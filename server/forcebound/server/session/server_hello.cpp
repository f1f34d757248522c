// The server's answers to Hellos: admission of clients, or refusal with the reason.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

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

std::string refusal_of_server_law(const control::LawRegistry& laws, std::string_view law) {
  std::string known;
  for (const std::string& name : laws.names()) {
    if (laws.find(name).make_server_side) known += (known.empty() ? "" : ", ") + name;
  }
  return "this server has no server-side law '" + printable(law) + "'" +
         (known.empty() ? " (known: none)" : " (known: " + known + ")");
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

std::string refusal_for_now(const std::string& scene, std::string_view why) {
  return "scene '" + scene + "' is not available at the moment: " + std::string(why);
}

std::string refusal_of_dof(const EnvironmentKind& kind, const wire::Hello& hello) {
  return "scene '" + kind.name + "' accepts devices with " + kind.accepted_degrees_of_freedom() +
         " degrees of freedom, device '" + printable(hello.device) + "' has " +
         std::to_string(hello.degrees_of_freedom);
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
  if (hello_is_over_rate(from, now)) {
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
      wanted.kind->sessions_max > 0 && home != options_.worker.number && !handed_) {
    elsewhere_ = home;
    return;
  }
  if (const auto refusal = refusal_of(hello, *wanted.kind, guest, now)) {
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
    const auto making =
        options_.worker.limits != nullptr ? options_.worker.limits->making() : std::unique_lock<std::mutex>();
    if (const auto too_much = memory_.refusal_of(name); !too_much.text.empty()) return refuse_for_memory(too_much);
    const std::size_t before = memory_.in_use();
    MadeEnvironment made = make_for(hello, *kind);
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

std::optional<Server::Refused> Server::refusal_of(const wire::Hello& hello, const EnvironmentKind& kind,
                                                  const Guest& guest, Nanoseconds now) {
  if (!kind.accepts(hello.degrees_of_freedom)) {
    return Refused{RefusalReason::wrong_degrees_of_freedom, refusal_of_dof(kind, hello)};
  }
  if (!hello.server_law.empty() &&
      !options_.laws.make_server_side(hello.server_law, static_cast<int>(hello.degrees_of_freedom))) {
    return Refused{RefusalReason::unknown_server_law, refusal_of_server_law(options_.laws, hello.server_law)};
  }
  if (options_.sessions_per_address > 0 && sessions_of(guest.address) >= options_.sessions_per_address) {
    return Refused{RefusalReason::server_full, "this server takes " + std::to_string(options_.sessions_per_address) +
                                                   " sessions at once from each address, end one or try again later"};
  }
  const auto of_client = [&](const Session& session) { return session.client == guest.rights.name; };
  if (const auto most = guest.rights.sessions_max;
      most && sessions_of(guest.rights.name) >= *most && !evict_one(now, of_client)) {
    return Refused{RefusalReason::server_full, "client '" + printable(guest.rights.name) +
                                                   "' has as many sessions as it may, " + std::to_string(*most) +
                                                   ": end one or try again later"};
  }
  if (std::string busy = refusal_of_load(kind, now); !busy.empty()) {
    return Refused{RefusalReason::server_full, std::move(busy)};
  }
  const auto in_scene = [&](const Session& session) { return session.kind.get() == &kind; };
  if (kind.sessions_max > 0 && sessions_among(in_scene) >= kind.sessions_max && !evict_one(now, in_scene)) {
    return Refused{RefusalReason::server_full, "all " + std::to_string(kind.sessions_max) +
                                                   " places in the shared scene '" + kind.name +
                                                   "' are taken, try again later"};
  }
  if (sessions_of_all() >= options_.sessions_max && !evict_one(now, {})) {
    return Refused{RefusalReason::server_full,
                   "all " + std::to_string(options_.sessions_max) + " sessions are taken, try again later"};
  }
  return std::nullopt;
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

bool Server::hello_is_over_rate(const net::Address& from, Nanoseconds now) noexcept {
  if (handed_) return false;
  SharedLimits* const limits = options_.worker.limits;
  return limits != nullptr ? !limits->take_hello(from, now) : !hellos_.take(from, now);
}

std::uint64_t Server::new_session_number() {
  std::uint64_t number = session_ids_();
  // Zero means "no session" on the wire.
  while (number == 0 || !options_.worker.owns(number) || sessions_.contains(number)) number = session_ids_();
  return number;
}

SharedLimits::Place Server::place_for(std::uint64_t session, const Guest& guest) {
  if (options_.worker.limits == nullptr) return {};
  auto place = options_.worker.limits->take(
      {.session = session, .address = guest.address, .client = std::string(guest.rights.name)},
      {.all = options_.sessions_max,
       .of_address = options_.sessions_per_address,
       .of_client = guest.rights.sessions_max ? std::optional<std::size_t>(*guest.rights.sessions_max) : std::nullopt});
  if (!place) throw std::runtime_error("others have just taken the last session, try again later");
  return std::move(*place);
}

std::size_t Server::sessions_of_all() const noexcept {
  return options_.worker.limits != nullptr ? options_.worker.limits->sessions() : sessions_.size();
}

std::size_t Server::sessions_of(std::string_view client) const noexcept {
  if (options_.worker.limits != nullptr) return options_.worker.limits->sessions_of(client);
  return static_cast<std::size_t>(
      std::ranges::count_if(sessions_, [&](const auto& entry) { return entry.second.client == client; }));
}

std::size_t Server::sessions_of(const net::Address& address) const noexcept {
  if (options_.worker.limits != nullptr) return options_.worker.limits->sessions_of(address);
  return static_cast<std::size_t>(std::count_if(
      sessions_.begin(), sessions_.end(), [&](const auto& entry) { return entry.second.proven_at.ip == address.ip; }));
}

/// Another session will take as much as those in the same scene do on average; and as much of what belongs to no scene.
std::string Server::refusal_of_load(const EnvironmentKind& kind, Nanoseconds now) {
  if (sessions_.empty()) return {};
  double all = 0;
  double of_kind = 0;
  int there = 0;
  for (auto& [id, session] : sessions_) {
    const double share = session.compute.share(now);
    all += share;
    if (session.kind.get() != &kind) continue;
    of_kind += share;
    ++there;
  }
  const double load = std::max(all, busy_);
  // Those that the load is of may have left.
  const auto sharing = static_cast<double>(std::max(sessions_.size(), busy_with_));
  const double expected = std::max(there > 0 ? of_kind / there : 0, (load - all) / sharing);
  if (load + expected <= options_.load_max) return {};
  const auto percent = [](double share) { return std::to_string(std::lround(share * 1e2)) + " %"; };
  return "this server is busy: its sessions take " + percent(load) +
         " of its processor's time, and one more would take " + percent(expected) + ", of " +
         percent(options_.load_max) + " at most; try again later";
}

std::size_t Server::sessions_among(const Among& among) const {
  return static_cast<std::size_t>(
      std::count_if(sessions_.begin(), sessions_.end(), [&](const auto& entry) { return among(entry.second); }));
}

std::optional<Nanoseconds> Server::idle_since(const Session& session, Nanoseconds now,
                                              bool places_are_few) const noexcept {
  // A real client sends motion at once; one that never did may have a forged address.
  constexpr Nanoseconds kProofTime = std::chrono::seconds{1};
  const bool unproven = session.arrivals.counts.motions_received == 0 && now - session.last_heard > kProofTime;
  const bool absent = places_are_few && now - session.last_heard > options_.presence_timeout;
  if (unproven || absent) return session.last_heard;
  const bool still = places_are_few && now - session.last_moved > options_.stillness_timeout;
  return still ? std::optional(session.last_moved) : std::nullopt;
}

bool Server::evict_one(Nanoseconds now, const Among& among) {
  auto oldest = sessions_.end();
  Nanoseconds since = now;
  for (auto it = sessions_.begin(); it != sessions_.end(); ++it) {
    if (among && !among(it->second)) continue;
    const auto idle = idle_since(it->second, now, static_cast<bool>(among));
    if (!idle || *idle >= since) continue;
    since = *idle;
    oldest = it;
  }
  if (oldest == sessions_.end()) return false;
  const Session& session = oldest->second;
  const bool is_there =
      session.arrivals.counts.motions_received > 0 && now - session.last_heard <= options_.presence_timeout;
  ++(is_there ? counters_.sessions_still : counters_.sessions_idle);
  if (session.arrivals.counts.motions_received > 0) send(session.arrivals.counts, session.proven_at);
  close(session, is_there ? CloseReason::did_not_move : CloseReason::idle);
  sessions_.erase(oldest);
  return true;
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
  session.client = guest.rights.name;
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
