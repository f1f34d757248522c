#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/baselines/device_limits.hpp"
#include "forcebound/baselines/two_port.hpp"
#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/energy_sum.hpp"

namespace forcebound::baselines {
namespace {

/// The range of the device's positions since the set position in use arrived [m].
class Range {
 public:
  void begin(const Vector& position) noexcept { least_ = most_ = position; }
  void extend(const Vector& position) noexcept {
    if (least_.rows() != position.rows()) begin(position);
    least_ = least_.cwiseMin(position);
    most_ = most_.cwiseMax(position);
  }
  void forget() noexcept { least_.resize(0); }
  [[nodiscard]] double square_m2() const noexcept { return least_.rows() > 0 ? (most_ - least_).squaredNorm() : 0.0; }

 private:
  Vector least_;
  Vector most_;
};

/// Passive set-position modulation [Lee & Huang 2010]: the device feels a spring to a set position y, and y is moved no
/// further than the energy allows that the device is known to have dissipated.
///
/// Task space; x device [m], x_s where the environment was asked and f_e what it answered there [N], f the force on the
/// device; ybar the set position in use, E the energy at hand [J], b the least damping [N s/m], T the period.
///
///     y = x_s + f_e/Kp                                        the spring's other end, for a pull of f_e at x_s
///     at each y that comes:
///     D = Bp |range of x|^2 / dt                              dissipated since the last one, at least
///     1/2 Kp r^2 = E + dE_y + D + 1/2 Kp |x - ybar|^2         dE_y came from the server-side law
///     ybar' = x + (y - x) min(1, r/|y - x|)                   the one closest to y that the energy allows
///     E' = 1/2 Kp (r^2 - |x - ybar'|^2) >= 0;  E' > E_max: the excess is sent to the server-side law
///     f = Kp (ybar - x)
///
/// dt is measured and the range is that of the readings. The device's own damping is the only damping: the hold takes
/// Kp T/2 of it, so Bp <= b - Kp T/2 and Kp <= 2b/T; otherwise the constructor throws. Where the force applied is less
/// than the spring's (the largest force, actuator steps, a lost reading), ybar is moved to where the spring agrees and
/// the difference in stored energy is dropped. f_e is the request, which fades when answers are late: then y goes to
/// x_s, and the spring stays there. The energy travels as a sum since the beginning, of which the largest received
/// counts. These details are ours.
///
/// Passive, where readings are exact, ticks punctual and forces immediate, whatever environment and network do: the
/// server-side law returns only what it was sent.
/// Real time: noexcept, no allocation, O(dof).
class SetPositionModulation final : public control::PassivityLaw {
 public:
  struct Gains {
    double stiffness_N_per_m;
    double damping_N_s_per_m;
    double energy_J_max;
  };

  SetPositionModulation(const control::DeviceFacts& facts, const Gains& gains)
      : held_(facts.degrees_of_freedom(), facts.period_s), gains_(gains) {
    from_server_.begin_at_zero();
  }

  [[nodiscard]] std::string_view name() const noexcept override { return kName; }
  [[nodiscard]] std::string_view server_law() const noexcept override { return kName; }

  void credit(const control::Motion& motion) noexcept override {
    const EndedInterval ended = next_interval(held_, motion);
    if (!(ended.interval_s > 0)) forget_spring(ended.unseen_J);
    // Before the first numbers of the server-side law there is no set position.
    if (!position_known_ || place_.rows() == 0) set_position_ = motion.position;
    position_known_ = true;
    position_ = motion.position;
    range_.extend(position_);
    since_last_s_ += ended.interval_s;
  }

  void lose(const control::Motion& motion) noexcept override {
    forget_spring(held_.worst_case_J(motion.interval_s));
    held_.lose();
  }

  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override {
    if (place_.rows() == position_.rows() && (came_ || request_N != request_N_)) modulate(request_N);
    return gains_.stiffness_N_per_m * (set_position_ - position_);
  }

  void commit(const Vector& force_N) noexcept override {
    held_.hold(force_N);
    if (position_known_) set_position_ = position_ + force_N / gains_.stiffness_N_per_m;
  }

  /// E [J].
  [[nodiscard]] double energy_J() const noexcept override { return energy_.value_J(); }

  [[nodiscard]] control::ServerLawNumbers outgoing() const noexcept override {
    return control::ServerLawNumbers::Constant(1, sent_.value_J());
  }
  void incoming(const control::ServerLawNumbers& numbers) noexcept override {
    energy_.add(from_server_.receive(number_at(numbers, 0)));
    place_ = numbers.rows() > 1 && numbers.rows() <= 1 + control::kDofMax ? Vector(numbers.tail(numbers.rows() - 1))
                                                                          : Vector();
    came_ = true;
  }
  void begin_server_side() noexcept override { from_server_.begin_at_zero(); }

  static constexpr std::string_view kName = "pspm";

 private:
  void modulate(const Vector& request_N) noexcept {
    came_ = false;
    request_N_ = request_N;
    const Vector wanted = place_ + request_N / gains_.stiffness_N_per_m - position_;
    const double half_stiffness = gains_.stiffness_N_per_m / 2;
    // The spring's energy counts as available; if nothing changes, the same number remains stored.
    energy_.add(half_stiffness * (position_ - set_position_).squaredNorm());
    if (since_last_s_ > 0) energy_.add(gains_.damping_N_s_per_m * range_.square_m2() / since_last_s_);
    range_.begin(position_);
    since_last_s_ = 0;
    const double reach_m = std::sqrt(std::max(0.0, energy_.value_J()) / half_stiffness);
    const double distance_m = wanted.stableNorm();
    Vector stretch = Vector::Zero(wanted.rows());
    if (distance_m > 0 && std::isfinite(distance_m)) stretch = wanted * std::min(1.0, reach_m / distance_m);
    set_position_ = position_ + stretch;
    energy_.add(-half_stiffness * stretch.squaredNorm());
    const double excess_J = energy_.value_J() - gains_.energy_J_max;
    if (!(excess_J > 0)) return;
    energy_.add(-excess_J);
    sent_.add(excess_J);
  }

  /// The device's position is unknown, so the spring is released. Its stored energy first covers the most that its
  /// force can have returned.
  void forget_spring(double unseen_J) noexcept {
    const double held_J =
        position_known_ ? gains_.stiffness_N_per_m / 2 * (position_ - set_position_).squaredNorm() : 0;
    energy_.add(-std::max(0.0, unseen_J - held_J));
    position_known_ = false;
    range_.forget();
    since_last_s_ = 0;
  }

  control::HeldForce held_;
  Gains gains_;
  Vector position_;
  Vector set_position_;  // ybar
  bool position_known_ = false;
  Vector place_;  // x_s of the newest answer; no rows: none yet
  Vector request_N_;
  bool came_ = false;
  Range range_;
  double since_last_s_ = 0;
  control::EnergySum energy_;
  control::EnergySum sent_;
  RemoteSum from_server_;
};

/// The server-side law: reports where the environment was asked. An environment has no spring of its own to spend
/// energy on, so this law is a store that is always full and returns what it is sent.
class SetPositionServerSideLaw final : public control::ServerSideLaw {
 public:
  [[nodiscard]] Vector place(const Received& received) noexcept override {
    sent_.add(from_device_.receive(number_at(received.numbers, 0)));
    place_ = received.position;
    return place_;
  }

  [[nodiscard]] Reply answer(const Vector& force_N) noexcept override {
    control::ServerLawNumbers numbers(1 + place_.rows());
    numbers << sent_.value_J(), place_;
    return {.force = force_N, .numbers = numbers};
  }

 private:
  Vector place_;
  control::EnergySum sent_;
  RemoteSum from_device_;
};

double hold_limit_N_per_m(const control::DeviceFacts& facts) { return 2 * least_damping(facts) / facts.period_s; }

std::unique_ptr<control::PassivityLaw> make_set_position_modulation(const control::DeviceFacts& facts,
                                                                    const control::LawOptions& options) {
  require_constant_translations(SetPositionModulation::kName, facts);
  const double stiffness_N_per_m = options.parameters.at("spring_N_per_m");
  const double left_N_s_per_m = least_damping(facts) - stiffness_N_per_m * facts.period_s / 2;
  if (left_N_s_per_m < 0) {
    control::ClassicText text;
    text << "law 'pspm': spring_N_per_m must be at most 2b/T = " << hold_limit_N_per_m(facts) << " N/m on device '"
         << facts.name << "' (b " << least_damping(facts) << " N s/m, T " << facts.period_s << " s), got "
         << stiffness_N_per_m;
    throw std::invalid_argument(text.str());
  }
  return std::make_unique<SetPositionModulation>(
      facts, SetPositionModulation::Gains{.stiffness_N_per_m = stiffness_N_per_m,
                                          .damping_N_s_per_m = options.parameters.at("damping_share") * left_N_s_per_m,
                                          .energy_J_max = options.parameters.at("energy_J_max")});
}

}  // namespace

control::LawDescription set_position_modulation() {
  return {.name = std::string(SetPositionModulation::kName),
          .summary = "passive set-position modulation: a spring whose other end moves as far as energy allows",
          .reference = "Lee & Huang 2010",
          .certainty = control::LawCertainty::likely,
          .claim = control::LawClaim::passive_if_ideal,
          .parameters = {{.name = "spring_N_per_m",
                          .purpose = "Kp of the spring that the device feels; standard half of 2b/T",
                          .least = 1e-3,
                          .standard = [](const control::DeviceFacts& facts) { return hold_limit_N_per_m(facts) / 2; }},
                         {.name = "damping_share",
                          .purpose = "Bp, as a multiple of the damping that the held spring leaves: b - Kp T/2",
                          .most = 1,
                          .standard = [](const control::DeviceFacts&) { return 1.0; }},
                         {.name = "energy_J_max",
                          .purpose = "most energy stored; standard: the spring's at the largest force",
                          .standard =
                              [](const control::DeviceFacts& facts) {
                                return facts.force_N_max * facts.force_N_max / hold_limit_N_per_m(facts);
                              }}},
          .make = make_set_position_modulation,
          .make_server_side = [](int) { return std::make_unique<SetPositionServerSideLaw>(); }};
}

}  // namespace forcebound::baselines
