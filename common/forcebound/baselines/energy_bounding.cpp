#include <algorithm>
#include <cmath>
#include <memory>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/baselines/device_limits.hpp"
#include "forcebound/control/ledger.hpp"

namespace forcebound::baselines {
namespace {

/// The bounds of EnergyBoundingLaw, as shares of b/T.
struct Bounds {
  double c1 = 1;
  double c2 = 4;
};

/// The energy bounding algorithm: the force goes towards the request with a stiffness of c1 at most.
///
/// Vectors have `dof` rows in the device frame: position [m], force on the device f [N]; F = -f as published, damping
/// b [N s/m]. Per axis, with d the displacement of the last interval [m]:
///
///     F_n = F_{n-1} + beta d,   beta = (F_e - F_{n-1}) / d              held where d = 0
///     beta <= c1 <= b/T                                                 [Kim & Ryu 2010]
///     beta in c2 - F_{n-1}/d -+ sqrt(c2^2 + (F_{n-1}/d)^2)              that is F_n d >= (F_n^2 - F_{n-1}^2) / 2 c2
///
/// and then projected on the direction of the request [Kim 2010]. Built from published descriptions; these details are
/// ours:
///  - Where both bounds cannot hold, c1 does: energy that the damping does not dissipate may not be returned.
///  - c2 is 4 b/T unless chosen. From about 2 b/T on, c1 limits everything but the last step out of a wall: the force
///    falls along the line on which it rose, and a stiff static wall shows the stiffness c1, but for the distance that
///    the step into the wall travelled in free space. Below c1, c2 is the stiffness shown.
///  - With several axes, c1 and c2 are shares of an axis' own b/T, b being `diagonal_below` the device's damping. The
///    projection is the one that lowers sum F_i^2/b_i: the orthogonal one where axes are alike. A request of zero has
///    no direction and projects nothing; as published, it does not end a force while the device stands still.
///  - Where the damping has become less since the last reading, the force is shortened to the same sum F_i^2/b_i.
///
/// Passive where readings are exact, ticks punctual and forces immediate: then sum F_i^2 / 2 c_i never exceeds what the
/// device has dissipated and taken, c_i being the smaller of c1 and c2, and half of that sum would suffice. The law's
/// only memory is its last force. It cannot know that a wall softer than b/T has stored more than that, and releases
/// such a wall along a lower force than it pressed with. An interval without usable readings ends the force; energy
/// that more than two periods of it returned is not repaid.
///
/// Real time: noexcept, no allocation; O(dof), and O(dof^3) where the damping couples axes.
class EnergyBoundingLaw final : public control::PassivityLaw {
 public:
  /// @throws std::invalid_argument unless degrees of freedom are 1 to 6 and period [s] > 0.
  EnergyBoundingLaw(const control::DeviceFacts& facts, const Bounds& bounds)
      : ledger_(facts.degrees_of_freedom(), facts.period_s),
        bounds_(bounds),
        period_s_(facts.period_s),
        force_N_max_(facts.force_N_max),
        step_(Vector::Zero(facts.degrees_of_freedom())),
        damping_(Vector::Ones(facts.degrees_of_freedom())),
        damping_before_(damping_) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "eba"; }

  void credit(const control::Motion& motion) noexcept override {
    const auto d = ledger_.held().displacement(motion);
    const bool seen = control::is_measurable(motion.interval_s) && motion.held_s >= motion.interval_s;
    step_.setZero();
    if (seen && d && d->allFinite()) step_ = *d;
    ledger_.credit(motion);
    damping_before_ = damping_;
    damping_ = control::diagonal_below(motion.damping->matrix());
  }

  void lose(const control::Motion& motion) noexcept override { ledger_.lose(motion.interval_s); }

  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override {
    Vector reaction = -ledger_.held().force();
    for (Eigen::Index i = 0; i < reaction.rows(); ++i) {
      reaction[i] = followed(-request_N[i], reaction[i], step_[i], damping_before_[i] / period_s_);
    }
    reserve_ = weighted(reaction, damping_before_);
    const Vector force = shortened(projected(-reaction, request_N));
    reserve_ = std::min(reserve_, weighted(force, damping_));
    return force;
  }

  [[nodiscard]] bool allows(const Vector& force_N, double /*latency_s*/) const noexcept override {
    constexpr double kRounding = 1e-12;
    return weighted(force_N, damping_) <= reserve_ * (1 + kRounding);
  }

  void commit(const Vector& force_N) noexcept override { ledger_.hold(force_N); }

  /// The balance of LessConservativeLaw; this law does not use it.
  [[nodiscard]] double energy_J() const noexcept override { return ledger_.energy_J(); }

 private:
  /// F_n of one axis. The bounds on beta are bounds on F_n, without a division by d:
  /// F_n <= F + c1 d and c2 d - h <= F_n <= c2 d + h, h^2 = (c2 d)^2 + F^2, for d > 0; mirrored for d < 0.
  [[nodiscard]] double followed(double wanted, double before, double d, double damping_N_per_m) const noexcept {
    if (d == 0) return before;
    const double sign = d > 0 ? 1 : -1;
    const double step_N = bounds_.c2 * damping_N_per_m * std::abs(d);
    const double long_side_N = step_N + std::hypot(step_N, before);
    const double most = std::min(sign * before + bounds_.c1 * damping_N_per_m * std::abs(d), long_side_N);
    // step_N - hypot(step_N, before), without the difference of two nearly equal numbers
    const double least = std::min(long_side_N > 0 ? -before * (before / long_side_N) : 0.0, most);
    return sign * std::clamp(sign * wanted, least, most);
  }

  /// The root of sum f_i^2/b_i; its square never exceeds what the device's dissipated and absorbed energy allows.
  [[nodiscard]] static double weighted(const Vector& force_N, const Vector& damping) noexcept {
    return force_N.cwiseQuotient(damping.cwiseSqrt()).stableNorm();
  }

  [[nodiscard]] Vector projected(const Vector& force_N, const Vector& request_N) const noexcept {
    const double largest = request_N.lpNorm<Eigen::Infinity>();
    if (!(largest > 0)) return force_N;
    const Vector direction = request_N / largest;
    const Vector weighted_direction = direction.cwiseQuotient(damping_);
    return direction * (weighted_direction.dot(force_N) / weighted_direction.dot(direction));
  }

  /// To what the present damping allows, and to the device's largest force.
  [[nodiscard]] Vector shortened(const Vector& force_N) const noexcept {
    const double needed = weighted(force_N, damping_);
    const double length = force_N.stableNorm();
    if (!std::isfinite(needed) || !std::isfinite(length)) return Vector::Zero(force_N.rows());
    double share = needed > reserve_ ? reserve_ / needed : 1.0;
    if (share * length > force_N_max_) share = force_N_max_ / length;
    return share * force_N;
  }

  control::Ledger ledger_;
  Bounds bounds_;
  double period_s_;
  double force_N_max_;
  Vector step_;            // d; zero: none seen
  Vector damping_;         // of each axis [N s/m], for the interval that begins
  Vector damping_before_;  // for the one that ended
  double reserve_ = 0;     // largest `weighted` of the present force
};

}  // namespace

control::LawDescription energy_bounding() {
  return {
      .name = "eba",
      .summary = "energy bounding algorithm: follows the request with a stiffness of b/T at most",
      .reference = "Kim & Ryu 2004, 2010",
      .certainty = control::LawCertainty::likely,
      .claim = control::LawClaim::passive_if_ideal,
      .parameters = {{.name = "c1_T_per_b",
                      .purpose = "stiffness with which a force may rise, as a share of b/T",
                      .least = 1e-3,
                      .most = 1,
                      .standard = [](const control::DeviceFacts&) { return 1.0; }},
                     {.name = "c2_T_per_b",
                      .purpose = "stiffness c2 of the spring whose stored energy bounds the release, as a share of b/T",
                      .least = 1e-3,
                      .most = 1e3,
                      .standard = [](const control::DeviceFacts&) { return 4.0; }}},
      .make = [](const control::DeviceFacts& facts, const control::LawOptions& options) {
        require_translations("eba", facts);
        return std::make_unique<EnergyBoundingLaw>(
            facts, Bounds{.c1 = options.parameters.at("c1_T_per_b"), .c2 = options.parameters.at("c2_T_per_b")});
      }};
}

}  // namespace forcebound::baselines
