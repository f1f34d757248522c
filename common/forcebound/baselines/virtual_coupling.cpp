#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/baselines/device_limits.hpp"
#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/held_force.hpp"

namespace forcebound::baselines {
namespace {

struct Coupling {
  double stiffness_N_per_m = 0;
  double damping_N_s_per_m = 0;
  double tool_mass_kg = 0;
  double contact_periods = 0;
};

/// A virtual tool between device and environment [Colgate, Stanley, Brown 1995]: the environment is asked at the tool,
/// and a spring and a damper connect the device to it.
///
/// Task space, device frame, all axes in metres; x device, x_v tool [m], e = x - x_v, f_e what the environment asks for
/// [N], our f is their -F. Every tick one implicit Euler step of a nominal period T:
///
///     m (v_v' - v_v)/T = f_e + F - D v_v',    x_v' = x_v + T v_v',    F = Kc e' + Bc (e' - e)/T,    f = -F
///
/// Where the environment is passive, so is the device if b > Kc T/2 + |Bc|; otherwise the constructor throws. An active
/// or late environment can drive the tool; then passivity is not guaranteed.
///
/// Open in the publication, and our decisions:
/// - **A late answer.** There tool and environment are computed together. Here f_e belongs to where the tool was a
///   tick or more ago, and a wall of stiffness K answered one tick late drives any tool for which K > Kc + (Bc + D)/T,
///   whatever its mass. So the tool is damped along the contact, D = n T k u u', u = f_e/|f_e|, with k the stiffness
///   that the environment shows: the largest |change of f_e| over the largest step of the tool in the last ticks,
///   forgotten over half a second. A soft environment is hardly damped by it; a wall of 150 N/mm settles with answers
///   up to two ticks late at n = 3 (`contact_periods`).
/// - **Free space** is free: when the environment has requested zero force for some ticks, the tool moves with the
///   device, its spring is released and its motion stopped, which only dissipates energy.
/// - **The largest force.** A coupling that would exceed the device's largest force slips: the tool stops where the
///   coupling gives just that force. This only dissipates energy as well.
/// - **Time** is counted in nominal periods. The tool's energy balance counts displacements, so a late tick does not
///   upset it.
///
/// After a lost reading the tool starts at the device's next position, at rest.
/// Real time: noexcept, no allocation, O(dof).
class VirtualCoupling final : public control::PassivityLaw {
 public:
  VirtualCoupling(const control::DeviceFacts& facts, const Coupling& coupling)
      : held_(facts.degrees_of_freedom(), facts.period_s),
        coupling_(coupling),
        force_N_max_(facts.force_N_max),
        displacement_(Vector::Zero(facts.degrees_of_freedom())),
        tool_(displacement_),
        velocity_(displacement_),
        stretch_(displacement_),
        normal_(displacement_),
        request_(displacement_) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "vc"; }

  void credit(const control::Motion& motion) noexcept override {
    const auto d = held_.displacement(motion);
    held_.begin(motion);
    device_ = motion.position;
    displacement_ = d ? *d : Vector::Zero(device_.rows());
    if (!d) ride();
  }

  void lose(const control::Motion& /*motion*/) noexcept override { held_.lose(); }

  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override {
    if (!held_.known()) return Vector::Zero(request_N.rows());
    update_contact(request_N);
    if (quiet_ticks_ > kTicks) {
      ride();
      return Vector::Zero(request_N.rows());
    }
    const Vector before = tool_;
    const Vector force = step(request_N);
    if (!force.allFinite() || !tool_.allFinite()) {
      ride();
      return Vector::Zero(request_N.rows());
    }
    steps_[next_step_] = (tool_ - before).norm();
    next_step_ = (next_step_ + 1) % kTicks;
    return -force;
  }

  void commit(const Vector& force_N) noexcept override { held_.hold(force_N); }

  /// The tool's energy: spring and motion [J].
  [[nodiscard]] double energy_J() const noexcept override {
    const double energy_J =
        (coupling_.stiffness_N_per_m * stretch_.squaredNorm() + coupling_.tool_mass_kg * velocity_.squaredNorm()) / 2;
    return std::min(energy_J, std::numeric_limits<double>::max());
  }

  [[nodiscard]] Vector proxy_position(const Vector& position) const noexcept override {
    return held_.known() ? tool_ : position;
  }

 private:
  static constexpr std::size_t kTicks = 4;               // for which a contact is remembered
  static constexpr double kForgetting = 1 - 2e-3;        // of the environment's stiffness, per tick
  static constexpr double kStepLeast_m = 1e-9;           // shorter steps give no estimate of stiffness
  static constexpr double kStiffnessMost_N_per_m = 1e9;  // keeps a request of 1e300 N from overflowing

  void ride() noexcept {
    tool_ = device_;
    velocity_.setZero(device_.rows());
    stretch_.setZero(device_.rows());
    request_.setZero(device_.rows());
    steps_.fill(displacement_.norm());
    contact_N_per_m_ = 0;
    quiet_ticks_ = kTicks + 1;
  }

  void update_contact(const Vector& request_N) noexcept {
    const double largest = request_N.lpNorm<Eigen::Infinity>();
    quiet_ticks_ = largest > 0 ? 0 : quiet_ticks_ + 1;
    if (largest > 0) normal_ = (request_N / largest).normalized();
    const double moved_m = *std::ranges::max_element(steps_);
    contact_N_per_m_ *= kForgetting;
    if (moved_m > kStepLeast_m) {
      const double shown_N_per_m = (request_N - request_).lpNorm<Eigen::Infinity>() / moved_m;
      contact_N_per_m_ = std::min(std::max(contact_N_per_m_, shown_N_per_m), kStiffnessMost_N_per_m);
    }
    request_ = request_N;
  }

  /// One step of the tool under `push_N`; gives F.
  Vector step(const Vector& push_N) noexcept {
    const double T = held_.period_s();
    const double m = coupling_.tool_mass_kg;
    const double kc = coupling_.stiffness_N_per_m;
    const double bc = coupling_.damping_N_s_per_m;
    const double drag = coupling_.contact_periods * T * contact_N_per_m_;

    const double diagonal = m / T + bc + kc * T;
    const Vector drive = m / T * velocity_ + push_N + kc * (stretch_ + displacement_) + bc / T * displacement_;
    velocity_ = (drive - drag / (diagonal + drag) * normal_.dot(drive) * normal_) / diagonal;
    const Vector before = stretch_;
    stretch_ += displacement_ - T * velocity_;
    tool_ = device_ - stretch_;
    const Vector force = kc * stretch_ + bc / T * (stretch_ - before);
    return force.norm() > force_N_max_ ? slip(force * (force_N_max_ / force.norm()), before) : force;
  }

  Vector slip(const Vector& force_N, const Vector& stretch_before) noexcept {
    const double bc_per_T = coupling_.damping_N_s_per_m / held_.period_s();
    stretch_ = (force_N + bc_per_T * stretch_before) / (coupling_.stiffness_N_per_m + bc_per_T);
    tool_ = device_ - stretch_;
    velocity_.setZero();
    return force_N;
  }

  control::HeldForce held_;
  Coupling coupling_;
  double force_N_max_;
  Vector device_;
  Vector displacement_;  // of the device, in the interval that ended
  Vector tool_;
  Vector velocity_;  // of the tool
  Vector stretch_;   // e
  Vector normal_;
  Vector request_;
  std::array<double, kTicks> steps_{};  // of the tool [m]
  std::size_t next_step_ = 0;
  double contact_N_per_m_ = 0;
  std::size_t quiet_ticks_ = kTicks + 1;
};

[[noreturn]] void refuse(const control::DeviceFacts& facts, const std::string& why) {
  throw std::invalid_argument("law 'vc': device '" + facts.name + "' " + why);
}

std::unique_ptr<control::PassivityLaw> make(const control::DeviceFacts& facts, const control::LawOptions& options) {
  require_constant_translations("vc", facts);
  const Coupling coupling{.stiffness_N_per_m = options.parameters.at("coupling_N_per_m"),
                          .damping_N_s_per_m = options.parameters.at("coupling_damping_N_s_per_m"),
                          .tool_mass_kg = options.parameters.at("tool_mass_kg"),
                          .contact_periods = options.parameters.at("contact_periods")};
  auto law = std::make_unique<VirtualCoupling>(facts, coupling);
  const double needed = coupling.stiffness_N_per_m * facts.period_s / 2 + coupling.damping_N_s_per_m;
  if (least_damping(facts) > needed) return law;
  control::ClassicText text;
  text << "has a damping of " << least_damping(facts) << " N s/m; a coupling of " << coupling.stiffness_N_per_m
       << " N/m and " << coupling.damping_N_s_per_m << " N s/m at a period of " << facts.period_s
       << " s needs more than Kc T/2 + |Bc| = " << needed << " N s/m";
  refuse(facts, text.str());
}

}  // namespace

control::LawDescription virtual_coupling() {
  return {
      .name = "vc",
      .summary = "virtual coupling: a passive tool touches the environment, a spring and a damper hold the device",
      .reference = "Colgate, Stanley, Brown 1995",
      .certainty = control::LawCertainty::likely,
      .parameters = {{.name = "coupling_N_per_m",
                      .purpose = "stiffness of the coupling, Kc",
                      .least = 1e-3,
                      .most = 1e9,
                      .standard =
                          [](const control::DeviceFacts& f) { return 0.9 * 2 * least_damping(f) / f.period_s; }},
                     {.name = "coupling_damping_N_s_per_m",
                      .purpose = "damping of the coupling, Bc",
                      .most = 1e6,
                      .standard = [](const control::DeviceFacts& f) { return 0.05 * least_damping(f); }},
                     {.name = "tool_mass_kg",
                      .purpose = "mass of the tool",
                      .most = 1e3,
                      .standard = [](const control::DeviceFacts& f) { return least_damping(f) * f.period_s; }},
                     {.name = "contact_periods",
                      .purpose = "damping of the tool's contact, as a number of periods times the stiffness it meets",
                      .most = 1e3,
                      .standard = [](const control::DeviceFacts&) { return 3.0; }}},
      .make = make};
}

}  // namespace forcebound::baselines
