#include "forcebound/client/rendering/dragged_mass.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "forcebound/local_model/no_longer_than.hpp"

namespace forcebound::client {
namespace {

constexpr double kStepMost_s = 1e-3;
constexpr int kStepsMost = 100;
constexpr double kReachMost_m = local_model::Mass::kReachMost_m;
constexpr double kSpeedMost_m_per_s = local_model::Mass::kSpeedMost_m_per_s;
// A mass that moves by less than this share of what it would by itself is held.
constexpr double kHeld = 0.02;

}  // namespace

void DraggedMass::update(const local_model::Mass& told, const ModelAge& age, Nanoseconds now) noexcept {
  const bool same = there_ && told.id == reported_.id;
  const Point before_N = pull_N(device_);
  reported_ = told;
  there_ = true;
  find_way_back();
  if (!same) {
    begin(age);
    return;
  }
  match_held_velocity();
  // Of another coupling the force is another at once, not on the next tick: only so can the difference fade.
  moved_by_N_ += pull_N(device_) - before_N;
  const auto place_m = place_at_m(now - time::from_seconds(age.s));
  // Of the time before it began here nothing is known.
  if (!place_m) return;
  Point deviation_m = told.place_m - *place_m;
  if (!(deviation_m.norm() > kAgrees_m)) deviation_m.setZero();
  // Where it is beyond the limit it comes back no faster than from anywhere else.
  const double beyond_m = way_m() + deviation_m.dot(told.push) - told.travel_m;
  if (beyond_m > kWithin_m) deviation_m -= beyond_m * back_;
  if (deviation_m.norm() > kBeginsAnew_m) {
    begin(age);
  } else {
    deviation_m_ = deviation_m;
  }
}

/// Along which it goes where its joints keep it from going along the push alone.
void DraggedMass::find_way_back() noexcept {
  const Point pushed = reported_.free_per_kg * reported_.push;
  const double along = pushed.dot(reported_.push);
  back_ = along > kHeld * pushed.norm() ? Point(pushed / along) : reported_.push;
}

/// Where it hardly answers to a force something holds it, and it has the velocity of that.
void DraggedMass::match_held_velocity() noexcept {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(reported_.free_per_kg, Eigen::EigenvaluesOnly);
  const double free_per_kg = solver.eigenvalues().maxCoeff();
  solver.computeDirect(reported_.mobility_per_kg);
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (solver.eigenvalues()[i] > kHeld * free_per_kg) continue;
    const Point along = solver.eigenvectors().col(i);
    velocity_m_per_s_ += along * along.dot(reported_.velocity_m_per_s - velocity_m_per_s_);
  }
}

void DraggedMass::begin(const ModelAge& age) noexcept {
  place_m_ = reported_.place_m + age.s * local_model::no_longer_than(reported_.velocity_m_per_s, kSpeedMost_m_per_s);
  velocity_m_per_s_ = reported_.velocity_m_per_s;
  stop_at(reported_.travel_m);
  deviation_m_.setZero();
  corrected_m_.setZero();
  moved_ = false;
  past_count_ = 0;
}

std::optional<Point> DraggedMass::place_at_m(Nanoseconds time) const noexcept {
  const std::size_t known = std::min(past_count_, kPasts);
  for (std::size_t back = 1; back <= known; ++back) {
    const Past& past = past_[(past_count_ - back) % kPasts];
    if (past.time > time) continue;
    Point at_m = past.place_m;
    if (back > 1) {
      const Past& next = past_[(past_count_ - back + 1) % kPasts];
      const double share = time::to_seconds(time - past.time) / time::to_seconds(next.time - past.time);
      at_m += share * (next.place_m - past.place_m);
    }
    // Corrections that were made since count as made then: the answer could not know of them.
    return Point(at_m + corrected_m_);
  }
  return std::nullopt;
}

Point DraggedMass::pull_N(const DevicePoint& device) const noexcept {
  return reported_.stiffness_N_per_m * local_model::no_longer_than<Point>(device.place_m - place_m_, kReachMost_m) +
         reported_.damping_N_s_per_m *
             (local_model::no_longer_than(device.velocity_m_per_s, kSpeedMost_m_per_s) - velocity_m_per_s_);
}

double DraggedMass::way_m() const noexcept { return (place_m_ - reported_.place_m).dot(reported_.push); }

void DraggedMass::stop_at(double most_m) noexcept {
  const double beyond_m = way_m() - most_m;
  if (!(beyond_m > 0)) return;
  place_m_ -= beyond_m * back_;
  velocity_m_per_s_ -= std::max(0.0, velocity_m_per_s_.dot(reported_.push)) * back_;
}

void DraggedMass::step(const DevicePoint& device, double step_s, double share) noexcept {
  const Point pull = pull_N(device);
  moved_by_N_ = pull;
  device_ = device;
  moved_ = true;
  const bool leaves = reported_.push.dot(reported_.free_per_kg * pull) < 0;
  const Eigen::Matrix3d& moved_per_kg = leaves ? reported_.free_per_kg : reported_.mobility_per_kg;
  velocity_m_per_s_ += step_s * (share * reported_.bias_m_per_s2 + moved_per_kg * pull);
  velocity_m_per_s_ = local_model::no_longer_than(velocity_m_per_s_, kSpeedMost_m_per_s);
  const double most_m = std::max(reported_.travel_m, way_m());
  place_m_ += step_s * velocity_m_per_s_;
  stop_at(most_m);
}

void DraggedMass::advance(const DevicePoint& device, double elapsed_s, Nanoseconds now, double share) noexcept {
  if (!there_ || !(elapsed_s > 0)) return;
  const int steps = static_cast<int>(std::clamp(std::ceil(elapsed_s / kStepMost_s - 1e-6), 1.0, double{kStepsMost}));
  const double step_s = std::min(elapsed_s / steps, kStepMost_s);
  for (int i = 1; i <= steps; ++i) {
    DevicePoint then = device;
    then.place_m -= step_s * (steps - i) * device.velocity_m_per_s;
    step(then, step_s, share);
  }
  correct(elapsed_s);
  remember(now);
}

void DraggedMass::correct(double elapsed_s) noexcept {
  const double left_m = deviation_m_.norm();
  if (!(left_m > 0)) return;
  const double most_m = std::min(kCorrection_m_per_s * elapsed_s, left_m);
  const Point by_m = deviation_m_ * (std::min(most_m, left_m * elapsed_s / kCorrection_s) / left_m);
  place_m_ += by_m;
  corrected_m_ += by_m;
  deviation_m_ -= by_m;
}

void DraggedMass::remember(Nanoseconds now) noexcept {
  past_[past_count_ % kPasts] = {.time = now, .place_m = place_m_ - corrected_m_};
  ++past_count_;
}

}  // namespace forcebound::client
