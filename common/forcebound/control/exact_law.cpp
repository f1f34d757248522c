#include "forcebound/control/exact_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

#include "forcebound/control/assertion.hpp"
#include "forcebound/control/damping.hpp"

namespace forcebound::control {
namespace {

// A clock that says that next to no time has passed would credit any motion with any energy.
constexpr double kIntervalLeastPeriods = 0.1;
constexpr double kLatencyMaxPeriods = 8;
// What rounding may do to a reading, in parts of itself and of the encoder's step.
constexpr double kRounding = 1e-15;
constexpr double kStepRounding = 1e-9;

template <typename Value>
[[noreturn]] void refuse(const DeviceFacts& facts, const char* what, const Value& got) {
  std::ostringstream text;
  text << "device '" << facts.name << "': " << what << ", got " << got;
  throw std::invalid_argument(text.str());
}

void check(const DeviceFacts& facts) {
  (void)Damping::from_matrix(facts.damping);
  const auto per_joint = [&](const Vector& v) {
    return v.rows() == facts.damping.rows() && v.allFinite() && (v.array() >= 0).all();
  };
  const auto above_zero = [](double v) { return v > 0 && std::isfinite(v); };
  if (!above_zero(facts.period_s)) refuse(facts, "period must be > 0 s", facts.period_s);
  if (!above_zero(facts.hold_s_max)) refuse(facts, "hold time must be > 0 s", facts.hold_s_max);
  if (!(facts.latency_s >= 0) || facts.latency_s > kLatencyMaxPeriods * facts.period_s) {
    refuse(facts, "latency must be 0 to 8 periods [s]", facts.latency_s);
  }
  if (!(facts.force_N_max >= 0)) refuse(facts, "largest force must be >= 0 N", facts.force_N_max);
  if (!per_joint(facts.friction)) refuse(facts, "friction must be >= 0 for each joint", facts.friction.transpose());
  if (!per_joint(facts.encoder_step)) {
    refuse(facts, "encoder step must be >= 0 for each joint", facts.encoder_step.transpose());
  }
}

template <std::size_t... Joint>
std::array<LeastEnergy, kDofMax> make_joints(const Vector& damping, const Vector& friction,
                                             std::index_sequence<Joint...> /*joints*/) {
  const auto joint = [&](std::size_t i) {
    const auto row = static_cast<Eigen::Index>(i);
    return row < damping.rows() ? LeastEnergy(damping[row], friction[row]) : LeastEnergy(1, 0);
  };
  return {joint(Joint)...};
}

}  // namespace

ExactLaw::ExactLaw(const DeviceFacts& facts, EnergyMemory memory)
    : dof_((check(facts), facts.damping.rows())),
      joints_(make_joints(diagonal_below(facts.damping), facts.friction, std::make_index_sequence<kDofMax>())),
      encoder_step_(facts.encoder_step),
      period_s_(facts.period_s),
      hold_s_(facts.hold_s_max),
      release_s_(facts.releases ? facts.hold_s_max : std::numeric_limits<double>::infinity()),
      force_N_max_(facts.force_N_max),
      memory_(memory),
      jacobian_(Matrix::Identity(dof_, dof_)),
      held_(dof_),
      committed_(Vector::Zero(dof_)) {}

void ExactLaw::credit(const Motion& motion) noexcept {
  FORCEBOUND_ASSERT(motion.joint.rows() == dof_, "a reading has a row for each joint");
  note_times(motion);
  for (Eigen::Index i = 0; i < dof_; ++i) {
    LeastEnergy& joint = joints_[static_cast<std::size_t>(i)];
    const LeastEnergy::Tube read = tube(i, motion.joint[i]);
    const auto gain_J = located_ ? joint.read(read) : std::nullopt;
    // What no finite motion explains was charged its worst case already: holding a force takes it from the minimum.
    if (!gain_J) joint.restart(read);
    energy_.add(gain_J.value_or(0));
  }
  located_ = true;
  jacobian_ = motion.jacobian;
  if (memory_ == EnergyMemory::capped) forget_excess();
}

void ExactLaw::lose(const Motion& motion) noexcept { note_times(motion); }

/// Lets the time since the previous reading pass over V and over the forces in effect.
void ExactLaw::note_times(const Motion& motion) noexcept {
  latency_s_max_ = std::max(0.0, motion.latency_s_max);
  held_.command(committed_, std::max(0.0, motion.latency_s), std::min(release_s_, motion.held_s));
  committed_.setZero();
  if (is_measurable(motion.interval_s)) {
    let_act(motion.interval_s, std::max(1.0, kIntervalLeastPeriods * period_s_ / motion.interval_s));
    held_.pass(motion.interval_s);
  } else if (located_) {
    let_act(std::max(hold_s_, held_.horizon_s()), 1);
    located_ = false;
  }
}

void ExactLaw::let_act(double duration_s, double stretch) noexcept {
  held_.each_piece(duration_s, [&](const Vector& torque, double piece_s) {
    for (Eigen::Index i = 0; i < dof_; ++i) {
      energy_.add(joints_[static_cast<std::size_t>(i)].hold(torque[i], piece_s * stretch));
    }
  });
}

void ExactLaw::forget_excess() noexcept {
  constexpr double kRoom = 1 + 1e-12;  // rounding shall not bound the largest force
  const double most_J = kRoom * needed_J(force_N_max_ * jacobian_.colwise().norm().transpose());
  const double excess_J = energy_J() - most_J;
  if (excess_J > 0) energy_.add(-excess_J);
}

/// The encoder's true position lies within half a step of its reading.
LeastEnergy::Tube ExactLaw::tube(Eigen::Index joint, double reading) const noexcept {
  const double step = encoder_step_[joint];
  if (step == 0) return {reading, reading};
  const double half = 0.5 * step * (1 + kStepRounding) + kRounding * std::abs(reading);
  return {reading - half, reading + half};
}

/// What may be spent if the next force takes effect `latency_s` after the reading: until then others are in effect.
double ExactLaw::energy_at(double latency_s) const noexcept {
  double taken_J = 0;
  held_.each_piece(std::max(latency_s, held_.horizon_s()), [&](const Vector& torque, double piece_s) {
    for (Eigen::Index i = 0; i < dof_; ++i) {
      taken_J += joints_[static_cast<std::size_t>(i)].reserve_J(torque[i], piece_s);
    }
  });
  return energy_.value_J() - taken_J;
}

double ExactLaw::needed_J(const Vector& torque) const noexcept {
  double needed_J = 0;
  for (Eigen::Index i = 0; i < dof_; ++i)
    needed_J += joints_[static_cast<std::size_t>(i)].reserve_J(torque[i], hold_s_);
  return needed_J;
}

Vector ExactLaw::bound(const Vector& request_N) noexcept {
  const double largest = request_N.lpNorm<Eigen::Infinity>();
  if (!(largest > 0) || !located_) return Vector::Zero(dof_);
  // Through its largest component, so that neither 1e300 N nor 1e-300 N leaves the range of a double when squared.
  const Vector direction = request_N / largest;
  const double largest_allowed = largest_scale(jacobian_.transpose() * direction, std::max(energy_J(), 0.0));
  return largest <= largest_allowed ? request_N : Vector(direction * largest_allowed);
}

/// The largest s with sum_i max(s |t_i| - c_i, 0)^2 T_hold/(4 b_i) <= energy: a parabola for each joint, from where its
/// friction is overcome on.
double ExactLaw::largest_scale(const Vector& torque, double energy_J) const noexcept {
  struct Parabola {
    double begin = std::numeric_limits<double>::infinity();
    double weight = 0;
  };
  std::array<Parabola, kDofMax> parabolas;  // sorted by where they begin
  auto end = parabolas.begin();
  for (Eigen::Index i = 0; i < dof_; ++i) {
    const LeastEnergy& joint = joints_[static_cast<std::size_t>(i)];
    const double size = std::abs(torque[i]);
    if (!(size > 0)) continue;
    const Parabola parabola{joint.friction() / size, size * size * hold_s_ / (4 * joint.damping())};
    auto place = end++;
    for (; place != parabolas.begin() && parabola.begin < (place - 1)->begin; --place) *place = *(place - 1);
    *place = parabola;
  }
  for (auto newest = parabolas.begin(); newest != end; ++newest) {
    // With t = s - newest->begin:  a t^2 + 2 b t = room
    double a = 0;
    double b = 0;
    double room = energy_J;
    for (auto p = parabolas.begin(); p <= newest; ++p) {
      const double ahead = newest->begin - p->begin;
      a += p->weight;
      b += p->weight * ahead;
      room -= p->weight * ahead * ahead;
    }
    // Roots before the product: a * room underflows where little is left, and nothing would then bound the force.
    const double root = std::hypot(b, std::sqrt(a) * std::sqrt(std::max(room, 0.0)));
    const double scale = newest->begin + (room > 0 ? room / (b + root) : 0.0);
    if (newest + 1 == end || scale <= (newest + 1)->begin) return scale;
  }
  return std::numeric_limits<double>::infinity();
}

bool ExactLaw::allows(const Vector& force_N, double latency_s) const noexcept {
  constexpr double kForceRounding = 1e-12;
  if (force_N.isZero(0)) return true;
  if (!located_) return false;
  const Vector torque = jacobian_.transpose() * force_N * (1 - kForceRounding);
  return needed_J(torque) <= std::max(energy_at(latency_s), 0.0);
}

void ExactLaw::commit(const Vector& force_N) noexcept { committed_ = jacobian_.transpose() * force_N; }

int ExactLaw::knots() const noexcept {
  int most = 0;
  for (Eigen::Index i = 0; i < dof_; ++i) most = std::max(most, joints_[static_cast<std::size_t>(i)].knots());
  return most;
}

}  // namespace forcebound::control
