#include "forcebound/control/force_times.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::control {
namespace {

constexpr double kTimeRounding_s = 1e-9;

ReleaseStages stages_of(const DeviceFacts& facts) noexcept {
  const Bracket& later = facts.uncertainty.hold_s;
  const double full_s = facts.hold_s_max;
  const bool staged = facts.release_share > 0 && facts.release_s > 0;
  const double part_s = full_s + (staged ? facts.release_s : 0.0);
  return {.full_s = {full_s + later.least, full_s + later.most},
          .share = staged ? facts.release_share : 0,
          .part_s = {part_s + later.least, part_s + later.most}};
}

bool apart(const Bracket& a, const Bracket& b) noexcept {
  return a.most < b.least - kTimeRounding_s || a.least > b.most + kTimeRounding_s;
}

bool releases_reported(const Motion& motion) noexcept {
  // Where the write failed, the release may have been that of the force before.
  return !motion.write_failed && std::isfinite(motion.held_s);
}

/// How long after the time of effect a report came. The ends of a bracket count from those of the time of effect, as
/// those of a release do.
Bracket after_effect(const Bracket& at_s, const Bracket& begin_s) noexcept {
  return {std::max(0.0, at_s.least - begin_s.least), at_s.most - begin_s.most};
}

}  // namespace

Bracket later_than_told(const Uncertainty& uncertainty) noexcept {
  const Bracket& each_s = uncertainty.latency_s;
  const Bracket& constant_s = uncertainty.latency_offset_s;
  return {each_s.least + constant_s.least, each_s.most + constant_s.most};
}

ForceTimes::ForceTimes(const DeviceFacts& facts) noexcept
    : longest_release_(stages_of(facts)),
      release_by_facts_(facts.releases ? longest_release_ : ReleaseStages{}),
      stamp_s_(facts.uncertainty.stamp_s),
      latency_s_(later_than_told(facts.uncertainty)),
      latency_facts_s_(facts.latency_s),
      clock_rate_(1 / (1 - facts.uncertainty.clock_share)) {}

Bracket ForceTimes::true_time(double shown_s) const noexcept {
  const auto [least_s, most_s] = std::minmax({shown_s / clock_rate_, shown_s * clock_rate_});
  return {least_s, most_s};
}

/// The true time of what came `by_s` after the clock showed `shown_s`.
Bracket ForceTimes::later(double shown_s, const Bracket& by_s) const noexcept {
  const Bracket time_s = true_time(shown_s);
  return {time_s.least + by_s.least, time_s.most + by_s.most};
}

Bracket ForceTimes::effect_by_facts(const Motion& motion) const noexcept {
  return later(std::max(0.0, motion.latency_s), latency_s_);
}

/// When it was commanded, at the earliest.
double ForceTimes::commanded(const Motion& motion) const noexcept {
  return true_time(motion.latency_s - latency_facts_s_).least;
}

bool ForceTimes::before_command(const Motion& motion, const Bracket& reported_s) const noexcept {
  return reported_s.most < commanded(motion) - kTimeRounding_s;
}

Bracket ForceTimes::effect(const Motion& motion) const noexcept {
  const Bracket facts_s = effect_by_facts(motion);
  if (std::isnan(motion.effect_s) || !is_measurable(motion.interval_s)) return facts_s;
  Bracket reported_s = later(motion.effect_s, stamp_s_);
  if (before_command(motion, reported_s)) return facts_s;
  const double commanded_s = std::max(0.0, commanded(motion));
  reported_s = {std::max(reported_s.least, commanded_s), std::max(reported_s.most, commanded_s)};
  if (!apart(reported_s, facts_s)) return reported_s;
  // What is reported has happened before the reading at which it is.
  const double now_s = true_time(motion.interval_s).most + std::max(0.0, stamp_s_.most);
  return {std::min(reported_s.least, facts_s.least), std::max(std::min(reported_s.most, now_s), facts_s.most)};
}

bool ForceTimes::effect_is_outside_facts(const Motion& motion) const noexcept {
  if (std::isnan(motion.effect_s)) return false;
  const Bracket reported_s = later(motion.effect_s, stamp_s_);
  return before_command(motion, reported_s) || apart(reported_s, effect_by_facts(motion));
}

ReleaseStages ForceTimes::release(const Motion& motion, const Bracket& begin_s) const noexcept {
  if (!releases_reported(motion)) return release_by_facts_;
  return reported_release(later(motion.latency_s + motion.held_s, stamp_s_), begin_s);
}

bool ForceTimes::release_is_outside_facts(const Motion& motion) const noexcept {
  if (!releases_reported(motion)) return false;
  const Bracket at_s = later(motion.latency_s + motion.held_s, stamp_s_);
  const Bracket begin_s = effect(motion);
  return apart({at_s.least - begin_s.most, at_s.most - begin_s.least}, release_by_facts_.full_s);
}

/// The stages of a force whose release began within `at_s` as the device says. At a time that the facts allow wherever
/// in its bracket the force took effect, it goes on as they say; where it may have been earlier, or was at a time that
/// they do not allow, nobody knows for how long a share of the force is held.
ReleaseStages ForceTimes::reported_release(const Bracket& at_s, const Bracket& begin_s) const noexcept {
  ReleaseStages release = release_by_facts_;
  const Bracket facts_s = release.full_s;
  const Bracket reported_s = after_effect(at_s, begin_s);
  if (at_s.most < begin_s.least - kTimeRounding_s) return release;  // before the effect
  if (apart({at_s.least - begin_s.most, at_s.most - begin_s.least}, facts_s)) {
    const double part_s = longest_release_.part_s.most - longest_release_.full_s.most;
    release.full_s = {std::min(reported_s.least, facts_s.least), std::max(reported_s.most, facts_s.most)};
    release.part_s = {release.full_s.least, std::max(release.part_s.most, reported_s.most + part_s)};
  } else {
    const bool maybe_early = at_s.least - begin_s.most < facts_s.least - kTimeRounding_s;
    release.full_s = {maybe_early ? reported_s.least : std::max(reported_s.least, facts_s.least),
                      std::min(reported_s.most, facts_s.most)};
    release.part_s.least = maybe_early ? reported_s.least : std::max(release.part_s.least, release.full_s.least);
  }
  // Rounding leaves no time in which there is neither the force nor its release.
  release.full_s.most = std::max(release.full_s.most, begin_s.least + release.full_s.least - begin_s.most);
  return release;
}

}  // namespace forcebound::control
