#include "forcebound/server/session/answerer.hpp"

#include <algorithm>
#include <exception>
#include <optional>
#include <span>
#include <string>
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

}  // namespace

Answerer::Answerer(const ServerOptions& options, const Parts& parts)
    : parts_(parts),
      refusals_(kRefusalInterval * options.worker.workers, part_of(kRefusalsAtOnce, options.worker), parts.clock.now()),
      views_(Nanoseconds{std::chrono::seconds{1}} / part_of(options.view.pieces_per_s_all, options.worker),
             part_of(kViewPiecesAtOnce, options.worker), parts.clock.now()) {
  waiting_.reserve(2 * options.sessions_max);
}

void Answerer::receive(const wire::MotionSample& motion, std::size_t bytes, const net::Address& from,
                       Nanoseconds now) noexcept {
  using Arrival = time::SequenceWindow::Arrival;
  ServerCounters& counters = parts_.counters;
  Session* const session = parts_.table.find(motion.session);
  if (session == nullptr) {
    if (auto* const ended = parts_.table.find_ended(motion.session)) {
      counters.motions_after_end += ended->arrivals.count(motion.sequence, now, counters) == Arrival::newest;
    }
    return;
  }
  if (motion.position.rows() != static_cast<Eigen::Index>(session->info.degrees_of_freedom)) {
    ++counters.motions_of_wrong_size;
    return;
  }
  const Arrival arrival = session->arrivals.count(motion.sequence, now, counters);
  if (arrival == Arrival::duplicate || arrival == Arrival::too_far_ahead) return;
  session->last_received = now;
  if (arrival == Arrival::late) return;
  session->store_place(motion.position, now);
  follow(*session, motion, bytes, from);
  if (!session->rate.take(now)) {
    ++counters.motions_over_rate;
    return;
  }
  if (std::exchange(session->waiting, WaitingMotion{motion, now})) {
    ++counters.motions_superseded;
    return;
  }
  // Stays bounded even if a client opens and ends many sessions between two answers.
  if (waiting_.size() == waiting_.capacity()) answer_waiting();
  FORCEBOUND_ASSERT(waiting_.size() < waiting_.capacity(), "a motion that waits needs no memory of its own");
  waiting_.push_back(motion.session);
}

void Answerer::refuse(std::uint64_t session, std::size_t bytes, const net::Address& from, Nanoseconds now) noexcept {
  ++parts_.counters.motions_without_session;
  if (!refusals_.take(now)) return;
  // Nobody is answered more than was sent, whoever the address belongs to.
  parts_.replies.send_within(bytes, wire::Refusal{.session = session, .reason = wire::RefusalReason::unknown_session},
                             from);
}

void Answerer::answer_waiting() noexcept {
  while (answer_next()) {
  }
}

bool Answerer::answer_next() noexcept {
  while (next_waiting_ < waiting_.size()) {
    Session* const session = parts_.table.find(waiting_[next_waiting_++]);
    if (session == nullptr || !session->waiting) continue;
    if (parts_.table.size() > 1 && !session->compute.may_answer(parts_.clock.now())) {
      session->waiting.reset();
      ++parts_.counters.motions_over_budget;
      continue;
    }
    answer(*session, *std::exchange(session->waiting, std::nullopt));
    return true;
  }
  waiting_.clear();
  next_waiting_ = 0;
  return false;
}

void Answerer::follow(Session& session, const wire::MotionSample& motion, std::size_t bytes,
                      const net::Address& from) noexcept {
  if (session.info.address != from) {
    ++parts_.counters.addresses_changed;
    session.info.address = from;
    session.amplification.begin(new_challenge());
    if (from == session.proven_at) session.amplification.prove();
  }
  session.amplification.count_received(bytes, motion.challenge);
  if (session.amplification.proven()) session.proven_at = from;
}

std::uint64_t Answerer::new_challenge() noexcept {
  try {
    return parts_.random();
  } catch (const std::exception&) {
    return 0;  // without randomness no address can be proven
  }
}

Answer Answerer::ask(Session& session, const Motion& motion) noexcept {
  const Answer answer = session.made.environment->respond(motion);
  if (answer::is_sound(answer, motion.position.rows())) return answer;
  ++parts_.counters.responses_unsound;
  if (!std::exchange(session.unsound_reported, true)) parts_.observer.on_unsound_response(session.info);
  return {.force = Vector::Zero(motion.position.rows())};
}

/// The one place that checks a model: here a stranger's environment enters, and scenes are like it.
void Answerer::trim(const Session& session, Answer& answer) noexcept {
  if (!session.sender) answer.server_parts_N = {};
  if (answer.model.empty()) return;
  const bool wanted = session.wants_models && session.amplification.proven();
  if (wanted && local_model::is_sound(answer.model)) return;
  if (wanted) ++parts_.counters.models_unsound;
  answer.model = {};
}

void Answerer::answer(Session& session, const WaitingMotion& waiting) noexcept {
  const wire::MotionSample& motion = waiting.motion;
  const Nanoseconds now = waiting.since;
  parts_.observer.on_motion(motion);
  const Nanoseconds begin = parts_.clock.now();
  const Vector place = session.server_side.place(motion);
  FORCEBOUND_ASSERT(place.rows() == static_cast<Eigen::Index>(session.info.degrees_of_freedom) && place.allFinite(),
                    "an environment is asked about a place, with a row for each degree of freedom");
  Answer answer = ask(session, {.position = place,
                                .device_time = motion.device_time,
                                .server_time = now,
                                .wants_model = session.wants_models,
                                .handle = control::sound(motion.handle).handle,
                                .energy_given_J = motion.energy_given_J});
  const control::ServerSideLaw::Reply reply = session.server_side.answer(answer.force);
  const Nanoseconds end = parts_.clock.now();
  session.compute.charge(end - begin, end);
  answer.force = reply.force;
  trim(session, answer);

  const wire::EnvironmentForce force{.session = motion.session,
                                     .sequence = session.arrivals.counts.forces_sent + 1,
                                     .motion_sequence = motion.sequence,
                                     .motion_device_time = motion.device_time,
                                     .position = place,
                                     .server_receive_time = now,
                                     .server_send_time = end,
                                     .compute_time = end - begin,
                                     .motions_received = session.arrivals.counts.motions_received,
                                     .motions_duplicated = session.arrivals.counts.motions_duplicated,
                                     .motions_reordered = session.arrivals.counts.motions_reordered,
                                     .server_law_numbers = reply.numbers,
                                     .challenge = session.amplification.challenge(),
                                     .answer = answer};
  for (const std::string* name : session.made.environment->quarantined())
    parts_.observer.on_quarantined(session.info, *name);
  const std::span<const std::byte> encoded = parts_.replies.encode(force);
  if (!session.amplification.proven() && !session.amplification.spend(encoded.size())) {
    ++parts_.counters.motions_unproven;
    return;
  }
  if (!parts_.replies.send(encoded, session.info.address)) return;
  ++session.arrivals.counts.forces_sent;
  ++parts_.counters.forces_sent;
  parts_.observer.on_force(force);
  if (session.sender && session.amplification.proven()) hand_over(session, motion, now);
  if (session.view && session.amplification.proven()) show(session, now);
}

void Answerer::hand_over(Session& session, const wire::MotionSample& motion, Nanoseconds now) noexcept {
  // Of a client that sends its motions rarely each brings in more; a burst of more would fill a queue on the way.
  constexpr int kPiecesPerMotionMax = 4;
  SceneSender& sender = *session.sender;
  sender.on_motion(motion, now);
  for (int i = 0; i < kPiecesPerMotionMax; ++i) {
    const auto next = sender.next(now);
    if (!next) return;
    ++(next->again ? parts_.counters.pieces_sent_again : parts_.counters.pieces_sent);
    parts_.replies.send(wire::ScenePiece{.session = motion.session,
                                         .transmission = next->transmission,
                                         .number = next->number,
                                         .content = sender.scene().piece(next->number)},
                        session.info.address);
  }
}

/// One piece at most: a motion's answer never waits for a picture by more than the time of one.
void Answerer::show(Session& session, Nanoseconds now) noexcept {
  auto piece = session.view->next(*session.made.environment, views_, now);
  if (!piece) return;
  piece->session = session.info.session;
  ++parts_.counters.view_pieces_sent;
  parts_.replies.send(*piece, session.info.address);
}

}  // namespace forcebound::server
