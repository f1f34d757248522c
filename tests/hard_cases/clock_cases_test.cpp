// Case 4: a clock that stands still, runs back, jumps or has invalid readings, for every law.

#include <gtest/gtest.h>

#include <cmath>

#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/hard_cases/bounding_laws.hpp"
#include "tests/support/ideal_device.hpp"
#include "tests/support/published_law_checks.hpp"
#include "tests/support/special_numbers.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound {
namespace {

using control::Matrix;
using control::Vector;
using test::kInfinity;
using test::kNaN;
using test::kPeriod_s;
using test::LawLoop;

// What no clock can have measured.
constexpr std::array kImpossible{0.0,   -0.0,    -1e-300, 5e-324, 1e-320,    1e-300,     9e-10,
                                 -1e-3, -3600.0, 1e7,     1e300,  kInfinity, -kInfinity, kNaN};

class HardCase04 : public testing::TestWithParam<std::string> {};

TEST_P(HardCase04, AnIntervalThatNoClockMeasuredEarnsNothing) {
  for (const double interval_s : kImpossible) {
    SCOPED_TRACE(interval_s);
    LawLoop loop(GetParam(), Matrix::Constant(1, 1, 30));
    for (int i = 0; i < 10; ++i) loop.tick(1e-4 * (i % 2), 0.1);
    const double before_J = loop.energy_J();
    ASSERT_GT(before_J, 0.0);
    loop.set_interval(interval_s);
    for (int i = 0; i < 10; ++i) {
      // Ten metres, which would be a fortune.
      const double force_N = loop.tick(i % 2 == 0 ? 10.0 : 0.0, 5);
      ASSERT_LE(loop.energy_J(), before_J);
      ASSERT_EQ(loop.counts().intervals_impossible, static_cast<std::uint64_t>(i) + 1);
      ASSERT_LE(force_N * force_N, 4 * before_J * 30 / kPeriod_s * (1 + 1e-12)) << "more than was saved before";
    }
    loop.set_interval(kPeriod_s);
    for (int i = 0; i < 100; ++i) loop.tick(1e-4 * (i % 2), 0);
    EXPECT_EQ(loop.tick(0, 0.5), 0.5) << "did not recover";
  }
}

TEST_P(HardCase04, AShortOrLongIntervalEarnsAtMostWhatAMotionInATenthOfAPeriodDissipates) {
  for (const double interval_s : {1e-9, 1e-4, 0.1, 10.0, 3600.0, 1e6}) {
    SCOPED_TRACE(interval_s);
    LawLoop loop(GetParam(), Matrix::Constant(1, 1, 30));
    for (int i = 0; i < 10; ++i) loop.tick(1e-4 * (i % 2), 0.1);
    const double before_J = loop.energy_J();
    loop.set_interval(interval_s);
    const double force_N = loop.tick(1e-3, 5);
    EXPECT_TRUE(std::isfinite(force_N));
    EXPECT_LE(loop.energy_J(), before_J + 30 / (0.1 * kPeriod_s) * 1e-6 + 5 * 1e-3);
    EXPECT_TRUE(std::isfinite(loop.energy_J()));
  }
}

TEST_P(HardCase04, ALostReadingAfterAnyIntervalLeavesTheLedgerANumber) {
  for (const double lost_s : {0.0, -1.0, 1e-320, 1e-300, 1e-9, 10.0, 1e6, 1e300, 1e308, kInfinity, kNaN}) {
    SCOPED_TRACE(lost_s);
    LawLoop loop(GetParam(), Matrix::Constant(1, 1, 30));
    for (int i = 0; i < 10; ++i) loop.tick(1e-3 * (i % 2), 1);
    const double before_J = loop.energy_J();
    loop.set_interval(lost_s);
    EXPECT_EQ(loop.tick(kNaN, 1), 0);
    EXPECT_LE(loop.energy_J(), before_J);
    EXPECT_TRUE(std::isfinite(loop.energy_J()));
    loop.set_interval(kPeriod_s);
    EXPECT_EQ(loop.tick(kNaN, 1), 0);
    EXPECT_TRUE(std::isfinite(loop.energy_J()));
  }
}

// The device moves in true time, a period per tick; now and then the clock is wrong.
TEST_P(HardCase04, IsPassiveHoweverOftenTheClockSaysWhatItCannotHaveMeasured) {
  for (const int degrees_of_freedom : {1, 3}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Matrix damping = test::full_damping(degrees_of_freedom, seed);
      LawLoop loop(GetParam(), damping);
      std::size_t tick = 0;
      const test::Extraction result =
          test::play({.seed = seed,
                      .degrees_of_freedom = degrees_of_freedom,
                      .dampings = [&](int) { return damping; },
                      .law =
                          [&](const Vector& position, const Vector& request, const Matrix&) {
                            const bool lies = ++tick % 5 == 0 || tick % 97 < 4;
                            loop.set_interval(lies ? kImpossible[tick / 5 % kImpossible.size()] : kPeriod_s);
                            return loop.tick(position, request);
                          }});
      EXPECT_GT(result.turnover_J, 1e-3L) << "nothing happened";
      EXPECT_GE(result.least_J, -1e-13L * result.turnover_J) << degrees_of_freedom << " axes, seed " << seed;
    }
  }
}

//   press at the wall -- session ==( 1 ms each way )== server; the client's clock: the same tick again and again, back
//   by half a second, ahead by an hour
TEST_P(HardCase04, ASessionWhoseClockStandsRunsBackAndJumpsAnHourStaysPassive) {
  using namespace std::chrono_literals;
  device::DeviceDescription device = device::load_device("wall-1dof");
  device.facts.encoder_step.setZero();
  const auto delay = netem::parse_netem("delay 1ms");
  sim::ClosedLoop loop({.device = device,
                        .hand = "press",
                        .law = GetParam(),
                        .scene = server::load_scene("wall"),
                        .network = {.up = delay, .down = delay, .trace = {}, .seed = 4}});
  loop.run(2s);
  for (const auto jump : {-1ms, -1ms, -500ms, 3'600'000ms}) {
    SCOPED_TRACE(jump.count());
    loop.stall(jump);
    loop.run(3s);
    EXPECT_EQ(loop.session().state(), client::SessionState::active);
    EXPECT_TRUE(std::isfinite(loop.session().law().energy_J()));
    EXPECT_GE(loop.device().audit()->minimum_J, -1e-9);
  }
  EXPECT_GE(loop.totals().impossible_intervals, 2U) << "and so is a clock that stands or runs back";
  EXPECT_GE(loop.totals().released_by_device, 1U) << "the hour is counted in the summary";
  EXPECT_EQ(loop.device().counters().gaps_cut, 1U);
}

INSTANTIATE_TEST_SUITE_P(Laws, HardCase04, testing::ValuesIn(test::bounding_laws()), test::name_of_law);

}  // namespace
}  // namespace forcebound
