#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "forcebound/control/exact_law.hpp"

namespace forcebound::control {
namespace {

constexpr Bracket kShare{-0.1, 0.05};

DeviceFacts device_with_gain(const Vector& damping, const Bracket& share) {
  DeviceFacts facts;
  facts.name = "test";
  facts.damping = damping.asDiagonal();
  facts.friction = 0.01 * damping;
  facts.encoder_step = Vector::Constant(damping.rows(), 1e-5);
  facts.actuator_step = Vector::Zero(damping.rows());
  facts.force_N_max = std::numeric_limits<double>::infinity();
  facts.release_share = 0.3;
  facts.release_s = 1e-3;
  facts.latency_s = 2e-4;
  facts.uncertainty.torque_gain_share = share;
  return facts;
}

DeviceFacts joint_of_known_gain(double damping, double gain_share, bool losses_with_gain) {
  const double scale = losses_with_gain ? 1 + gain_share : 1;
  return device_with_gain(Vector::Constant(1, scale * damping), {gain_share, gain_share});
}

/// Laws that know the gain of the one joint they have: at the least, and at the most.
struct KnownGains {
  KnownGains(double damping, bool losses_with_gain)
      : least(joint_of_known_gain(damping, kShare.least, losses_with_gain), EnergyMemory::full),
        most(joint_of_known_gain(damping, kShare.most, losses_with_gain), EnergyMemory::full) {}
  ExactLaw least;
  ExactLaw most;
};

Motion motion_of(const Vector& joint) {
  Motion motion;
  motion.interval_s = 1e-3;
  motion.latency_s = motion.latency_s_max = 2e-4;
  motion.position = motion.joint = joint;
  motion.jacobian = Matrix::Identity(joint.rows(), joint.rows());
  return motion;
}

// Of each joint the worse of two laws that know its gain; for one joint their smaller force.
class MotorGain : public testing::TestWithParam<bool> {};

TEST_P(MotorGain, CountsForEachJointAsTheWorseOfItsEnds) {
  const bool losses_with_gain = GetParam();
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const auto joints = static_cast<Eigen::Index>(1 + seed % 3);
    const Vector damping = Vector::NullaryExpr(joints, [&](Eigen::Index) { return std::exp(normal(random)) * 10; });
    DeviceFacts facts = device_with_gain(damping, kShare);
    facts.uncertainty.losses_with_gain = losses_with_gain;
    ExactLaw law(facts, EnergyMemory::full);
    std::vector<KnownGains> apart;
    for (Eigen::Index i = 0; i < joints; ++i) apart.emplace_back(damping[i], losses_with_gain);
    Vector place = Vector::Zero(joints);
    Vector force = Vector::Zero(joints);
    int bounded = 0;
    for (int n = 0; n < 2000; ++n) {
      place += Vector::NullaryExpr(joints, [&](Eigen::Index) { return 5e-5 * normal(random); });
      if (n % 3 > 0) place += 5e-4 * force.cwiseQuotient(damping);
      law.credit(motion_of(place));
      double energy_J = 0;
      for (Eigen::Index i = 0; i < joints; ++i) {
        KnownGains& known = apart[static_cast<std::size_t>(i)];
        known.least.credit(motion_of(place.segment(i, 1)));
        known.most.credit(motion_of(place.segment(i, 1)));
        energy_J += std::min(known.least.energy_J(), known.most.energy_J());
      }
      ASSERT_NEAR(law.energy_J(), energy_J, 1e-9 * (1e-3 + std::abs(energy_J))) << n;
      const Vector request = Vector::NullaryExpr(joints, [&](Eigen::Index) { return 8 * normal(random); });
      force = law.bound(request);
      if (joints == 1) {
        const double least = apart[0].least.bound(request)[0];
        const double most = apart[0].most.bound(request)[0];
        ASSERT_NEAR(force[0], std::abs(least) < std::abs(most) ? least : most, 1e-6 * (1 + std::abs(force[0]))) << n;
      }
      ASSERT_TRUE(law.allows(force, 2e-4)) << n;
      if (force != request && law.energy_J() > 1e-9) {
        ASSERT_FALSE(law.allows(1.0001 * force, 2e-4)) << n;
        ++bounded;
      }
      law.commit(force);
      for (Eigen::Index i = 0; i < joints; ++i) {
        KnownGains& known = apart[static_cast<std::size_t>(i)];
        known.least.commit(force.segment(i, 1));
        known.most.commit(force.segment(i, 1));
      }
    }
    EXPECT_GT(bounded, 100);
  }
}

INSTANTIATE_TEST_SUITE_P(LossesWithGain, MotorGain, testing::Bool());

// Everything in units of the command: one unknown gain multiplies all energies.
TEST(MotorGainOfOneJoint, CostsNothingWhereLossesAreToldWithIt) {
  DeviceFacts facts = device_with_gain(Vector::Constant(1, 10), {0, 0});
  ExactLaw known(facts);
  facts.uncertainty.torque_gain_share = {-0.3, 0.4};
  ExactLaw with_losses_known(facts);
  facts.uncertainty.losses_with_gain = true;
  ExactLaw with_losses_told(facts);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Vector place = Vector::Zero(1);
  double shown_N = 0;
  double shown_with_losses_known_N = 0;
  for (int n = 0; n < 2000; ++n) {
    place[0] += 5e-5 * normal(random);
    const Vector request = Vector::Constant(1, 8 * normal(random));
    for (ExactLaw* law : {&known, &with_losses_known, &with_losses_told}) law->credit(motion_of(place));
    const double force_N = known.bound(request)[0];
    ASSERT_NEAR(with_losses_told.bound(request)[0], force_N, 1e-9 * (1 + std::abs(force_N))) << n;
    shown_with_losses_known_N += std::abs(with_losses_known.bound(request)[0]);
    shown_N += std::abs(force_N);
    for (ExactLaw* law : {&known, &with_losses_known, &with_losses_told}) law->commit(Vector::Constant(1, force_N));
  }
  EXPECT_LT(shown_with_losses_known_N, 0.9 * shown_N);
}

}  // namespace
}  // namespace forcebound::control
