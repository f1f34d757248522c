#include "forcebound/control/exact_law.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "forcebound/control/force_bounder.hpp"
#include "forcebound/control/less_conservative_law.hpp"
#include "tests/support/ideal_device.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::control {
namespace {

using test::kInfinity;
using test::kPeriod_s;

/// The published laws' world: ideal encoder, no friction, no latency, held for the period.
DeviceFacts ideal(const Vector& damping) {
  DeviceFacts facts;
  facts.name = "test";
  facts.damping = damping.asDiagonal();
  facts.friction = facts.encoder_step = facts.actuator_step = Vector::Zero(damping.rows());
  facts.force_N_max = kInfinity;
  facts.hold_s_max = kPeriod_s;
  return facts;
}

Vector vector(std::initializer_list<double> values) {
  Vector result(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), result.data());
  return result;
}

Motion motion_to(const Vector& position, const Damping* damping = nullptr, double interval_s = kPeriod_s) {
  Motion motion;
  motion.interval_s = interval_s;
  motion.position = motion.joint = position;
  motion.jacobian = Matrix::Identity(position.rows(), position.rows());
  motion.damping = damping;
  return motion;
}

TEST(ExactLaw, IsLessConservativeLawOnAnIdealDevice) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const int dof = 1 + static_cast<int>(seed % 6);
    const Vector b = Vector::NullaryExpr(dof, [&](Eigen::Index) { return std::exp(normal(random)) * 10; });
    const Damping damping = Damping::from_matrix(b.asDiagonal());
    ExactLaw exact(ideal(b), EnergyMemory::full);
    LessConservativeLaw less(dof, kPeriod_s);
    Vector position = Vector::Zero(dof);
    Vector less_force = Vector::Zero(dof);
    int bounded = 0;
    for (int n = 0; n < 3000; ++n) {
      // Mostly the motion that takes the most out of the force.
      position += Vector::NullaryExpr(dof, [&](Eigen::Index) { return 2e-5 * normal(random); });
      if (n % 3 > 0) position += kPeriod_s / 2 * less_force.cwiseQuotient(b);
      const Vector request = Vector::NullaryExpr(dof, [&](Eigen::Index) { return 8 * normal(random); });
      exact.credit(motion_to(position, &damping));
      less.credit(motion_to(position, &damping));
      const Vector expected = less.bound(request);
      const Vector force = exact.bound(request);
      ASSERT_NEAR(exact.energy_J(), less.energy_J(), 1e-9 * (1 + std::abs(less.energy_J()))) << n;
      // The root of next to nothing magnifies rounding.
      const double tolerance = less.energy_J() > 1e-10 ? 1e-9 : 1e-6;
      ASSERT_LE((force - expected).norm(), tolerance * (1 + expected.norm())) << n;
      bounded += expected.norm() < 0.99 * request.norm();
      exact.commit(expected);
      less.commit(expected);
      less_force = expected;
    }
    EXPECT_GT(bounded, 100);
  }
}

TEST(ExactLaw, AllowsExactlyTheFrictionAtRest) {
  DeviceFacts facts = ideal(vector({30}));
  facts.friction = vector({0.75});
  facts.encoder_step = vector({15e-6});
  ExactLaw law(facts);
  for (int n = 0; n < 1000; ++n) {
    law.credit(motion_to(vector({0.0123})));
    const Vector force = law.bound(vector({n % 2 == 0 ? -5.0 : 5.0}));
    EXPECT_EQ(std::abs(force[0]), 0.75);
    law.commit(force);
  }
  EXPECT_EQ(law.energy_J(), 0);
}

TEST(ExactLaw, HoldsWithEveryJointsFrictionInTheDirectionAskedFor) {
  DeviceFacts facts = ideal(vector({10, 20, 5}));
  facts.friction = vector({0.3, 0.1, 0.2});
  ExactLaw law(facts);
  law.credit(motion_to(vector({0, 0, 0})));
  const Vector force = law.bound(vector({1, -1, 0}));
  EXPECT_DOUBLE_EQ(force[0], 0.1) << "the joint with the least gives way first";
  EXPECT_DOUBLE_EQ(force[1], -0.1);
  EXPECT_EQ(force[2], 0);
}

TEST(ExactLaw, SpendsOnAllJointsWhatFrictionDoesNotHold) {
  DeviceFacts facts = ideal(vector({10, 20}));
  facts.friction = vector({0.3, 0.1});
  ExactLaw law(facts, EnergyMemory::full);
  law.credit(motion_to(vector({0, 0})));
  law.credit(motion_to(vector({1e-4, 0})));
  const double energy_J = 10 / kPeriod_s * 1e-8 + 0.3 * 1e-4;
  EXPECT_DOUBLE_EQ(law.energy_J(), energy_J);
  const Vector u = vector({0.6, 0.8});
  const double phi = law.bound(100 * u).norm();
  const double needed_J = std::pow(0.6 * phi - 0.3, 2) * kPeriod_s / 40 + std::pow(0.8 * phi - 0.1, 2) * kPeriod_s / 80;
  EXPECT_NEAR(needed_J, energy_J, 1e-12 * energy_J);
  EXPECT_TRUE(law.allows(phi * u, 0));
  EXPECT_FALSE(law.allows(1.0001 * phi * u, 0));
}

TEST(ExactLaw, ForgetsWhatNoForceCouldNeedUnlessToldNotTo) {
  DeviceFacts facts = ideal(vector({30}));
  facts.force_N_max = 3;
  ExactLaw capped(facts);
  ExactLaw full(facts, EnergyMemory::full);
  for (int n = 0; n < 100; ++n) {
    capped.credit(motion_to(vector({1e-3 * n})));
    full.credit(motion_to(vector({1e-3 * n})));
  }
  EXPECT_NEAR(capped.energy_J(), Spending().memory_reserves * 9 * kPeriod_s / 120, 1e-12);
  EXPECT_DOUBLE_EQ(full.energy_J(), 99 * 30e3 * 1e-6);
  EXPECT_EQ(capped.bound(vector({3}))[0], 3);
}

TEST(ExactLaw, ReservesForEachStageOfTheRelease) {
  DeviceFacts facts = ideal(vector({30}));
  facts.release_share = 0.5;
  facts.release_s = 2 * kPeriod_s;
  facts.friction = vector({0.3});
  ExactLaw law(facts, EnergyMemory::full);
  law.credit(motion_to(vector({0})));
  law.credit(motion_to(vector({1e-4})));
  const double force_N = std::abs(law.bound(vector({-30}))[0]);
  const double needed_J =
      (std::pow(force_N - 0.3, 2) * kPeriod_s + std::pow(0.5 * force_N - 0.3, 2) * 2 * kPeriod_s) / 120;
  EXPECT_NEAR(needed_J, law.energy_J(), 1e-12 * needed_J);
  // Late, the device let go: then the stages are what the motion is judged by.
  law.commit(vector({-force_N}));
  law.credit(motion_to(vector({1e-4}), nullptr, 5 * kPeriod_s));
  EXPECT_GE(law.energy_J(), 0);
}

/// What is left after forces beside a motion, with a latency that is longer by up to `most_s`: by one constant, or by
/// another one each time.
double energy_with_unknown_latency_J(bool constant, double lag_s, double most_s) {
  DeviceFacts facts = ideal(vector({30}));
  facts.latency_s = 1e-4;
  facts.uncertainty.actuator_lag_s = lag_s;
  (constant ? facts.uncertainty.latency_offset_s : facts.uncertainty.latency_s) = {0, most_s};
  ExactLaw law(facts, EnergyMemory::full);
  law.receive_energy(1);
  for (int n = 0; n < 50; ++n) {
    Motion motion = motion_to(vector({1e-3 * std::sin(0.3 * n)}));
    motion.latency_s = motion.latency_s_max = facts.latency_s;
    law.credit(motion);
    law.commit(law.bound(vector({-3 * std::sin(0.7 * n)})));
  }
  return law.energy_J();
}

TEST(ExactLaw, CountsAConstantLatencyAsAnotherOneEachTime) {
  for (const double most_s : {5e-5, 5e-4}) {
    EXPECT_EQ(energy_with_unknown_latency_J(true, 0, most_s), energy_with_unknown_latency_J(false, 0, most_s));
    EXPECT_LT(energy_with_unknown_latency_J(true, 0, most_s), energy_with_unknown_latency_J(true, 0, 0));
  }
  EXPECT_EQ(energy_with_unknown_latency_J(true, 1e-4, 1e-4), energy_with_unknown_latency_J(false, 1e-4, 1e-4)) << "lag";
}

// In a singular configuration no force needs energy, but if the next write fails the last one goes on.
TEST(ExactLaw, GivesUpNothingThatTheForceInEffectCanStillTake) {
  DeviceFacts facts = ideal(vector({30}));
  facts.force_N_max = 3;
  facts.hold_s_max = 2 * kPeriod_s;
  ExactLaw law(facts);
  for (int n = 0; n < 100; ++n) law.credit(motion_to(vector({1e-3 * n})));
  ASSERT_EQ(law.bound(vector({-3}))[0], -3);
  law.commit(vector({-3}));
  Motion singular = motion_to(vector({0.1}));
  singular.jacobian.setZero();
  law.credit(singular);
  EXPECT_NEAR(law.energy_J(), 9 * facts.hold_s_max / 120, 1e-15);
}

/// The energy after a force of 1 N was held for 5 ms against a motion, with what the device reports of its release.
double energy_after_release_J(double held_s, double latency_s = 0, double latency_unknown_s = 0) {
  DeviceFacts facts = ideal(vector({30}));
  facts.uncertainty.latency_s = {0, latency_unknown_s};
  facts.hold_s_max = 2e-3;
  facts.release_share = 0.5;
  facts.release_s = 2e-3;
  facts.latency_s = latency_s;
  ExactLaw law(facts, EnergyMemory::full);
  law.credit(motion_to(vector({0})));
  law.commit(vector({-1}));
  Motion motion = motion_to(vector({1e-4}), nullptr, 5e-3);
  motion.latency_s = latency_s;
  motion.held_s = held_s;
  law.credit(motion);
  return law.energy_J();
}

TEST(ExactLaw, KnowsNotHowAReleaseGoesOnThatComesTooEarly) {
  LeastEnergy joint(30, 0);
  joint.restart({0, 0});
  double energy_J = joint.hold(-1, 0, 0.5e-3);
  energy_J += joint.hold(-0.5, 0.5, 1.5e-3);
  energy_J += joint.hold(-0.25, 0.25, 2e-3);
  energy_J += joint.hold(0, 0, 1e-3);
  energy_J += joint.read({1e-4, 1e-4}).value();
  EXPECT_NEAR(energy_after_release_J(0.5e-3), energy_J, 1e-15) << "or the report is wrong";
}

TEST(ExactLaw, KnowsNotHowAReleaseGoesOnThatMayHaveComeTooEarly) {
  // In effect from 1 ms on, released after 1.5 ms instead of 2, then gone: reported at a time that would be right for a
  // force in effect sooner.
  LeastEnergy joint(30, 0);
  joint.restart({0, 0});
  double energy_J = joint.hold(0, 0, 1e-3);
  energy_J += joint.hold(-1, 0, 1.5e-3);
  energy_J += joint.hold(0, 0, 2.5e-3);
  energy_J += joint.read({1e-4, 1e-4}).value();
  EXPECT_LE(energy_after_release_J(2.5e-3, 0, 1e-3), energy_J + 1e-15);
}

TEST(ExactLaw, TakesAReportOfAReleaseOnTimeAsTheFactsSay) {
  EXPECT_NEAR(energy_after_release_J(2e-3), energy_after_release_J(kInfinity), 1e-15);
}

TEST(ExactLaw, BelievesNoReleaseFromBeforeTheForceWasInEffect) {
  EXPECT_NEAR(energy_after_release_J(-0.5e-3, 1e-3), energy_after_release_J(kInfinity, 1e-3), 1e-15);
}

/// The energy after a way of which 1 N took a part, in effect at a time of which the device reports that it was
/// `reported_s`.
double energy_after_effect_J(double way_m, double reported_s, double latency_s) {
  DeviceFacts facts = ideal(vector({30}));
  facts.hold_s_max = 1;
  facts.latency_s = 1e-3;
  ExactLaw law(facts, EnergyMemory::full);
  law.credit(motion_to(vector({0})));
  law.commit(vector({-1}));
  Motion motion = motion_to(vector({way_m}), nullptr, 5e-3);
  motion.latency_s = latency_s;
  motion.effect_s = reported_s;
  law.credit(motion);
  return law.energy_J();
}

TEST(ExactLaw, CreditsNoMoreThanTheWorseOfAnEffectReportedOutsideTheFactsAndTheFacts) {
  for (const double way_m : {1e-4, -1e-4}) {
    SCOPED_TRACE(way_m);
    const double early_J = energy_after_effect_J(way_m, 2e-3, 2e-3);
    const double late_J = energy_after_effect_J(way_m, 3e-3, 3e-3);
    const double worse_J = std::min(early_J, late_J);
    ASSERT_GT(std::max(early_J, late_J), worse_J + 1e-5);
    EXPECT_LE(energy_after_effect_J(way_m, 3e-3, 2e-3), worse_J + 1e-15) << "reported too late";
    EXPECT_LE(energy_after_effect_J(way_m, 2e-3, 3e-3), worse_J + 1e-15) << "reported too early";
    EXPECT_NEAR(early_J, energy_after_effect_J(way_m, std::nan(""), 2e-3), 1e-15) << "reported as the facts say";
  }
}

TEST(ExactLaw, BelievesNoEffectBeforeItsCommand) {
  EXPECT_NEAR(energy_after_effect_J(-1e-4, 1e-3, 3e-3), energy_after_effect_J(-1e-4, std::nan(""), 3e-3), 1e-15);
}

TEST(ExactLaw, GivesNothingInADeficitUntilTheLagHasLetGoOfWhatFrictionDoesNotHold) {
  DeviceFacts facts = ideal(vector({30}));
  facts.friction = vector({0.5});
  facts.uncertainty.actuator_lag_s = 1e-4;
  ExactLaw law(facts);
  law.credit(motion_to(vector({0})));
  law.commit(vector({-5}));
  law.credit(motion_to(vector({0})));
  ASSERT_LT(law.energy_J(), 0) << "more than was allowed";
  EXPECT_EQ(law.bound(vector({-1}))[0], 0);
  EXPECT_FALSE(law.allows(vector({-0.1}), 0));
  for (int n = 0; n < 3; ++n) {
    law.commit(vector({0}));
    law.credit(motion_to(vector({0})));
  }
  ASSERT_LT(law.energy_J(), 0);
  EXPECT_TRUE(law.allows(vector({-0.5}), 0));
  EXPECT_FALSE(law.allows(vector({-0.51}), 0));
}

TEST(ExactLaw, LetsTheShareOfTheRequestThatIsShownRiseByDegrees) {
  ExactLaw law(ideal(vector({30})), EnergyMemory::capped, {.memory_reserves = 1e9, .rise_per_s = 100});
  law.credit(motion_to(vector({0})));
  EXPECT_EQ(law.bound(vector({-1}))[0], 0) << "there is no energy";
  for (int n = 1; n <= 12; ++n) {
    law.credit(motion_to(vector({1e-3 * n})));
    EXPECT_NEAR(law.bound(vector({-1}))[0], -std::min(0.1 * n, 1.0), 1e-12);
  }
  (void)law.bound(vector({0}));
  law.credit(motion_to(vector({1})));
  EXPECT_EQ(law.bound(vector({-1}))[0], -1) << "a contact that begins is shown at once";
}

TEST(ExactLaw, CountsOnNoMoreThanTheLowerEndsOfItsFacts) {
  const auto energy_J = [](auto change) {
    DeviceFacts facts = ideal(vector({30}));
    change(facts.uncertainty);
    ExactLaw law(facts, EnergyMemory::full);
    law.credit(motion_to(vector({0})));
    law.credit(motion_to(vector({1e-3})));
    return law.energy_J();
  };
  const double exact_J = 30 * 1e-6 / kPeriod_s;
  EXPECT_NEAR(energy_J([](Uncertainty&) {}), exact_J, 1e-15);
  EXPECT_NEAR(energy_J([](Uncertainty& u) { u.damping_share = 0.25; }), 0.75 * exact_J, 1e-12);
  EXPECT_NEAR(energy_J([](Uncertainty& u) { u.stamp_s = {-1e-4, 1.5e-4}; }), exact_J / 1.25, 1e-12);
  EXPECT_NEAR(energy_J([](Uncertainty& u) { u.clock_share = 0.2; }), exact_J * 0.8, 1e-12);
}

TEST(ExactLaw, ReservesForTheForceInEffectUntilTheNextOneIs) {
  DeviceFacts facts = ideal(vector({30}));
  facts.hold_s_max = 2e-3;
  ExactLaw law(facts, EnergyMemory::full);
  law.credit(motion_to(vector({0})));
  law.credit(motion_to(vector({1e-4})));
  law.commit(vector({-1}));
  Motion motion = motion_to(vector({1e-4}));
  motion.latency_s = motion.latency_s_max = 300e-6;
  law.credit(motion);
  // To rest in the end, through 0.3 ms of nothing and 0.7 ms of -1 N: on with the force and back, (0.7 ms)(0.3 ms)/T.
  // Then again 0.3 ms of -1 N before the next force is in effect.
  EXPECT_NEAR(law.energy_J(), 30 / kPeriod_s * 1e-8 - 0.7e-3 * 0.3 / 120 - 0.3e-3 / 120, 1e-15);
}

TEST(ExactLaw, StartsAgainWhereNoClockCanHaveMeasuredTheInterval) {
  for (const double interval_s : {0.0, -1e-3, -3600.0, 1e-320, 1e7, kInfinity, std::nan("")}) {
    SCOPED_TRACE(interval_s);
    ExactLaw law(ideal(vector({30})), EnergyMemory::full);
    law.credit(motion_to(vector({0})));
    law.credit(motion_to(vector({1e-4})));
    const double energy_J = law.energy_J();
    law.commit(vector({-2}));
    law.credit(motion_to(vector({5.0}), nullptr, interval_s));
    EXPECT_DOUBLE_EQ(law.energy_J(), energy_J - 4 * kPeriod_s / 120);
  }
}

struct Told {
  double interval_s = kPeriod_s;
  bool lost = false;
};

/// Of a law that was told of places 1 mm apart.
double energy_after_J(std::initializer_list<Told> readings) {
  ExactLaw law(ideal(vector({30})), EnergyMemory::full);
  double place_m = 0;
  for (const Told& reading : readings) {
    const Motion motion = motion_to(vector({place_m += 1e-3}), nullptr, reading.interval_s);
    reading.lost ? law.lose(motion) : law.credit(motion);
    law.commit(law.bound(vector({0})));
  }
  return law.energy_J();
}

TEST(ExactLaw, CreditsNothingUntilAnIntervalWhoseStampsAreBelievedHasPassed) {
  constexpr double kOneInterval_J = 30 * 1e-6 / kPeriod_s;
  constexpr double kTooShort_s = 0.1 * kPeriod_s;  // would be credited ten times that
  constexpr bool kLost = true;
  EXPECT_EQ(energy_after_J({{0, kLost}, {-kTooShort_s}, {kTooShort_s}}), 0);
  EXPECT_EQ(energy_after_J({{0, kLost}, {-kTooShort_s}, {kTooShort_s}, {}}), 0);
  EXPECT_DOUBLE_EQ(energy_after_J({{0, kLost}, {-kTooShort_s}, {kTooShort_s}, {}, {}}), kOneInterval_J);

  // The reading at which the time without credit would end is lost, and the next stamp is wrong.
  EXPECT_DOUBLE_EQ(energy_after_J({{0}, {}, {0}, {}, {kPeriod_s, kLost}, {-kTooShort_s}, {kTooShort_s}}),
                   kOneInterval_J);
  EXPECT_NEAR(energy_after_J({{0}, {}, {0}, {}, {kPeriod_s, kLost}, {-kTooShort_s}, {kTooShort_s}, {}, {}}),
              2 * kOneInterval_J, 1e-15);
}

TEST(ExactLaw, CreditsAVeryShortIntervalAsATenthOfThePeriod) {
  ExactLaw law(ideal(vector({30})), EnergyMemory::full);
  law.credit(motion_to(vector({0})));
  law.credit(motion_to(vector({1e-6}), nullptr, 1e-9));
  EXPECT_DOUBLE_EQ(law.energy_J(), 30 / (0.1 * kPeriod_s) * 1e-12);
}

TEST(ExactLaw, GoesOnAfterALostReadingWithoutCreditForTheGap) {
  ForceBounder bounder(ideal(vector({30})), std::make_unique<ExactLaw>(ideal(vector({30}))));
  (void)bounder.tick(motion_to(vector({0})), vector({0}));
  EXPECT_LT(bounder.tick(motion_to(vector({1e-3})), vector({-5}))[0], -4.9);
  const double before_J = bounder.law().energy_J();
  EXPECT_EQ(bounder.tick(motion_to(vector({std::nan("")})), vector({-5}))[0], 0);
  EXPECT_DOUBLE_EQ(bounder.law().energy_J(), before_J - 25 * kPeriod_s / 120);
  (void)bounder.tick(motion_to(vector({1e-3})), vector({0}));
  EXPECT_LT(bounder.law().energy_J(), before_J) << "two ticks at rest, one of them under -5 N";
}

TEST(ExactLaw, GoesOnFromACopyAsFromItself) {
  DeviceFacts facts = ideal(vector({30, 10}));
  facts.encoder_step = vector({15e-6, 15e-6});
  facts.friction = vector({0.1, 0});
  ExactLaw law(facts);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const auto play = [&](ExactLaw& on, std::uint64_t seed) {
    std::mt19937_64 same(seed);
    double sum = 0;
    for (int n = 0; n < 500; ++n) {
      on.credit(motion_to(vector({15e-6 * std::round(3 * normal(same)), 15e-6 * std::round(normal(same))})));
      const Vector force = on.bound(vector({normal(same), normal(same)}));
      on.commit(force);
      sum += force[0] + force[1];
    }
    return sum;
  };
  play(law, 1);
  ExactLaw saved = law;
  EXPECT_EQ(play(law, 2), play(saved, 2));
}

/// Each interval with a force takes three quarters of what energy there is, down to the smallest doubles: in powers of
/// two, so that no rounding stops it before.
TEST(ExactLaw, BoundsTheForceWhereHardlyAnyEnergyIsLeft) {
  constexpr double kPower_s = 1.0 / 1024;
  for (const double latency_s : {0.0, kPower_s}) {
    SCOPED_TRACE(latency_s);
    DeviceFacts facts = ideal(vector({16}));
    facts.force_N_max = 32;
    facts.period_s = facts.hold_s_max = kPower_s;
    facts.latency_s = latency_s;
    ExactLaw law(facts, EnergyMemory::full);
    double at_m = 1.0 / 1024;  // as far as 32 N for a period take it at the most
    Motion motion = motion_to(vector({2 * at_m}), nullptr, kPower_s);
    motion.latency_s = motion.latency_s_max = latency_s;
    law.credit(motion);
    long double energy_J = 16 / kPower_s * at_m * at_m;
    long double least_J = 0;
    for (int n = 0; n < 600; ++n) {
      motion.joint[0] = at_m;
      law.credit(motion);
      const double force_N = law.bound(vector({-32}))[0];
      law.commit(vector({force_N}));
      if (latency_s > 0) {  // nothing moves before it is in effect
        law.credit(motion);
        law.commit(vector({0}));
      }
      const double d = force_N * kPower_s / 64;
      at_m += d;
      energy_J += static_cast<long double>(16 / kPower_s) * d * d - static_cast<long double>(force_N) * d;
      least_J = std::min(least_J, energy_J);
    }
    EXPECT_GE(static_cast<double>(least_J), -1e-12);
    EXPECT_LT(std::abs(static_cast<double>(energy_J)), 1e-300) << "the motion took less than it was to take";
  }
}

TEST(ExactLaw, RefusesADeviceItCannotKeepPassive) {
  const auto refusal = [](auto change) {
    DeviceFacts facts = ideal(vector({30, 20}));
    change(facts);
    try {
      const ExactLaw law(facts);
      return std::string("accepted");
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
  };
  using testing::HasSubstr;
  EXPECT_EQ(refusal([](DeviceFacts&) {}), "accepted");
  EXPECT_THAT(refusal([](DeviceFacts& f) { f.hold_s_max = 0; }), HasSubstr("hold time must be > 0 s, got 0"));
  EXPECT_THAT(refusal([](DeviceFacts& f) { f.period_s = -1; }), HasSubstr("period must be > 0 s, got -1"));
  EXPECT_THAT(refusal([](DeviceFacts& f) { f.latency_s = 0.01; }), HasSubstr("latency must be 0 to 8 periods"));
  EXPECT_THAT(refusal([](DeviceFacts& f) { f.friction[1] = -1; }), HasSubstr("friction must be >= 0 for each joint"));
  EXPECT_THAT(refusal([](DeviceFacts& f) { f.encoder_step = Vector::Zero(1); }),
              HasSubstr("encoder step must be >= 0"));
  EXPECT_THAT(refusal([](DeviceFacts& f) { f.damping(0, 0) = -1; }), HasSubstr("positive definite"));
  EXPECT_THAT(refusal([](DeviceFacts& f) { f.force_N_max = std::nan(""); }), HasSubstr("largest force must be >= 0"));
  EXPECT_THAT(refusal([](DeviceFacts& f) { f.release_share = 1.5; }), HasSubstr("must be 0 to 1, got 1.5"));
  EXPECT_THAT(refusal([](DeviceFacts& f) { f.release_s = -1; }), HasSubstr("time of release must be >= 0 s, got -1"));
  EXPECT_THAT(refusal([](DeviceFacts& f) {
                f.releases = false;
                f.release_share = 0.5;
                f.release_s = 1e-3;
              }),
              HasSubstr("share of a force at its release must be 0 where the device does not release, got 0.5"));
  EXPECT_THAT(refusal([](DeviceFacts& f) {
                f.uncertainty.stamp_s = {1e-3, -1e-3};
              }),
              HasSubstr("uncertainty of stamps must be two times [s], least first, got 0.001 to -0.001"));
  EXPECT_THAT(refusal([](DeviceFacts& f) { f.uncertainty.damping_share = 1; }),
              HasSubstr("uncertainty of the damping must be a share of 0 to less than 1, got 1"));
  EXPECT_THAT(refusal([](DeviceFacts& f) { f.uncertainty.torque_ripple_share = -0.1; }),
              HasSubstr("ripple of the torque must be a share of 0 to less than 1, got -0.1"));
  EXPECT_THAT(refusal([](DeviceFacts& f) {
                f.uncertainty.torque_gain_share = {0.1, -0.1};
              }),
              HasSubstr("uncertainty of the motors' gain must be two shares, least first, got 0.1 to -0.1"));
  EXPECT_THAT(refusal([](DeviceFacts& f) {
                f.uncertainty.torque_gain_share = {-1, 0};
              }),
              HasSubstr("gain must be more than -1, or it could be zero, got -1"));
  EXPECT_THAT(refusal([](DeviceFacts& f) {
                f.uncertainty.latency_s = {-1e-6, 0};
              }),
              HasSubstr("a force would take effect before its command, got -1e-06"));
  EXPECT_THAT(refusal([](DeviceFacts& f) {
                f.uncertainty.hold_s = {-1e-3, 0};
              }),
              HasSubstr("hold time must be > 0 s at the least, got 0"));
}

}  // namespace
}  // namespace forcebound::control
