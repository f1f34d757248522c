#include "forcebound/client/commands/identify/slide_energy.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace forcebound::client::commands::identify {
namespace {

/// A slide's motion as a line through readings, with the fitted state in place of a reading where the force ended.
struct Trace {
  std::vector<double> time_s;
  std::vector<double> progress;

  [[nodiscard]] double at(double time) const noexcept {
    const auto after = std::upper_bound(time_s.begin(), time_s.end(), time);
    if (after == time_s.begin()) return progress.front();
    if (after == time_s.end()) return progress.back();
    const auto i = static_cast<std::size_t>(after - time_s.begin());
    const double share = (time - time_s[i - 1]) / (time_s[i] - time_s[i - 1]);
    return progress[i - 1] + share * (progress[i] - progress[i - 1]);
  }
};

/// The end of what is used of a slide: time, place and speed by a parabola through the last readings.
struct Ending {
  double time_s = 0;
  double progress = 0;
  double speed = 0;
  double speed_error = 0;
};

/// Integral of v^2 dt between two known places, v taken constant between equally spaced knots. Less what rounding adds.
double raw_square(const Trace& trace, double from_s, double from, double to_s, double to, int pieces,
                  double rounding) noexcept {
  const double piece_s = (to_s - from_s) / pieces;
  double last = from;
  double sum = 0;
  for (int i = 1; i <= pieces; ++i) {
    const double next = i == pieces ? to : trace.at(from_s + i * piece_s);
    sum += (next - last) * (next - last) / piece_s;
    last = next;
  }
  const double rounded_twice = 2.0 * std::max(pieces - 1, 0);
  return sum - rounded_twice * rounding * rounding / piece_s;
}

/// The same in the limit of short pieces (Richardson): the error of one falls with its length squared.
double integral_of_square(const Trace& trace, double from_s, double from, double to_s, double to, double step) {
  if (!(to_s > from_s)) return 0;
  constexpr double kPiece_s = 4e-3;
  constexpr double kSteps = 4;
  const double speed = std::max(std::abs(to - from) / (to_s - from_s), 1e-9);
  const double piece_s = std::max(kPiece_s, kSteps * step / speed);
  const int half = std::max(1, static_cast<int>((to_s - from_s) / (2 * piece_s)));
  const double rounding = step / std::sqrt(12.0);
  const double fine = raw_square(trace, from_s, from, to_s, to, 2 * half, rounding);
  const double coarse = raw_square(trace, from_s, from, to_s, to, half, rounding);
  return fine + (fine - coarse) / 3;
}

Ending ending_of(const Slide& slide, double step) {
  constexpr std::size_t kMost = 16;
  const auto& s = slide.samples;
  // The force must have ended before.
  constexpr std::size_t kLeast = 4;
  const std::size_t count = std::clamp((s.size() - slide.released) / 2, kLeast, kMost);
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const double end_s = s.back().latched_s;
  for (std::size_t i = s.size() - count; i < s.size(); ++i) {
    const double t = s[i].latched_s - end_s;
    const Eigen::Vector3d row(1, t, t * t);
    matrix += row * row.transpose();
    right += row * s[i].progress;
  }
  const Eigen::Matrix3d inverse = matrix.inverse();
  const Eigen::Vector3d found = inverse * right;
  return {end_s, found[0], found[1], step / std::sqrt(12.0) * std::sqrt(inverse(1, 1))};
}

int place_of(double position, double from, double to) noexcept {
  const double share = (position - from) / std::max(to - from, 1e-12);
  return std::clamp(static_cast<int>(share * kPlaces), 0, kPlaces - 1);
}

/// The way from 0 to `progress`, by places.
void add_way(Row& row, const Slide& slide, double progress, double from, double to) noexcept {
  constexpr int kPieces = 60;
  for (int i = 0; i < kPieces; ++i) {
    const double middle = progress * (i + 0.5) / kPieces;
    row[kFirstPlace + place_of(slide.begin + slide.direction * middle, from, to)] += progress / kPieces;
  }
  row[kWeight] = slide.direction * progress;
}

struct SlideEnergy {
  double work_J = 0;
  double changes = 0;  ///< sum of changes of the force while it moved, as their places are known to rounding only
};

/// Of the motor until the release. The force may have been raised before the joint moved.
SlideEnergy work_of(const Slide& slide, const Trace& trace, double delay_s, double released_at) {
  const auto& s = slide.samples;
  SlideEnergy energy;
  double force = s.front().force;
  double last = 0;
  for (std::size_t k = 1; k < slide.released; ++k) {
    if (s[k].force == force) continue;
    const double place = trace.at(s[k].commanded_s + delay_s);
    energy.work_J += force * (place - last);
    energy.changes += std::abs(s[k].force - force);
    last = place;
    force = s[k].force;
  }
  energy.work_J += force * (released_at - last);
  return energy;
}

Trace trace_of(const Slide& slide, double release_s, double progress) {
  Trace trace;
  bool put = false;
  for (const SlideSample& sample : slide.samples) {
    if (!put && sample.latched_s >= release_s) {
      trace.time_s.push_back(release_s);
      trace.progress.push_back(progress);
      put = true;
      if (sample.latched_s == release_s) continue;
    }
    trace.time_s.push_back(sample.latched_s);
    trace.progress.push_back(sample.progress);
  }
  return trace;
}

double delay_of(const Slide& slide, const ReleaseFit& fit) noexcept {
  const bool silent = slide.end == Slide::End::silence;
  return fit.latency_s.value + (silent && fit.hold_s ? fit.hold_s->value : 0);
}

}  // namespace

SlideEquations equations_of(const Slide& slide, const ReleaseFit& fit, const ReleaseState& state, double step,
                            double from, double to) {
  const double rounding = step / std::sqrt(12.0);
  const double release_s = slide.released_s() + delay_of(slide, fit);
  const Trace trace = trace_of(slide, release_s, state.progress);
  const SlideEnergy energy = work_of(slide, trace, fit.latency_s.value, state.progress);
  const double begin_s = slide.samples.front().commanded_s + fit.latency_s.value;
  const double push = slide.push();
  SlideEquations both;
  Equation& first = both.at_release;
  add_way(first.row, slide, state.progress, from, to);
  first.row[kDamping] = integral_of_square(trace, begin_s, 0, release_s, state.progress, step);
  first.row[kMass] = 0.5 * state.speed * state.speed;
  first.energy_J = energy.work_J;
  const double begin_J = push * rounding;  // the place where it began
  const double release_J = fit.mass * state.speed * std::max(0.002 * state.speed, rounding / 0.05);
  const double changes_J = energy.changes * rounding;
  first.error_J = std::hypot(begin_J, release_J, 0.002 * energy.work_J) + changes_J;
  first.latency_J_per_s = push * state.speed;

  const Ending ending = ending_of(slide, step);
  Equation& second = both.at_end;
  add_way(second.row, slide, ending.progress, from, to);
  second.row[kDamping] =
      first.row[kDamping] + integral_of_square(trace, release_s, state.progress, ending.time_s, ending.progress, step);
  second.row[kMass] = 0.5 * ending.speed * ending.speed;
  second.energy_J = energy.work_J;
  const double end_J = fit.mass * std::abs(ending.speed) * ending.speed_error;
  second.error_J = std::hypot(begin_J, end_J, 0.002 * energy.work_J) + changes_J;
  second.latency_J_per_s = push * state.speed;
  return both;
}

}  // namespace forcebound::client::commands::identify
