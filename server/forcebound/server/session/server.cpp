#include "forcebound/server/session/server.hpp"

#include <algorithm>
#include <exception>
#include <new>
#include <stdexcept>
#include <utility>

#include "forcebound/control/assertion.hpp"

namespace forcebound::server {
namespace {

// Most refusals per second of motion of unknown sessions: enough for every client after a restart.
constexpr Nanoseconds kRefusalInterval = std::chrono::milliseconds{1};
constexpr int kRefusalsAtOnce = 100;
constexpr int kViewPiecesAtOnce = 100;

/// A worker's part of what all may do together.
int part_of(int all, const WorkerPlace& worker) noexcept { return std::max(1, all / static_cast<int>(worker.workers)); }

// A motion may overtake the time since the newest by as much as the network's delay shrinks: 12 s has been observed.
constexpr Nanoseconds kDelayShrinksMost = std::chrono::seconds{16};

// Number of ended sessions remembered; searched for each motion of an unknown session.
constexpr std::size_t kEndedMax = 64;

}  // namespace

Server::Server(ServerOptions options, EnvironmentLibrary environments, net::DatagramLink& link,
               const time::Clock& clock, std::function<std::uint64_t()> session_ids, ServerObserver* observer)
    : options_(std::move(options)),
      environments_(std::move(environments)),
      link_(link),
      clock_(clock),
      session_ids_(std::move(session_ids)),
      observer_(observer == nullptr ? nobody_ : *observer),
      memory_(options_.memory),
      hellos_(options_.hellos_per_s_max, clock.now(), session_ids_()),
      refusals_(kRefusalInterval * options_.worker.workers, part_of(kRefusalsAtOnce, options_.worker), clock.now()),
      views_(Nanoseconds{std::chrono::seconds{1}} / part_of(options_.view.pieces_per_s_all, options_.worker),
             part_of(kViewPiecesAtOnce, options_.worker), clock.now()) {
  if (!environments_.find(options_.scene)) throw std::invalid_argument(environments_.unknown_text(options_.scene));
  if (options_.sessions_max == 0 || options_.idle_timeout <= Nanoseconds{0} || options_.hellos_per_s_max < 1 ||
      !(options_.motions_per_promised > 0) || !(options_.session_compute_max > 0) || !(options_.load_max > 0)) {
    throw std::invalid_argument(
        "sessions_max, idle_timeout, motions_per_promised, hellos_per_s_max, session_compute_max and load_max must be "
        "> 0");
  }
  sessions_.reserve(options_.sessions_max);
  waiting_.reserve(2 * options_.sessions_max);
  ended_.resize(std::min(options_.sessions_max, kEndedMax));
}

void Server::on_datagram(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now,
                         const ClientRights& rights) {
  take_in(datagram, from, now, rights);
  answer_waiting();
}

void Server::note_busy(double share, std::uint64_t datagrams) noexcept {
  const std::uint64_t before = std::exchange(motions_when_noted_, counters_.motions_received);
  const double motions = static_cast<double>(counters_.motions_received - before);
  busy_ = share * std::min(1.0, motions / static_cast<double>(std::max<std::uint64_t>(1, datagrams)));
  busy_with_ = std::exchange(sessions_since_noted_, sessions_.size());
}

void Server::answer_waiting() noexcept {
  while (answer_next()) {
  }
}

bool Server::answer_next() noexcept {
  while (next_waiting_ < waiting_.size()) {
    const auto found = sessions_.find(waiting_[next_waiting_++]);
    if (found == sessions_.end() || !found->second.waiting) continue;
    if (sessions_.size() > 1 && !found->second.compute.may_answer(clock_.now())) {
      found->second.waiting.reset();
      ++counters_.motions_over_budget;
      continue;
    }
    answer(found->second, *std::exchange(found->second.waiting, std::nullopt));
    return true;
  }
  waiting_.clear();
  next_waiting_ = 0;
  return false;
}

void Server::take_in(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now,
                     const ClientRights& rights) {
  ++counters_.datagrams;
  take_in(datagram, Guest{.address = from, .rights = rights}, now);
}

void Server::take_in_judged(std::span<const std::byte> hello, const net::Address& from, Nanoseconds now,
                            const ClientRights& rights) {
  take_in(hello, Guest{.address = from, .rights = rights, .judged = true}, now);
}

void Server::take_in(std::span<const std::byte> datagram, const Guest& sender, Nanoseconds now) {
  elsewhere_.reset();
  const net::Address& from = sender.address;
  const auto heading = wire::heading_of(datagram);
  if (const auto* malformed = std::get_if<wire::Malformed>(&heading)) {
    ++counters_.malformed[static_cast<std::size_t>(*malformed)];
    return;
  }
  if (is_dropped(std::get<wire::Heading>(heading), datagram.size(), from, now)) return;
  const auto decoded = codec_.decode(datagram, std::get<wire::Heading>(heading));
  if (const auto* malformed = std::get_if<wire::Malformed>(&decoded)) {
    ++counters_.malformed[static_cast<std::size_t>(*malformed)];
    return;
  }
  const auto& message = std::get<wire::Message>(decoded);
  if (is_of_another(message, sender.rights)) {
    ++counters_.datagrams_of_others;
    return;
  }
  if (const auto* motion = std::get_if<wire::MotionSample>(&message)) {
    on_motion(*motion, datagram.size(), from, now);
  } else if (const auto* hello = std::get_if<wire::Hello>(&message)) {
    try {
      on_hello(*hello, sender, now);
    } catch (const std::bad_alloc&) {
      refuse_for_lack_of_memory(*hello, from);
    }
  } else if (const auto* bye = std::get_if<wire::Bye>(&message)) {
    on_bye(*bye, datagram.size(), from);
  }
}

bool Server::is_of_another(const wire::Message& message, const ClientRights& rights) const noexcept {
  const auto* const motion = std::get_if<wire::MotionSample>(&message);
  const auto* const bye = std::get_if<wire::Bye>(&message);
  if (motion == nullptr && bye == nullptr) return false;
  const auto found = sessions_.find(motion != nullptr ? motion->session : bye->session);
  return found != sessions_.end() && found->second.client != rights.key;
}

bool Server::is_dropped(const wire::Heading& heading, std::size_t bytes, const net::Address& from,
                        Nanoseconds now) noexcept {
  if (heading.is<wire::MotionSample>()) {
    if (sessions_.contains(heading.session) || find_ended(heading.session) != nullptr) return false;
    ++counters_.motions_without_session;
    // Nobody is answered more than was sent, whoever the address belongs to.
    const wire::Refusal refusal{.session = heading.session, .reason = wire::RefusalReason::unknown_session};
    if (refusals_.take(now) && codec_.encode(refusal).size() <= bytes) send(refusal, from);
    return true;
  }
  if (heading.is<wire::Hello>() || heading.is<wire::Bye>() || heading.kind >= std::variant_size_v<wire::Message>) {
    return false;
  }
  ++counters_.unexpected;
  return true;
}

void Server::on_timer(Nanoseconds now) {
  std::erase_if(sessions_, [&](const auto& entry) {
    const Session& session = entry.second;
    if (is_wanted_elsewhere(session, now)) {
      give_up_place(session, now);
      return true;
    }
    if (now - session.last_heard < options_.idle_timeout) return false;
    ++counters_.sessions_idle;
    // If only the direction to the server is dead, the client learns it. A client that never sent motion may be forged.
    if (session.arrivals.counts.motions_received > 0) send(session.arrivals.counts, session.proven_at);
    close(session, CloseReason::idle);
    return true;
  });
}

void Server::stop() {
  for (const auto& [id, session] : sessions_) {
    send(session.arrivals.counts, session.proven_at);
    close(session, CloseReason::server_stops);
  }
  sessions_.clear();
}

bool Server::end_session(std::uint64_t session) {
  const auto found = sessions_.find(session);
  if (found == sessions_.end()) return false;
  ++counters_.sessions_removed;
  send(found->second.arrivals.counts, found->second.proven_at);
  close(found->second, CloseReason::was_asked_to);
  sessions_.erase(found);
  return true;
}

std::size_t Server::end_sessions_unless(const std::function<bool(std::string_view key)>& may_stay) {
  std::vector<std::uint64_t> ending;
  for (const auto& [id, session] : sessions_) {
    if (!session.client.empty() && !may_stay(session.client)) ending.push_back(id);
  }
  for (const std::uint64_t id : ending) (void)end_session(id);
  return ending.size();
}

ServerCounters Server::counters() const noexcept {
  ServerCounters total = counters_;
  for (const auto& [id, session] : sessions_) {
    total.add(session.made.environment->faults());
  }
  return total;
}

Server::Ended* Server::find_ended(std::uint64_t session) noexcept {
  if (session == 0) return nullptr;
  const auto found = std::find_if(ended_.begin(), ended_.end(),
                                  [&](const Ended& ended) { return ended.arrivals.counts.session == session; });
  return found == ended_.end() ? nullptr : &*found;
}

time::SequenceWindow::Arrival Server::note(Arrivals& arrivals, std::uint64_t sequence, Nanoseconds now) noexcept {
  using Arrival = time::SequenceWindow::Arrival;
  const double elapsed_s =
      time::to_seconds(std::max(now - arrivals.newest_arrived, Nanoseconds{0}) + kDelayShrinksMost);
  constexpr double kCountMost = 1e15;  // of a rate without end
  const auto sent_most = static_cast<std::uint64_t>(std::min(elapsed_s * arrivals.motions_per_s_max, kCountMost));
  const Arrival arrival = arrivals.window.note(sequence, std::max(sent_most, time::SequenceWindow::kNumbers));
  if (arrival == Arrival::too_far_ahead) {
    ++counters_.motions_far_ahead;
    return arrival;
  }
  if (arrival == Arrival::newest) arrivals.newest_arrived = now;
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
    arrivals.counts.motions_behind = std::max(arrivals.counts.motions_behind, arrivals.window.newest() - sequence);
  }
  return arrival;
}

void Server::on_motion(const wire::MotionSample& motion, std::size_t bytes, const net::Address& from,
                       Nanoseconds now) noexcept {
  using Arrival = time::SequenceWindow::Arrival;
  const auto found = sessions_.find(motion.session);
  if (found == sessions_.end()) {
    if (Ended* ended = find_ended(motion.session)) {
      counters_.motions_after_end += note(ended->arrivals, motion.sequence, now) == Arrival::newest;
    }
    return;
  }
  Session& session = found->second;
  if (motion.position.rows() != static_cast<Eigen::Index>(session.info.degrees_of_freedom)) {
    ++counters_.motions_of_wrong_size;
    return;
  }
  const auto arrival = note(session.arrivals, motion.sequence, now);
  if (arrival == Arrival::duplicate || arrival == Arrival::too_far_ahead) return;
  session.last_heard = now;
  if (arrival == Arrival::late) return;
  note_place(session, motion.position, now);
  follow(session, motion, bytes, from);
  if (!session.rate.take(now)) {
    ++counters_.motions_over_rate;
    return;
  }
  if (std::exchange(session.waiting, Waiting{motion, now})) {
    ++counters_.motions_superseded;
    return;
  }
  // Stays bounded even if a client opens and ends many sessions between two answers.
  if (waiting_.size() == waiting_.capacity()) answer_waiting();
  FORCEBOUND_ASSERT(waiting_.size() < waiting_.capacity(), "a motion that waits needs no memory of its own");
  waiting_.push_back(motion.session);
}

void Server::note_place(Session& session, const Vector& position, Nanoseconds now) noexcept {
  constexpr double kStill_m = 1e-3;
  if (session.stays_at.rows() == position.rows() && (position - session.stays_at).norm() <= kStill_m) return;
  session.stays_at = position;
  session.last_moved = now;
}

void Server::follow(Session& session, const wire::MotionSample& motion, std::size_t bytes,
                    const net::Address& from) noexcept {
  if (session.info.address != from) {
    ++counters_.addresses_changed;
    session.info.address = from;
    session.amplification.begin(new_challenge());
    if (from == session.proven_at) session.amplification.prove();
  }
  session.amplification.count_received(bytes, motion.challenge);
  if (session.amplification.proven()) session.proven_at = from;
}

std::uint64_t Server::new_challenge() noexcept {
  try {
    return session_ids_();
  } catch (const std::exception&) {
    return 0;  // without randomness no address can be proven
  }
}

void Server::on_bye(const wire::Bye& bye, std::size_t bytes, const net::Address& from) {
  if (const auto found = sessions_.find(bye.session); found != sessions_.end()) {
    const Session& session = found->second;
    answer_bye(session.arrivals.counts, bytes, from, session.proven_at);
    ended_[ended_next_++ % ended_.size()] = {session.nonce, session.proven_at, session.arrivals};
    ++counters_.sessions_ended;
    close(session, CloseReason::client_said_bye);
    sessions_.erase(found);
    return;
  }
  if (const Ended* ended = find_ended(bye.session)) {
    ++counters_.byes_repeated;
    answer_bye(ended->arrivals.counts, bytes, from, ended->address);
    return;
  }
  ++counters_.byes_unknown;
}

void Server::answer_bye(const wire::Bye& counts, std::size_t bytes, const net::Address& from,
                        const net::Address& proven_at) {
  if (from == proven_at || codec_.encode(counts).size() <= bytes) send(counts, from);
}

bool Server::send_encoded(std::span<const std::byte> datagram, const net::Address& to) noexcept {
  const bool sent = link_.send(datagram, to);
  if (!sent) ++counters_.sends_failed;
  return sent;
}

void Server::close(const Session& session, CloseReason reason) {
  counters_.add(session.made.environment->faults());
  counters_.motions_after_end += session.waiting.has_value();
  observer_.on_closed(session.info, reason, session.arrivals.counts);
}

}  // namespace forcebound::server
