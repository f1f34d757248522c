#include "forcebound/client/commands/identify/release_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace forcebound::client::commands::identify {
namespace {

constexpr int kStepsMax = 100;

}  // namespace

// From the beginning, with F for the push's p = F / mass, r for the slowing by friction, t' = time after the push:
//   x = x0 + v0 phi(t) - r psi(t) + p (psi(t) - psi(t'))

double ReleaseSolver::moving_s(std::size_t slide, const SharedVector& shared, const Point& point) const noexcept {
  const double pushed = pushed_s(slide, shared);
  const Response r = response(pushed, shared[kRate]);
  const double drive = slides_[slide].push() * shared[kMobility] - slowing(slide, shared);
  return pushed + stopped_s(point.speed * r.decay + drive * r.phi, slowing(slide, shared), shared[kRate]);
}

ReleaseState ReleaseSolver::at_release(std::size_t slide) const noexcept {
  if (!used(slide)) return {};
  const Response r = response(pushed_s(slide, shared_), shared_[kRate]);
  const double drive = slides_[slide].push() * shared_[kMobility] - slowing(slide, shared_);
  const Point& point = points_[slide];
  return {.used = true,
          .progress = point.progress + point.speed * r.phi + drive * r.psi,
          .speed = point.speed * r.decay + drive * r.phi};
}

/// @param after_s the part of that time after the push
double ReleaseSolver::way(std::size_t slide, double time_s, double after_s, const SharedVector& shared,
                          const Point& point) const noexcept {
  const Response r = response(time_s, shared[kRate]);
  const double push = slides_[slide].push() * shared[kMobility];
  const double coasted = after_s > 0 ? response(after_s, shared[kRate]).psi : 0;
  return point.progress + point.speed * r.phi - slowing(slide, shared) * r.psi + push * (r.psi - coasted);
}

/// Readings between which the joint moves less than a step err alike: only about one for each step counts.
double ReleaseSolver::weight(std::size_t slide, std::size_t sample) const noexcept {
  const auto& s = slides_[slide].samples;
  if (step_ == 0) return 1;
  constexpr std::size_t kApart = 3;
  const std::size_t from = sample < kApart ? 0 : sample - kApart;
  const std::size_t to = std::min(sample + kApart, s.size() - 1);
  const double moved = std::abs(s[to].progress - s[from].progress) / static_cast<double>(to - from);
  return std::clamp(moved / step_, 0.05, 1.0);
}

void ReleaseSolver::begin_slide(std::size_t slide) noexcept {
  // Linear in its own unknowns: two Gauss-Newton steps from anywhere.
  points_[slide] = {};
  for (int i = 0; i < 2; ++i) {
    const Normal n = normal(slide, 0);
    const Eigen::Vector2d change = n.own.ldlt().solve(n.own_score);
    points_[slide].progress += change[0];
    points_[slide].speed += change[1];
  }
}

ReleaseSolver::Normal ReleaseSolver::normal(std::size_t slide, double lambda) const noexcept {
  Normal n;
  const Slide& all = slides_[slide];
  const Point& point = points_[slide];
  const double rate = shared_[kRate];
  const double rate_step = 1e-4 * std::max(1.0, std::abs(rate));
  const double push = all.push() * shared_[kMobility];
  const double pushed = pushed_s(slide, shared_);
  const double moving = moving_s(slide, shared_, point);
  const int slowing_row = all.direction > 0 ? kSlowingForward : kSlowingBackward;
  const int delay_row = all.end == Slide::End::silence ? kLetGo : kLatency;
  SharedVector faster = shared_;
  SharedVector slower = shared_;
  faster[kRate] += rate_step;
  slower[kRate] -= rate_step;
  for (std::size_t k = parts_[slide].begin; k < parts_[slide].end; ++k) {
    const double t = std::min(all.samples[k].latched_s - begin_s(slide), moving);
    const double t_after = std::max(t - pushed, 0.0);
    const Response r = response(t, rate);
    const Response after = response(t_after, rate);
    SharedVector row = SharedVector::Zero();
    row[kMobility] = all.push() * (r.psi - after.psi);
    row[slowing_row] = -r.psi;
    row[kRate] = (way(slide, t, t_after, faster, point) - way(slide, t, t_after, slower, point)) / (2 * rate_step);
    row[delay_row] = push * after.phi;
    const Eigen::Vector2d own(1, r.phi);
    const double off = all.samples[k].progress - way(slide, t, t_after, shared_, point);
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

double ReleaseSolver::cost_at(const SharedVector& shared, const std::vector<Point>& points) const noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < slides_.size(); ++i) {
    if (!used(i)) continue;
    const double pushed = pushed_s(i, shared);
    const double moving = moving_s(i, shared, points[i]);
    for (std::size_t k = parts_[i].begin; k < parts_[i].end; ++k) {
      const SlideSample& sample = slides_[i].samples[k];
      const double t = std::min(sample.latched_s - begin_s(i), moving);
      const double off = sample.progress - way(i, t, std::max(t - pushed, 0.0), shared, points[i]);
      sum += weight(i, k) * off * off;
    }
  }
  return sum;
}

void ReleaseSolver::freeze_unused(SharedMatrix& matrix, bool with_silence) noexcept {
  for (int i = 0; i < kSharedCount; ++i) {
    const bool unused = !with_silence && i == kLetGo;
    if (matrix(i, i) > 0 && !unused) continue;
    matrix.row(i).setZero();
    matrix.col(i).setZero();
    matrix(i, i) = 1;
  }
}

bool ReleaseSolver::run(bool with_silence) {
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

/// Of each slide's part in what is found: without it, all else would be found so much otherwise (jackknife). Where few
/// slides tell a time, each of them weighs much, and this tells more of the error than what they leave.
ReleaseSolver::Errors ReleaseSolver::errors(bool with_silence) const noexcept {
  struct Share {
    SharedMatrix matrix;
    SharedVector score;
  };
  std::vector<Share> parts;
  SharedMatrix matrix = SharedMatrix::Zero();
  for (std::size_t i = 0; i < slides_.size(); ++i) {
    if (!used(i)) continue;
    const Normal n = normal(i, 0);
    const Eigen::Matrix2d inverse = n.own.inverse();
    parts.push_back({n.matrix - n.cross * inverse * n.cross.transpose(), n.score - n.cross * inverse * n.own_score});
    matrix += parts.back().matrix;
  }
  freeze_unused(matrix, with_silence);
  const SharedMatrix inverse = matrix.ldlt().solve(SharedMatrix::Identity());
  Errors errors;
  // Where by chance the slides agree better than rounding lets them, rounding counts.
  const double deviation = std::max(residual_steps(), 1 / std::sqrt(12.0)) * step_;
  errors.by_rounding = deviation * deviation * inverse;
  SharedVector shares = SharedVector::Zero();
  SharedVector squares = SharedVector::Zero();
  for (const Share& part : parts) {
    SharedMatrix rest = matrix - part.matrix;
    freeze_unused(rest, with_silence);
    const SharedVector change = rest.ldlt().solve(part.score);
    errors.by_scatter += change * change.transpose();
    const SharedVector share = (inverse * part.matrix * inverse).diagonal();
    shares += share;
    squares += share.cwiseProduct(share);
  }
  errors.telling = shares.cwiseProduct(shares).cwiseQuotient(squares.cwiseMax(1e-300));
  return errors;
}

double ReleaseSolver::residual_steps() const noexcept {
  double weights = 0;
  for (std::size_t i = 0; i < slides_.size(); ++i) {
    for (std::size_t k = parts_[i].begin; k < parts_[i].end; ++k) weights += weight(i, k);
  }
  return step_ > 0 && weights > 0 ? std::sqrt(cost() / weights) / step_ : 0;
}

}  // namespace forcebound::client::commands::identify
