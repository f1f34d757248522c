#include "tests/tools/lab/identification/hidden_device.hpp"

#include <cmath>
#include <numbers>

#include "forcebound/device/kinematics/arm_kinematics.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "tests/tools/sim/draw.hpp"

namespace forcebound::lab::identification {
namespace {

using client::commands::identify::KnownMass;
using device::Matrix;
using device::Vector;

constexpr double kGainShare = 0.1;  // of motors, as a data sheet has it

double between(sim::Draw& draw, double low, double high) { return low * std::exp(draw.share() * std::log(high / low)); }

/// One axis as felt at the tip.
struct Tip {
  double mass_kg = 0;
  double damping_N_s_per_m = 0;
  double friction_N = 0;
};

Tip draw_tip(sim::Draw& draw, double force_N_max, bool has_friction) {
  Tip tip;
  tip.mass_kg = between(draw, 0.04, 0.6);
  tip.damping_N_s_per_m = between(draw, 0.3, 8);
  // A device's friction is a small part of its force, or it would be felt before all else.
  if (has_friction) tip.friction_N = between(draw, 0.01, 0.08) * force_N_max;
  return tip;
}

device::ArmGeometry draw_arm(sim::Draw& draw) {
  device::ArmGeometry arm;
  arm.upper_length_m = draw.number(0.1, 0.25);
  arm.fore_length_m = arm.upper_length_m * draw.number(0.8, 1.2);
  arm.origin_reach_m = arm.upper_length_m * draw.number(1.05, 1.3);
  arm.origin_height_m = arm.upper_length_m * draw.number(-0.2, 0.2);
  return arm;
}

}  // namespace

HiddenDevice draw_hidden_device(std::uint64_t seed) {
  sim::Draw draw(seed);
  HiddenDevice hidden;
  const bool arm = draw.chance(0.4);
  const int dof = arm ? 3 : 1 + static_cast<int>(draw.index(3));
  hidden.kind = arm ? "arm" : dof == 1 ? "1 axis" : std::to_string(dof) + " axes";
  control::DeviceFacts& facts = hidden.description.facts;
  facts.name = "hidden-" + std::to_string(seed);
  facts.cartesian = !arm;
  facts.force_N_max = between(draw, 3, 20);
  const double step_m = between(draw, 5e-6, 100e-6);
  const bool has_friction = draw.chance(0.6);
  Matrix jacobian = Matrix::Identity(dof, dof);
  if (arm) {
    const device::ArmGeometry geometry = draw_arm(draw);
    hidden.description.geometry = geometry;
    const device::ArmKinematics kinematics(geometry);
    jacobian = kinematics.jacobian(kinematics.joints_at(Vector::Zero(dof)));
  }
  facts.damping = Matrix::Zero(dof, dof);
  hidden.description.inertia = Matrix::Zero(dof, dof);
  facts.friction = facts.encoder_step = facts.actuator_step = Vector::Zero(dof);
  const Tip all = draw_tip(draw, facts.force_N_max, has_friction);
  for (int i = 0; i < dof; ++i) {
    const double lever = jacobian.col(i).norm();
    const auto vary = [&] { return draw.number(0.6, 1.5); };
    hidden.description.inertia(i, i) = all.mass_kg * vary() * lever * lever;
    facts.damping(i, i) = all.damping_N_s_per_m * vary() * lever * lever;
    facts.friction[i] = all.friction_N * vary() * lever;
    facts.encoder_step[i] = step_m / lever;
    // An encoder on a joint has a whole number of counts to a turn.
    if (arm) facts.encoder_step[i] = 2 * std::numbers::pi / std::ceil(2 * std::numbers::pi / facts.encoder_step[i]);
  }
  facts.latency_s = draw.chance(0.15) ? 0 : between(draw, 30e-6, 2e-3);
  facts.hold_s_max = draw.number(2e-3, 8e-3);
  facts.releases = !draw.chance(0.1);
  hidden.flaws = {.seed = draw.seed(),
                  .torque_gain_share = {-kGainShare, kGainShare},
                  .releases_reported = draw.chance(0.5),
                  .effects_reported = draw.chance(0.3)};
  return hidden;
}

control::DeviceFacts declared_facts(const HiddenDevice& hidden) {
  const control::DeviceFacts& truth = hidden.description.facts;
  const int dof = truth.degrees_of_freedom();
  control::DeviceFacts declared;
  declared.name = truth.name;
  declared.cartesian = truth.cartesian;
  declared.period_s = truth.period_s;
  declared.force_N_max = truth.force_N_max;
  declared.damping = Matrix::Identity(dof, dof) * 1e-6;
  declared.uncertainty.torque_gain_share = {-kGainShare, kGainShare};
  declared.friction = declared.encoder_step = declared.actuator_step = Vector::Zero(dof);
  return declared;
}

KnownMass known_mass(const HiddenDevice& hidden) {
  constexpr double kShare = 0.01;
  sim::Draw draw(hidden.flaws.seed);
  KnownMass known{.share = kShare};
  for (const double mass : hidden.description.inertia.diagonal()) {
    known.of_joints.push_back(mass * (1 + draw.number(-kShare, kShare)));
  }
  return known;
}

std::unique_ptr<device::SimulatedDevice> without_hand(const device::DeviceDescription& description,
                                                      const device::DeviceFlaws& flaws) {
  const std::string nobody = "wave:mass_kg=0,stiffness_N_per_m=0,damping_N_s_per_m=0";
  return std::make_unique<device::SimulatedDevice>(description, device::make_operator(nobody, description.facts),
                                                   flaws);
}

}  // namespace forcebound::lab::identification
