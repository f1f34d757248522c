#include "forcebound/server/session/session.hpp"

#include <algorithm>

namespace forcebound::server {
namespace {

// A motion may overtake the time since the newest by as much as the network's delay shrinks: 12 s has been observed.
constexpr Nanoseconds kDelayShrinksMost = std::chrono::seconds{16};

}  // namespace

time::SequenceWindow::Arrival Arrivals::count(std::uint64_t sequence, Nanoseconds now,
                                              ServerCounters& totals) noexcept {
  using Arrival = time::SequenceWindow::Arrival;
  const double elapsed_s = time::to_seconds(std::max(now - newest_arrived, Nanoseconds{0}) + kDelayShrinksMost);
  constexpr double kCountMost = 1e15;  // of a rate without end
  const auto sent_most = static_cast<std::uint64_t>(std::min(elapsed_s * motions_per_s_max, kCountMost));
  const Arrival arrival = window.add(sequence, std::max(sent_most, time::SequenceWindow::kNumbers));
  if (arrival == Arrival::too_far_ahead) {
    ++totals.motions_far_ahead;
    return arrival;
  }
  if (arrival == Arrival::newest) newest_arrived = now;
  if (arrival == Arrival::duplicate) {
    ++counts.motions_duplicated;
    ++totals.motions_duplicated;
    return arrival;
  }
  ++counts.motions_received;
  ++totals.motions_received;
  if (arrival == Arrival::late) {
    ++counts.motions_reordered;
    ++totals.motions_reordered;
    counts.motions_behind = std::max(counts.motions_behind, window.newest() - sequence);
  }
  return arrival;
}

Vector ServerSide::place(const wire::MotionSample& motion) noexcept {
  if (!law) return motion.position;
  // A clock that runs backwards gives no interval.
  const Nanoseconds interval = motion.device_time - answered.value_or(motion.device_time);
  answered = motion.device_time;
  Vector at = law->place({.position = motion.position,
                          .numbers = motion.server_law_numbers,
                          .interval_s = time::to_seconds(std::max(interval, Nanoseconds::zero()))});
  // No environment, least of all a shared one, may receive a position that is not finite.
  const bool sound = at.rows() == motion.position.rows() && at.allFinite();
  return sound ? at : motion.position;
}

control::ServerSideLaw::Reply ServerSide::answer(const Vector& force_N) noexcept {
  if (!law) return {.force = force_N, .numbers = {}};
  return law->answer(force_N);
}

void Session::store_place(const Vector& position, Nanoseconds now) noexcept {
  constexpr double kStill_m = 1e-3;
  if (stays_at.rows() == position.rows() && (position - stays_at).norm() <= kStill_m) return;
  stays_at = position;
  last_moved = now;
}

}  // namespace forcebound::server
