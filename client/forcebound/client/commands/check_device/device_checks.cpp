#include "forcebound/client/commands/check_device/device_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "forcebound/client/commands/check_device/device_driving.hpp"
#include "forcebound/client/commands/check_device/guided_checks.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::client::commands {
namespace {

constexpr int kFirstTicksMost = 500;
constexpr int kQuietTicks = 1000;
// What more costs stiffness, since the tick after it is a late one.
constexpr double kStaleShare_max = 0.2;
constexpr double kJitterPeriods_max = 2;
constexpr int kFaultyCommands = 20;
constexpr double kOldShare_max = 0.5;
constexpr double kDrift_m_max = 0.002;
constexpr double kSeen_m = 1e-4;
constexpr double kMass_kg_min = 0.005;
constexpr double kMass_kg_max = 50;
constexpr double kBlockedShare_max = 0.01;
constexpr double kMoving_m_per_s = 0.005;
constexpr double kCoast_m_max = 0.05;

std::string short_text(double value) { return text::rounded(value); }
std::string short_ms(double value_s) { return short_text(1e3 * value_s) + " ms"; }
std::string short_mm(double value_m) { return short_text(1e3 * value_m) + " mm"; }

Verdict verdict_of(bool holds) { return holds ? Verdict::passed : Verdict::failed; }

std::string axis_name(Eigen::Index axis) {
  constexpr std::array<const char*, 6> kNames{"x", "y", "z", "4", "5", "6"};
  return kNames.at(static_cast<std::size_t>(axis));
}

/// The checks in their order; each needs what those before it found.
class Checks {
 public:
  Checks(device::HapticDevice& device, Pace& pace, const DeviceCheckSettings& settings)
      : driving_(device, pace, settings),
        settings_(settings),
        force_N_(settings.force_share * device.facts().force_N_max),
        whole_force_(settings.force_share >= 1) {}

  std::vector<DeviceCheck> run() {
    driving_.begin("start");
    driving_.start();
    driving_.begin("readings");
    try {
      stay_quiet();
      if (moves_safely_) move();
    } catch (const TooFast& error) {
      add(driving_.check(), Verdict::failed, error.what(), slow_enough());
      give_up("no more force: it was too fast");
    } catch (const OutOfControl& error) {
      add(driving_.check(), Verdict::failed, error.what(), error.accepted());
      give_up("no more force: " + driving_.check() + " failed");
    } catch (...) {
      driving_.stop();
      throw;
    }
    if (!moves_safely_) leave_out();
    driving_.begin("calls in time");
    driving_.stop();
    judge_calls();
    return std::move(checks_);
  }

 private:
  void add(std::string name, Verdict verdict, std::string measured, std::string accepted) {
    checks_.push_back({std::move(name), verdict, std::move(measured), std::move(accepted)});
    if (settings_.found) settings_.found(checks_.back());
  }

  void give_up(std::string why) {
    moves_safely_ = false;
    why_not_ = std::move(why);
  }

  [[nodiscard]] std::string slow_enough() const {
    return "at most " + short_text(settings_.speed_m_per_s_max) + " m/s";
  }

  void move() {
    push_each_axis();
    if (!moves_safely_) return;
    command_what_is_not_finite();
    let_go();
    stop_in_motion();
    ask_too_much();
    if (settings_.person == nullptr) return;
    check_with_a_person(driving_, *settings_.person, force_N_, [this](const DeviceCheck& check) {
      add(check.name, check.verdict, check.measured, check.accepted);
    });
  }

  /// Readings, their times, and whether it stays where it is while no force is asked for.
  void stay_quiet() {
    // A driver with a thread of its own has nothing to tell at first.
    for (int tick = 0; tick < kFirstTicksMost && driving_.readings().good == 0; ++tick) driving_.tick(driving_.zero());
    driving_.forget_readings();
    const Nanoseconds begin = driving_.now();
    driving_.tick(driving_.zero());
    const Vector from = driving_.position();
    for (int tick = 1; tick < kQuietTicks; ++tick) driving_.tick(driving_.zero());
    const double tick_s = time::to_seconds(driving_.now() - begin) / kQuietTicks;
    const ReadingCounts& counts = driving_.readings();
    const std::uint64_t refused = counts.out_of_time();
    const bool readable = counts.failed() == refused;
    add("readings", verdict_of(readable),
        std::to_string(counts.failed() - refused) + " of " + std::to_string(kQuietTicks) + " failed" +
            (readable ? "" : ": " + counts.last_failure),
        "none");
    const bool often = judge_rate(counts, tick_s);
    add("times run forward", verdict_of(refused == 0),
        std::to_string(refused) + " of " + std::to_string(kQuietTicks) + " ran backwards or lay in the future", "none");
    const bool known_when = judge_ages(counts);
    const double drift_m = (driving_.position() - from).norm();
    const double drift_m_max = kDrift_m_max + 10 * driving_.facts().encoder_step.norm();
    const bool rests = drift_m <= drift_m_max;
    add("rest at zero force", verdict_of(rests), "moved " + short_mm(drift_m) + " in 1000 ticks",
        "at most " + short_mm(drift_m_max));
    if (!readable || !often || refused > 0 || !known_when || !rests) give_up("no force on a device that failed above");
  }

  /// How often it has something new to tell.
  bool judge_rate(const ReadingCounts& counts, double tick_s) {
    const double stale = static_cast<double>(counts.stale) / kQuietTicks;
    const bool often = counts.good > 1 && stale <= kStaleShare_max;
    std::string measured = counts.good > 1 ? "a new reading each " +
                                                 short_ms(time::to_seconds(counts.last_latched - counts.first_latched) /
                                                          static_cast<double>(counts.good - 1))
                                           : "no readings";
    measured += ", a tick each " + short_ms(tick_s) + " (its period: " + short_ms(driving_.facts().period_s) + "); " +
                short_text(100 * stale) + " % of the ticks found none";
    add("rate", verdict_of(often), measured,
        "at most " + short_text(100 * kStaleShare_max) + " %; a longer period finds more");
    return often;
  }

  /// How old readings are when they are read, and how much that changes.
  bool judge_ages(const ReadingCounts& counts) {
    const double old = static_cast<double>(counts.old) / kQuietTicks;
    const bool recent = counts.good > 0 && old <= kOldShare_max;
    add("reading times", verdict_of(recent), short_text(100 * old) + " % latched more than 20 periods ago",
        "most are newer");
    if (!recent) return false;
    std::vector<double> age_s = counts.age_s;
    std::ranges::sort(age_s);
    const auto quantile = [&](double share) {
      return age_s[static_cast<std::size_t>(share * static_cast<double>(age_s.size() - 1))];
    };
    constexpr double kTail = 0.05;
    const double jitter_s = quantile(1 - kTail) - quantile(kTail);
    const double most_s = kJitterPeriods_max * driving_.facts().period_s + driving_.facts().uncertainty.stamp_s.most;
    const bool steady = jitter_s <= most_s;  // else speeds are wrong too, and with them their limit
    add("jitter", verdict_of(steady),
        "9 of 10 readings are " + short_ms(quantile(kTail)) + " to " + short_ms(quantile(1 - kTail)) + " old",
        "within " + short_ms(most_s));
    return steady;
  }

  void push_each_axis() {
    for (Eigen::Index axis = 0; axis < driving_.zero().size() && moves_safely_; ++axis) push_along(axis);
  }

  void push_along(Eigen::Index axis) {
    const std::string name = axis_name(axis);
    driving_.begin("force along +" + name);
    const Vector along = Vector::Unit(driving_.zero().size(), axis);
    const Push push = driving_.push({.along = along, .force_N = force_N_});
    const double moved_m = push.moved[axis];
    Eigen::Index most = 0;
    push.moved.cwiseAbs().maxCoeff(&most);
    const bool follows = moved_m >= kSeen_m && most == axis;
    std::string went = "moved " + short_mm(moved_m) + " along it";
    if (most != axis) went += ", " + short_mm(push.moved[most]) + " along " + axis_name(most);
    mass_kg_ = (push.twice_integrated - driving_.damping_along(along) * push.moved_integrated) / moved_m;
    const bool plausible = mass_kg_ >= kMass_kg_min && mass_kg_ <= kMass_kg_max;
    // Units that are wrong make it seem too fast as well.
    if (follows && plausible && !push.too_fast.empty()) throw TooFast(push.too_fast);
    add("force along +" + name, verdict_of(follows), went, "along +" + name + ", > 0.1 mm");
    if (!follows) return give_up("no more force: it does not go where it is pushed");
    add("units along " + name, verdict_of(plausible), "moves like " + short_text(mass_kg_) + " kg",
        short_text(kMass_kg_min) + " to " + short_text(kMass_kg_max) + " kg");
    if (!plausible) return give_up("no more force: its units cannot be right");
    driving_.keep_lightest(mass_kg_);
    brake_after("the push along " + name);
  }

  void brake_after(const std::string& what) {
    driving_.begin("braking after " + what);
    driving_.brake(force_N_);
  }

  /// What is not a number is zero by the time that a driver gets it.
  void command_what_is_not_finite() {
    const std::string name = "not a number";
    driving_.begin(name);
    const std::uint64_t shown_as_zero = driving_.counters().faulty_commands;
    const Vector from = driving_.position();
    const Vector faulty = Vector::Constant(driving_.zero().size(), std::numeric_limits<double>::quiet_NaN());
    for (int tick = 0; tick < kFaultyCommands; ++tick) driving_.tick(faulty);
    const double moved_m = (driving_.position() - from).norm();
    const bool counted = driving_.counters().faulty_commands == shown_as_zero + kFaultyCommands;
    add(name, verdict_of(counted && moved_m <= kDrift_m_max),
        std::to_string(kFaultyCommands) + " such forces: moved " + short_mm(moved_m), "shown as zero");
  }

  [[nodiscard]] Push set_in_motion() {
    const Push push = driving_.push({.along = first(), .force_N = force_N_});
    if (!push.too_fast.empty()) throw TooFast(push.too_fast);
    return push;
  }
  [[nodiscard]] Vector first() const { return Vector::Unit(driving_.zero().size(), 0); }

  /// How long to watch a device that moves so fast, until its damping must have told whether a force is left.
  [[nodiscard]] double watch_s(double speed_m_per_s) const {
    constexpr double kShortest_s = 0.05;
    constexpr double kLongest_s = 0.4;
    const double settling_s = mass_kg_ / driving_.damping_along(first());
    return std::clamp(std::min(settling_s, kCoast_m_max / std::max(1e-3, speed_m_per_s)), kShortest_s, kLongest_s);
  }

  /// The share of its speed that it keeps in so long, at most.
  [[nodiscard]] double kept(double seconds) const {
    return std::exp(-driving_.damping_along(first()) * seconds / mass_kg_);
  }

  [[nodiscard]] double speed() const { return first().dot(driving_.velocity()); }

  /// Without a command. @param from where the device was when it got its last one
  void watch(double seconds, const Vector& from) {
    constexpr double kWay_m_max = 2 * kCoast_m_max;
    const Nanoseconds begin = driving_.now();
    while (time::to_seconds(driving_.now() - begin) < seconds) {
      driving_.tick_letting_go();
      const double way_m = (driving_.position() - from).norm();
      if (way_m <= kWay_m_max) continue;
      driving_.stop();
      throw OutOfControl("moved " + short_mm(way_m) + " after the last command: the force is zero",
                         "at most " + short_mm(kWay_m_max));
    }
  }

  void let_go() {
    const std::string name = "hold time";
    if (!driving_.facts().releases) {
      add(name, Verdict::not_checked, "its facts say that it never lets go", "");
      return;
    }
    driving_.begin(name);
    (void)set_in_motion();
    const control::DeviceFacts& facts = driving_.facts();
    constexpr double kWindow_s = 0.015;  // over which a speed is measured
    const Vector from = driving_.position();
    watch(facts.hold_s_max + facts.release_s + facts.latency_s + kWindow_s, from);
    const double before = speed();
    if (before < kMoving_m_per_s) {
      add(name, Verdict::not_checked, "at rest before the hold time was over; try a larger --force-share", "");
      brake_after("the hold time");
      return;
    }
    const double seconds = watch_s(before);
    watch(seconds, from);
    const double after = speed();
    const double most = before * (1 + kept(seconds)) / 2;
    add(name, verdict_of(after <= most), slowing(before, after, seconds),
        "< " + short_text(most) + " m/s: no force once " + short_text(1e3 * facts.hold_s_max) + " ms are over");
    brake_after("the hold time");
  }

  static std::string slowing(double before, double after, double seconds) {
    return "from " + short_text(before) + " to " + short_text(after) + " m/s in " + short_text(1e3 * seconds) + " ms";
  }

  /// Stops it while it is pushed, and starts it again.
  void stop_in_motion() {
    driving_.begin("stop");
    const Push push = set_in_motion();
    const Vector from = driving_.position();
    const double seconds = watch_s(push.speed_m_per_s);
    driving_.stop();
    driving_.rest_for(seconds);
    driving_.begin("start again");
    driving_.start();
    const std::uint64_t failed = driving_.readings().failed();
    const std::uint64_t good = driving_.readings().good;
    for (int tick = 0; tick < 20; ++tick) driving_.tick(driving_.zero());
    const double way_m = first().dot(driving_.position() - from);
    // Half way between where it gets without a force and with the one that it had.
    const double damping = driving_.damping_along(first());
    const double settling_s = mass_kg_ / damping;
    const double way_free_m = push.speed_m_per_s * settling_s * (1 - kept(seconds));
    const double pushed_m_per_s = push.force_N / damping;
    const double way_pushed_m = way_free_m + pushed_m_per_s * (seconds - settling_s * (1 - kept(seconds)));
    const double most_m = (way_free_m + way_pushed_m) / 2 + kSeen_m;
    add("stop", verdict_of(way_m <= most_m),
        "went on by " + short_mm(way_m) + " in " + short_text(1e3 * seconds) + " ms",
        "< " + short_mm(most_m) + ": no force after stop");
    add("start again", verdict_of(driving_.readings().failed() == failed && driving_.readings().good > good),
        std::to_string(driving_.readings().good - good) + " of 20 readings", "readings as before");
    brake_after("the start");
  }

  void ask_too_much() {
    const std::string name = "saturation";
    if (!whole_force_) {
      add(name, Verdict::not_checked, "only with --force-share 1", "");
      return;
    }
    driving_.begin(name);
    constexpr double kTooMuch = 1.5;
    const double asked_N = kTooMuch * driving_.facts().force_N_max;
    const Push push =
        driving_.push({.along = first(), .force_N = asked_N, .ramp_s = 0, .seconds = 0.03, .way_m = 0.001});
    const double way_m = first().dot(push.moved);
    add(name, verdict_of(way_m > -kSeen_m), "asked for " + short_text(asked_N) + " N: moved " + short_mm(way_m),
        "along +x, or not at all");
    if (way_m > 0) brake_after("the largest force");
  }

  void leave_out() {
    for (const char* name : {"not a number", "hold time", "stop", "start again", "saturation"}) {
      const bool known = std::ranges::any_of(checks_, [&](const DeviceCheck& check) { return check.name == name; });
      if (!known) add(name, Verdict::not_checked, why_not_, "");
    }
  }

  void judge_calls() {
    const device::DeviceCounters counters = driving_.counters();
    if (settings_.person == nullptr) {
      add("commands", verdict_of(counters.failed_writes == 0),
          std::to_string(counters.failed_writes) + " of " + std::to_string(driving_.commands()) + " failed", "none");
    }
    const bool any_failed = driving_.failures() + counters.failed_writes > 0;
    add("last error", any_failed ? verdict_of(counters.unexplained == 0) : Verdict::not_checked,
        any_failed ? std::to_string(counters.unexplained) + " calls failed without a reason" : "no call failed",
        any_failed ? "none" : "");
    const CallCounts& calls = driving_.calls();
    const double share = static_cast<double>(calls.blocked) / static_cast<double>(calls.calls);
    std::string measured = std::to_string(calls.blocked) + " of " + std::to_string(calls.calls) + " blocked";
    if (calls.blocked > 0)
      measured += ", " + short_text(1e-6 * static_cast<double>(calls.longest.count())) + " ms at most";
    if (calls.preempted > 0) measured += "; " + std::to_string(calls.preempted) + " more were interrupted";
    add("calls in time", verdict_of(share <= kBlockedShare_max), measured, "0.2 ms, but for 1 % of them");
  }

  DeviceDriving driving_;
  const DeviceCheckSettings& settings_;
  double force_N_;
  bool whole_force_;
  bool moves_safely_ = true;
  std::string why_not_;
  double mass_kg_ = 0;
  std::vector<DeviceCheck> checks_;
};

}  // namespace

std::vector<DeviceCheck> check_device(device::HapticDevice& device, Pace& pace, const DeviceCheckSettings& settings) {
  return Checks(device, pace, settings).run();
}

}  // namespace forcebound::client::commands
