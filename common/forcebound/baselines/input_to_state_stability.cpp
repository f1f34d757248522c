#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "forcebound/baselines/damper_parameters.hpp"
#include "forcebound/baselines/device_limits.hpp"
#include "forcebound/baselines/later_laws.hpp"
#include "forcebound/control/energy_sum.hpp"
#include "forcebound/control/held_force.hpp"

namespace forcebound::baselines {
namespace {

using control::Vector;

enum class IssVariant : std::uint8_t {
  transformed,  ///< 2015: force and place are the transformed ones
  observed,     ///< 2016: an observer of the transformed ones, and damping
};

struct IssChoice {
  IssVariant variant = IssVariant::transformed;
  double tau_s = 0;
  double mu_N_per_m = 1;
  double damping_most = 1;  ///< the most that may be added, as a multiple of the device's own
};

/// The input-to-state stable approach: a spring behind a hold is a hysteresis of slope 0 to mu. The loop with it is
/// stable where the hysteresis takes in, in place of F'v, the product of two other quantities [multiplier 1 + tau s and
/// loop transformation 1/mu of Pare, Hassibi, How 2001; haptics: Jafari, Nabeel, Ryu 2015]. A limited amount of energy
/// may then be returned, so that less is damped than for passivity.
///
/// Vectors have `dof` rows in the device frame: position x [m], what the environment asks for f_e [N], F_e = -f_e as
/// published, d the displacement of the last interval [m], Delta the change since the tick before, T the period, b the
/// device's damping.
///
///     2015:  F = F_e + tau Delta F_e/T,  the environment is asked at x - F_e/mu
///     2016:  S_n = S_{n-1} + (F_{n-1} + tau Delta F_e/T)'(d - Delta F_e/mu)
///            S_n < 0:  F = F_e + alpha b v,  alpha = min(-S_n/(T v'b v), alpha_max)
///
/// An undelayed spring K < mu has S >= 0 from tau = T/2 on. The rest of the loop, a device of mass m, is positive real
/// with the inverse multiplier up to mu tau = 4 b, if m is large: K of 8 b/T where passivity allows 2 b/T. A delay t
/// each way needs tau >= T/2 + 2 t at least.
///
/// How sure: the two transformed quantities are those of two public programs, one of which cites the paper of 2015;
/// they apply them as they stand (`2015`), and our x - F_e/mu is their velocity, summed. That the publication of 2016
/// has an observer is known from its title; the equations of the publications were not at hand.
/// Ours: the damper of `2016`; its F_{n-1}, the force that was applied, so that what it dissipates counts; tau = T/2
/// and mu = 8 b/T, where those programs have 5 ms and a third of the device's largest stiffness or more; F_e/mu is at
/// most the device's largest force over mu. A tick after a lost reading has Delta F_e = 0; S is charged the most that
/// the force can have returned beyond the device's damping.
///
/// Passivity is not guaranteed, nor meant. An environment stiffer than mu breaks `2015`, whose place then rings, and
/// so does a tau that makes tau K more damping than the hold allows. `2016` lets a spring alone that rings with a hand.
///
/// Real time: noexcept, no allocation, O(dof^2).
class InputToStateStability final : public control::PassivityLaw {
 public:
  /// @throws std::invalid_argument unless degrees of freedom are 1 to 6 and period [s] > 0.
  InputToStateStability(const control::DeviceFacts& facts, const IssChoice& choice)
      : held_(facts.degrees_of_freedom(), facts.period_s),
        choice_(choice),
        force_N_max_(facts.force_N_max),
        step_(Vector::Zero(facts.degrees_of_freedom())) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "iss"; }

  void credit(const control::Motion& motion) noexcept override {
    const bool seen = control::is_measurable(motion.interval_s) && motion.held_s >= motion.interval_s;
    if (!seen) lose_for(std::min(motion.interval_s, motion.held_s));
    const auto d = held_.displacement(motion);
    step_.setZero();
    if (d && d->allFinite()) step_ = *d;
    held_.begin(motion);
  }

  void lose(const control::Motion& motion) noexcept override { lose_for(motion.interval_s); }

  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override {
    const Vector change_N = asked_N_ ? Vector(request_N - *asked_N_) : Vector(Vector::Zero(request_N.rows()));
    const Vector steep_N = choice_.tau_s / held_.period_s() * change_N;
    observe(steep_N, change_N);
    asked_N_ = request_N;
    const Vector force = choice_.variant == IssVariant::transformed ? Vector(request_N + steep_N) : damped(request_N);
    return force.allFinite() ? force : request_N;
  }

  void commit(const Vector& force_N) noexcept override { held_.hold(force_N); }

  /// S_n [J].
  [[nodiscard]] double energy_J() const noexcept override { return observed_.value_J(); }

  [[nodiscard]] Vector proxy_position(const Vector& position) const noexcept override {
    if (choice_.variant != IssVariant::transformed || !asked_N_) return position;
    const double length_N = asked_N_->stableNorm();
    const double share = length_N > force_N_max_ ? force_N_max_ / length_N : 1.0;
    return position + share / choice_.mu_N_per_m * *asked_N_;
  }

 private:
  void lose_for(double interval_s) noexcept {
    observed_.add(-held_.worst_case_J(interval_s));
    held_.lose();
    step_.setZero();
    asked_N_.reset();
  }

  /// Signs: held and asked forces are on the device, -F.
  void observe(const Vector& steep_N, const Vector& change_N) noexcept {
    const double taken_J = -(held_.force() + steep_N).dot(step_ + change_N / choice_.mu_N_per_m);
    if (std::isfinite(taken_J)) observed_.add(taken_J);
  }

  [[nodiscard]] Vector damped(const Vector& request_N) const noexcept {
    const double missing_J = -observed_.value_J();
    const double damper_J = held_.known() ? held_.dissipation_J(step_) : 0.0;
    if (!(missing_J > 0) || !(damper_J > 0)) return request_N;
    const double alpha = std::min(choice_.damping_most, missing_J / damper_J);
    return request_N - alpha / held_.period_s() * (held_.damping().matrix() * step_);
  }

  control::HeldForce held_;
  IssChoice choice_;
  double force_N_max_;
  Vector step_;                    // d; zero: none seen
  std::optional<Vector> asked_N_;  // f_e of the tick before
  control::EnergySum observed_;    // S
};

}  // namespace

control::LawDescription input_to_state_stability() {
  return {.name = "iss",
          .summary = "input-to-state stable approach: damps less than passivity asks for",
          .reference = "Jafari, Nabeel, Ryu 2015; Jafari, Nabeel, Singh, Ryu 2016",
          .certainty = control::LawCertainty::reconstruction,
          .parameters = {{.name = "variant",
                          .purpose = "year of the publication: transformed force and place, or an observer of them",
                          .choices = {2015, 2016},
                          .standard = [](const control::DeviceFacts&) { return 2015.0; }},
                         {.name = "tau_s",
                          .purpose = "time constant of the multiplier, half a period and more",
                          .most = 1,
                          .standard = [](const control::DeviceFacts& facts) { return facts.period_s / 2; }},
                         {.name = "mu_N_per_m",
                          .purpose = "the stiffest environment; standard 8 b/T",
                          .least = 1,
                          .most = 1e9,
                          .standard =
                              [](const control::DeviceFacts& facts) {
                                return std::clamp(8 * least_damping(facts) / facts.period_s, 1.0, 1e9);
                              }},
                         most_added_damping()},
          .make = [](const control::DeviceFacts& facts, const control::LawOptions& options) {
            require_constant_translations("iss", facts);
            const control::LawParameters& chosen = options.parameters;
            return std::make_unique<InputToStateStability>(
                facts,
                IssChoice{.variant = chosen.at("variant") < 2016 ? IssVariant::transformed : IssVariant::observed,
                          .tau_s = chosen.at("tau_s"),
                          .mu_N_per_m = chosen.at("mu_N_per_m"),
                          .damping_most = chosen.at("alpha_max_per_b")});
          }};
}

}  // namespace forcebound::baselines
