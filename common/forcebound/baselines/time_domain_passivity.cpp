#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/baselines/damper_parameters.hpp"
#include "forcebound/control/energy_sum.hpp"
#include "forcebound/control/held_force.hpp"

namespace forcebound::baselines {
namespace {

enum class Observer : std::uint8_t {
  predicted,  ///< 2002: energy of the present force over the step before it
  exact,      ///< 2004: energy that the held force took
};

enum class Weighting : std::uint8_t {
  direction,  ///< damps along the force [Preusche 2003]
  damping,    ///< damps along b v [after Hertkorn 2010]
};

struct PassivityChoice {
  Observer observer = Observer::exact;
  Weighting weighting = Weighting::direction;
  double damping_most = 1;  ///< the most that may be added, as a multiple of the device's own
  double velocity_floor_m_per_s = 0;
};

/// Rows with one common observer, and its W.
struct Port {
  int first = 0;
  int rows = 0;
  control::EnergySum energy{};

  [[nodiscard]] auto of(const Vector& v) const noexcept { return v.segment(first, rows); }
};

/// The time-domain passivity approach, one port: an observer of the energy that the environment took in, and a damper
/// that acts when it would return more.
///
/// Vectors have `dof` rows in the device frame: position [m], force on the device f [N]; F = -f as published, d the
/// displacement of the last interval [m], v = d/T.
///
///     W_n = W_{n-1} + F_{n-1}'d_n                          [Ryu, Kim, Hannaford 2004; exact for a held force]
///     W_n = W_{n-1} + F_{n-1}'d_{n-1}                      [Hannaford & Ryu 2002; the step before the force]
///     W_n + F_e'v T < 0:  F = F_e + alpha v,  alpha = min(-(W_n + F_e'v T)/(T v'v), alpha_max)
///
/// In several degrees of freedom
///  - along the force [Preusche 2003]: F = F_e + alpha u(u'v), u = F_e/|F_e|, alpha = -(...)/(T (u'v)^2), translation
///    and rotation (rows beyond the third) each with an observer of its own. Without a request u is along v.
///  - weighted [Hertkorn 2010]: F = F_e + alpha M v, alpha = -(...)/(T v'M v), one observer. A device's facts contain
///    no mass, so M is its damping b.
///
/// What is ours: alpha_max is in multiples of the device's damping, `alpha_max / (u'b^-1 u)` along u and `alpha_max b`
/// weighted, because a sampled damper of more than b is not passive itself. Without a mass it is unknown at which force
/// the velocity reverses, so that is the only cap. Below the velocity floor nothing is damped, and the energy returned
/// stays in W; with the default, half an encoder's step per period, every visible step counts. An interval without
/// usable readings charges every observer the most energy that the force can have returned beyond the device's damping.
///
/// Passivity is not guaranteed: the damper acts a tick late, is limited, and does not act at standstill. An adversary
/// that pushes at standstill extracts as much as without any law.
///
/// Real time: noexcept, no allocation, O(dof^2).
class TimeDomainPassivity final : public control::PassivityLaw {
 public:
  /// @throws std::invalid_argument unless degrees of freedom are 1 to 6 and period [s] > 0.
  TimeDomainPassivity(const control::DeviceFacts& facts, const PassivityChoice& choice)
      : held_(facts.degrees_of_freedom(), facts.period_s),
        choice_(choice),
        step_(Vector::Zero(facts.degrees_of_freedom())) {
    constexpr int kTranslations = 3;
    const int dof = facts.degrees_of_freedom();
    const bool apart = choice.weighting == Weighting::direction && dof > kTranslations;
    ports_[0].rows = apart ? kTranslations : dof;
    ports_[1].first = ports_[0].rows;
    ports_[1].rows = dof - ports_[0].rows;
  }

  [[nodiscard]] std::string_view name() const noexcept override { return "tdpa"; }

  void credit(const control::Motion& motion) noexcept override {
    const bool seen = control::is_measurable(motion.interval_s) && motion.held_s >= motion.interval_s;
    if (!seen) lose_for(std::min(motion.interval_s, motion.held_s));
    const auto d = held_.displacement(motion);
    const Vector before = step_;
    step_.setZero();
    if (d && d->allFinite()) step_ = *d;
    observe(choice_.observer == Observer::exact ? step_ : before);
    held_.begin(motion);
  }

  void lose(const control::Motion& motion) noexcept override { lose_for(motion.interval_s); }

  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override {
    Vector force = request_N;
    for (const Port& port : ports_) {
      const double taken_J = port.energy.value_J() - port.of(request_N).dot(port.of(step_));
      if (port.rows > 0 && !(taken_J >= 0)) force -= damping_force(port, request_N, -taken_J);
    }
    return force;
  }

  void commit(const Vector& force_N) noexcept override { held_.hold(force_N); }

  /// W_n [J]: energy that the environment took in and did not return.
  [[nodiscard]] double energy_J() const noexcept override {
    control::EnergySum sum;
    for (const Port& port : ports_) sum.add(port.energy.value_J());
    return sum.value_J();
  }

 private:
  void lose_for(double interval_s) noexcept {
    for (Port& port : ports_) {
      if (port.rows > 0) port.energy.add(-held_.worst_case_J(interval_s));
    }
    held_.lose();
    step_.setZero();
  }

  void observe(const Vector& step) noexcept {
    for (Port& port : ports_) {
      const double taken_J = -port.of(held_.force()).dot(port.of(step));
      if (std::isfinite(taken_J)) port.energy.add(taken_J);
    }
  }

  /// alpha times its weight [N], to dissipate `excess_J` in a step like the last one, or as much as allowed.
  [[nodiscard]] Vector damping_force(const Port& port, const Vector& request_N, double excess_J) const noexcept {
    Vector step = Vector::Zero(step_.rows());
    step.segment(port.first, port.rows) = port.of(step_);
    const double floor_m = choice_.velocity_floor_m_per_s * held_.period_s();
    if (!(step.stableNorm() > floor_m)) return Vector::Zero(step.rows());
    if (choice_.weighting == Weighting::damping) {
      const double share = excess_J / held_.dissipation_J(step);
      return std::min(choice_.damping_most, share) / held_.period_s() * (held_.damping().matrix() * step);
    }
    Vector direction = step;
    if (!port.of(request_N).isZero(0)) {
      direction.segment(port.first, port.rows) = port.of(request_N);
    }
    direction.stableNormalize();
    const double along_m = direction.dot(step);
    if (!(std::abs(along_m) > floor_m)) return Vector::Zero(step.rows());
    const double most_N =
        choice_.damping_most * std::abs(along_m) / held_.period_s() / held_.damping().mobility(direction);
    return std::copysign(std::min(most_N, excess_J / std::abs(along_m)), along_m) * direction;
  }

  control::HeldForce held_;
  PassivityChoice choice_;
  Vector step_;  // d; zero: none seen
  std::array<Port, 2> ports_;
};

}  // namespace

control::LawDescription time_domain_passivity() {
  return {
      .name = "tdpa",
      .summary = "time-domain passivity approach: damps when the environment returned more than it took in",
      .reference = "Hannaford & Ryu 2002; Ryu, Kim, Hannaford 2004; in several axes Preusche 2003, Hertkorn 2010",
      .certainty = control::LawCertainty::published,
      .parameters = {{.name = "variant",
                      .purpose = "year of the observer: of the step before a force, or exact",
                      .choices = {2002, 2004},
                      .standard = [](const control::DeviceFacts&) { return 2004.0; }},
                     {.name = "weighting",
                      .purpose = "in several axes 0: damp along the force (Preusche; likely), 1: along the velocity, "
                                 "weighted by the device's damping (Hertkorn; likely)",
                      .choices = {0, 1},
                      .standard = [](const control::DeviceFacts&) { return 0.0; }},
                     most_added_damping(),
                     velocity_floor()},
      .make = [](const control::DeviceFacts& facts, const control::LawOptions& options) {
        const auto& chosen = options.parameters;
        return std::make_unique<TimeDomainPassivity>(
            facts, PassivityChoice{.observer = chosen.at("variant") < 2003 ? Observer::predicted : Observer::exact,
                                   .weighting = chosen.at("weighting") > 0 ? Weighting::damping : Weighting::direction,
                                   .damping_most = chosen.at("alpha_max_per_b"),
                                   .velocity_floor_m_per_s = chosen.at("velocity_floor_m_per_s")});
      }};
}

}  // namespace forcebound::baselines
