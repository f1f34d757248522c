// Which slides there are, and what is fitted between them.
#include <algorithm>
#include <cmath>
#include <utility>

#include "forcebound/client/commands/identify/guide.hpp"

namespace forcebound::client::commands::identify {
namespace {

constexpr int kExtraMost = 256;
constexpr int kExtraAtOnce = 8;  // and later half of what there were
constexpr double kExplained_steps = 3;
constexpr double kLatencyGoal_s = 9e-6;  // standard errors
constexpr double kHoldGoal_s = 30e-6;

}  // namespace

void Guide::next_joint() {
  plan_.clear();
  planned_ = 0;
  unmoved_ = 0;
  joint_done_ = refit_due_ = false;
  if (joint_ + 1 == declared_.degrees_of_freedom()) {
    begin_work(Work::times);
    return;
  }
  ++joint_;
  slide_ = {.joint = joint_, .direction = 1};
  start_ = axis().watch.position();
  axis().home = start_;
  enter(State::grow);
}

void Guide::give_up_joint(const std::string& why) {
  record().refused = why;
  if (extra_joint_ >= 0) {
    enter(State::finished);
  } else {
    next_joint();
  }
}

void Guide::plan_joint() {
  plan_ = {{0.5}, {0.5}, {0.5}, {0.5}};
  for (int i = 0; i < 4; ++i) {
    plan_.insert(plan_.end(), {{1}, {1}, {0.25, false, true}, {0.25, false, true}});
    plan_.insert(plan_.end(), {{0.5, false, true}, {1, true}, {1, true}, {0.25, false, true}});
  }
}

void Guide::next_slide() {
  if (planned_ >= plan_.size()) {
    joint_done_ = true;
    start_ = planned_start_ = axis().home;
    enter(State::place);
    return;
  }
  now_ = plan_[planned_++];
  const double direction = -slide_.direction;
  slide_ = {.joint = joint_, .direction = direction};
  slide_.end = now_.silent ? Slide::End::silence : Slide::End::zero;
  std::uniform_real_distribution<double> off(-0.08, 0.08);
  const bool late = now_.short_way && random_() % 2 == 0;
  start_ = axis().home - direction * axis().reach * ((late ? 0 : 1) + off(random_));
  planned_start_ = start_;
  travel_ = (now_.short_way ? 1 : 2) * axis().reach;
  enter(State::place);
}

void Guide::end_slide() {
  unmoved_ = 0;
  record().slides.push_back(std::move(slide_));
  slide_ = {.joint = joint_, .direction = record().slides.back().direction};
  const std::size_t count = record().slides.size();
  refit_due_ = count == 4 || count == 8 || count == 16 || planned_ == plan_.size();
  next_slide();
}

void Guide::begin_work(Work work) {
  work_ = work;
  work_taken_ = false;
  work_done_ = false;
  work_steps_ = readings().encoder_step;
  start_ = axis().watch.position();
  enter(State::wait);
}

std::function<void()> Guide::take_work() {
  if (state_ != State::wait || std::exchange(work_taken_, true)) return {};
  return [this] {
    fitted_ = work_ == Work::refit ? refitted() : best_for_times();
    work_done_ = true;
  };
}

/// The joint is held where it rests, as are the others.
void Guide::wait_tick(Vector& torque) {
  torque[joint_] = force_towards(start_, axis().watch, record().guess, 0.05 * axis().reach, axis().force_max);
  if (!work_done_) return;
  if (work_ == Work::times) {
    plan_more();
    return;
  }
  if (fitted_.guess) {
    record().guess = *fitted_.guess;
    for (Slide& slide : record().slides) slide.still_pushed = still_pushed(slide, record().guess);
  }
  start_ = planned_start_;
  enter(State::place);
}

Guide::Fitted Guide::refitted() const {
  const JointGuess& guess = record().guess;
  const auto fit = fit_releases(record().slides, work_steps_[static_cast<std::size_t>(joint_)], guess);
  constexpr double kSane = 8;
  if (!fit || fit->mass > kSane * guess.mass || fit->mass < guess.mass / kSane) return {};
  JointGuess better{.mass = fit->mass,
                    .damping = std::max(fit->damping, 0.0),
                    .friction = std::max(fit->friction, 0.0),
                    .latency_s = std::max(fit->latency_s.value, 0.0),
                    .hold_s = guess.hold_s};
  if (fit->hold_s) better.hold_s = fit->hold_s->value;
  return {.guess = better};
}

/// The joint that tells latency and hold time best.
Guide::Fitted Guide::best_for_times() const {
  Fitted best;
  for (int i = 0; i < declared_.degrees_of_freedom(); ++i) {
    if (extra_joint_ >= 0 && i != extra_joint_) continue;
    const auto at = static_cast<std::size_t>(i);
    const JointRecord& candidate = records_[at];
    if (!candidate.refused.empty()) continue;
    const auto fit = fit_releases(candidate.slides, work_steps_[at], candidate.guess);
    // What is left of a spring or a hand, more slides do not make smaller.
    if (!fit || fit->residual > kExplained_steps) continue;
    const double latency_share = fit->latency_s.error / kLatencyGoal_s;
    const double hold_share = fit->hold_s ? fit->hold_s->error / kHoldGoal_s : 0;
    if (best.joint >= 0 && std::max(latency_share, hold_share) >= std::max(best.latency_share, best.hold_share))
      continue;
    best.joint = i;
    best.latency_share = latency_share;
    best.hold_share = hold_share;
  }
  return best;
}

/// More slides of that joint until both times are known well enough.
void Guide::plan_more() {
  const double farther = std::max(fitted_.latency_share, fitted_.hold_share);
  if (fitted_.joint < 0 || farther < 1 || extra_ >= kExtraMost) {
    enter(State::finished);
    return;
  }
  joint_ = extra_joint_ = fitted_.joint;
  const int count = std::min(std::max(kExtraAtOnce, extra_ / 2), kExtraMost - extra_);
  extra_ += count;
  plan_.clear();
  planned_ = 0;
  for (int i = 0; i < count; ++i) plan_.push_back({1, fitted_.hold_share == farther && i % 4 > 1});
  next_slide();
}

double Guide::share() const noexcept {
  if (state_ == State::finished) return 1;
  constexpr double kPlanned = 36;
  constexpr double kExtraShare = 0.1;
  const auto dof = static_cast<double>(declared_.degrees_of_freedom());
  if (extra_joint_ >= 0) return 1 - kExtraShare * (1 - static_cast<double>(extra_) / kExtraMost);
  const double here = std::min(static_cast<double>(planned_) / kPlanned, 1.0);
  return (1 - kExtraShare) * (std::clamp(joint_, 0, declared_.degrees_of_freedom() - 1) + here) / dof;
}

std::string Guide::doing() const {
  if (state_ == State::rest) return "at rest, without force";
  if (state_ == State::finished) return "done";
  if (state_ == State::wait) return "computing what the slides say";
  const std::string name = joint_name(joint_, declared_.cartesian);
  if (state_ == State::grow || state_ == State::first_push) return name + ": the force grows until it moves";
  return name + ": slide " + std::to_string(record().slides.size() + 1) + (now_.silent ? ", let go by silence" : "");
}

}  // namespace forcebound::client::commands::identify
