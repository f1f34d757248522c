#include <forcebound.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include "forcebound/baselines/running_law.hpp"
#include "forcebound/device/load_device.hpp"
#include "tests/library/handles.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/random_ticks.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::library {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;

using Facts = Owned<fb_facts>;
using Law = Owned<fb_law>;

Facts load(const char* name) {
  fb_facts* facts = nullptr;
  EXPECT_EQ(fb_facts_load(name, &facts), FB_OK) << fb_last_error();
  return Facts(facts);
}

Law make(const char* name, const Facts& facts, const fb_law_options* options = nullptr) {
  fb_law* law = nullptr;
  EXPECT_EQ(fb_law_create(name, facts.get(), options, &law), FB_OK) << fb_last_error();
  return Law(law);
}

fb_ledger ledger_of(const Law& law) {
  fb_ledger ledger = FB_INIT(fb_ledger);
  EXPECT_EQ(fb_law_ledger(law.get(), &ledger), FB_OK) << fb_last_error();
  return ledger;
}

fb_motion motion_at(double x_m, double interval_s = 1e-3) {
  fb_motion motion = FB_INIT(fb_motion);
  motion.interval_s = interval_s;
  motion.position[0] = x_m;
  return motion;
}

TEST(LibraryFacts, AreThoseOfTheShippedDevice) {
  const Facts facts = load("omni");
  fb_facts_info info = FB_INIT(fb_facts_info);
  ASSERT_EQ(fb_facts_describe(facts.get(), &info), FB_OK);
  const control::DeviceFacts shipped = device::load_device("omni").facts;
  EXPECT_EQ(info.name, shipped.name);
  EXPECT_EQ(info.axes, shipped.degrees_of_freedom());
  EXPECT_EQ(info.joints, shipped.joints());
  EXPECT_EQ(info.cartesian, 0);
  EXPECT_EQ(info.period_s, shipped.period_s);
  EXPECT_EQ(info.force_N_max, shipped.force_N_max);
}

TEST(LibraryFacts, SayWhereTheirTextIsWrongAndWhatIsAccepted) {
  fb_facts* facts = nullptr;
  EXPECT_EQ(fb_facts_parse("kind = \"cartesian\"\ndegrees_of_freedom = 9\n", "mine.toml", &facts), FB_FAILED);
  EXPECT_THAT(fb_last_error(), AllOf(HasSubstr("fb_facts_parse: mine.toml:2"), HasSubstr("from 1 to 3, got 9")));
  EXPECT_EQ(fb_facts_load("omny", &facts), FB_INVALID);
  EXPECT_THAT(fb_last_error(), HasSubstr("did you mean 'omni'"));
  EXPECT_EQ(fb_facts_load("./no-such-file.toml", &facts), FB_FAILED);
  EXPECT_THAT(fb_last_error(), HasSubstr("./no-such-file.toml"));
  EXPECT_EQ(facts, nullptr);
}

TEST(LibraryFacts, AnOlderProgramsSmallerStructIsNotWrittenBeyondItsSize) {
  const Facts facts = load("wall-1dof");
  fb_facts_info info = FB_INIT(fb_facts_info);
  std::memset(static_cast<void*>(&info), 0x5a, sizeof info);
  info.size = offsetof(fb_facts_info, torque_N_m_max);
  ASSERT_EQ(fb_facts_describe(facts.get(), &info), FB_OK) << fb_last_error();
  EXPECT_GT(info.force_N_max, 0);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(&info);
  EXPECT_THAT(std::vector<unsigned>(bytes + info.size, bytes + sizeof info), Each(0x5aU));
}

class LibraryLaw : public ::testing::TestWithParam<const char*> {};

/// Every tick, to the last bit, also of a device whose joints are not its axes.
TEST_P(LibraryLaw, GivesTheForcesOfTheLawInCpp) {
  for (const char* const device : {"firm-3dof", "omni"}) {
    SCOPED_TRACE(device);
    const Facts facts = load(device);
    const Law law = make(GetParam(), facts);
    baselines::RunningLaw expected(device::load_device(device).facts, GetParam(), {});
    int felt = 0;
    for (const test::ReferenceTick& tick : test::random_ticks({.degrees_of_freedom = 3, .motion_m = 3e-4})) {
      fb_motion motion = motion_at(0, expected.begun() ? 1e-3 : 0);
      control::Motion& same = expected.motion();
      same.interval_s = motion.interval_s;
      for (std::size_t k = 0; k < 3; ++k) {
        motion.position[k] = same.position[static_cast<Eigen::Index>(k)] = tick.position_m[k];
        motion.joint[k] = same.joint[static_cast<Eigen::Index>(k)] = 5 * tick.position_m[k];
        for (std::size_t j = 0; j < 3; ++j) motion.jacobian[3 * k + j] = k == j ? 0.2 : 0.01;
      }
      if (!expected.facts().cartesian) {
        same.jacobian = control::Matrix::Constant(3, 3, 0.01);
        same.jacobian.diagonal().setConstant(0.2);
      }
      std::array<double, 3> force_N{};
      ASSERT_EQ(fb_law_tick(law.get(), &motion, tick.request_N.data(), force_N.data(), 3), FB_OK) << fb_last_error();
      const control::Vector wanted_N = expected.tick(Eigen::Map<const Eigen::Vector3d>(tick.request_N.data()));
      ASSERT_EQ(force_N, (std::array{wanted_N[0], wanted_N[1], wanted_N[2]}));
      felt += wanted_N.norm() > 0 ? 1 : 0;
    }
    EXPECT_GT(felt, 100);
    EXPECT_EQ(ledger_of(law).energy_J, expected.bounder().law().energy_J());
    EXPECT_EQ(ledger_of(law).saturated, expected.bounder().counts().saturated);
  }
}
INSTANTIATE_TEST_SUITE_P(Laws, LibraryLaw, ::testing::Values("none", "fba-exact", "fba-less", "fba-more", "tdpa"));

TEST(LibraryLawAlone, IsNamedByNumber) {
  std::vector<std::string> names;
  while (const char* const name = fb_law_name(names.size())) names.emplace_back(name);
  EXPECT_THAT(names, ::testing::IsSupersetOf({"none", "fba-exact", "vc"}));
}

TEST(LibraryLawAlone, TakesParametersAsTomlAndRefusesOthers) {
  const Facts facts = load("firm-3dof");
  fb_law_options options = FB_INIT(fb_law_options);
  options.parameters = "[vc]\ncoupling_N_per_m = 1000\n";
  (void)make("vc", facts, &options);
  fb_law* law = nullptr;
  options.parameters = "[vc]\ncoupling = 1\n";
  EXPECT_NE(fb_law_create("vc", facts.get(), &options, &law), FB_OK);
  EXPECT_THAT(fb_last_error(), AllOf(HasSubstr("parameters:2"), HasSubstr("coupling_N_per_m")));
  EXPECT_EQ(fb_law_create("fba-exakt", facts.get(), nullptr, &law), FB_INVALID);
  EXPECT_THAT(fb_last_error(), HasSubstr("fba-exact"));
  EXPECT_EQ(fb_law_create("wave", facts.get(), nullptr, &law), FB_INVALID);
  EXPECT_THAT(fb_last_error(), HasSubstr("at the server"));
  EXPECT_EQ(law, nullptr);
}

/// A wrong call is a reading that is lost: zero force, and no more energy to spend than before.
TEST(LibraryLawAlone, AfterAWrongCallTheForceIsZeroAndTheLedgerStillHolds) {
  const Facts facts = load("wall-1dof");
  const Law law = make("fba-exact", facts);
  double force_N = 0;
  const double request_N = -5;
  fb_motion motion = motion_at(0, 0);
  ASSERT_EQ(fb_law_tick(law.get(), &motion, &request_N, &force_N, 1), FB_OK);
  for (int n = 1; n <= 20; ++n) {
    motion = motion_at(1e-4 * n);
    ASSERT_EQ(fb_law_tick(law.get(), &motion, &request_N, &force_N, 1), FB_OK);
  }
  ASSERT_LT(force_N, 0);
  const double energy_J = ledger_of(law).energy_J;

  const auto refused = [&](const fb_motion* given, const double* to, std::size_t axes, const std::string& why) {
    std::array<double, 8> forces_N{9, 9, 9, 9, 9, 9, 9, 9};
    EXPECT_EQ(fb_law_tick(law.get(), given, &request_N, to == nullptr ? nullptr : forces_N.data(), axes), FB_INVALID);
    EXPECT_THAT(fb_last_error(), HasSubstr(why));
    EXPECT_EQ(forces_N[0], to == nullptr ? 9 : 0) << why;
    EXPECT_EQ(forces_N[7], 9);
  };
  refused(&motion, &force_N, 3, "axes must be 1, the degrees of freedom of device 'wall-1dof', got 3");
  refused(nullptr, &force_N, 1, "fb_motion is null");
  refused(&motion, nullptr, 1, "force_N is null");
  fb_motion wrong = motion;
  wrong.size = 12;
  refused(&wrong, &force_N, 1, "fb_motion.size is 12, accepted are 72 or more: set it by FB_INIT(fb_motion)");
  wrong.size = static_cast<std::size_t>(-1);
  refused(&wrong, &force_N, 1, "fb_motion.size is 18446744073709551615");
  wrong = motion;
  wrong.has = FB_HAS_LATENCY;
  wrong.latency_s = test::kNaN;
  refused(&wrong, &force_N, 1, "latency_s must be 0 to 1e6 s");

  const fb_ledger ledger = ledger_of(law);
  EXPECT_EQ(ledger.calls_refused, 6U);
  EXPECT_LE(ledger.energy_J, energy_J);
  EXPECT_EQ(fb_law_tick(law.get(), &motion, &request_N, &force_N, 1), FB_OK);
  EXPECT_EQ(fb_law_tick(nullptr, &motion, &request_N, &force_N, 1), FB_INVALID);
  EXPECT_EQ(force_N, 0);
}

TEST(LibraryLawAlone, ReadingsThatAreNotFiniteGiveZeroForceAndAreCounted) {
  const Law law = make("fba-exact", load("wall-1dof"));
  double force_N = 9;
  const double request_N = -1;
  for (const double x_m : {test::kNaN, test::kInfinity}) {
    const fb_motion motion = motion_at(x_m);
    EXPECT_EQ(fb_law_tick(law.get(), &motion, &request_N, &force_N, 1), FB_OK);
    EXPECT_EQ(force_N, 0);
  }
  EXPECT_EQ(ledger_of(law).readings_not_finite, 2U);
  const fb_motion motion = motion_at(0);
  EXPECT_EQ(fb_law_tick(law.get(), &motion, &test::kNaN, &force_N, 1), FB_OK);
  EXPECT_EQ(force_N, 0);
  EXPECT_EQ(ledger_of(law).requests_not_finite, 1U);
}

/// What a program knows of an older header: no times, and a struct that ends before them.
TEST(LibraryLawAlone, AnOlderProgramsSmallerMotionIsTakenByTheFacts) {
  const Facts facts = load("omni");
  const Law older = make("fba-exact", facts);
  const Law newer = make("fba-exact", facts);
  const std::array<double, 3> request_N{-1, 0.5, 0};
  for (int n = 0; n < 100; ++n) {
    fb_motion motion = motion_at(1e-5 * n, n == 0 ? 0 : 1e-3);
    motion.joint[0] = 1e-4 * n;
    motion.jacobian[0] = motion.jacobian[4] = motion.jacobian[8] = 0.1;
    std::array<double, 3> by_newer_N{};
    ASSERT_EQ(fb_law_tick(newer.get(), &motion, request_N.data(), by_newer_N.data(), 3), FB_OK);
    motion.size = offsetof(fb_motion, latency_s);
    motion.has = 0;
    motion.latency_s = motion.held_s = 1e9;  // not the program's: rubbish behind its struct
    std::array<double, 3> by_older_N{};
    ASSERT_EQ(fb_law_tick(older.get(), &motion, request_N.data(), by_older_N.data(), 3), FB_OK) << fb_last_error();
    ASSERT_EQ(by_older_N, by_newer_N);
  }
}

/// A program with a newer header, which appends a field.
TEST(LibraryLawAlone, ANewerProgramsLargerMotionIsTakenIfItSetsNothingThatIsNotKnown) {
  struct NewerMotion {
    fb_motion known;
    double added;
  } newer{.known = motion_at(0, 0), .added = 0};
  newer.known.size = sizeof newer;
  const Law law = make("fba-exact", load("wall-1dof"));
  double force_N = 0;
  EXPECT_EQ(fb_law_tick(law.get(), &newer.known, nullptr, &force_N, 1), FB_OK) << fb_last_error();
  newer.added = 1;
  EXPECT_EQ(fb_law_tick(law.get(), &newer.known, nullptr, &force_N, 1), FB_INVALID);
  EXPECT_THAT(fb_last_error(), HasSubstr("sets a field that this library"));
}

TEST(LibraryLawAlone, WithdrawsAForceThatTakesEffectSoonerThanItCan) {
  const Law law = make("fba-exact", load("wall-1dof"));
  double force_N = 0;
  const double request_N = -5;
  for (int n = 0; n <= 20; ++n) {
    const fb_motion motion = motion_at(1e-4 * n, n == 0 ? 0 : 1e-3);
    ASSERT_EQ(fb_law_tick(law.get(), &motion, &request_N, &force_N, 1), FB_OK);
  }
  double confirmed_N = 0;
  ASSERT_EQ(fb_law_confirm(law.get(), 0, &confirmed_N, 1), FB_OK);
  EXPECT_EQ(confirmed_N, force_N);
  ASSERT_EQ(fb_law_confirm(law.get(), -1e-3, &confirmed_N, 1), FB_OK);
  EXPECT_EQ(confirmed_N, 0);
  EXPECT_EQ(ledger_of(law).forces_withdrawn, 1U);
}

TEST(LibraryLawAlone, ATickDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const Law law = make("fba-exact", load("omni"));
  const std::array<double, 3> request_N{-1, 0.5, 0};
  std::array<double, 3> force_N{};
  fb_ledger ledger = FB_INIT(fb_ledger);
  const test::AllocationGuard guard;
  for (int n = 0; n < 100; ++n) {
    fb_motion motion = motion_at(1e-5 * n, n == 0 ? 0 : 1e-3);
    motion.joint[0] = 1e-4 * n;
    motion.jacobian[0] = motion.jacobian[4] = motion.jacobian[8] = 0.1;
    (void)fb_law_tick(law.get(), &motion, n % 7 == 0 ? nullptr : request_N.data(), force_N.data(), 3);
    (void)fb_law_confirm(law.get(), 1e-4, force_N.data(), 3);
    (void)fb_law_ledger(law.get(), &ledger);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::library
