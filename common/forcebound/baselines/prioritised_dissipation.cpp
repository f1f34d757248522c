#include <algorithm>
#include <cmath>
#include <memory>

#include "forcebound/baselines/damper_parameters.hpp"
#include "forcebound/baselines/later_laws.hpp"
#include "forcebound/control/energy_sum.hpp"
#include "forcebound/control/held_force.hpp"

namespace forcebound::baselines {
namespace {

using control::Vector;

/// In which direction energy is dissipated first.
enum class First : std::uint8_t { along_force, across_force };

struct PriorityChoice {
  First first = First::along_force;
  double damping_most = 1;  ///< the most that may be added, as a multiple of the device's own
  double velocity_floor_m_per_s = 0;
};

/// The time-domain passivity approach in several axes, with an order of the directions that dissipate: what the first
/// cannot take is left to the second.
///
/// Vectors have `dof` rows in the device frame: position [m], force on the device f [N]; F = -f as published, d the
/// displacement of the last interval [m], v = d/T, b the device's damping, u = F_e/|F_e|, without a request along v.
///
///     W_n = W_{n-1} + F_{n-1}'d_n                          [Ryu, Kim, Hannaford 2004; exact for a held force]
///     X = -(W_n + F_e'v T) > 0 is to be dissipated in a step like the last one
///     F = F_e + g u + alpha (b v - u (u'v)/m),  m = u'b^-1 u                [along the force, and across it]
///     along:  |g| = min(X/|u'd|, alpha_max |u'v|/m),  takes |g u'd|
///     across: alpha = min(X/D, alpha_max),  takes alpha D,  D = T (v'b v - (u'v)^2/m)
///
/// X of the second is what the first left. Along the force first: where the environment gives energy, what dissipates
/// takes load off the motors [least load first, the rest in the orthogonal hyperplane: Celli et al. 2026]. Across it
/// first: in the null space of the force that is shown [Ott, Artigas, Preusche 2011].
///
/// How sure: the observer is as published. The order and what its two directions are for are from the abstract of
/// Celli et al., the null space from what is said of Ott et al.; the formulas of neither were at hand, so the split and
/// its limits are ours. A device's facts have no
/// limits of single motors, so its damping is the metric: with alpha_max for both, the two parts are one damper of
/// alpha_max b. On one axis this is `tdpa`. Below the velocity floor nothing is damped, and what was returned stays in
/// W. One observer serves all axes, rotations too. An interval without usable readings is charged the most energy that
/// the force can have returned beyond the device's damping.
///
/// Passivity is not guaranteed, as with `tdpa`: it acts a tick late, is limited, and does not act at standstill.
///
/// Real time: noexcept, no allocation, O(dof^2).
class PrioritisedDissipation final : public control::PassivityLaw {
 public:
  /// @throws std::invalid_argument unless degrees of freedom are 1 to 6 and period [s] > 0.
  PrioritisedDissipation(const control::DeviceFacts& facts, const PriorityChoice& choice)
      : held_(facts.degrees_of_freedom(), facts.period_s),
        choice_(choice),
        step_(Vector::Zero(facts.degrees_of_freedom())) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "tdpa-priority"; }

  void credit(const control::Motion& motion) noexcept override {
    const bool seen = control::is_measurable(motion.interval_s) && motion.held_s >= motion.interval_s;
    if (!seen) lose_for(std::min(motion.interval_s, motion.held_s));
    const auto d = held_.displacement(motion);
    step_.setZero();
    if (d && d->allFinite()) step_ = *d;
    const double taken_J = -held_.force().dot(step_);
    if (std::isfinite(taken_J)) taken_.add(taken_J);
    held_.begin(motion);
  }

  void lose(const control::Motion& motion) noexcept override { lose_for(motion.interval_s); }

  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override {
    Vector force = request_N;
    double excess_J = request_N.dot(step_) - taken_.value_J();
    for (const First direction : {choice_.first, second()}) {
      if (!(excess_J > 0) || !(step_.stableNorm() > floor_m())) break;
      const Damper damper = direction == First::along_force ? along(request_N, excess_J) : across(request_N, excess_J);
      force -= damper.force_N;
      excess_J -= damper.taken_J;
    }
    return force;
  }

  void commit(const Vector& force_N) noexcept override { held_.hold(force_N); }

  /// W_n [J]: energy that the environment took in and did not return.
  [[nodiscard]] double energy_J() const noexcept override { return taken_.value_J(); }

 private:
  struct Damper {
    Vector force_N;      ///< to be taken from the force
    double taken_J = 0;  ///< in a step like the last one
  };

  [[nodiscard]] First second() const noexcept {
    return choice_.first == First::along_force ? First::across_force : First::along_force;
  }
  [[nodiscard]] double floor_m() const noexcept { return choice_.velocity_floor_m_per_s * held_.period_s(); }

  void lose_for(double interval_s) noexcept {
    taken_.add(-held_.worst_case_J(interval_s));
    held_.lose();
    step_.setZero();
  }

  /// u
  [[nodiscard]] Vector direction_of(const Vector& request_N) const noexcept {
    Vector direction = request_N.isZero(0) ? step_ : request_N;
    direction.stableNormalize();
    return direction;
  }

  [[nodiscard]] Damper along(const Vector& request_N, double excess_J) const noexcept {
    const Vector u = direction_of(request_N);
    const double along_m = u.dot(step_);
    const double way_m = std::abs(along_m);
    if (!(way_m > floor_m())) return {.force_N = Vector::Zero(u.rows())};
    const double most_N = choice_.damping_most * way_m / held_.period_s() / held_.damping().mobility(u);
    const double force_N = std::min(excess_J / way_m, most_N);
    return {.force_N = std::copysign(force_N, along_m) * u, .taken_J = force_N * way_m};
  }

  [[nodiscard]] Damper across(const Vector& request_N, double excess_J) const noexcept {
    const Vector u = direction_of(request_N);
    const double along_m = u.dot(step_);
    const double along_N = along_m / held_.period_s() / held_.damping().mobility(u);
    const double whole_J = held_.dissipation_J(step_);
    const double across_J = whole_J - along_N * along_m;
    constexpr double kRounding = 1e-12;  // all of the motion is along the force
    if (!(across_J > kRounding * whole_J)) return {.force_N = Vector::Zero(u.rows())};
    const double alpha = std::min(choice_.damping_most, excess_J / across_J);
    return {.force_N = alpha * (held_.damping().matrix() * step_ / held_.period_s() - along_N * u),
            .taken_J = alpha * across_J};
  }

  control::HeldForce held_;
  PriorityChoice choice_;
  Vector step_;  // d; zero: none seen
  control::EnergySum taken_;
};

}  // namespace

control::LawDescription prioritised_dissipation() {
  return {.name = "tdpa-priority",
          .summary = "time-domain passivity in several axes: dissipates in one direction first, the rest across it",
          .reference = "Celli et al. 2026; Ott, Artigas, Preusche 2011",
          .certainty = control::LawCertainty::reconstruction,
          .parameters = {{.name = "first",
                          .purpose = "what dissipates first: 0: along the force (Celli), 1: across it (Ott)",
                          .choices = {0, 1},
                          .standard = [](const control::DeviceFacts&) { return 0.0; }},
                         most_added_damping(),
                         velocity_floor()},
          .make = [](const control::DeviceFacts& facts, const control::LawOptions& options) {
            const control::LawParameters& chosen = options.parameters;
            return std::make_unique<PrioritisedDissipation>(
                facts, PriorityChoice{.first = chosen.at("first") > 0 ? First::across_force : First::along_force,
                                      .damping_most = chosen.at("alpha_max_per_b"),
                                      .velocity_floor_m_per_s = chosen.at("velocity_floor_m_per_s")});
          }};
}

}  // namespace forcebound::baselines
