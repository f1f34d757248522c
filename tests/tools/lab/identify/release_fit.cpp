#include "tests/tools/lab/identify/release_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace forcebound::lab::identify {
namespace {

// Shared by all slides of a joint.
constexpr int kMobility = 0;  // 1 / mass
constexpr int kSlowingForward = 1;
constexpr int kSlowingBackward = 2;
constexpr int kRate = 3;  // damping / mass
constexpr int kLatency = 4;
constexpr int kLetGo = 5;  // from the last command before silence to the end of its force
constexpr int kSharedCount = 6;
using SharedVector = Eigen::Matrix<double, kSharedCount, 1>;
using SharedMatrix = Eigen::Matrix<double, kSharedCount, kSharedCount>;

constexpr double kWindow_s = 0.12;     // on each side of the release: the farther, the more a joint may differ there
constexpr double kSlowest = 0.1;       // of the speed at the release: slower motion is mostly rounding
constexpr std::size_t kSideLeast = 3;  // samples
constexpr int kSlidesLeast = 4;
constexpr int kStepsMax = 100;

/// phi and psi of s: v phi + u psi is the way in the time s from speed v under u = v' + rate v.
struct Response {
  double decay = 0;
  double phi = 0;
  double psi = 0;
};

Response response(double s, double rate) noexcept {
  const double z = rate * s;
  if (std::abs(z) < 1e-3) {
    return {.decay = std::exp(-z),
            .phi = s * (1 - z / 2 * (1 - z / 3 * (1 - z / 4))),
            .psi = s * s / 2 * (1 - z / 3 * (1 - z / 4 * (1 - z / 5)))};
  }
  const double phi = -std::expm1(-z) / rate;
  return {.decay = std::exp(-z), .phi = phi, .psi = (s - phi) / rate};
}

/// When friction has stopped what moves freely with this speed; it does not start again.
double stopped_s(double speed, double slowing, double rate) noexcept {
  if (!(slowing > 0)) return std::numeric_limits<double>::infinity();
  if (!(speed > 0)) return 0;
  const double share = speed / slowing;
  return std::abs(rate * share) < 1e-6 ? share
         : rate * share > -1           ? std::log1p(rate * share) / rate
                                       : std::numeric_limits<double>::infinity();
}

/// The samples of a slide that are used.
struct Part {
  std::size_t begin = 0;
  std::size_t end = 0;
};

double speed_between(const Slide& slide, std::size_t from, std::size_t to) noexcept {
  const auto& s = slide.samples;
  return (s[to].progress - s[from].progress) / (s[to].latched_s - s[from].latched_s);
}

Part part_of(const Slide& slide) noexcept {
  const auto& s = slide.samples;
  constexpr std::size_t kApart = 4;
  if (slide.still_pushed || slide.released < kApart + 1 || s.size() < slide.released + kSideLeast) return {};
  const double speed = speed_between(slide, slide.released - kApart, slide.released);
  if (!(speed > 0)) return {};
  Part part{slide.released, slide.released};
  while (part.begin > 0) {
    const std::size_t next = part.begin - 1;
    if (s[slide.released].latched_s - s[next].latched_s > kWindow_s) break;
    // The force must have been the same, from a latency before on.
    if (next < kApart || s[next - kApart].force != slide.push()) break;
    if (speed_between(slide, next - kApart / 2, next + kApart / 2) < kSlowest * speed) break;
    part.begin = next;
  }
  while (part.end < s.size()) {
    if (s[part.end].latched_s - s[slide.released].latched_s > kWindow_s) break;
    if (part.end > slide.released + kApart && speed_between(slide, part.end - kApart, part.end) < kSlowest * speed)
      break;
    ++part.end;
  }
  if (slide.released - part.begin < kSideLeast || part.end - slide.released < kSideLeast) return {};
  return part;
}

/// Where a slide's used samples begin.
struct Point {
  double progress = 0;
  double speed = 0;
};

class Fit {
 public:
  Fit(std::span<const Slide> slides, double step) : slides_(slides), step_(step) {
    for (const Slide& slide : slides) parts_.push_back(part_of(slide));
    points_.resize(slides.size());
  }

  [[nodiscard]] int usable(Slide::End end) const noexcept {
    int count = 0;
    for (std::size_t i = 0; i < slides_.size(); ++i) count += used(i) && slides_[i].end == end;
    return count;
  }

  void begin_at(const SharedVector& shared) noexcept {
    shared_ = shared;
    for (std::size_t i = 0; i < slides_.size(); ++i) {
      if (used(i)) begin_slide(i);
    }
  }

  /// Levenberg-Marquardt. @returns whether it came to rest
  bool run(bool with_silence);

  [[nodiscard]] double cost() const noexcept { return cost_at(shared_, points_); }
  [[nodiscard]] const SharedVector& shared() const noexcept { return shared_; }
  [[nodiscard]] ReleaseFit::State at_release(std::size_t slide) const noexcept;
  [[nodiscard]] bool used(std::size_t slide) const noexcept { return parts_[slide].end > parts_[slide].begin; }
  [[nodiscard]] SharedMatrix covariance(bool with_silence) const noexcept;
  [[nodiscard]] double residual_steps() const noexcept;

 private:
  struct Normal {  // of one slide, its own two unknowns eliminated
    SharedMatrix matrix = SharedMatrix::Zero();
    SharedVector score = SharedVector::Zero();
    Eigen::Matrix<double, kSharedCount, 2> cross = Eigen::Matrix<double, kSharedCount, 2>::Zero();
    Eigen::Matrix2d own = Eigen::Matrix2d::Zero();
    Eigen::Vector2d own_score = Eigen::Vector2d::Zero();
  };

  [[nodiscard]] double value(std::size_t slide, double latched_s, const SharedVector& shared,
                             const Point& point) const noexcept;
  [[nodiscard]] double weight(std::size_t slide, std::size_t sample) const noexcept;
  [[nodiscard]] Normal normal(std::size_t slide, double lambda) const noexcept;
  [[nodiscard]] double cost_at(const SharedVector& shared, const std::vector<Point>& points) const noexcept;
  void begin_slide(std::size_t slide) noexcept;
  static void freeze_unused(SharedMatrix& matrix, bool with_silence) noexcept;

  [[nodiscard]] double slowing(std::size_t slide, const SharedVector& shared) const noexcept {
    return shared[slides_[slide].direction > 0 ? kSlowingForward : kSlowingBackward];
  }
  [[nodiscard]] double begin_s(std::size_t slide) const noexcept {
    return slides_[slide].samples[parts_[slide].begin].latched_s;
  }
  /// From the beginning to the end of the push.
  [[nodiscard]] double pushed_s(std::size_t slide, const SharedVector& shared) const noexcept {
    const bool silent = slides_[slide].end == Slide::End::silence;
    return slides_[slide].released_s() + shared[silent ? kLetGo : kLatency] - begin_s(slide);
  }
  /// From the beginning until friction has stopped it.
  [[nodiscard]] double moving_s(std::size_t slide, const SharedVector& shared, const Point& point) const noexcept;

  std::span<const Slide> slides_;
  double step_;
  std::vector<Part> parts_;
  SharedVector shared_ = SharedVector::Zero();
  std::vector<Point> points_;
};

// From the beginning, with F for the push's p = F / mass, r for the slowing by friction, t' = time after the push:
//   x = x0 + v0 phi(t) - r psi(t) + p (psi(t) - psi(t'))

double Fit::moving_s(std::size_t slide, const SharedVector& shared, const Point& point) const noexcept {
  const double pushed = pushed_s(slide, shared);
  const Response r = response(pushed, shared[kRate]);
  const double drive = slides_[slide].push() * shared[kMobility] - slowing(slide, shared);
  return pushed + stopped_s(point.speed * r.decay + drive * r.phi, slowing(slide, shared), shared[kRate]);
}

ReleaseFit::State Fit::at_release(std::size_t slide) const noexcept {
  if (!used(slide)) return {};
  const Response r = response(pushed_s(slide, shared_), shared_[kRate]);
  const double drive = slides_[slide].push() * shared_[kMobility] - slowing(slide, shared_);
  const Point& point = points_[slide];
  return {.used = true,
          .progress = point.progress + point.speed * r.phi + drive * r.psi,
          .speed = point.speed * r.decay + drive * r.phi};
}

double Fit::value(std::size_t slide, double latched_s, const SharedVector& shared, const Point& point) const noexcept {
  const double t = std::min(latched_s - begin_s(slide), moving_s(slide, shared, point));
  const double after = std::max(t - pushed_s(slide, shared), 0.0);
  const Response r = response(t, shared[kRate]);
  const double push = slides_[slide].push() * shared[kMobility];
  return point.progress + point.speed * r.phi - slowing(slide, shared) * r.psi +
         push * (r.psi - response(after, shared[kRate]).psi);
}

/// Readings between which the joint moves less than a step err alike: only about one for each step counts.
double Fit::weight(std::size_t slide, std::size_t sample) const noexcept {
  const auto& s = slides_[slide].samples;
  if (step_ == 0) return 1;
  constexpr std::size_t kApart = 3;
  const std::size_t from = sample < kApart ? 0 : sample - kApart;
  const std::size_t to = std::min(sample + kApart, s.size() - 1);
  const double moved = std::abs(s[to].progress - s[from].progress) / static_cast<double>(to - from);
  return std::clamp(moved / step_, 0.05, 1.0);
}

void Fit::begin_slide(std::size_t slide) noexcept {
  // Linear in its own unknowns: two Gauss-Newton steps from anywhere.
  points_[slide] = {};
  for (int i = 0; i < 2; ++i) {
    const Normal n = normal(slide, 0);
    const Eigen::Vector2d change = n.own.ldlt().solve(n.own_score);
    points_[slide].progress += change[0];
    points_[slide].speed += change[1];
  }
}

Fit::Normal Fit::normal(std::size_t slide, double lambda) const noexcept {
  Normal n;
  const Slide& all = slides_[slide];
  const Point& point = points_[slide];
  const double rate = shared_[kRate];
  const double rate_step = 1e-4 * std::max(1.0, std::abs(rate));
  const double push = all.push() * shared_[kMobility];
  const double slow = slowing(slide, shared_);
  const double pushed = pushed_s(slide, shared_);
  const double moving = moving_s(slide, shared_, point);
  const int slowing_row = all.direction > 0 ? kSlowingForward : kSlowingBackward;
  const int delay_row = all.end == Slide::End::silence ? kLetGo : kLatency;
  const auto way = [&](const Response& r, const Response& after) {
    return point.progress + point.speed * r.phi - slow * r.psi + push * (r.psi - after.psi);
  };
  for (std::size_t k = parts_[slide].begin; k < parts_[slide].end; ++k) {
    const double t = std::min(all.samples[k].latched_s - begin_s(slide), moving);
    const double t_after = std::max(t - pushed, 0.0);
    const Response r = response(t, rate);
    const Response after = response(t_after, rate);
    SharedVector row = SharedVector::Zero();
    row[kMobility] = all.push() * (r.psi - after.psi);
    row[slowing_row] = -r.psi;
    row[kRate] = (way(response(t, rate + rate_step), response(t_after, rate + rate_step)) -
                  way(response(t, rate - rate_step), response(t_after, rate - rate_step))) /
                 (2 * rate_step);
    row[delay_row] = push * after.phi;
    const Eigen::Vector2d own(1, r.phi);
    const double off = all.samples[k].progress - way(r, after);
    const double w = weight(slide, k);
    n.matrix += w * row * row.transpose();
    n.cross += w * row * own.transpose();
    n.own += w * own * own.transpose();
    n.score += w * row * off;
    n.own_score += w * own * off;
  }
  n.own.diagonal() *= 1 + lambda;
  return n;
}

double Fit::cost_at(const SharedVector& shared, const std::vector<Point>& points) const noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < slides_.size(); ++i) {
    for (std::size_t k = parts_[i].begin; k < parts_[i].end; ++k) {
      const SlideSample& sample = slides_[i].samples[k];
      const double off = sample.progress - value(i, sample.latched_s, shared, points[i]);
      sum += weight(i, k) * off * off;
    }
  }
  return sum;
}

void Fit::freeze_unused(SharedMatrix& matrix, bool with_silence) noexcept {
  for (int i = 0; i < kSharedCount; ++i) {
    const bool unused = !with_silence && i == kLetGo;
    if (matrix(i, i) > 0 && !unused) continue;
    matrix.row(i).setZero();
    matrix.col(i).setZero();
    matrix(i, i) = 1;
  }
}

bool Fit::run(bool with_silence) {
  double lambda = 1e-4;
  double now = cost();
  for (int step = 0; step < kStepsMax; ++step) {
    SharedMatrix matrix = SharedMatrix::Zero();
    SharedVector score = SharedVector::Zero();
    std::vector<Normal> normals(slides_.size());
    for (std::size_t i = 0; i < slides_.size(); ++i) {
      if (!used(i)) continue;
      Normal& n = normals[i] = normal(i, lambda);
      const Eigen::Matrix2d inverse = n.own.inverse();
      matrix += n.matrix - n.cross * inverse * n.cross.transpose();
      score += n.score - n.cross * inverse * n.own_score;
    }
    freeze_unused(matrix, with_silence);
    if (!with_silence) score[kLetGo] = 0;
    matrix.diagonal() *= 1 + lambda;
    const SharedVector change = matrix.ldlt().solve(score);
    const SharedVector next = shared_ + change;
    std::vector<Point> points = points_;
    for (std::size_t i = 0; i < slides_.size(); ++i) {
      if (!used(i)) continue;
      const Eigen::Vector2d own =
          normals[i].own.ldlt().solve(normals[i].own_score - normals[i].cross.transpose() * change);
      points[i].progress += own[0];
      points[i].speed += own[1];
    }
    const double then = cost_at(next, points);
    if (!(then <= now)) {
      lambda = std::max(lambda, 1e-9) * 8;
      if (lambda > 1e9) return std::isfinite(now);
      continue;
    }
    shared_ = next;
    points_ = std::move(points);
    // A step that was shortened says nothing.
    const bool rests = lambda < 1e-3 && now - then <= 1e-9 * now;
    now = then;
    lambda = lambda < 1e-12 ? 0 : lambda * 0.1;
    if (rests) return std::isfinite(now);
  }
  return std::isfinite(now);
}

SharedMatrix Fit::covariance(bool with_silence) const noexcept {
  SharedMatrix matrix = SharedMatrix::Zero();
  SharedMatrix scatter = SharedMatrix::Zero();
  int count = 0;
  for (std::size_t i = 0; i < slides_.size(); ++i) {
    if (!used(i)) continue;
    const Normal n = normal(i, 0);
    const Eigen::Matrix2d inverse = n.own.inverse();
    matrix += n.matrix - n.cross * inverse * n.cross.transpose();
    const SharedVector score = n.score - n.cross * inverse * n.own_score;
    scatter += score * score.transpose();
    ++count;
  }
  freeze_unused(matrix, with_silence);
  const SharedMatrix inverse = matrix.ldlt().solve(SharedMatrix::Identity());
  const double few = static_cast<double>(count) / std::max(1, count - kSharedCount);
  const SharedMatrix by_scatter = few * inverse * scatter * inverse;
  // Where by chance the slides agree better than rounding lets them, rounding counts.
  const double deviation = std::max(residual_steps(), 1 / std::sqrt(12.0)) * step_;
  const SharedMatrix by_rounding = deviation * deviation * inverse;
  SharedMatrix larger = by_scatter;
  if (by_rounding(kLatency, kLatency) > by_scatter(kLatency, kLatency)) larger = by_rounding;
  return larger;
}

double Fit::residual_steps() const noexcept {
  double weights = 0;
  for (std::size_t i = 0; i < slides_.size(); ++i) {
    for (std::size_t k = parts_[i].begin; k < parts_[i].end; ++k) weights += weight(i, k);
  }
  return step_ > 0 && weights > 0 ? std::sqrt(cost() / weights) / step_ : 0;
}

/// Where the force ends after silence is unknown by tens of ms: the best of many beginnings.
double searched_hold_s(std::span<const Slide> slides, double step, SharedVector shared) {
  constexpr std::size_t kSlidesMost = 3;
  std::vector<Slide> some;
  for (const Slide& slide : slides) {
    if (slide.end == Slide::End::silence && !slide.still_pushed && some.size() < kSlidesMost) some.push_back(slide);
  }
  Fit fit(some, step);
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
bool run_to_best(Fit& fit, std::span<const Slide> slides, double step, const JointGuess& guess, bool with_silence) {
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
  Fit fit(slides, encoder_step);
  if (fit.usable(Slide::End::zero) < kSlidesLeast || !(guess.mass > 0)) return std::nullopt;
  const bool with_silence = fit.usable(Slide::End::silence) > 0;
  if (!run_to_best(fit, slides, encoder_step, guess, with_silence)) return std::nullopt;

  const SharedVector& found = fit.shared();
  const SharedMatrix covariance = fit.covariance(with_silence);
  ReleaseFit result;
  result.mass = 1 / found[kMobility];
  if (!(result.mass > 0) || !found.allFinite()) return std::nullopt;
  result.damping = found[kRate] * result.mass;
  result.friction = 0.5 * (found[kSlowingForward] + found[kSlowingBackward]) * result.mass;
  result.weight = 0.5 * (found[kSlowingForward] - found[kSlowingBackward]) * result.mass;
  result.latency_s = {found[kLatency], std::sqrt(covariance(kLatency, kLatency))};
  if (with_silence) {
    const double variance =
        covariance(kLetGo, kLetGo) + covariance(kLatency, kLatency) - 2 * covariance(kLetGo, kLatency);
    result.hold_s = Estimate{found[kLetGo] - found[kLatency], std::sqrt(std::max(variance, 0.0))};
  }
  result.residual = fit.residual_steps();
  for (std::size_t i = 0; i < slides.size(); ++i) {
    result.states.push_back(fit.at_release(i));
    result.slides += fit.used(i);
  }
  return result;
}

}  // namespace forcebound::lab::identify
