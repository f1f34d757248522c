#include "forcebound/record/summary.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace forcebound::record {
namespace {

constexpr double kRelativeRounding = 1e-12;

/// Whether the law reduced the force that the device could have applied.
bool was_bounded(const TickRecord& tick, const RunInfo& info) noexcept {
  if (tick.applied.size() != tick.request.size()) return tick.applied.size() != 0;
  const double asked_N = tick.request.stableNorm();
  const double shown_N = std::min(asked_N, info.force_N_max);
  const double scale = asked_N > shown_N ? shown_N / asked_N : 1;
  const double difference = (tick.applied - scale * tick.request).stableNorm();
  return !(difference <= std::max(info.rounding_N, kRelativeRounding * shown_N));
}

}  // namespace

void Summary::on_tick(const TickRecord& tick) noexcept {
  add_period(tick);
  add_force_stream(tick);
  add_contact(tick);
  add_energy(tick);
}

void Summary::add_period(const TickRecord& tick) noexcept {
  if (tick.state != SessionState::connecting) connected_ = true;
  if (ticks_ == 0) {
    first_ = tick.time;
  } else {
    period_ns_.add(tick.interval.count());
    if (tick.interval > info_.period + kLateBy) ++late_ticks_;
  }
  ++ticks_;
  last_ = tick.time;
  tick_latency_ns_.add(tick.latency.count());
  if (tick.motion_sequence != 0) ++sent_;
}

void Summary::add_force_stream(const TickRecord& tick) noexcept {
  if (tick.rendering == ForceOrigin::at_client) ++at_client_ticks_;
  if (tick.rendering == ForceOrigin::both) ++both_ticks_;
  if (tick.model.rows() > 0) ++modelled_ticks_;
  if (tick.model_trust) model_trust_.add(*tick.model_trust);
  if (tick.force_sequence != 0) age_ns_.add(tick.force_age.count());
  if (waiting_ && tick.force_sequence == arrived_motion_) {
    wait_ns_.add(std::max(Nanoseconds::zero(), tick.time - arrival_).count());
    waiting_ = false;
  }
  if (tick.policy == ForcePolicy::fading) ++fading_ticks_;
  if (tick.policy == ForcePolicy::dropped) ++dropped_ticks_;
  if (ticks_ > 1 && tick.policy != policy_) ++policy_changes_;
  policy_ = tick.policy;

  if (forces_ == 0) return;
  const Nanoseconds without_force = tick.time - arrival_;
  const bool blackout = without_force > info_.hold;
  if (blackout && !blackout_) ++blackouts_;
  blackout_ = blackout;
  if (blackout) blackout_longest_ = std::max(blackout_longest_, without_force);
}

void Summary::add_contact(const TickRecord& tick) noexcept {
  const double force_N = tick.applied.norm();
  force_N_max_ = std::max(force_N_max_, force_N);
  shows_torque_ |= tick.applied_torque_N_m.rows() > 0;
  torque_N_m_max_ = std::max(torque_N_m_max_, tick.applied_torque_N_m.norm());
  if (tick.penetration_m > penetration_m_max_) penetration_m_max_ = tick.penetration_m;
  if (was_bounded(tick, info_)) ++bounded_ticks_;
  if (std::isnan(tick.penetration_m)) ++unknown_ticks_;
  const auto stiffness = displayed_.on_tick(tick);
  if (!tick.contact) return;
  ++contact_ticks_;
  if (!contact_) contact_ = tick.time;
  if (time::to_seconds(tick.time - *contact_) < info_.settle_s) return;
  ++settled_ticks_;
  force_N_.add(force_N);
  if (tick.penetration_m > 0) penetration_m_.add(tick.penetration_m);
  if (displayed_.at_rest()) {
    ++rest_ticks_;
    rest_uN_.add(time::from_seconds(force_N * 1e-3).count());  // N to uN, saturating
    rest_nm_.add(time::from_seconds(tick.penetration_m).count());
  }
  if (!stiffness) return;
  stiffness_.add(*stiffness);
  stiffness_mN_per_m_.add(time::from_seconds(*stiffness * 1e-6).count());  // N/m to mN/m, saturating
}

void Summary::add_energy(const TickRecord& tick) noexcept {
  // Written so that NaN stays the minimum: it must not be taken for passivity.
  if (!(tick.audit_minimum_J >= passivity_minimum_J_) && !std::isnan(passivity_minimum_J_)) {
    passivity_minimum_J_ = tick.audit_minimum_J;
  }
  passivity_final_J_ = tick.audit_J;
  ledger_final_J_ = tick.energy_J;
}

/// Before `arrival_` is that of this one.
void Summary::add_follower(const ForceRecord& force) noexcept {
  using enum control::FollowerState;
  constexpr Nanoseconds kKnown = std::chrono::milliseconds{100};
  if (follower_ != none) {
    const Nanoseconds since = std::max(Nanoseconds{0}, force.receive_time - arrival_);
    const Nanoseconds known = std::min(since, kKnown);
    follower_times_[follower_] += known;
    follower_unknown_ += since - known;
  }
  const control::FollowerState state = force.force.answer.follower;
  follower_changes_ += has_follower_ && state != follower_ ? 1 : 0;
  has_follower_ = has_follower_ || state != none;
  follower_ = state;
}

void Summary::on_force(const ForceRecord& record) noexcept {
  const wire::EnvironmentForce& force = record.force;
  const Nanoseconds at_server = force.server_send_time - force.server_receive_time;
  round_trip_ns_.add(record.round_trip.count());
  compute_ns_.add(force.compute_time.count());
  network_ns_.add((record.round_trip - at_server).count());
  server_ns_.add((at_server - force.compute_time).count());
  ++forces_;
  connected_ = true;
  if (force.motion_sequence <= arrived_motion_) return;  // reordered: no tick uses it
  add_follower(record);
  arrival_ = record.receive_time;
  arrived_motion_ = force.motion_sequence;
  waiting_ = true;
}

}  // namespace forcebound::record
