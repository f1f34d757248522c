#include "tests/tools/lab/identify/energy_balance.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "forcebound/text/numbers.hpp"
#include "tests/tools/lab/identify/student.hpp"

namespace forcebound::lab::identify {
namespace {

// Unknowns.
constexpr int kDamping = 0;
constexpr int kMass = 1;
constexpr int kWeight = 2;
constexpr int kFirstPlace = 3;
constexpr int kCount = kFirstPlace + EnergyBalance::kPlaces;
using Row = Eigen::Matrix<double, kCount, 1>;
using Square = Eigen::Matrix<double, kCount, kCount>;

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

struct Equation {
  Row row = Row::Zero();
  double energy_J = 0;
  double error_J = 0;          ///< standard deviation
  double latency_J_per_s = 0;  ///< change of what is left, if the release was later
  std::size_t slide = 0;
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
  return std::clamp(static_cast<int>(share * EnergyBalance::kPlaces), 0, EnergyBalance::kPlaces - 1);
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

/// Both equations of a slide.
struct SlideEquations {
  Equation at_release;
  Equation at_end;
};

SlideEquations equations_of(const Slide& slide, const ReleaseFit& fit, const ReleaseFit::State& state, double step,
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
  first.error_J = std::hypot(begin_J, release_J, 0.002 * energy.work_J);
  first.latency_J_per_s = push * state.speed;

  const Ending ending = ending_of(slide, step);
  Equation& second = both.at_end;
  add_way(second.row, slide, ending.progress, from, to);
  second.row[kDamping] =
      first.row[kDamping] + integral_of_square(trace, release_s, state.progress, ending.time_s, ending.progress, step);
  second.row[kMass] = 0.5 * ending.speed * ending.speed;
  second.energy_J = energy.work_J;
  const double end_J = fit.mass * std::abs(ending.speed) * ending.speed_error;
  second.error_J = std::hypot(begin_J, end_J, 0.002 * energy.work_J) + energy.changes * rounding;
  second.latency_J_per_s = push * state.speed;
  return both;
}

/// Least squares with errors from the scatter of slides.
class Solution {
 public:
  Solution(const std::vector<Equation>& equations, std::size_t slides) : equations_(equations) {
    for (const Equation& e : equations) {
      const double w = 1 / (e.error_J * e.error_J);
      matrix_ += w * e.row * e.row.transpose();
      right_ += w * e.row * e.energy_J;
      later_ += w * e.row * e.latency_J_per_s;
    }
    for (int i = 0; i < kCount; ++i) {
      if (!(matrix_(i, i) > 0)) matrix_(i, i) = 1;  // a place never seen
    }
    scale_ = matrix_.diagonal().cwiseSqrt().cwiseInverse();
    const Square scaled = scale_.asDiagonal() * matrix_ * scale_.asDiagonal();
    inverse_ = scale_.asDiagonal() * scaled.ldlt().solve(Square::Identity()) * scale_.asDiagonal();
    found_ = inverse_ * right_;
    scatter(slides);
  }

  [[nodiscard]] double value(int unknown) const noexcept { return found_[unknown]; }
  [[nodiscard]] double error(int unknown) const noexcept { return std::sqrt(covariance_(unknown, unknown)); }
  [[nodiscard]] double per_latency(int unknown) const noexcept { return std::abs((inverse_ * later_)[unknown]); }
  /// Change of what is found if each energy is wrong by this share, all to the worse.
  [[nodiscard]] double per_share(int unknown) const noexcept {
    double sum = 0;
    for (const Equation& e : equations_) {
      sum += std::abs(inverse_.row(unknown).dot(e.row) * e.energy_J / (e.error_J * e.error_J));
    }
    return sum;
  }
  [[nodiscard]] double misfit() const noexcept { return misfit_; }
  [[nodiscard]] double residual_share() const noexcept { return residual_share_; }

 private:
  void scatter(std::size_t slides) {
    std::vector<Row> scores(slides, Row::Zero());
    Square expected = Square::Zero();
    double shares = 0;
    double misfits = 0;
    for (const Equation& e : equations_) {
      const double off = e.energy_J - e.row.dot(found_);
      const double w = 1 / (e.error_J * e.error_J);
      scores[e.slide] += w * off * e.row;
      expected += w * e.row * e.row.transpose();
      shares += off * off / (e.energy_J * e.energy_J);
      misfits += off * off * w;
    }
    Square seen = Square::Zero();
    for (const Row& score : scores) seen += score * score.transpose();
    const auto count = static_cast<double>(slides);
    const double few = count / std::max(1.0, count - kCount);
    // Where by chance the slides agree better than rounding lets them, rounding counts.
    const Square by_scatter = few * inverse_ * seen * inverse_;
    const Square by_rounding = inverse_ * expected * inverse_;
    covariance_ = by_scatter.cwiseMax(by_rounding);
    const auto equations = static_cast<double>(equations_.size());
    residual_share_ = std::sqrt(shares / equations);
    misfit_ = std::sqrt(misfits / std::max(1.0, equations - kCount));
  }

  const std::vector<Equation>& equations_;
  Square matrix_ = Square::Zero();
  Row right_ = Row::Zero();
  Row later_ = Row::Zero();
  Row scale_ = Row::Zero();
  Square inverse_ = Square::Zero();
  Row found_ = Row::Zero();
  Square covariance_ = Square::Zero();
  double misfit_ = 0;
  double residual_share_ = 0;
};

// Beyond both the motions are not those of mass, damping and friction. The first in expected errors.
constexpr double kMisfitMost = 6;
constexpr double kResidualMost = 0.08;
constexpr int kSlidesForBounds = 8;

// What nothing here tells of: clocks, the Jacobian's rounding, the line between two readings.
constexpr double kEnergyShare = 0.003;
constexpr double kValueShare = 0.01;

std::string why_not(const EnergyBalance& balance, const Solution& solution) {
  if (balance.slides < kSlidesForBounds) {
    return "only " + std::to_string(balance.slides) + " slides can be used, " + std::to_string(kSlidesForBounds) +
           " are needed";
  }
  if (solution.misfit() > kMisfitMost && balance.residual_share > kResidualMost) {
    return "mass, damping and friction leave " + text::rounded(100 * balance.residual_share, 2) +
           " % of the energy unexplained; was a hand on the device, or does a spring or stop act?";
  }
  return {};
}

}  // namespace

EnergyBalance balance_energy(std::span<const Slide> slides, const ReleaseFit& fit, const BalanceSettings& settings) {
  EnergyBalance balance;
  for (std::size_t i = 0; i < slides.size(); ++i) {
    if (!fit.states[i].used) continue;
    const double end = slides[i].begin + slides[i].direction * slides[i].samples.back().progress;
    balance.from = std::min({balance.from, slides[i].begin, end});
    balance.to = std::max({balance.to, slides[i].begin, end});
  }
  std::vector<Equation> equations;
  std::size_t used = 0;
  for (std::size_t i = 0; i < slides.size(); ++i) {
    if (!fit.states[i].used) continue;
    SlideEquations both = equations_of(slides[i], fit, fit.states[i], settings.encoder_step, balance.from, balance.to);
    both.at_release.slide = both.at_end.slide = used++;
    equations.push_back(both.at_release);
    equations.push_back(both.at_end);
  }
  balance.slides = static_cast<int>(used);
  if (used == 0) {
    balance.damping.refused = balance.friction.refused = "no slide can be used";
    return balance;
  }
  const Solution solution(equations, used);
  balance.mass = solution.value(kMass);
  balance.weight = solution.value(kWeight);
  balance.residual_share = solution.residual_share();
  const double quantile = student_quantile(settings.confidence, std::max(5.0, static_cast<double>(used) - kCount));
  const auto bound_of = [&](int unknown) {
    const double margin = quantile * solution.error(unknown) +
                          settings.latency_error_s * solution.per_latency(unknown) +
                          kEnergyShare * solution.per_share(unknown) + kValueShare * std::abs(solution.value(unknown));
    return LowerBound{.estimate = solution.value(unknown), .bound = solution.value(unknown) - margin};
  };
  balance.damping = bound_of(kDamping);
  balance.friction = bound_of(kFirstPlace);
  for (int i = 0; i < EnergyBalance::kPlaces; ++i) {
    const LowerBound here = bound_of(kFirstPlace + i);
    balance.friction_at[static_cast<std::size_t>(i)] = here.estimate;
    if (here.bound < balance.friction.bound) balance.friction = here;
  }
  balance.damping.refused = balance.friction.refused = why_not(balance, solution);
  return balance;
}

std::vector<SlidePoint> slide_points(std::span<const Slide> slides, const ReleaseFit& fit, double encoder_step) {
  std::vector<SlidePoint> points;
  for (std::size_t i = 0; i < slides.size(); ++i) {
    if (!fit.states[i].used) continue;
    const Equation end = equations_of(slides[i], fit, fit.states[i], encoder_step, -1, 1).at_end;
    const double way = std::abs(end.row[kWeight]);
    if (!(way > 0)) continue;
    points.push_back({.speed = end.row[kDamping] / way,
                      .force = (end.energy_J - fit.mass * end.row[kMass]) / way,
                      .direction = slides[i].direction});
  }
  return points;
}

}  // namespace forcebound::lab::identify
