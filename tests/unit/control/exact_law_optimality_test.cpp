// Theorem 2: what the exact law allows is safe in every world that the facts allow, and no more is. By trying worlds
// and motions in turn, without V.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "forcebound/control/exact_law.hpp"

namespace forcebound::control {
namespace {

constexpr double kLatency_s = 3e-4;
constexpr double kHold_s = 5e-3;

DeviceFacts ideal_facts(const Vector& damping, const Vector& friction) {
  DeviceFacts facts;
  facts.name = "test";
  facts.damping = damping.asDiagonal();
  facts.friction = friction;
  facts.encoder_step = facts.actuator_step = Vector::Zero(damping.rows());
  facts.force_N_max = std::numeric_limits<double>::infinity();
  facts.hold_s_max = kHold_s;
  facts.latency_s = kLatency_s;
  return facts;
}

Motion motion_to(const Vector& place, double interval_s) {
  Motion motion;
  motion.interval_s = interval_s;
  motion.latency_s = motion.latency_s_max = kLatency_s;
  motion.position = motion.joint = place;
  motion.jacobian = Matrix::Identity(place.rows(), place.rows());
  return motion;
}

/// A joint's torque from one reading to the next: the one before, and from then on the next one.
struct Step {
  double interval_s = 0;
  double way = 0;
  double before = 0;
  double after = 0;
};

/// One joint of a world.
struct JointWorld {
  double damping = 1;
  double friction = 0;
  double gain = 1;

  /// The least that a step dissipates beyond what the motor supplies, by trying velocities before the change of torque.
  [[nodiscard]] double least_J(const Step& step) const {
    const double after_s = step.interval_s - kLatency_s;
    const auto power = [&](double v, double torque) {
      return (damping * v - gain * torque) * v + friction * std::abs(v);
    };
    const auto cost_J = [&](double v) {
      return kLatency_s * power(v, step.before) + after_s * power((step.way - kLatency_s * v) / after_s, step.after);
    };
    const double size = std::abs(step.before) + std::abs(step.after) + friction;
    double high = std::abs(step.way) / std::min(kLatency_s, after_s) + 2 * gain * size / damping;
    double low = -high;
    for (int i = 0; i < 120; ++i) {  // convex in v
      const double third = (high - low) / 3;
      if (cost_J(low + third) < cost_J(high - third)) {
        high -= third;
      } else {
        low += third;
      }
    }
    return cost_J(0.5 * (low + high));
  }

  /// The most that a torque returns in a time.
  [[nodiscard]] double reserve_J(double torque, double duration_s) const {
    const double excess = std::max(gain * std::abs(torque) - friction, 0.0);
    return excess * excess * duration_s / (4 * damping);
  }

  /// What is left of a history when the next force takes effect.
  [[nodiscard]] double left_J(const std::vector<Step>& history) const {
    double left_J = -reserve_J(history.back().after, kLatency_s);
    for (const Step& step : history) left_J += least_J(step);
    return left_J;
  }
};

std::vector<double> through(const Bracket& bracket) {
  if (bracket.least == bracket.most) return {bracket.least};
  std::vector<double> values;
  for (const double share : {0.0, 0.2, 0.5, 0.8, 1.0}) {
    values.push_back(bracket.least + share * (bracket.most - bracket.least));
  }
  return values;
}

/// A device, its history, and the law that saw it.
struct Game {
  Bracket gain;
  Vector damping;
  Vector friction;
  double begin_J = 0;
  std::vector<std::vector<Step>> histories{};  ///< of each joint

  /// The least over all worlds of what is left after `torque` was held until its release.
  [[nodiscard]] double worst_J(const Vector& torque) const {
    double sum_J = begin_J;
    for (std::size_t i = 0; i < histories.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      double least_J = std::numeric_limits<double>::infinity();
      for (const double more : through(gain)) {
        const JointWorld world{damping[row], friction[row], 1 + more};
        least_J = std::min(least_J, world.left_J(histories[i]) - world.reserve_J(torque[row], kHold_s));
      }
      sum_J += least_J;
    }
    return sum_J;
  }
};

void play(std::uint64_t seed, const Bracket& gain, int& bounded) {
  SCOPED_TRACE(testing::Message() << "seed " << seed << ", gain " << gain.least << " to " << gain.most);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto joints = static_cast<Eigen::Index>(1 + seed % 2);
  const auto drawn = [&](double size) {
    return Vector(Vector::NullaryExpr(joints, [&](Eigen::Index) { return size * normal(random); }));
  };
  Game game{gain, 10 * drawn(0.5).array().exp().matrix(), seed % 3 == 0 ? Vector(drawn(0.3).cwiseAbs()) : drawn(0)};
  game.histories.resize(static_cast<std::size_t>(joints));
  game.begin_J = 2e-3 * std::exp(normal(random));
  DeviceFacts facts = ideal_facts(game.damping, game.friction);
  facts.uncertainty.torque_gain_share = gain;
  ExactLaw law(facts, EnergyMemory::full);
  law.receive_energy(game.begin_J);
  Vector place = Vector::Zero(joints);
  Vector before = Vector::Zero(joints);
  Vector after = Vector::Zero(joints);
  for (int n = 0; n < 6; ++n) {
    double interval_s = 0;
    if (n > 0) {
      interval_s = std::uniform_real_distribution<double>(0.8e-3, 1.2e-3)(random);
      const Vector way = after.cwiseQuotient(game.damping) * 5e-4 * std::abs(normal(random)) + drawn(3e-5);
      place += way;
      for (Eigen::Index i = 0; i < joints; ++i) {
        game.histories[static_cast<std::size_t>(i)].push_back({interval_s, way[i], before[i], after[i]});
      }
    }
    law.credit(motion_to(place, interval_s));
    before = after;
    after = law.bound(drawn(3));
    if (n > 0 && law.energy_J() > 1e-6) {
      const double tolerance_J = 1e-9;
      ASSERT_NEAR(law.energy_J(), game.worst_J(0 * after), tolerance_J) << n;
      const Vector direction = drawn(1e3);
      ASSERT_GE(game.worst_J(ExactLaw(law).bound(direction)), -tolerance_J) << n;
      ExactLaw bolder(law);
      bolder.receive_energy(2 * tolerance_J);
      ASSERT_LT(game.worst_J(bolder.bound(direction)), 0) << n;
      ++bounded;
    }
    law.commit(after);
  }
}

TEST(ExactLawOptimality, AllowsWhatIsSafeWhateverTheGainsAndNoMore) {
  int bounded = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    play(seed, {-0.1, 0.15}, bounded);
    play(seed, {}, bounded);
  }
  EXPECT_GT(bounded, 200);
}

}  // namespace
}  // namespace forcebound::control
