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

/// Whether the numbers can be what they say; what follows may then compute with them.
bool fits(const wire::EnvironmentForce& force, int degrees_of_freedom) noexcept {
  constexpr double kPenetration_m_max = 10;
  constexpr double kNormalRounding = 1e-6;
  if (force.force.rows() != degrees_of_freedom || force.position.rows() != degrees_of_freedom) return false;
  if (force.server_receive_time < Nanoseconds::zero() || force.server_send_time < force.server_receive_time)
    return false;
  if (force.compute_time < Nanoseconds::zero() ||
      force.compute_time > force.server_send_time - force.server_receive_time) {
    return false;
  }
  if (force.contact_normal.rows() == 0) return true;
  if (!fits(force.texture_wave, degrees_of_freedom) || !fits(force.texture_across, degrees_of_freedom)) return false;
  return force.contact_normal.rows() == degrees_of_freedom && std::abs(force.penetration_m) <= kPenetration_m_max &&
         std::abs(force.contact_normal.stableNorm() - 1) <= kNormalRounding;
}

}  // namespace

ForceStream::ForceStream(int degrees_of_freedom) : degrees_of_freedom_(degrees_of_freedom), sent_(kSentRing) {}

void ForceStream::begin_session(std::uint64_t session) noexcept {
  ended_ = counts();
  session_ = session;
  arrivals_ = {};
  server_ = {};
  sent_here_ = 0;
  received_ = 0;
}

std::uint64_t ForceStream::note_sent(Nanoseconds reading_time) noexcept {
  ++sequence_;
  ++sent_here_;
  sent_[sequence_ % kSentRing] = {sequence_, reading_time};
  return sequence_;
}

ForceStream::Verdict ForceStream::accept(const wire::EnvironmentForce& force) noexcept {
  if (session_ == 0 || force.session != session_) {
    ++ended_.foreign;
    return Verdict::foreign;
  }
  const Sent& motion = sent_[force.motion_sequence % kSentRing];
  const bool answers =
      force.motion_sequence != 0 && motion.sequence == force.motion_sequence && motion.time == force.motion_device_time;
  const bool counts = can_count(force.motions_received, force.sequence);
  if (!answers || !counts || !fits(force, degrees_of_freedom_)) {
    ++ended_.implausible;
    return Verdict::implausible;
  }
  if (arrivals_.note(force.sequence) == wire::SequenceWindow::Arrival::duplicate) {
    ++ended_.duplicated;
    return Verdict::duplicate;
  }
  ++received_;
  note_server_counts({.session = force.session,
                      .motions_received = force.motions_received,
                      .motions_duplicated = force.motions_duplicated,
                      .motions_reordered = force.motions_reordered,
                      .forces_sent = force.sequence});
  if (newest_ && newest_->motion_sequence >= force.motion_sequence) {
    ++ended_.overtaken;
    return Verdict::overtaken;
  }
  newest_ = force;
  return Verdict::newest;
}

bool ForceStream::accept(const wire::Bye& bye) noexcept {
  if (session_ == 0 || bye.session != session_) return false;
  if (can_count(bye.motions_received, bye.forces_sent)) {
    note_server_counts(bye);
  } else {
    ++ended_.implausible;
  }
  return true;
}

void ForceStream::note_server_counts(const wire::Bye& counts) noexcept {
  // Cumulative, so that it does not matter which of them are lost: the largest is the latest.
  server_.motions_received = std::max(server_.motions_received, counts.motions_received);
  server_.motions_duplicated = std::max(server_.motions_duplicated, counts.motions_duplicated);
  server_.motions_reordered = std::max(server_.motions_reordered, counts.motions_reordered);
  server_.forces_sent = std::max(server_.forces_sent, counts.forces_sent);
}

ForceStream::Counts ForceStream::counts() const noexcept {
  const auto missing = [](std::uint64_t all, std::uint64_t seen) { return all > seen ? all - seen : 0; };
  Counts all = ended_;
  all.sent += sent_here_;
  all.received += received_;
  all.lost_up += missing(sent_here_, server_.motions_received);
  all.lost_down += missing(server_.forces_sent, received_);
  all.motions_duplicated += server_.motions_duplicated;
  all.motions_overtaken += server_.motions_reordered;
  return all;
}

}  // namespace forcebound::client
