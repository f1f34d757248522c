// fba-exact against an opponent that plays hand, environment, clock and transport at once, and knows the true position.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "forcebound/control/exact_law.hpp"
#include "forcebound/control/less_conservative_law.hpp"
#include "tests/support/ideal_device.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::control {
namespace {

using test::kInfinity;
using test::kPeriod_s;

/// What is drawn once for a game.
struct Game {
  DeviceFacts facts;
  EnergyMemory memory = EnergyMemory::capped;
  bool late_ticks = false;
  bool turning = false;  ///< the Jacobian changes from tick to tick, now and then through singular ones
};

class Opponent {
 public:
  Opponent(std::uint64_t seed, const Game& game)
      : random_(seed),
        game_(game),
        dof_(game.facts.damping.rows()),
        damping_(Damping::from_matrix(game.facts.damping)),
        joint_(Vector::Zero(dof_)),
        acting_(Vector::Zero(dof_)) {}

  /// The least P(t) [J] that it could bring about.
  long double play(PassivityLaw& law, int ticks) {
    law.credit(motion());
    command(law);
    for (int n = 1; n < ticks; ++n) {
      const double interval_s = next_interval_s();
      live(interval_s);
      law.credit(motion(interval_s));
      command(law);
    }
    return least_J_;
  }

 private:
  struct Command {
    double effect_s = 0;  // from the latest reading on
    Vector torque;
  };

  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  bool sometimes(double share) { return number(0, 1) < share; }
  Vector any(double size) {
    return Vector::NullaryExpr(dof_, [&](Eigen::Index) { return number(-size, size); });
  }

  double next_interval_s() {
    if (!game_.late_ticks || sometimes(0.8)) return kPeriod_s;
    return sometimes(0.1) ? number(0.15, 1) * kPeriod_s : number(1, 6) * kPeriod_s;
  }

  Motion motion(double interval_s = 0) {
    Motion motion;
    motion.interval_s = interval_s;
    motion.latency_s = latency_s_;
    motion.held_s = released_ ? game_.facts.hold_s_max : kInfinity;
    motion.latency_s_max = game_.facts.latency_s;
    motion.joint = read_ = joint_;
    for (Eigen::Index i = 0; i < dof_; ++i) {
      const double step = game_.facts.encoder_step[i];
      if (step > 0) motion.joint[i] = step * std::round(joint_[i] / step);
    }
    motion.position = motion.joint;
    motion.jacobian = Matrix::Identity(dof_, dof_);
    if (game_.turning) {
      motion.jacobian = Matrix::NullaryExpr(dof_, dof_, [&](Eigen::Index, Eigen::Index) { return number(-1, 1); });
      if (sometimes(0.1)) motion.jacobian.col(0).setZero();
    }
    jacobian_ = motion.jacobian;
    motion.damping = &damping_;
    return motion;
  }

  void command(PassivityLaw& law) {
    if (sometimes(0.2)) request_ = any(1) * std::pow(10, number(-2, 3));
    if (sometimes(0.3)) request_ = -request_;
    const Vector request = request_.size() > 0 ? request_ : any(10);
    const double size = request.norm();
    const Vector force =
        law.bound(size > game_.facts.force_N_max ? request * (game_.facts.force_N_max / size) : request);
    law.commit(force);
    latency_s_ = game_.facts.latency_s * (sometimes(0.5) ? 1 : number(0, 1));
    if (!commands_.empty()) latency_s_ = std::max(latency_s_, commands_.back().effect_s);
    commands_.push_back({latency_s_, jacobian_.transpose() * force});
  }

  /// Moves the device through the forces of an interval, at constant velocity through each of them.
  void live(double interval_s) {
    double now_s = 0;
    while (now_s < interval_s) {
      double next_s = interval_s;
      if (!commands_.empty()) next_s = std::min(next_s, commands_.front().effect_s);
      if (held_s_ < game_.facts.hold_s_max) next_s = std::min(next_s, now_s + game_.facts.hold_s_max - held_s_);
      if (next_s > now_s) move(next_s - now_s);
      held_s_ += next_s - now_s;
      now_s = next_s;
      if (held_s_ >= game_.facts.hold_s_max * (1 - 1e-12)) release();
      if (!commands_.empty() && commands_.front().effect_s <= now_s) take_effect();
    }
    for (Command& waiting : commands_) waiting.effect_s -= interval_s;
  }

  void release() {
    acting_.setZero();
    released_ = commands_.empty();
    held_s_ = kInfinity;
  }

  void take_effect() {
    acting_ = commands_.front().torque;
    commands_.erase(commands_.begin());
    held_s_ = 0;
    released_ = false;
  }

  void move(double duration_s) {
    Vector way(dof_);
    for (Eigen::Index i = 0; i < dof_; ++i) {
      const double b = game_.facts.damping(i, i);
      const double surplus = std::max(std::abs(acting_[i]) - game_.facts.friction[i], 0.0);
      way[i] = std::copysign(surplus, acting_[i]) * duration_s / (2 * b);  // takes the most
      if (sometimes(0.15)) way[i] *= number(-1, 3);
      // Let go of: back to where the reading was, as if nothing had been taken.
      if (surplus == 0 && sometimes(0.5)) way[i] = read_[i] - joint_[i];
      if (sometimes(0.1)) way[i] = flicker(i);
      if (sometimes(0.05)) way[i] = number(-1e-4, 1e-4);
    }
    long double change_J = 0;
    change_J += damping_.dissipation(way) / duration_s;
    for (Eigen::Index i = 0; i < dof_; ++i) {
      change_J += static_cast<long double>(game_.facts.friction[i]) * std::abs(way[i]);
      change_J -= static_cast<long double>(acting_[i]) * way[i];
    }
    joint_ += way;
    energy_J_ += change_J;
    least_J_ = std::min(least_J_, energy_J_);
  }

  /// Just over the nearest edge between two counts: the shortest way to what reads as a whole step.
  double flicker(Eigen::Index i) {
    const double step = game_.facts.encoder_step[i];
    if (step == 0) return 0;
    const double edge = (std::floor(joint_[i] / step) + 0.5) * step;
    return edge - joint_[i] + (sometimes(0.5) ? 1e-9 : -1e-9);
  }

  std::mt19937_64 random_;
  Game game_;
  Eigen::Index dof_;
  Damping damping_;
  Vector joint_;
  Vector read_;  ///< where it was at the reading
  Vector acting_;
  Vector request_;
  Matrix jacobian_;
  std::vector<Command> commands_;
  double held_s_ = kInfinity;
  double latency_s_ = 0;
  bool released_ = false;
  long double energy_J_ = 0;
  long double least_J_ = 0;
};

Game game(std::uint64_t seed) {
  std::mt19937_64 random(seed * 7919);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto one_of = [&](std::vector<double> values) {
    return values[std::uniform_int_distribution<std::size_t>(0, values.size() - 1)(random)];
  };
  const auto dof = static_cast<Eigen::Index>(one_of({1, 1, 2, 3, 6}));
  Game game;
  DeviceFacts& facts = game.facts;
  facts.name = "game";
  facts.damping = Vector::NullaryExpr(dof, [&](Eigen::Index) { return number(0.5, 30); }).asDiagonal();
  if (dof > 1 && number(0, 1) < 0.3) {
    const Matrix mix = Matrix::NullaryExpr(dof, dof, [&](Eigen::Index, Eigen::Index) { return number(-1, 1); });
    facts.damping += mix * mix.transpose();
  }
  facts.friction = Vector::Constant(dof, one_of({0, 0, 0.05, 0.5}));
  facts.encoder_step = Vector::Constant(dof, one_of({0, 15e-6, 55e-6}));
  facts.force_N_max = one_of({3, 30});
  facts.latency_s = one_of({0, 20e-6, 100e-6, 300e-6, 2.5e-3});
  facts.hold_s_max = one_of({1e-3, 2e-3, 5e-3});
  game.memory = one_of({0, 1}) > 0 ? EnergyMemory::full : EnergyMemory::capped;
  game.late_ticks = one_of({0, 1}) > 0;
  game.turning = one_of({0, 0, 1}) > 0;
  return game;
}

TEST(ExactLaw, IsPassiveAgainstAnyHandEnvironmentClockAndTransport) {
  long double worst_of_published_J = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    const Game drawn = game(seed);
    ExactLaw law(drawn.facts, drawn.memory);
    ASSERT_GE(static_cast<double>(Opponent(seed, drawn).play(law, 2000)), -1e-12);

    if (drawn.turning) continue;  // published laws know no joints
    LessConservativeLaw published(static_cast<int>(drawn.facts.damping.rows()), kPeriod_s);
    worst_of_published_J = std::min(worst_of_published_J, Opponent(seed, drawn).play(published, 2000));
  }
  EXPECT_LT(static_cast<double>(worst_of_published_J), -0.1) << "the opponent is too weak to prove anything";
}

}  // namespace
}  // namespace forcebound::control
