#include "forcebound/server/session/server.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "forcebound/server/scene/explain.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

using text::printable;
using wire::RefusalReason;

// A client may promise anything; we believe it within reason.
constexpr double kPeriodLeast_s = 100e-6;
constexpr double kPeriodMost_s = 1;

// As much as one second promises may come at once, after a network held it back.
int burst(double period_s) { return std::max(16, static_cast<int>(1 / period_s)); }

// Motion of a session that we do not know is answered this often at most: enough for every client after a restart.
constexpr Nanoseconds kRefusalInterval = std::chrono::milliseconds{1};
constexpr int kRefusalsAtOnce = 100;

// So many ended sessions are looked through for each motion of none.
constexpr std::size_t kEndedMax = 64;

std::string refusal_of_version(std::uint32_t version) {
  return "this server speaks protocol version " + std::to_string(wire::kProtocolVersion) + ", the client " +
         std::to_string(version);
}

std::string refusal_of_dof(const Scene& scene, const wire::Hello& hello) {
  return "scene '" + scene.facts().name + "' accepts devices with " + scene.accepted_degrees_of_freedom() +
         " degrees of freedom, device '" + printable(hello.device) + "' has " +
         std::to_string(hello.degrees_of_freedom);
}

}  // namespace

Server::Server(ServerOptions options, SceneLibrary scenes, net::DatagramLink& link, const time::Clock& clock,
               std::function<std::uint64_t()> session_ids, ServerObserver* observer)
    : options_(std::move(options)),
      scenes_(std::move(scenes)),
      link_(link),
      clock_(clock),
      session_ids_(std::move(session_ids)),
      observer_(observer == nullptr ? nobody_ : *observer),
      hellos_(Nanoseconds{std::chrono::seconds{1}} / std::max(1, options_.hellos_per_s_max),
              std::max(1, options_.hellos_per_s_max), clock.now()),
      refusals_(kRefusalInterval, kRefusalsAtOnce, clock.now()) {
  if (!scenes_.find(options_.scene)) throw std::invalid_argument(scenes_.unknown_scene_text(options_.scene));
  if (options_.sessions_max == 0 || options_.idle_timeout <= Nanoseconds{0} || options_.hellos_per_s_max < 1 ||
      !(options_.motions_per_promised > 0)) {
    throw std::invalid_argument("sessions_max, idle_timeout, motions_per_promised, hellos_per_s_max must be > 0");
  }
  sessions_.reserve(options_.sessions_max);
  waiting_.reserve(2 * options_.sessions_max);
  ended_.resize(std::min(options_.sessions_max, kEndedMax));
}

void Server::on_datagram(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now) {
  take_in(datagram, from, now);
  answer_waiting();
}

void Server::answer_waiting() noexcept {
  while (answer_next()) {
  }
}

bool Server::answer_next() noexcept {
  while (next_waiting_ < waiting_.size()) {
    const auto found = sessions_.find(waiting_[next_waiting_++]);
    if (found == sessions_.end() || !std::exchange(found->second.waits, false)) continue;
    answer(found->second);
    return true;
  }
  waiting_.clear();
  next_waiting_ = 0;
  return false;
}

void Server::take_in(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now) {
  ++counters_.datagrams;
  const auto decoded = codec_.decode(datagram);
  if (const auto* malformed = std::get_if<wire::Malformed>(&decoded)) {
    ++counters_.malformed[static_cast<std::size_t>(*malformed)];
    return;
  }
  const auto& message = std::get<wire::Message>(decoded);
  if (const auto* motion = std::get_if<wire::MotionSample>(&message)) {
    on_motion(*motion, from, now);
  } else if (const auto* hello = std::get_if<wire::Hello>(&message)) {
    on_hello(*hello, from, now);
  } else if (const auto* bye = std::get_if<wire::Bye>(&message)) {
    on_bye(*bye, from);
  } else {
    ++counters_.unexpected;
  }
}

void Server::on_timer(Nanoseconds now) {
  std::erase_if(sessions_, [&](const auto& entry) {
    const Session& session = entry.second;
    if (now - session.last_heard < options_.idle_timeout) return false;
    ++counters_.sessions_idle;
    // If only the way up is dead, its client learns so. Who never sent motion may be somebody else's address.
    if (session.arrivals.counts.motions_received > 0) send(session.arrivals.counts, session.info.address);
    close(session, CloseReason::idle);
    return true;
  });
}

void Server::stop() {
  for (const auto& [id, session] : sessions_) {
    send(session.arrivals.counts, session.info.address);
    close(session, CloseReason::server_stops);
  }
  sessions_.clear();
}

ServerCounters Server::counters() const noexcept {
  ServerCounters total = counters_;
  for (const auto& [id, session] : sessions_) {
    total.add(session.scene.faults());
  }
  return total;
}

void Server::on_hello(const wire::Hello& hello, const net::Address& from, Nanoseconds now) {
  // Who is here already is answered even while strangers use up the rate.
  if (const Session* session = find(from, hello.client_nonce)) {
    ++counters_.hellos_repeated;
    welcome(*session);
    return;
  }
  if (!hellos_.take(now)) {
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
    refuse(hello, from, {RefusalReason::version_mismatch, refusal_of_version(hello.protocol_version)});
    return;
  }
  const auto wanted = scenes_.request(hello.scene.empty() ? std::string_view{options_.scene} : hello.scene);
  if (wanted.coming) {
    // Whose motions are answered meanwhile shall not wait; the client says Hello again.
    ++counters_.hellos_too_early;
    return;
  }
  if (!wanted.why_not.empty()) {
    refuse(hello, from,
           {RefusalReason::server_full,
            "scene '" + printable(hello.scene) + "' cannot be had at the moment: " + wanted.why_not});
    return;
  }
  if (!wanted.scene) {
    refuse(hello, from, {RefusalReason::unknown_scene, scenes_.unknown_scene_text(printable(hello.scene))});
    return;
  }
  if (const auto refusal = refusal_of(hello, *wanted.scene, now)) {
    refuse(hello, from, *refusal);
    return;
  }
  Session& session = open(hello, wanted.scene, from, now);
  welcome(session);
  observer_.on_opened(session.info);
}

void Server::refuse(const wire::Hello& hello, const net::Address& from, const Refused& refused) {
  ++counters_.hellos_refused;
  send(wire::Refusal{.client_nonce = hello.client_nonce, .reason = refused.reason, .text = refused.text}, from);
  observer_.on_refused(from, refused.text);
}

std::optional<Server::Refused> Server::refusal_of(const wire::Hello& hello, const Scene& scene, Nanoseconds now) {
  if (!scene.accepts(hello.degrees_of_freedom)) {
    return Refused{RefusalReason::wrong_degrees_of_freedom, refusal_of_dof(scene, hello)};
  }
  if (scene.facts().shared && is_full(scene) && !evict_unproven(now, &scene)) {
    return Refused{RefusalReason::server_full, "all " + std::to_string(scene.facts().clients_max) +
                                                   " places in the shared scene '" + scene.facts().name +
                                                   "' are taken, try again later"};
  }
  if (sessions_.size() >= options_.sessions_max && !evict_unproven(now, nullptr)) {
    return Refused{RefusalReason::server_full,
                   "all " + std::to_string(options_.sessions_max) + " sessions are taken, try again later"};
  }
  return std::nullopt;
}

bool Server::is_full(const Scene& scene) const {
  const auto there = std::count_if(sessions_.begin(), sessions_.end(),
                                   [&](const auto& entry) { return &entry.second.scene.scene() == &scene; });
  return there >= scene.facts().clients_max;
}

SceneState Server::enter(const std::shared_ptr<const Scene>& scene, std::uint32_t degrees_of_freedom) const {
  if (!scene->facts().shared) return {scene, degrees_of_freedom};
  for (const auto& [id, session] : sessions_) {
    if (&session.scene.scene() != scene.get()) continue;
    const MediaNow media = session.scene.media();
    const bool sound = std::all_of(media.begin(), media.end(), [](const auto& now) { return now->state().sound(); });
    if (sound) return {scene, degrees_of_freedom, media};
  }
  return {scene, degrees_of_freedom, begin_media(*scene, scene->facts().clients_max)};
}

bool Server::evict_unproven(Nanoseconds now, const Scene* scene) {
  // A client that is there sends motion at once; who never did may be nobody at all.
  constexpr Nanoseconds kProofTime = std::chrono::seconds{1};
  auto oldest = sessions_.end();
  for (auto it = sessions_.begin(); it != sessions_.end(); ++it) {
    const Session& session = it->second;
    const bool unproven = session.arrivals.counts.motions_received == 0 && now - session.last_heard > kProofTime;
    if (scene != nullptr && &session.scene.scene() != scene) continue;
    if (unproven && (oldest == sessions_.end() || session.last_heard < oldest->second.last_heard)) oldest = it;
  }
  if (oldest == sessions_.end()) return false;
  ++counters_.sessions_idle;
  close(oldest->second, CloseReason::idle);
  sessions_.erase(oldest);
  return true;
}

Server::Session* Server::find(const net::Address& address, std::uint64_t nonce) noexcept {
  for (auto& [id, session] : sessions_) {
    if (session.nonce == nonce && session.info.address == address) return &session;
  }
  return nullptr;
}

Server::Session& Server::open(const wire::Hello& hello, const std::shared_ptr<const Scene>& scene,
                              const net::Address& from, Nanoseconds now) {
  std::uint64_t id = session_ids_();
  // Zero means "no session" on the wire.
  while (id == 0 || sessions_.contains(id)) id = session_ids_();

  const double period_s = std::clamp(hello.period_s, kPeriodLeast_s, kPeriodMost_s);
  SessionInfo info{.session = id,
                   .address = from,
                   .device = printable(hello.device),
                   .degrees_of_freedom = hello.degrees_of_freedom,
                   .scene = scene->facts().name};
  Session session{
      .info = std::move(info),
      .nonce = hello.client_nonce,
      .scene = enter(scene, hello.degrees_of_freedom),
      .rate = time::TokenBucket(time::from_seconds(period_s / options_.motions_per_promised), burst(period_s), now),
      .last_heard = now};
  session.arrivals.counts.session = id;
  ++counters_.sessions_opened;
  return sessions_.emplace(id, std::move(session)).first->second;
}

void Server::welcome(const Session& session) {
  const Scene& scene = session.scene.scene();
  const std::string simulated = summary(scene);
  send(wire::Welcome{.client_nonce = session.nonce,
                     .session = session.info.session,
                     .scene_hash = scene.facts().hash,
                     .scene = scene.facts().name,
                     .simulated = simulated},
       session.info.address);
}

Server::Ended* Server::find_ended(std::uint64_t session) noexcept {
  if (session == 0) return nullptr;
  const auto found = std::find_if(ended_.begin(), ended_.end(),
                                  [&](const Ended& ended) { return ended.arrivals.counts.session == session; });
  return found == ended_.end() ? nullptr : &*found;
}

wire::SequenceWindow::Arrival Server::note(Arrivals& arrivals, std::uint64_t sequence) noexcept {
  using Arrival = wire::SequenceWindow::Arrival;
  const Arrival arrival = arrivals.window.note(sequence);
  if (arrival == Arrival::duplicate) {
    ++arrivals.counts.motions_duplicated;
    ++counters_.motions_duplicated;
    return arrival;
  }
  ++arrivals.counts.motions_received;
  ++counters_.motions_received;
  if (arrival == Arrival::late) {
    ++arrivals.counts.motions_reordered;
    ++counters_.motions_reordered;
  }
  return arrival;
}

void Server::on_motion(const wire::MotionSample& motion, const net::Address& from, Nanoseconds now) noexcept {
  const auto found = sessions_.find(motion.session);
  if (found == sessions_.end()) {
    if (Ended* ended = find_ended(motion.session)) {
      (void)note(ended->arrivals, motion.sequence);
      return;
    }
    ++counters_.motions_without_session;
    if (!refusals_.take(now)) return;
    send(wire::Refusal{.session = motion.session, .reason = RefusalReason::unknown_session}, from);
    return;
  }
  Session& session = found->second;
  if (motion.position.rows() != static_cast<Eigen::Index>(session.info.degrees_of_freedom)) {
    ++counters_.motions_of_wrong_size;
    return;
  }
  const auto arrival = note(session.arrivals, motion.sequence);
  if (arrival == wire::SequenceWindow::Arrival::duplicate) return;
  session.last_heard = now;
  if (arrival == wire::SequenceWindow::Arrival::late) return;
  if (session.info.address != from) {
    ++counters_.addresses_changed;
    session.info.address = from;
  }
  if (!session.rate.take(now)) {
    ++counters_.motions_over_rate;
    return;
  }
  session.waiting = motion;
  session.waiting_since = now;
  if (std::exchange(session.waits, true)) {
    ++counters_.motions_overtaken;
    return;
  }
  // Nobody who opens sessions and ends them between two answers shall make this grow.
  if (waiting_.size() == waiting_.capacity()) answer_waiting();
  waiting_.push_back(motion.session);
}

void Server::answer(Session& session) noexcept {
  const wire::MotionSample& motion = session.waiting;
  const Nanoseconds now = session.waiting_since;
  observer_.on_motion(motion);
  const Nanoseconds begin = clock_.now();
  const SceneAnswer scene = session.scene.answer(motion.position, motion.device_time, now);
  const Nanoseconds end = clock_.now();

  const auto wave = [&](int i) {
    const bool any = scene.texture.amplitude_N > 0 && i < scene.texture.waves;
    return any ? session.scene.in_device_rows(scene.texture.waves_rad_per_m.at(static_cast<std::size_t>(i))) : Vector();
  };
  const wire::EnvironmentForce force{.session = motion.session,
                                     .sequence = session.arrivals.counts.forces_sent + 1,
                                     .motion_sequence = motion.sequence,
                                     .motion_device_time = motion.device_time,
                                     .force = scene.force,
                                     .position = motion.position,
                                     .contact_normal = scene.contact_normal,
                                     .penetration_m = scene.penetration_m,
                                     .server_receive_time = now,
                                     .server_send_time = end,
                                     .compute_time = end - begin,
                                     .motions_received = session.arrivals.counts.motions_received,
                                     .motions_duplicated = session.arrivals.counts.motions_duplicated,
                                     .motions_reordered = session.arrivals.counts.motions_reordered,
                                     .texture_N = scene.texture.amplitude_N,
                                     .texture_wave = wave(0),
                                     .texture_across = wave(1)};
  for (const std::string* name : scene.quarantined) observer_.on_quarantined(session.info, *name);
  if (!send(force, session.info.address)) return;
  ++session.arrivals.counts.forces_sent;
  ++counters_.forces_sent;
  observer_.on_force(force);
}

void Server::on_bye(const wire::Bye& bye, const net::Address& from) {
  if (const auto found = sessions_.find(bye.session); found != sessions_.end()) {
    const Session& session = found->second;
    send(session.arrivals.counts, from);
    ended_[ended_next_++ % ended_.size()] = {session.nonce, session.info.address, session.arrivals};
    ++counters_.sessions_ended;
    close(session, CloseReason::client_said_bye);
    sessions_.erase(found);
    return;
  }
  if (const Ended* ended = find_ended(bye.session)) {
    ++counters_.byes_repeated;
    send(ended->arrivals.counts, from);
    return;
  }
  ++counters_.byes_unknown;
}

bool Server::send(const wire::Message& message, const net::Address& to) noexcept {
  const bool sent = link_.send(codec_.encode(message), to);
  if (!sent) ++counters_.sends_failed;
  return sent;
}

void Server::close(const Session& session, CloseReason reason) {
  counters_.add(session.scene.faults());
  observer_.on_closed(session.info, reason, session.arrivals.counts);
}

}  // namespace forcebound::server
