#include "forcebound/client/session/force_stream.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::client {
namespace {

// At 1 kHz the last 65 s of motion: longer than any force can be of use.
constexpr std::size_t kSentRing = 65536;

bool fits(const control::Vector& wave_rad_per_m, int degrees_of_freedom) noexcept {
  constexpr double kWave_rad_per_m_max = 1e9;
  return wave_rad_per_m.rows() == 0 || (wave_rad_per_m.rows() == degrees_of_freedom &&
                                        wave_rad_per_m.lpNorm<Eigen::Infinity>() <= kWave_rad_per_m_max);
}

/// Whether the numbers are plausible, so that later computations with them are safe.
bool fits(const wire::EnvironmentForce& force, int degrees_of_freedom) noexcept {
  constexpr double kSurface_m_max = 1e4;  // farther from the origin than a scene's file can place a surface
  constexpr double kNormalRounding = 1e-6;
  const wire::Answer& answer = force.answer;
  if (answer.force.rows() != degrees_of_freedom || force.position.rows() != degrees_of_freedom) return false;
  if (answer.server_parts_N.rows() != 0 && answer.server_parts_N.rows() != degrees_of_freedom) return false;
  if (answer.torque_N_m.rows() != 0 && answer.torque_N_m.rows() != Eigen::Vector3d::RowsAtCompileTime) return false;
  if (force.server_receive_time < Nanoseconds::zero() || force.server_send_time < force.server_receive_time)
    return false;
  if (force.compute_time < Nanoseconds::zero() ||
      force.compute_time > force.server_send_time - force.server_receive_time) {
    return false;
  }
  if (answer.contact_normal.rows() == 0) return true;
  if (!fits(answer.texture_wave, degrees_of_freedom) || !fits(answer.texture_across, degrees_of_freedom)) return false;
  // Triangle inequality: a position is no farther from a surface than from the origin plus the origin from the surface.
  // A limit independent of the position would refuse every answer to a device far behind a wall.
  const double penetration_m_max = kSurface_m_max + force.position.stableNorm();
  return answer.contact_normal.rows() == degrees_of_freedom && std::abs(answer.penetration_m) <= penetration_m_max &&
         std::abs(answer.contact_normal.stableNorm() - 1) <= kNormalRounding;
}

constexpr std::uint64_t missing(std::uint64_t all, std::uint64_t seen) noexcept { return all > seen ? all - seen : 0; }

}  // namespace

ForceStream::ForceStream(int degrees_of_freedom) : degrees_of_freedom_(degrees_of_freedom), sent_(kSentRing) {}

void ForceStream::begin_session(std::uint64_t session) noexcept {
  ended_ = settled_counts();
  session_ = session;
  arrivals_ = {};
  server_ = {};
  sent_here_ = 0;
  received_ = 0;
  settled_ = sequence_;
  earlier_ = sequence_;
  round_trip_ = Nanoseconds::zero();
  lateness_ = Nanoseconds::zero();
}

std::uint64_t ForceStream::count_sent(Nanoseconds reading_time) noexcept {
  ++sequence_;
  sent_[sequence_ % kSentRing] = {sequence_, reading_time, sent_here_};
  ++sent_here_;
  return sequence_;
}

ForceStream::Verdict ForceStream::accept(const wire::EnvironmentForce& force, Nanoseconds arrival) noexcept {
  if (session_ == 0 || force.session != session_) {
    ++ended_.foreign;
    return Verdict::foreign;
  }
  const Sent& motion = sent_[force.motion_sequence % kSentRing];
  const bool answers =
      force.motion_sequence != 0 && motion.sequence == force.motion_sequence && motion.time == force.motion_device_time;
  // Each force answers another motion of this session, so that neither count can be ahead of the other's. That also
  // bounds how far one datagram can move the window.
  const bool counts = force.sequence != 0 && can_count(force.motions_received, force.sequence) &&
                      force.motion_sequence > earlier_ && force.sequence <= force.motion_sequence - earlier_;
  if (!answers || !counts || !fits(force, degrees_of_freedom_)) {
    ++ended_.implausible;
    return Verdict::implausible;
  }
  if (arrivals_.add(force.sequence) == time::SequenceWindow::Arrival::duplicate) {
    ++ended_.duplicated;
    return Verdict::duplicate;
  }
  ++received_;
  settled_ = std::max(settled_, force.motion_sequence);
  round_trip_ = std::max(round_trip_, arrival - motion.time);
  store_server_counts({.session = force.session,
                       .motions_received = force.motions_received,
                       .motions_duplicated = force.motions_duplicated,
                       .motions_reordered = force.motions_reordered,
                       .forces_sent = force.sequence});
  if (newest_ && newest_->motion_sequence >= force.motion_sequence) {
    ++ended_.reordered;
    return Verdict::reordered;
  }
  newest_ = force;
  newest_arrival_ = arrival;
  return Verdict::newest;
}

bool ForceStream::accept(const wire::Bye& bye) noexcept {
  if (session_ == 0 || bye.session != session_) return false;
  if (can_count(bye.motions_received, bye.forces_sent) && bye.motions_behind < sequence_ - earlier_) {
    const bool later = bye.motions_behind > server_.motions_behind;
    store_server_counts(bye);
    if (later) lateness_ = std::max(lateness_, longest_time_between(bye.motions_behind));
  } else {
    ++ended_.implausible;
  }
  return true;
}

void ForceStream::store_server_counts(const wire::Bye& counts) noexcept {
  // Cumulative, so that it does not matter which of them are lost: the largest is the latest.
  server_.motions_received = std::max(server_.motions_received, counts.motions_received);
  server_.motions_duplicated = std::max(server_.motions_duplicated, counts.motions_duplicated);
  server_.motions_reordered = std::max(server_.motions_reordered, counts.motions_reordered);
  server_.forces_sent = std::max(server_.forces_sent, counts.forces_sent);
  server_.motions_behind = std::max(server_.motions_behind, counts.motions_behind);
}

std::uint64_t ForceStream::oldest_known() const noexcept {
  return sequence_ < kSentRing ? 1 : sequence_ - kSentRing + 1;
}

// By the times at which they were sent: ticks may be late, and a period is not always the device's.
Nanoseconds ForceStream::longest_time_between(std::uint64_t motions) const noexcept {
  Nanoseconds longest{0};
  for (std::uint64_t i = std::max(earlier_ + 1, oldest_known()); i + motions <= sequence_; ++i) {
    longest = std::max(longest, sent_[(i + motions) % kSentRing].time - sent_[i % kSentRing].time);
  }
  return longest;
}

std::uint64_t ForceStream::in_flight(Nanoseconds now) const noexcept {
  std::uint64_t first = std::max(settled_ + 1, oldest_known());
  for (std::uint64_t left = sequence_ + 1 - first; left > 0;) {  // by halves: readings are in the order of time
    const std::uint64_t half = left / 2;
    const bool too_old = now - sent_[(first + half) % kSentRing].time > round_trip_;
    if (too_old) first += half + 1;
    left = too_old ? left - half - 1 : half;
  }
  if (first > sequence_) return 0;
  return std::min(missing(sent_here_, sent_[first % kSentRing].before), missing(sent_here_, server_.motions_received));
}

ForceStream::Counts ForceStream::counts(Nanoseconds now) const noexcept {
  Counts all = settled_counts();
  all.in_flight = in_flight(now);
  return all;
}

ForceStream::Counts ForceStream::settled_counts() const noexcept {
  Counts all = ended_;
  all.sent += sent_here_;
  all.received += received_;
  all.lost_up += missing(sent_here_, server_.motions_received);
  all.lost_down += missing(server_.forces_sent, received_);
  all.unanswered += missing(server_.motions_received, server_.forces_sent);
  all.motions_duplicated += server_.motions_duplicated;
  all.motions_reordered += server_.motions_reordered;
  return all;
}

}  // namespace forcebound::client
