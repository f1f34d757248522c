#include "tests/support/drawn_games.hpp"

#include <random>
#include <vector>

namespace forcebound::test {
namespace {

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed * 7919) {}
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double one_of(std::vector<double> values) {
    return values[std::uniform_int_distribution<std::size_t>(0, values.size() - 1)(random_)];
  }

 private:
  std::mt19937_64 random_;
};

}  // namespace

KinematicGame game_of_exact_facts(std::uint64_t seed) {
  Draw draw(seed);
  const auto dof = static_cast<Eigen::Index>(draw.one_of({1, 1, 2, 3, 6}));
  KinematicGame game{.seed = seed};
  control::DeviceFacts& facts = game.facts;
  facts.name = "game";
  facts.damping = control::Vector::NullaryExpr(dof, [&](Eigen::Index) { return draw.number(0.5, 30); }).asDiagonal();
  if (dof > 1 && draw.number(0, 1) < 0.3) {
    const control::Matrix mix =
        control::Matrix::NullaryExpr(dof, dof, [&](Eigen::Index, Eigen::Index) { return draw.number(-1, 1); });
    facts.damping += mix * mix.transpose();
  }
  facts.friction = control::Vector::Constant(dof, draw.one_of({0, 0, 0.05, 0.5}));
  facts.encoder_step = control::Vector::Constant(dof, draw.one_of({0, 15e-6, 55e-6}));
  facts.force_N_max = draw.one_of({3, 30});
  facts.latency_s = draw.one_of({0, 20e-6, 100e-6, 300e-6, 2.5e-3});
  facts.hold_s_max = draw.one_of({1e-3, 2e-3, 5e-3});
  facts.release_share = draw.one_of({0, 0.3});
  facts.release_s = draw.one_of({0, 2e-3});
  game.late_ticks = draw.one_of({0, 1}) > 0;
  game.turning = draw.one_of({0, 0, 1}) > 0;
  return game;
}

DeviceTruth truth_beyond_facts(std::uint64_t seed) {
  Draw draw(~seed);
  DeviceTruth truth;
  truth.stamp_s = {-draw.one_of({0, 5e-6, 30e-6, 125e-6}), draw.one_of({0, 5e-6, 30e-6})};
  truth.latency_s = {0, draw.one_of({0, 20e-6, 100e-6, 1e-3})};
  truth.hold_s = {-draw.one_of({0, 5e-5, 2e-4}), draw.one_of({0, 5e-5, 2e-4})};
  truth.early_release_share = draw.one_of({0, 0, 0.5});
  truth.clock_share = draw.one_of({0, 5e-4, 1e-2});
  truth.encoder_steps = draw.one_of({0, 0.1, 0.5, 1});
  truth.damping_share = draw.one_of({0, 0.01, 0.3});
  truth.friction_share = draw.one_of({0, 0.2, 0.9});
  truth.torque_ripple_share = draw.one_of({0, 0.01, 0.1});
  truth.actuator_lag_s = draw.one_of({0, 0, 1e-4, 1e-3});
  truth.failed_writes = draw.one_of({0, 0, 0.1});
  truth.failures_reported = true;
  truth.impossible_intervals = draw.one_of({0, 0, 0.1});
  truth.effects_reported = draw.one_of({0, 0, 1}) > 0;
  truth.releases_reported = draw.one_of({0, 1}) > 0;
  truth.latency_offset_s = {0, draw.one_of({0, 0, 50e-6, 300e-6})};
  truth.torque_gain_share = {-draw.one_of({0, 0, 0.03, 0.1}), draw.one_of({0, 0, 0.03, 0.1})};
  truth.losses_with_gain = draw.one_of({0, 1}) > 0;
  return truth;
}

}  // namespace forcebound::test
