#include "forcebound/client/commands/identify/release_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "forcebound/client/commands/identify/release_solver.hpp"
#include "forcebound/client/commands/identify/slide_motion.hpp"

namespace forcebound::client::commands::identify {
namespace {

constexpr int kSlidesLeast = 4;

/// Where the force ends after silence is unknown by tens of ms: the best of many beginnings.
double searched_hold_s(std::span<const Slide> slides, double step, SharedVector shared) {
  constexpr std::size_t kSlidesMost = 3;
  std::vector<Slide> some;
  for (const Slide& slide : slides) {
    if (slide.end == Slide::End::silence && !slide.still_pushed && some.size() < kSlidesMost) some.push_back(slide);
  }
  ReleaseSolver fit(some, step);
  constexpr double kStep_s = 1.5e-3;
  constexpr int kSteps = 60;
  double least = std::numeric_limits<double>::infinity();
  double best_s = 0;
  for (int i = 0; i < kSteps; ++i) {
    shared[kLetGo] = shared[kLatency] + i * kStep_s;
    fit.begin_at(shared);
    const double cost = fit.cost();
    if (cost < least) {
      least = cost;
      best_s = i * kStep_s;
    }
  }
  return best_s;
}

/// Runs from the guess; where that ends in a poor place, from other latencies, for the best of all.
bool run_to_best(ReleaseSolver& fit, std::span<const Slide> slides, double step, const JointGuess& guess,
                 bool with_silence) {
  constexpr double kGood = 0.32;  // steps; rounding alone makes 0.29
  const std::array latencies_s{guess.latency_s, 0.05e-3, 0.5e-3, 1.2e-3, 2e-3, 4e-3};
  SharedVector best = SharedVector::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (const double latency_s : latencies_s) {
    SharedVector shared = SharedVector::Zero();
    shared[kMobility] = 1 / guess.mass;
    shared[kSlowingForward] = shared[kSlowingBackward] = guess.friction / guess.mass;
    shared[kRate] = guess.damping / guess.mass;
    shared[kLatency] = latency_s;
    if (with_silence) shared[kLetGo] = latency_s + guess.hold_s.value_or(0);
    if (with_silence && (!guess.hold_s || least < std::numeric_limits<double>::infinity())) {
      shared[kLetGo] = latency_s + searched_hold_s(slides, step, shared);
    }
    fit.begin_at(shared);
    if (!fit.run(with_silence)) continue;
    if (fit.cost() < least) {
      least = fit.cost();
      best = fit.shared();
    }
    if (fit.residual_steps() < kGood) return true;
  }
  if (!std::isfinite(least)) return false;
  fit.begin_at(best);
  return fit.run(with_silence);
}

}  // namespace

bool still_pushed(const Slide& slide, const JointGuess& guess) noexcept {
  const auto& s = slide.samples;
  constexpr std::size_t kApart = 8;
  if (slide.end != Slide::End::silence || slide.released < kApart || s.size() < slide.released + kApart + 1) {
    return false;
  }
  const double before = speed_between(slide, slide.released - kApart, slide.released);
  const double after = speed_between(slide, s.size() - kApart - 1, s.size() - 1);
  const double time_s = s[s.size() - 1 - kApart / 2].latched_s - s[slide.released - kApart / 2].latched_s;
  const double rate = guess.damping / guess.mass;
  const double decay = std::exp(-rate * time_s);
  const double lasting_s = rate > 0 ? (1 - decay) / rate : time_s;
  const double free = std::max(before * decay - guess.friction / guess.mass * lasting_s, 0.0);
  const double pushed = before * decay + (slide.push() - guess.friction) / guess.mass * lasting_s;
  constexpr double kNearlyAll = 0.85;  // a force that ends late in the slide is worth its time
  return after > free + kNearlyAll * (pushed - free);
}

std::optional<ReleaseFit> fit_releases(std::span<const Slide> slides, double encoder_step, const JointGuess& guess) {
  ReleaseSolver fit(slides, encoder_step);
  if (fit.usable(Slide::End::zero) < kSlidesLeast || !(guess.mass > 0)) return std::nullopt;
  const bool with_silence = fit.usable(Slide::End::silence) > 0;
  if (!run_to_best(fit, slides, encoder_step, guess, with_silence)) return std::nullopt;

  const SharedVector& found = fit.shared();
  const ReleaseSolver::Errors errors = fit.errors(with_silence);
  ReleaseFit result;
  result.mass = 1 / found[kMobility];
  if (!(result.mass > 0) || !found.allFinite()) return std::nullopt;
  result.damping = found[kRate] * result.mass;
  result.friction = 0.5 * (found[kSlowingForward] + found[kSlowingBackward]) * result.mass;
  result.weight = 0.5 * (found[kSlowingForward] - found[kSlowingBackward]) * result.mass;
  const auto error_of = [&](const SharedVector& of) {
    return std::sqrt(std::max({of.dot(errors.by_scatter * of), of.dot(errors.by_rounding * of), 0.0}));
  };
  const SharedVector latency = SharedVector::Unit(kLatency);
  result.latency_s = {found[kLatency], error_of(latency), errors.telling[kLatency]};
  if (with_silence) {
    const SharedVector hold = SharedVector::Unit(kLetGo) - latency;
    result.hold_s = Estimate{found[kLetGo] - found[kLatency], error_of(hold),
                             std::min(errors.telling[kLetGo], errors.telling[kLatency])};
  }
  result.residual = fit.residual_steps();
  for (std::size_t i = 0; i < slides.size(); ++i) {
    result.states.push_back(fit.at_release(i));
    result.slides += fit.used(i);
  }
  return result;
}

}  // namespace forcebound::client::commands::identify
