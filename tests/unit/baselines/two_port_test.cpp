#include "forcebound/baselines/two_port.hpp"
#include "forcebound/baselines/baselines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/two_port_loop.hpp"

namespace forcebound::baselines {
namespace {

using test::TwoPortLoop;

TEST(RemoteSum, CountsTheLargestReceivedOnceInAnyOrder) {
  RemoteSum sum;
  sum.begin_at_zero();
  double total = 0;
  for (const double heard : {1.0, 3.0, 2.0, 3.0, 1.0, 3.5, 0.0, -4.0}) total += sum.receive(heard);
  EXPECT_EQ(total, 3.5);
}

TEST(RemoteSum, TakesTheFirstReceivedAsItsStart) {
  RemoteSum sum;
  EXPECT_EQ(sum.receive(100), 0);
  EXPECT_EQ(sum.receive(101), 1);
  EXPECT_EQ(sum.receive(99), 0);
}

TEST(RemoteSum, StaysANumber) {
  RemoteSum sum;
  constexpr double kMost = std::numeric_limits<double>::max();
  (void)sum.receive(-kMost);
  EXPECT_EQ(sum.receive(kMost), kMost);
}

/// Checks for every law with a server-side law.
class TwoPortLaws : public testing::TestWithParam<std::string> {};

TEST_P(TwoPortLaws, AreAskedForByTheirNameAtTheServer) {
  const auto law = shipped_laws().make(GetParam(), test::ideal_device(2));
  EXPECT_EQ(law->name(), GetParam());
  EXPECT_EQ(law->server_law(), GetParam());
  EXPECT_NE(shipped_laws().make_server_side(GetParam(), 2), nullptr);
}

TEST_P(TwoPortLaws, GainNothingFromWhatComesTwiceOrLate) {
  TwoPortLoop loop(GetParam(), {}, test::nothing_there());
  for (int i = 0; i < 3; ++i) loop.step(0, 0);
  const Vector rest = Vector::Zero(1);
  const double before_J = loop.energy_J();
  loop.bounder().receive(test::saying(2e-3, rest));
  EXPECT_NEAR(loop.energy_J() - before_J, 2e-3, 1e-15);
  const double once_J = loop.energy_J();
  for (const double sum_J : {2e-3, 1e-3, 0.0, 2e-3, -1.0}) loop.bounder().receive(test::saying(sum_J, rest));
  EXPECT_EQ(loop.energy_J(), once_J);
  loop.bounder().receive(test::saying(2.5e-3, rest));
  EXPECT_NEAR(loop.energy_J() - before_J, 2.5e-3, 1e-15) << "the lost energy comes with the next message";
}

TEST_P(TwoPortLaws, GainNothingAgainFromAServerThatRestarted) {
  TwoPortLoop loop(GetParam(), {}, test::nothing_there());
  for (int i = 0; i < 3; ++i) loop.step(0, 0);
  loop.bounder().receive(test::saying(2e-3, Vector::Zero(1)));
  const double before_J = loop.energy_J();
  loop.bounder().begin_server_side();
  EXPECT_EQ(loop.energy_J(), before_J);
  loop.bounder().receive(test::saying(0, Vector::Zero(1)));
  EXPECT_EQ(loop.energy_J(), before_J);
  loop.bounder().receive(test::saying(1e-3, Vector::Zero(1)));
  EXPECT_NEAR(loop.energy_J() - before_J, 1e-3, 1e-15) << "the new server's energy counts from zero";
}

TEST_P(TwoPortLaws, HaveAServerSideLawThatGivesNothingForWhatCameBeforeItBegan) {
  const auto server_side = shipped_laws().make_server_side(GetParam(), 1);
  const Vector x = Vector::Zero(1);
  control::ServerLawNumbers numbers = control::ServerLawNumbers::Constant(6, 1e3);
  for (int i = 0; i < 5; ++i) {
    (void)server_side->place({.position = x, .numbers = numbers, .interval_s = i > 0 ? 1e-3 : 0});
    const auto reply = server_side->answer(Vector::Zero(1));
    if (reply.numbers.rows() > 0) {
      EXPECT_EQ(reply.numbers[0], 0) << i;
    }
  }
}

TEST_P(TwoPortLaws, StayFiniteAndWithinTheLargestForceForHardNumbers) {
  constexpr double kMost = std::numeric_limits<double>::max();
  const std::vector<double> hard{0.0, kMost, -kMost, 1e300, -1e-300, 5e-324, 1e150, 1.0, -1e-3};
  std::mt19937_64 random(9);
  const auto any = [&] { return hard[random() % hard.size()]; };
  const auto server_side = shipped_laws().make_server_side(GetParam(), 3);
  TwoPortLoop loop(GetParam(), {.degrees_of_freedom = 3}, test::nothing_there());
  const auto finite_place = [](const Vector& place) { return place.rows() == 3 && place.allFinite(); };
  for (int i = 0; i < 20'000; ++i) {
    const Vector x = i % 3 == 0 ? Vector(Vector::Constant(3, 1e-3 * static_cast<double>(random() % 10)))
                                : Vector(Vector::NullaryExpr(3, any));
    const control::ServerLawNumbers numbers =
        control::ServerLawNumbers::NullaryExpr(static_cast<Eigen::Index>(random() % 17), any);
    ASSERT_TRUE(finite_place(server_side->place({.position = x, .numbers = numbers, .interval_s = std::abs(any())})));
    const auto reply = server_side->answer(Vector::NullaryExpr(3, any));
    ASSERT_TRUE(reply.force.allFinite() && reply.numbers.allFinite()) << i << ": " << reply.numbers.transpose();
    loop.bounder().receive(numbers);
    const Vector force = loop.step(x, Vector::NullaryExpr(3, any));
    ASSERT_TRUE(force.allFinite()) << i;
    ASSERT_LE(force.norm(), 30 * (1 + 1e-12)) << i;
    ASSERT_TRUE(std::isfinite(loop.energy_J())) << i;
    ASSERT_TRUE(loop.law().outgoing().allFinite()) << i;
  }
}

TEST_P(TwoPortLaws, GiveNoForceForALostReadingAndGoOnAfterwards) {
  TwoPortLoop loop(GetParam(), {}, test::wall_of(2000));
  for (int i = 0; i < 300; ++i) loop.tick(1e-5 * i);
  EXPECT_EQ(loop.step(std::nan(""), -5), 0);
  const double after_J = loop.energy_J();
  EXPECT_TRUE(std::isfinite(after_J));
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(std::isfinite(loop.tick(3e-3 + 1e-5 * i)));
  EXPECT_NE(loop.tick(6e-3), 0);
}

TEST_P(TwoPortLaws, DoNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  TwoPortLoop loop(GetParam(), {.degrees_of_freedom = 3}, test::nothing_there());
  const auto server_side = shipped_laws().make_server_side(GetParam(), 3);
  const test::AllocationGuard guard;
  double felt_N = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector x = Vector::Constant(3, 1e-5 * (i % 100));
    (void)server_side->place({.position = x, .numbers = loop.law().outgoing(), .interval_s = 1e-3});
    const auto reply = server_side->answer(-2000 * x);
    loop.bounder().receive(reply.numbers);
    felt_N += loop.step(x, reply.force).norm();
    if (i == 500) loop.bounder().begin_server_side();
    if (i % 100 == 99) (void)loop.step(Vector::Constant(3, std::nan("")), reply.force);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_GT(felt_N, 1);
}

TEST_P(TwoPortLaws, MakeContactWithAWallNearAndFar) {
  for (const std::size_t delay_ticks : {0U, 50U}) {
    SCOPED_TRACE(delay_ticks);
    TwoPortLoop loop(GetParam(), {.delay_ticks = delay_ticks}, test::wall_of(2000));
    double least_N = 0;
    for (int i = 0; i < 3000; ++i) {
      const double force_N = loop.tick(5e-3 * std::sin(2e-3 * i) - 1e-3);
      ASSERT_TRUE(std::isfinite(force_N));
      least_N = std::min(least_N, force_N);
    }
    EXPECT_LT(least_N, -0.5) << "a wall of 2 N/mm, 4 mm deep";
  }
}

INSTANTIATE_TEST_SUITE_P(All, TwoPortLaws, testing::Values("pspm", "tdpa-2port", "tdpa-er", "tla", "wave"),
                         [](const auto& law) {
                           std::string name = law.param;
                           std::erase(name, '-');
                           return name;
                         });

/// Those with one gain for all axes and poses.
class ConstantGainLaws : public testing::TestWithParam<std::string> {};

TEST_P(ConstantGainLaws, RefuseADeviceWhoseDampingDependsOnItsPose) {
  control::DeviceFacts arm = test::ideal_device(3);
  arm.cartesian = false;
  EXPECT_THAT(
      shipped_laws().refusal(GetParam(), arm),
      testing::HasSubstr("law '" + GetParam() + "' has one gain for all axes and poses, but device 'ideal' is an arm"));
  EXPECT_THAT(shipped_laws().refusal(GetParam(), test::ideal_device(6)),
              testing::HasSubstr("6 degrees of freedom, 1 to 3"));
}

INSTANTIATE_TEST_SUITE_P(All, ConstantGainLaws, testing::Values("iss", "pspm", "tla", "wave"));

}  // namespace
}  // namespace forcebound::baselines
