#include <algorithm>
#include <cmath>
#include <memory>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/baselines/device_limits.hpp"
#include "forcebound/baselines/travelling_wave.hpp"
#include "forcebound/baselines/two_port.hpp"

namespace forcebound::baselines {
namespace {

// Order of the numbers: the server-side law's parameters, then the energy of the wave and its integral.
constexpr Eigen::Index kImpedance = 0;
constexpr Eigen::Index kSpring = 1;
constexpr Eigen::Index kDamper = 2;
constexpr Eigen::Index kTool = 3;
constexpr Eigen::Index kWave = 4;

/// Wave variables, at the device [Niemeyer & Slotine 1991, 2004]: it exchanges waves, whose energy no constant
/// delay can change.
///
/// Task space, F = -f (f is the force on the device [N]), v = d/h of the interval that ended [m/s], T the period.
///
///     u = (b_w v + F)/sqrt(2 b_w)  goes out,   w = (b_w v - F)/sqrt(2 b_w)  comes back:   F v = u^2/2 - w^2/2
///     F = b_w v - sqrt(2 b_w) w
///
/// The force is computed from the wave alone; the environment's answer in newtons is not used, and so the late-force
/// policy has nothing to fade: without a wave the device feels a damper b_w.
///
/// The delay acts as a spring: with a one-way delay t_d the device feels b_w/t_d in series with all others.
///
/// Waves travel as integrals, with the sum of their energy. A sample is taken once; where none came the wave is zero,
/// and a late one is added to the next, but never with more energy than it was sent with [after Niemeyer & Slotine
/// 1998]. So no loss, jitter or copy creates energy. A wave that comes in bursts is spread over twice the longest
/// recent pause; the remaining ripple still costs energy, so that under strong jitter a held force fades and the tool
/// drifts. The force is held over a period in which the velocity differs from the one it was computed for: the wave
/// actually returned over it is known afterwards, and its excess over w is charged, less what the device's damping b
/// dissipated meanwhile. These details are ours.
///
/// Passivity is not guaranteed: the environment at the other end may be active.
/// Real time: noexcept, no allocation, O(dof).
class WaveVariables final : public control::PassivityLaw {
 public:
  struct Gains {
    double impedance_N_s_per_m;
    double spring_N_per_m;
    double damper_N_s_per_m;
    double tool_kg;
  };

  WaveVariables(const control::DeviceFacts& facts, const Gains& gains)
      : held_(facts.degrees_of_freedom(), facts.period_s),
        gains_(gains),
        coding_{gains.impedance_N_s_per_m},
        damping_N_s_per_m_(least_damping(facts)),
        velocity_(Vector::Zero(facts.degrees_of_freedom())),
        wave_(velocity_) {
    received_.begin_at_zero(facts.degrees_of_freedom());
  }

  [[nodiscard]] std::string_view name() const noexcept override { return kName; }
  [[nodiscard]] std::string_view server_law() const noexcept override { return kName; }

  void credit(const control::Motion& motion) noexcept override {
    const EndedInterval ended = next_interval(held_, motion);
    const double h = ended.interval_s;
    blackout_s_ += h;
    pause_s_ *= std::exp(-h / kForgetting_s);
    velocity_ = ended.velocity;
    received_.spend(ended.unseen_J);
    if (!(h > 0)) return;
    sent_.add(coding_.going(velocity_, -ended.force), h);
    const double taken_J = wave_.squaredNorm() / 2 * h;
    const double returned_J = coding_.returning(velocity_, -ended.force).squaredNorm() / 2 * h;
    const double dissipated_J = damping_N_s_per_m_ * velocity_.squaredNorm() * h;
    received_.spend(std::max(taken_J, returned_J - dissipated_J));
  }

  void lose(const control::Motion& motion) noexcept override {
    received_.spend(held_.worst_case_J(motion.interval_s));
    held_.lose();
    velocity_.setZero();
    wave_.setZero();
  }

  [[nodiscard]] Vector bound(const Vector& /*request_N*/) noexcept override {
    wave_ = received_.take(held_.period_s(), spread_s());
    return -coding_.force(velocity_, wave_);
  }

  void commit(const Vector& force_N) noexcept override { held_.hold(force_N); }

  /// Energy of the waves received and not yet taken [J].
  [[nodiscard]] double energy_J() const noexcept override { return received_.budget_J(); }

  [[nodiscard]] control::ServerLawNumbers outgoing() const noexcept override {
    control::ServerLawNumbers numbers(kWave + sent_.rows());
    numbers[kImpedance] = gains_.impedance_N_s_per_m;
    numbers[kSpring] = gains_.spring_N_per_m;
    numbers[kDamper] = gains_.damper_N_s_per_m;
    numbers[kTool] = gains_.tool_kg;
    sent_.write(numbers, kWave);
    return numbers;
  }
  void incoming(const control::ServerLawNumbers& numbers) noexcept override {
    received_.receive(numbers, 0);
    if (server_side_speaks_) pause_s_ = std::max(pause_s_, blackout_s_);
    server_side_speaks_ = true;
    blackout_s_ = 0;
  }
  void begin_server_side() noexcept override {
    received_.begin_at_zero(velocity_.rows());
    server_side_speaks_ = false;
  }

  static constexpr std::string_view kName = "wave";

 private:
  static constexpr double kForgetting_s = 1;

  /// A wave that comes in bursts is spread over two of the pauses between them; one that comes each tick is not.
  [[nodiscard]] double spread_s() const noexcept {
    const double period_s = held_.period_s();
    constexpr double kPunctual = 1.5;
    return pause_s_ < kPunctual * period_s ? period_s : 2 * pause_s_;
  }

  control::HeldForce held_;
  Gains gains_;
  WaveCoding coding_;
  double damping_N_s_per_m_;
  Vector velocity_;  // zero: unknown
  Vector wave_;      // w of the present interval
  bool server_side_speaks_ = false;
  double blackout_s_ = 0;
  double pause_s_ = 0;  // longest between two arrivals, decaying over kForgetting_s
  SentWave sent_;
  ReceivedWave received_;
};

/// The server-side law: a tool of mass m in the environment, pulled by a spring and a damper to the position x_d that
/// the wave commands.
///
///     b_w v_d + F = sqrt(2 b_w) u,   F = Kd (x_d - x) + Bd (v_d - v)
///     v_d = (sqrt(2 b_w) u + Bd v + Kd (x - x_d))/(b_w + Bd)
///     m dv/dt = F + f,   f what the environment answered at x
///     w = (b_w v_d - F)/sqrt(2 b_w) goes back
///
/// Each answer is one step h of the device's time, implicit in spring and damper, with f of the step before. The delay
/// of one step acts like a damper of -k h/2 in an environment of stiffness k, and nothing else in this loop would
/// dissipate that energy. So the tool is damped with k h along f, k the largest change of f over a step of the tool,
/// decaying over a tenth of a second; this is ours. After a gap h is at most `kStep_s_max`, and the wave of the rest is
/// taken up in the steps that follow.
class WaveServerSideLaw final : public control::ServerSideLaw {
 public:
  [[nodiscard]] Vector place(const Received& received) noexcept override {
    const control::ServerLawNumbers& numbers = received.numbers;
    const WaveCoding coding{number_at(numbers, kImpedance)};
    const bool sane = coding.impedance_N_s_per_m > 0 && number_at(numbers, kTool) > 0 &&
                      number_at(numbers, kSpring) >= 0 && number_at(numbers, kDamper) >= 0;
    if (place_.rows() != received.position.rows() || !sane) begin(received.position);
    if (!sane) return place_;
    received_.receive(numbers, kWave);
    const double h = std::min(received.interval_s, kStep_s_max);
    if (control::is_measurable(h)) step(coding, numbers, h);
    moved_m_ = (place_ - before_).stableNorm();
    before_ = place_;
    if (!place_.allFinite() || !wanted_.allFinite() || !velocity_.allFinite()) begin(received.position);
    return place_;
  }

  [[nodiscard]] Reply answer(const Vector& force_N) noexcept override {
    const double stiffness_N_per_m = (force_N - force_).stableNorm() / moved_m_;
    if (moved_m_ > 0 && std::isfinite(stiffness_N_per_m)) stiffness_ = std::max(stiffness_, stiffness_N_per_m);
    force_ = force_N;
    control::ServerLawNumbers numbers(sent_.rows());
    sent_.write(numbers, 0);
    return {.force = force_N, .numbers = numbers};
  }

 private:
  static constexpr double kStep_s_max = 10e-3;
  static constexpr double kForgetting_s = 0.1;

  void begin(const Vector& position) noexcept {
    place_ = wanted_ = before_ = position;
    stiffness_ = moved_m_ = 0;
    velocity_ = force_ = Vector::Zero(position.rows());
    received_.begin(position.rows());
  }

  void step(const WaveCoding& coding, const control::ServerLawNumbers& numbers, double h) noexcept {
    const double b = coding.impedance_N_s_per_m;
    const double kd = numbers[kSpring];
    const double m = numbers[kTool];
    const double g = numbers[kDamper] + h * kd;  // effective damping of spring and damper in an implicit step
    const Vector u = received_.take(h, h);
    received_.spend(u.squaredNorm() / 2 * h);
    const Vector pushed = coding.root() * u;
    const Vector stretch = wanted_ - place_;
    velocity_ =
        (m / h * velocity_ + g / (b + g) * pushed + b / (b + g) * kd * stretch + force_) / (m / h + b * g / (b + g));
    damp(m / h + b * g / (b + g), h);
    const Vector wanted_velocity = (pushed - kd * stretch + g * velocity_) / (b + g);
    const Vector coupling_N = pushed - b * wanted_velocity;
    place_ += h * velocity_;
    wanted_ += h * wanted_velocity;
    sent_.add(coding.returning(wanted_velocity, coupling_N), h);
  }

  /// Adds a damper of k h along the contact to the step, whose own resistance [N s/m] is `resistance`.
  void damp(double resistance, double h) noexcept {
    stiffness_ *= std::exp(-h / kForgetting_s);
    const double length = force_.stableNorm();
    if (!(length > 0) || !std::isfinite(length)) return;
    const Vector along = force_ / length;
    const double damper = stiffness_ * h;
    velocity_ -= along * (along.dot(velocity_) * (damper / (resistance + damper)));
  }

  Vector place_;   // x; no rows: nothing received yet
  Vector wanted_;  // x_d
  Vector velocity_;
  Vector force_;
  Vector before_;  // x of the step before
  double moved_m_ = 0;
  double stiffness_ = 0;  // k [N/m]
  SentWave sent_;
  ReceivedWave received_;
};

}  // namespace

control::LawDescription wave_variables() {
  return {
      .name = std::string(WaveVariables::kName),
      .summary = "wave variables: passive through any constant delay; a tool with spring and damper at the server",
      .reference = "Niemeyer & Slotine 1991, 1998, 2004",
      .certainty = control::LawCertainty::likely,
      .parameters =
          {{.name = "impedance_N_s_per_m",
            .purpose = "b_w of the wave; standard b/2",
            .least = 1e-6,
            .most = 1e6,
            .standard = [](const control::DeviceFacts& facts) { return least_damping(facts) / 2; }},
           {.name = "spring_N_per_m",
            .purpose = "Kd between wave and tool; standard b/T",
            .most = 1e9,
            .standard = [](const control::DeviceFacts& facts) { return least_damping(facts) / facts.period_s; }},
           {.name = "damper_N_s_per_m",
            .purpose = "Bd between wave and tool; standard b/2, as the wave",
            .most = 1e6,
            .standard = [](const control::DeviceFacts& facts) { return least_damping(facts) / 2; }},
           {.name = "tool_kg",
            .purpose = "mass of the tool; standard 2 b T, stable on walls up to 8 b/T",
            .least = 1e-9,
            .most = 1e3,
            .standard = [](const control::DeviceFacts& facts) { return 2 * least_damping(facts) * facts.period_s; }}},
      .make =
          [](const control::DeviceFacts& facts, const control::LawOptions& options) {
            require_constant_translations(WaveVariables::kName, facts);
            const control::LawParameters& chosen = options.parameters;
            return std::make_unique<WaveVariables>(
                facts, WaveVariables::Gains{.impedance_N_s_per_m = chosen.at("impedance_N_s_per_m"),
                                            .spring_N_per_m = chosen.at("spring_N_per_m"),
                                            .damper_N_s_per_m = chosen.at("damper_N_s_per_m"),
                                            .tool_kg = chosen.at("tool_kg")});
          },
      .make_server_side = [](int) { return std::make_unique<WaveServerSideLaw>(); }};
}

}  // namespace forcebound::baselines
