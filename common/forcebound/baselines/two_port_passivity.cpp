#include <algorithm>
#include <cmath>
#include <memory>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/baselines/device_limits.hpp"
#include "forcebound/baselines/two_port.hpp"
#include "forcebound/control/energy_sum.hpp"

namespace forcebound::baselines {
namespace {

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
  struct Gains {
    double alpha_max;
    double velocity_floor_m_per_s;
  };

  TwoPortPassivity(const control::DeviceFacts& facts, const Gains& gains)
      : held_(facts.degrees_of_freedom(), facts.period_s),
        gains_(gains),
        asked_(Vector::Zero(facts.degrees_of_freedom())),
        velocity_(asked_) {
    from_server_.begin_at_zero();
  }

  [[nodiscard]] std::string_view name() const noexcept override { return kName; }
  [[nodiscard]] std::string_view server_law() const noexcept override { return kName; }

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
    if (!(excess_J > 0) || !(velocity_.stableNorm() > gains_.velocity_floor_m_per_s)) return request_N;
    const double damped_J = held_.damping().dissipation(velocity_) * held_.period_s();
    const double alpha = std::min(excess_J / damped_J, gains_.alpha_max);
    return request_N - alpha * (held_.damping().matrix() * velocity_);
  }

  void commit(const Vector& force_N) noexcept override { held_.hold(force_N); }

  /// E_in(server) + E_pc - E_out [J].
  [[nodiscard]] double energy_J() const noexcept override { return allowance_.value_J(); }

  [[nodiscard]] control::ServerLawNumbers outgoing() const noexcept override {
    return control::ServerLawNumbers::Constant(1, in_.value_J());
  }
  void incoming(const control::ServerLawNumbers& numbers) noexcept override {
    allowance_.add(from_server_.receive(number_at(numbers, 0)));
  }
  void begin_server_side() noexcept override { from_server_.begin_at_zero(); }

  static constexpr std::string_view kName = "tdpa-2port";

 private:
  control::HeldForce held_;
  Gains gains_;
  Vector asked_;     // f_e of the present interval
  Vector velocity_;  // zero: unknown
  control::EnergySum in_;
  control::EnergySum allowance_;
  RemoteSum from_server_;
};

/// The server-side law: velocity is its input, so its controller adjusts velocity.
///
/// d the step of the device since the motion before, f the environment's answer there, taken to be held.
///
///     P = -f'd > 0 flows into the environment:  E_out += P,  else  E_in -= P
///     P > E_in(device) - E_out:  d += beta f, so that just the available energy flows
///
/// So E_out never exceeds E_in(device). Shortened steps are never made up: the position drifts away from the device,
/// which is the cost of this law.
class TwoPortServerSideLaw final : public control::ServerSideLaw {
 public:
  [[nodiscard]] Vector place(const Received& received) noexcept override {
    available_.add(from_device_.receive(number_at(received.numbers, 0)));
    if (place_.rows() != received.position.rows()) {
      place_ = device_ = received.position;
      force_ = Vector::Zero(received.position.rows());
    }
    const Vector d = received.position - device_;
    device_ = received.position;
    const double into_J = -force_.dot(d);
    if (!std::isfinite(into_J)) {
      place_ = device_;  // an overflow is a fault, not a motion
    } else if (into_J > 0) {
      const double kept_back_J = std::clamp(into_J - available_.value_J(), 0.0, into_J);
      available_.add(kept_back_J - into_J);
      place_ += keeping_back(d, force_, kept_back_J);
    } else {
      in_.add(-into_J);
      place_ += d;
    }
    if (!place_.allFinite()) place_ = device_;
    return place_;
  }

  [[nodiscard]] Reply answer(const Vector& force_N) noexcept override {
    force_ = force_N;
    return {.force = force_N, .numbers = control::ServerLawNumbers::Constant(1, in_.value_J())};
  }

 private:
  Vector place_;   // no rows: nothing received yet
  Vector device_;  // at the motion before
  Vector force_;
  control::EnergySum in_;
  control::EnergySum available_;  // E_in(device) - E_out
  RemoteSum from_device_;
};

}  // namespace

control::LawDescription two_port_passivity() {
  return {.name = std::string(TwoPortPassivity::kName),
          .summary = "time-domain passivity with delay: observers at both ends exchange energies; positions drift",
          .reference = "Ryu & Preusche 2007; Ryu, Artigas & Preusche 2010",
          .certainty = control::LawCertainty::likely,
          .parameters = {{.name = "alpha_max_per_b",
                          .purpose = "most damping that may be added, in multiples of the device's own",
                          .most = 100,
                          .standard = [](const control::DeviceFacts&) { return 1.0; }},
                         {.name = "velocity_floor_m_per_s",
                          .purpose = "slower motion is not damped",
                          .standard =
                              [](const control::DeviceFacts& facts) {
                                return std::max(1e-6, slowest_reading_m_per_s(facts));
                              }}},
          .make =
              [](const control::DeviceFacts& facts, const control::LawOptions& options) {
                const control::LawParameters& chosen = options.parameters;
                return std::make_unique<TwoPortPassivity>(
                    facts, TwoPortPassivity::Gains{.alpha_max = chosen.at("alpha_max_per_b"),
                                                   .velocity_floor_m_per_s = chosen.at("velocity_floor_m_per_s")});
              },
          .make_server_side = [](int) { return std::make_unique<TwoPortServerSideLaw>(); }};
}

}  // namespace forcebound::baselines
