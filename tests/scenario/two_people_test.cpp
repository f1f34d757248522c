#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "forcebound/server/environment/body_models.hpp"
#include "tests/tools/lab/rendering/two_people.hpp"
#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/sim/firm_device.hpp"
#include "tests/tools/sim/shared_loop.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

constexpr double kHandStiffness_N_per_m = 1000;

/// What one person feels along x.
class Feeling final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    if (tick.applied.rows() != 3) return;
    impulse_Ns += 1e-3 * tick.applied[0];
    pushed_Ns += 1e-3 * std::abs(tick.applied[0]);
    deviation_m = tick.model_deviation_m;
    most_deviation_m = std::max(most_deviation_m, deviation_m);
    if (tick.model.rows() == 3) ++modelled;
    if (tick.time < kRest) return;
    rest_N_ += tick.applied[0];
    ++rests_;
  }
  void on_force(const record::ForceRecord& record) noexcept override {
    by_device_clock = record.force.answer.model.empty() || record.force.answer.model.by_device_clock;
    before_reading = record.force.answer.model.before_reading;
  }

  [[nodiscard]] double at_rest_N() const { return rest_N_ / rests_; }

  static constexpr Nanoseconds kRest = 8s;
  double impulse_Ns = 0;
  double pushed_Ns = 0;
  double deviation_m = 0;
  double most_deviation_m = 0;
  int modelled = 0;
  bool by_device_clock = false;
  Nanoseconds before_reading{0};

 private:
  double rest_N_ = 0;
  int rests_ = 0;
};

SharedLoop::Person person(const std::string& netem, const lab::HandleMotion& motion, Feeling& feeling,
                          std::uint64_t seed = 1) {
  const netem::NetemParameters way = netem::parse_netem(netem);
  return {.device = firm_device(),
          .make_hand = lab::handle_hand(motion),
          .network = {.up = way, .down = way, .trace = {}, .seed = seed},
          .renders_locally = true,
          .sink = &feeling};
}

double least_J(const SharedLoop& loop, std::size_t person) { return loop.device(person).audit().value().minimum_J; }

class TwoPeopleOnOneBlock : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!server::has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  }

  Feeling left;
  Feeling right;
};

//   left hand, 5 mm to the right -- client ==( 10 ms )==+
//   right hand, 5 mm to the left -- client ==( 80 ms )==+== server, block
TEST_F(TwoPeopleOnOneBlock, FeelEachOtherAsMuchAtDifferentDelays) {
  SharedLoop loop({.scene = lab::block_with_two_handles(),
                   .law = "fba-exact",
                   .people = {person("delay 5ms", {.at_m = -0.02, .by_m = 0.005}, left),
                              person("delay 40ms", {.at_m = 0.02, .by_m = -0.005}, right)}});
  loop.run(10s);
  // Two hands and two couplings in series.
  const double push_N = 0.01 / (2 / kHandStiffness_N_per_m + 2 / lab::kHandleStiffness_N_per_m);
  EXPECT_NEAR(left.at_rest_N(), -push_N, 0.15 * push_N);
  EXPECT_NEAR(right.at_rest_N(), push_N, 0.15 * push_N);
  // The block is at rest in the beginning and in the end.
  EXPECT_LT(std::abs(left.impulse_Ns + right.impulse_Ns), 0.1 * (left.pushed_Ns + right.pushed_Ns));
  for (const Feeling* one : {&left, &right}) {
    EXPECT_GT(one->modelled, 8000);
    EXPECT_TRUE(one->by_device_clock);
    EXPECT_GT(one->before_reading, 0ms);
    EXPECT_LE(one->before_reading, 5ms) << "networks without jitter";
    EXPECT_LT(one->deviation_m, 1e-6) << "at rest a model foretells where it is";
  }
  EXPECT_GE(least_J(loop, 0), -1e-9);
  EXPECT_GE(least_J(loop, 1), -1e-9);
}

//   left hand, 10 mm to the right --- client ==( 10 ms )==+
//   right hand, stays --------------- client ==( 80 ms )==+== server, block
//
// A device that dissipates nothing at rest may return no energy: a hand at rest that has put none in feels no more than
// its own device's damping answers for, whoever pushes at the other side.
TEST_F(TwoPeopleOnOneBlock, PushesNobodyWithEnergyThatTheirDeviceCannotDissipate) {
  SharedLoop loop({.scene = lab::block_with_two_handles(),
                   .law = "fba-exact",
                   .people = {person("delay 5ms", {.at_m = -0.02, .by_m = 0.01}, left),
                              person("delay 40ms", {.at_m = 0.02}, right)}});
  loop.run(10s);
  EXPECT_LT(left.at_rest_N(), -1.5) << "who moved feels the other";
  EXPECT_LT(std::abs(right.at_rest_N()), 0.1);
  EXPECT_GE(least_J(loop, 0), -1e-9);
  EXPECT_GE(least_J(loop, 1), -1e-9);
}

//   to and fro at 2 Hz ----- client ==( 10 ms, jitter, loss )==+
//   to and fro at 1.3 Hz --- client ==( 80 ms, jitter, loss )==+== server, block
TEST_F(TwoPeopleOnOneBlock, GetNoEnergyFromNowhereWhenBothMove) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    Feeling near;
    Feeling far;
    SharedLoop loop({.scene = lab::block_with_two_handles(),
                     .law = "fba-exact",
                     .people = {person("delay 5ms 1ms loss 1%", {.at_m = -0.02, .amplitude_m = 0.01, .frequency_Hz = 2},
                                       near, seed),
                                person("delay 40ms 8ms loss 5%",
                                       {.at_m = 0.02, .amplitude_m = 0.01, .frequency_Hz = 1.3}, far, seed + 100)},
                     .seed = seed});
    loop.run(10s);
    EXPECT_GE(least_J(loop, 0), -1e-9);
    EXPECT_GE(least_J(loop, 1), -1e-9);
    for (const Feeling* one : {&near, &far}) {
      EXPECT_GT(one->modelled, 1000) << "where it foretells better than holding does";
      EXPECT_GT(one->most_deviation_m, 0) << "neither knows what the other does before it is told";
      EXPECT_LE(one->most_deviation_m, 0.02);
      EXPECT_GT(one->pushed_Ns, 1);
    }
  }
}

//   to and fro at 2 Hz ------------------- client ==( 10 ms )==========+
//   to and fro at 1 Hz, dead from 5 to 7 s - client ==( 80 ms, dead )==+== server, block
TEST_F(TwoPeopleOnOneBlock, StayPassiveWhenTheNetworkOfOneDies) {
  SharedLoop loop({.scene = lab::block_with_two_handles(),
                   .law = "fba-exact",
                   .people = {person("delay 5ms", {.at_m = -0.02, .amplitude_m = 0.01, .frequency_Hz = 2}, left),
                              person("delay 40ms", {.at_m = 0.02, .amplitude_m = 0.02}, right)}});
  loop.run(5s);
  for (const netem::Direction way : {netem::Direction::up, netem::Direction::down})
    loop.network(1).set_blackhole(way, true);
  loop.run(2s);
  for (const netem::Direction way : {netem::Direction::up, netem::Direction::down})
    loop.network(1).set_blackhole(way, false);
  loop.run(3s);
  EXPECT_EQ(loop.session(0).state(), client::SessionState::active);
  EXPECT_EQ(loop.session(1).state(), client::SessionState::active);
  EXPECT_GT(left.modelled, 8500) << "the other's network is none of its business";
  EXPECT_GE(least_J(loop, 0), -1e-9);
  EXPECT_GE(least_J(loop, 1), -1e-9);
}

TEST_F(TwoPeopleOnOneBlock, AreTheSameForTheSameSeed) {
  const auto run = [] {
    Feeling near;
    Feeling far;
    SharedLoop loop({.scene = lab::block_with_two_handles(),
                     .law = "fba-exact",
                     .people = {person("delay 5ms 1ms loss 5%", {.at_m = -0.02, .amplitude_m = 0.01}, near),
                                person("delay 20ms 5ms loss 5%", {.at_m = 0.02}, far)}});
    loop.run(4s);
    return std::tuple(near.impulse_Ns, far.impulse_Ns, near.most_deviation_m, far.most_deviation_m);
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace forcebound::sim
