#include <algorithm>
#include <cmath>
#include <memory>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/baselines/device_limits.hpp"
#include "forcebound/baselines/two_port.hpp"
#include "forcebound/control/energy_sum.hpp"

namespace forcebound::baselines {
namespace {

/// The energy tank at one end, and the energy that the two ends send each other.
class Tank {
 public:
  void add(double energy_J) noexcept {
    if (std::isfinite(energy_J)) level_.add(energy_J);
  }
  [[nodiscard]] double level_J() const noexcept { return level_.value_J(); }

  /// Simple energy transfer: that share of the level.
  void send(double share) noexcept {
    const double energy_J = share * std::max(0.0, level_J());
    level_.add(-energy_J);
    sent_.add(energy_J);
  }
  [[nodiscard]] double sent_J() const noexcept { return sent_.value_J(); }

 private:
  control::EnergySum level_;
  control::EnergySum sent_;
};

/// The two-layer approach, at the device [Franken, Stramigioli, Misra, Secchi & Macchelli 2011]: the upper layer may
/// request any force (here the environment's); the lower one pays for it from an energy tank at each end.
///
/// Task space; f_e the upper layer's request [N], f the force applied, d the displacement over the interval that ended
/// [m], v = d/h, T the nominal period, H the level of the tank [J]. Our f is the paper's -F.
///
///     H += -f'd + received,  then beta H is sent to the other tank           a tick
///     f_p = 0 if H <= 0;  |f_p| <= H/(|v_f| T) where it gives energy         v_f: velocity along f_p
///     f = f_p - alpha (H_d - H) v while H < H_d                              the tank is filled by damping
///
/// The energy sent travels as a sum since the beginning, of which the largest received counts. Ours: the damping that
/// fills the tank is at most the device's own b, which an empty tank asks for (alpha = b/H_d); H_d is the most energy
/// that the largest force can return beyond the device's damping in a period, f_max^2 T/(4 b); beta is 0.01, as
/// published.
///
/// Passivity is not guaranteed: the motion of the coming period may be faster than the one before, and an active
/// environment fills the other tank.
/// Real time: noexcept, no allocation, O(dof).
class TwoLayer final : public control::PassivityLaw {
 public:
  struct Gains {
    double beta;
    double desired_J;
    double damping_N_s_per_m;
  };

  TwoLayer(const control::DeviceFacts& facts, const Gains& gains)
      : held_(facts.degrees_of_freedom(), facts.period_s),
        gains_(gains),
        velocity_(Vector::Zero(facts.degrees_of_freedom())) {
    from_server_.begin_at_zero();
  }

  [[nodiscard]] std::string_view name() const noexcept override { return kName; }
  [[nodiscard]] std::string_view server_law() const noexcept override { return kName; }

  void credit(const control::Motion& motion) noexcept override {
    const EndedInterval ended = next_interval(held_, motion);
    velocity_ = ended.velocity;
    tank_.add(-ended.unseen_J);
    tank_.add(-ended.force.dot(ended.displacement));
    tank_.send(gains_.beta);
  }

  void lose(const control::Motion& motion) noexcept override {
    tank_.add(-held_.worst_case_J(motion.interval_s));
    held_.lose();
    velocity_.setZero();
  }

  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override {
    return paid_for(request_N) - filling_N_s_per_m() * velocity_;
  }

  void commit(const Vector& force_N) noexcept override { held_.hold(force_N); }

  /// H [J].
  [[nodiscard]] double energy_J() const noexcept override { return tank_.level_J(); }

  [[nodiscard]] control::ServerLawNumbers outgoing() const noexcept override {
    control::ServerLawNumbers numbers(2);
    numbers << tank_.sent_J(), gains_.beta;
    return numbers;
  }
  void incoming(const control::ServerLawNumbers& numbers) noexcept override {
    tank_.add(from_server_.receive(number_at(numbers, 0)));
  }
  void begin_server_side() noexcept override { from_server_.begin_at_zero(); }

  static constexpr std::string_view kName = "tla";

 private:
  [[nodiscard]] Vector paid_for(const Vector& request_N) const noexcept {
    const double level_J = tank_.level_J();
    if (!(level_J > 0)) return Vector::Zero(request_N.rows());
    const double giving_J = request_N.dot(velocity_) * held_.period_s();
    return giving_J > level_J ? Vector(request_N * (level_J / giving_J)) : request_N;
  }

  [[nodiscard]] double filling_N_s_per_m() const noexcept {
    const double missing_J = gains_.desired_J - tank_.level_J();
    if (!(missing_J > 0)) return 0;
    // For a device without a largest force no level is enough.
    const double missing = std::isfinite(missing_J) ? std::min(1.0, missing_J / gains_.desired_J) : 1.0;
    return missing * gains_.damping_N_s_per_m;
  }

  control::HeldForce held_;
  Gains gains_;
  Vector velocity_;  // zero: unknown
  Tank tank_;
  RemoteSum from_server_;
};

/// The server-side law: its position follows the device as far as its tank pays.
///
/// d from the position to the device, f the environment's answer at the position, taken to be held.
///
///     -f'd > max(H, 0):  d is shortened along f, so that just H flows into the environment;  H -= -f'd
///     then beta H is sent to the device's tank, an answer
///
/// Where the tank is empty the position goes no deeper; it catches up later, so that no drift remains.
class TwoLayerServerSideLaw final : public control::ServerSideLaw {
 public:
  [[nodiscard]] Vector place(const Received& received) noexcept override {
    tank_.add(from_device_.receive(number_at(received.numbers, 0)));
    share_ = std::clamp(number_at(received.numbers, 1), 0.0, 1.0);
    if (place_.rows() != received.position.rows()) {
      place_ = received.position;
      force_ = Vector::Zero(received.position.rows());
    }
    const Vector d = received.position - place_;
    const double into_J = -force_.dot(d);
    const double kept_back_J = into_J - std::max(0.0, tank_.level_J());
    place_ += keeping_back(d, force_, kept_back_J);
    tank_.add(-(into_J - std::max(0.0, kept_back_J)));
    if (!place_.allFinite()) place_ = received.position;
    return place_;
  }

  [[nodiscard]] Reply answer(const Vector& force_N) noexcept override {
    force_ = force_N;
    tank_.send(share_);
    return {.force = force_N, .numbers = control::ServerLawNumbers::Constant(1, tank_.sent_J())};
  }

 private:
  Vector place_;  // no rows: nothing received yet
  Vector force_;
  double share_ = 0;
  Tank tank_;
  RemoteSum from_device_;
};

}  // namespace

control::LawDescription two_layer() {
  return {.name = std::string(TwoLayer::kName),
          .summary = "two layers: the request is paid for from an energy tank at each end",
          .reference = "Franken 2011",
          .certainty = control::LawCertainty::likely,
          .parameters = {{.name = "beta",
                          .purpose = "share of a tank that is sent to the other one in a tick",
                          .most = 0.5,
                          .standard = [](const control::DeviceFacts&) { return 0.01; }},
                         {.name = "desired_J",
                          .purpose = "level to which damping fills the device's tank; standard f_max^2 T/(4 b)",
                          .standard =
                              [](const control::DeviceFacts& facts) {
                                return facts.force_N_max * facts.force_N_max * facts.period_s /
                                       (4 * least_damping(facts));
                              }},
                         {.name = "filling_N_s_per_m",
                          .purpose = "damping that fills an empty tank; standard b",
                          .standard = least_damping}},
          .make =
              [](const control::DeviceFacts& facts, const control::LawOptions& options) {
                require_constant_translations(TwoLayer::kName, facts);
                const control::LawParameters& chosen = options.parameters;
                return std::make_unique<TwoLayer>(facts,
                                                  TwoLayer::Gains{.beta = chosen.at("beta"),
                                                                  .desired_J = chosen.at("desired_J"),
                                                                  .damping_N_s_per_m = chosen.at("filling_N_s_per_m")});
              },
          .make_server_side = [](int) { return std::make_unique<TwoLayerServerSideLaw>(); }};
}

}  // namespace forcebound::baselines
