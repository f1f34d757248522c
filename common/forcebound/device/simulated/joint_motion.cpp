#include "forcebound/device/simulated/joint_motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>

#include "forcebound/device/simulated/polynomial.hpp"

namespace forcebound::device {
namespace {

// A joint at rest starts to slide this much above its friction, so that rounding cannot make it stick again at once.
constexpr double kBreakAwayMargin = 1e-12;

// rate * step below this: 28 terms suffice for double rounding with room to spare.
constexpr double kReachMax = 0.8;

// Most steps for one piece: with a faster system the series still converges, but not to the last digit.
constexpr double kStepsMax = 256;

/// An upper bound of |eigenvalue| for u'' + B u' + K u = 0.
double rate_of(const Matrix& damping_rate, const Matrix& stiffness_rate) noexcept {
  const double damping = damping_rate.cwiseAbs().rowwise().sum().maxCoeff();
  const double stiffness = stiffness_rate.cwiseAbs().rowwise().sum().maxCoeff();
  return 0.5 * damping + std::sqrt(0.25 * damping * damping + stiffness);
}

int terms_for(double reach, int most) noexcept {
  constexpr int kLeast = 8;
  int n = 1;
  for (double term = reach; term > 1e-19 && n < most; term *= reach / n) ++n;
  return std::clamp(n + 2, kLeast, most);
}

double soft_threshold(double value, double threshold) noexcept {
  if (value > threshold) return value - threshold;
  if (value < -threshold) return value + threshold;
  return 0;
}

}  // namespace

JointMotion::JointMotion(const Matrix& damping, const Vector& friction, const Vector& start)
    : dof_(static_cast<int>(start.size())),
      damping_(damping),
      friction_(friction),
      position_(start),
      velocity_(Vector::Zero(start.size())),
      start_(start) {
  for (int i = 0; i < dof_; ++i) {
    contact_[static_cast<std::size_t>(i)] = friction_[i] > 0 ? Contact::sticking : Contact::frictionless;
  }
}

void JointMotion::set_system(const JointSystem& system) noexcept {
  system_ = system;
  reduced_ = false;
}

double JointMotion::fastest_rate() const noexcept {
  const Eigen::LLT<Matrix> inertia(system_.inertia);
  return rate_of(inertia.solve(system_.damping), inertia.solve(system_.stiffness));
}

double JointMotion::sign(Contact contact) noexcept {
  if (contact == Contact::forward) return 1;
  return contact == Contact::backward ? -1 : 0;
}

bool JointMotion::stays(int joint) const noexcept {
  const Contact contact = contact_[static_cast<std::size_t>(joint)];
  return contact == Contact::sticking || contact == Contact::frozen;
}

void JointMotion::advance(const JointDrive& drive) noexcept {
  start_ = position_;
  for (Contact& contact : contact_) {
    if (contact == Contact::frozen) contact = Contact::sticking;
  }
  constexpr double kRemainderLeast = 1e-14;
  const double step_least = drive.length_s / kStepsMax;
  int events = 0;
  bool choose = true;
  double elapsed = 0;
  while (drive.length_s - elapsed > kRemainderLeast * drive.length_s) {
    set_force(drive, elapsed, 1);
    if (choose) choose_contacts(Eigen::Map<const Vector>(force_[0].data(), dof_));
    if (!reduced_) reduce_to_moving();
    const double longest = rate_ > 0 ? std::max(kReachMax / rate_, step_least) : drive.length_s;
    const double step = std::min(drive.length_s - elapsed, longest);
    set_force(drive, elapsed, step);
    expand(step);
    const Event event = first_event(step);
    account(drive, step, event.at);
    move(step, event.at);
    meet(event, events >= kEventsMax);
    choose = event.joint >= 0 && event.next == Contact::sticking;
    events += event.joint >= 0;
    elapsed += event.at * step;
  }
}

void JointMotion::set_force(const JointDrive& drive, double elapsed_s, double step_s) noexcept {
  const double e = elapsed_s;
  const auto& f = drive.hand_pull;
  for (int i = 0; i < dof_; ++i) {
    const auto row = static_cast<std::size_t>(i);
    double spring = 0;
    for (int j = 0; j < dof_; ++j) spring += system_.stiffness(i, j) * (position_[j] - start_[j]);
    force_[0][row] = drive.torque[i] - spring + f[0][i] + e * (f[1][i] + e * (f[2][i] + e * f[3][i]));
    force_[1][row] = step_s * (f[1][i] + e * (2 * f[2][i] + e * 3 * f[3][i]));
    force_[2][row] = step_s * step_s * (f[2][i] + 3 * e * f[3][i]);
    force_[3][row] = step_s * step_s * step_s * f[3][i];
  }
}

void JointMotion::choose_contacts(const Vector& force) noexcept {
  bool any_rests = false;
  for (int i = 0; i < dof_; ++i) {
    Contact& contact = contact_[static_cast<std::size_t>(i)];
    if (contact == Contact::frictionless || contact == Contact::frozen) continue;
    const Contact before = contact;
    contact = velocity_[i] > 0 ? Contact::forward : velocity_[i] < 0 ? Contact::backward : Contact::sticking;
    any_rests = any_rests || contact == Contact::sticking;
    reduced_ = reduced_ && (before == Contact::sticking) == (contact == Contact::sticking);
  }
  if (!any_rests) return;
  const Vector acceleration = starting_accelerations(force);
  for (int i = 0; i < dof_; ++i) {
    Contact& contact = contact_[static_cast<std::size_t>(i)];
    if (contact != Contact::sticking || acceleration[i] == 0) continue;
    contact = acceleration[i] > 0 ? Contact::forward : Contact::backward;
    reduced_ = false;
  }
}

Vector JointMotion::starting_accelerations(const Vector& force) const noexcept {
  constexpr int kSweepsMax = 100;
  Vector pull = force - system_.damping * velocity_;
  Vector threshold = Vector::Zero(dof_);
  for (int i = 0; i < dof_; ++i) {
    const Contact contact = contact_[static_cast<std::size_t>(i)];
    pull[i] -= friction_[i] * sign(contact);
    if (contact == Contact::sticking) threshold[i] = friction_[i] * (1 + kBreakAwayMargin);
  }
  Vector acceleration = Vector::Zero(dof_);
  for (int sweep = 0; sweep < kSweepsMax; ++sweep) {
    double change = 0;
    for (int i = 0; i < dof_; ++i) {
      if (contact_[static_cast<std::size_t>(i)] == Contact::frozen) continue;
      const double own = system_.inertia(i, i);
      const double rest = pull[i] - system_.inertia.row(i).dot(acceleration) + own * acceleration[i];
      const double next = soft_threshold(rest, threshold[i]) / own;
      change = std::max(change, std::abs(next - acceleration[i]));
      acceleration[i] = next;
    }
    if (!(change > 1e-15 * acceleration.cwiseAbs().maxCoeff())) break;
  }
  return acceleration;
}

void JointMotion::reduce_to_moving() noexcept {
  std::array<int, control::kDofMax> moving{};
  int count = 0;
  for (int i = 0; i < dof_; ++i) {
    if (!stays(i)) moving[static_cast<std::size_t>(count++)] = i;
  }
  mobility_ = Matrix::Zero(dof_, dof_);
  if (count > 0) {
    const std::span<const int> rows(moving.data(), static_cast<std::size_t>(count));
    const Matrix inertia = system_.inertia(rows, rows);
    const Eigen::LLT<Matrix> factor(inertia);
    const Matrix inverse = factor.solve(Matrix::Identity(count, count));
    mobility_(rows, rows) = inverse;
  }
  damping_rate_ = mobility_ * system_.damping;
  stiffness_rate_ = mobility_ * system_.stiffness;
  rate_ = rate_of(damping_rate_, stiffness_rate_);
  reduced_ = true;
}

void JointMotion::expand(double step_s) noexcept {
  terms_ = terms_for(rate_ * step_s, kTermsMax);
  const auto n = static_cast<std::size_t>(dof_);
  for (std::size_t i = 0; i < n; ++i) {
    displacement_[0][i] = 0;
    displacement_[1][i] = step_s * velocity_[static_cast<Eigen::Index>(i)];
  }
  Rows sliding{};
  for (std::size_t i = 0; i < n; ++i) sliding[i] = sign(contact_[i]) * friction_[static_cast<Eigen::Index>(i)];
  for (int k = 0; k + 2 < terms_; ++k) {
    const auto order = static_cast<std::size_t>(k);
    const double to_acceleration = step_s * step_s / ((k + 2) * (k + 1));
    const double to_velocity = (k + 1) / step_s;
    const Rows& u = displacement_[order];
    const Rows& u_next = displacement_[order + 1];
    for (int i = 0; i < dof_; ++i) {
      double sum = 0;
      for (int j = 0; j < dof_; ++j) {
        const auto column = static_cast<std::size_t>(j);
        sum -= damping_rate_(i, j) * u_next[column] * to_velocity + stiffness_rate_(i, j) * u[column];
        if (k < JointDrive::kTerms) {
          sum += mobility_(i, j) * (k == 0 ? force_[0][column] - sliding[column] : force_[order][column]);
        }
      }
      displacement_[order + 2][static_cast<std::size_t>(i)] = to_acceleration * sum;
    }
  }
}

JointMotion::Event JointMotion::first_event(double step_s) const noexcept {
  Event first;
  for (int i = 0; i < dof_; ++i) {
    const Contact contact = contact_[static_cast<std::size_t>(i)];
    if (contact == Contact::frictionless || contact == Contact::frozen) continue;
    const Event event = contact == Contact::sticking ? first_break_away(i, step_s) : first_reversal(i);
    if (event.joint >= 0 && (first.joint < 0 || event.at < first.at)) first = event;
  }
  return first;
}

JointMotion::Event JointMotion::first_reversal(int joint) const noexcept {
  const auto row = static_cast<std::size_t>(joint);
  const double forward = sign(contact_[row]);
  // From rest the velocity has the root s = 0, which is no reversal: divide it out.
  const std::size_t first = velocity_[joint] == 0 ? 2 : 1;
  std::array<double, kTermsMax> velocity{};
  std::size_t count = 0;
  for (std::size_t k = first; k < static_cast<std::size_t>(terms_); ++k) {
    velocity[count++] = forward * static_cast<double>(k) * displacement_[k][row];
  }
  const auto at = polynomial::first_negative({velocity.data(), count});
  return at ? Event{*at, joint, Contact::sticking} : Event{};
}

JointMotion::Event JointMotion::first_break_away(int joint, double step_s) const noexcept {
  const auto row = static_cast<std::size_t>(joint);
  std::array<double, kTermsMax> reaction{};
  const std::size_t count = static_cast<std::size_t>(terms_) - 2;
  for (std::size_t k = 0; k < count; ++k) {
    const auto order = static_cast<double>(k);
    double sum = k < JointDrive::kTerms ? force_[k][row] : 0;
    for (int j = 0; j < dof_; ++j) {
      const auto column = static_cast<std::size_t>(j);
      sum -= system_.inertia(joint, j) * (order + 2) * (order + 1) / (step_s * step_s) * displacement_[k + 2][column];
      sum -= system_.damping(joint, j) * (order + 1) / step_s * displacement_[k + 1][column];
      sum -= system_.stiffness(joint, j) * displacement_[k][column];
    }
    reaction[k] = sum;
  }
  const double most = friction_[joint] * (1 + kBreakAwayMargin);
  Event first;
  for (const double direction : {1.0, -1.0}) {
    std::array<double, kTermsMax> margin{};
    for (std::size_t k = 0; k < count; ++k) margin[k] = (k == 0 ? most : 0.0) - direction * reaction[k];
    const auto at = polynomial::first_negative({margin.data(), count});
    if (!at || (first.joint >= 0 && *at >= first.at)) continue;
    first = {*at, joint, direction > 0 ? Contact::forward : Contact::backward};
  }
  return first;
}

void JointMotion::account(const JointDrive& drive, double step_s, double share) noexcept {
  const auto n = static_cast<std::size_t>(dof_);
  const auto terms = static_cast<std::size_t>(terms_);
  Series velocity{};
  Series damped{};
  for (std::size_t k = 0; k + 1 < terms; ++k) {
    for (std::size_t i = 0; i < n; ++i) velocity[k][i] = static_cast<double>(k + 1) * displacement_[k + 1][i];
    for (int i = 0; i < dof_; ++i) {
      double sum = 0;
      for (int j = 0; j < dof_; ++j) sum += damping_(i, j) * velocity[k][static_cast<std::size_t>(j)];
      damped[k][static_cast<std::size_t>(i)] = sum;
    }
  }
  std::array<double, 2 * kTermsMax> power{};  // d P / d s
  for (std::size_t k = 0; k + 1 < terms; ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      const auto joint = static_cast<Eigen::Index>(i);
      power[k] += (sign(contact_[i]) * friction_[joint] - drive.torque[joint]) * velocity[k][i];
      power[2 * k] += velocity[k][i] * damped[k][i] / step_s;
    }
    for (std::size_t m = 0; m < k; ++m) {  // D is symmetric
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) sum += velocity[k][i] * damped[m][i];
      power[k + m] += 2 * sum / step_s;
    }
  }
  std::array<double, 2 * kTermsMax> energy{};
  const std::size_t count = 2 * terms - 2;
  for (std::size_t k = 1; k < count; ++k) energy[k] = power[k - 1] / static_cast<double>(k);

  const std::span<const double> gained(energy.data(), count);
  const double to_beat = minimum_J_ - energy_J_;
  const double least = polynomial::least(gained, share, to_beat);
  if (least < to_beat) minimum_J_ = energy_J_ + least;
  const double gain = polynomial::value(gained, share) + energy_rest_J_;
  const double sum = energy_J_ + gain;
  energy_rest_J_ = gain - (sum - energy_J_);
  energy_J_ = sum;
}

void JointMotion::move(double step_s, double share) noexcept {
  for (int i = 0; i < dof_; ++i) {
    if (stays(i)) continue;
    double displacement = 0;
    double velocity = 0;
    for (int k = terms_ - 1; k > 0; --k) {
      const double c = displacement_[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)];
      displacement = displacement * share + c;
      velocity = velocity * share + k * c;
    }
    position_[i] += displacement * share;
    velocity_[i] = velocity / step_s;
  }
}

void JointMotion::meet(const Event& event, bool freeze) noexcept {
  if (event.joint < 0) return;
  velocity_[event.joint] = 0;
  contact_[static_cast<std::size_t>(event.joint)] = freeze ? Contact::frozen : event.next;
  frozen_joints_ += freeze;
  reduced_ = false;
}

}  // namespace forcebound::device
