#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "forcebound/baselines/device_limits.hpp"
#include "forcebound/baselines/two_port.hpp"
#include "forcebound/control/energy_sum.hpp"
#include "forcebound/control/law_description.hpp"

/// The device's end of the laws that observe and control passivity at both ends of the network.
namespace forcebound::baselines {

/// Time-domain passivity with delay, at the device: an observer and a controller at each end of the network [Ryu &
/// Preusche 2007; Ryu, Artigas & Preusche 2010]. No end may return more energy than the other end took in.
///
/// Task space, device frame; f_e the force received [N], f the force applied, d the displacement over the interval that
/// ended [m], v = d/h, T the nominal period. Our f is the paper's -F.
///
///     P = -f_e'd > 0:  E_in += P,  else  E_out -= P          exact for a force that is held
///     E_pc += (f_e - f)'d                                    the controller's dissipation, exact too
///     W = E_out + max(0, f_e'v T) - E_in(server) - E_pc      > 0: too much, if the velocity stays as it is
///     f = f_e - alpha b v,  alpha = min(W / (T v'b v), alpha_max)
///
/// E_in travels as the sum since the beginning, of which the largest received counts. What is ours: the controller
/// damps along b v with the device's damping b as the metric, so that axes and units do not mix and one number,
/// alpha_max, serves every device (alpha_max = 1 adds as much as the device has, more than which a sampled damper
/// cannot dissipate). Below the velocity floor it cannot act; the energy not dissipated stays in W.
///
/// Passivity is not guaranteed: alpha_max, the floor and the hold all leak, and an active environment's energy is
/// counted as taken in.
/// Real time: noexcept, no allocation, O(dof^2).
class TwoPortPassivity final : public control::PassivityLaw {
 public:
  /// @param name of the law, for its server-side law too; outlives this
  /// @param chosen with those of `two_port_damper`
  /// @param told what else its server-side law needs to know: travels after E_in
  TwoPortPassivity(std::string_view name, const control::DeviceFacts& facts, const control::LawParameters& chosen,
                   const control::ServerLawNumbers& told = {})
      : name_(name),
        held_(facts.degrees_of_freedom(), facts.period_s),
        alpha_max_(chosen.at("alpha_max_per_b")),
        velocity_floor_m_per_s_(chosen.at("velocity_floor_m_per_s")),
        told_(told),
        asked_(Vector::Zero(facts.degrees_of_freedom())),
        velocity_(asked_) {
    from_server_.begin_at_zero();
  }

  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] std::string_view server_law() const noexcept override { return name_; }

  void credit(const control::Motion& motion) noexcept override {
    const EndedInterval ended = next_interval(held_, motion);
    velocity_ = ended.velocity;
    allowance_.add(-ended.unseen_J);
    // The force received and the force applied differ by the controller's.
    const double given_J = ended.interval_s > 0 ? asked_.dot(ended.displacement) : 0.0;
    const double applied_J = ended.force.dot(ended.displacement);
    if (!std::isfinite(given_J) || !std::isfinite(applied_J)) return;
    if (given_J < 0) in_.add(-given_J);
    allowance_.add(-std::max(given_J, 0.0));
    allowance_.add(given_J - applied_J);
  }

  void lose(const control::Motion& motion) noexcept override {
    allowance_.add(-held_.worst_case_J(motion.interval_s));
    held_.lose();
    velocity_.setZero();
    asked_.setZero();
  }

  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override {
    asked_ = request_N;
    const double coming_J = std::max(0.0, request_N.dot(velocity_) * held_.period_s());
    const double excess_J = coming_J - allowance_.value_J();
    if (!(excess_J > 0) || !(velocity_.stableNorm() > velocity_floor_m_per_s_)) return request_N;
    const double damped_J = held_.damping().dissipation(velocity_) * held_.period_s();
    const double alpha = std::min(excess_J / damped_J, alpha_max_);
    return request_N - alpha * (held_.damping().matrix() * velocity_);
  }

  void commit(const Vector& force_N) noexcept override { held_.hold(force_N); }

  /// E_in(server) + E_pc - E_out [J].
  [[nodiscard]] double energy_J() const noexcept override { return allowance_.value_J(); }

  [[nodiscard]] control::ServerLawNumbers outgoing() const noexcept override {
    control::ServerLawNumbers numbers(1 + told_.rows());
    numbers << in_.value_J(), told_;
    return numbers;
  }
  void incoming(const control::ServerLawNumbers& numbers) noexcept override {
    allowance_.add(from_server_.receive(number_at(numbers, 0)));
  }
  void begin_server_side() noexcept override { from_server_.begin_at_zero(); }

 private:
  std::string_view name_;
  control::HeldForce held_;
  double alpha_max_;
  double velocity_floor_m_per_s_;
  control::ServerLawNumbers told_;
  Vector asked_;     // f_e of the present interval
  Vector velocity_;  // zero: unknown
  control::EnergySum in_;
  control::EnergySum allowance_;
  RemoteSum from_server_;
};

/// Its parameters.
[[nodiscard]] inline std::vector<control::LawParameter> two_port_damper() {
  return {
      {.name = "alpha_max_per_b",
       .purpose = "most damping that may be added, in multiples of the device's own",
       .most = 100,
       .standard = [](const control::DeviceFacts&) { return 1.0; }},
      {.name = "velocity_floor_m_per_s",
       .purpose = "slower motion is not damped",
       .standard = [](const control::DeviceFacts& facts) { return std::max(1e-6, slowest_reading_m_per_s(facts)); }}};
}

}  // namespace forcebound::baselines
