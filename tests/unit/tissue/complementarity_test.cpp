#include "forcebound/tissue/complementarity.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::tissue {
namespace {

constexpr int kPlenty = 100;

TEST(SolveContacts, OneContactPushesUntilItTouches) {
  const auto pressed = solve_contacts(ContactMatrix::Constant(1, 1, 0.02), ContactVector::Constant(1, -0.003), kPlenty);
  EXPECT_NEAR(pressed.force_N[0], 0.15, 1e-15);
  EXPECT_LT(pressed.residual_m, 1e-17);
  const auto apart = solve_contacts(ContactMatrix::Constant(1, 1, 0.02), ContactVector::Constant(1, 0.003), kPlenty);
  EXPECT_EQ(apart.force_N[0], 0);
  EXPECT_EQ(apart.residual_m, 0);
}

TEST(SolveContacts, OneThatTheOthersLiftOffDoesNotPull) {
  ContactMatrix compliance(2, 2);
  compliance << 1, 0.9, 0.9, 1;
  ContactVector gap(2);
  gap << -1, -0.5;
  const auto found = solve_contacts(compliance, gap, kPlenty);
  EXPECT_NEAR(found.force_N[0], 1, 1e-15);
  EXPECT_EQ(found.force_N[1], 0);
}

TEST(SolveContacts, HoldsForAnyBody) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto size = static_cast<Eigen::Index>(1 + random() % kContactsMax);
    std::uniform_real_distribution<double> any(-1, 1);
    const ContactMatrix root = ContactMatrix::NullaryExpr(size, size, [&] { return any(random); });
    const ContactMatrix compliance = root * root.transpose() + 1e-6 * ContactMatrix::Identity(size, size);
    const ContactVector gap = ContactVector::NullaryExpr(size, [&] { return any(random); });
    const auto found = solve_contacts(compliance, gap, kPlenty);
    const ContactVector left = compliance * found.force_N + gap;
    EXPECT_GE(found.force_N.minCoeff(), 0);
    EXPECT_GT(left.minCoeff(), -1e-9);
    EXPECT_LT(std::abs(left.dot(found.force_N)), 1e-6 * (1 + found.force_N.maxCoeff()));
    EXPECT_LT(found.residual_m, 1e-8);
  }
}

TEST(SolveContacts, SaysWhatIsLeftWhenTheBudgetEnds) {
  const ContactMatrix compliance = ContactMatrix::Identity(4, 4);
  const ContactVector gap = ContactVector::LinSpaced(4, -4, -1);
  const auto found = solve_contacts(compliance, gap, 2);
  EXPECT_EQ(found.iterations, 2);
  EXPECT_NEAR(found.force_N[0], 4, 1e-15);
  EXPECT_NEAR(found.force_N[1], 3, 1e-15);
  EXPECT_NEAR(found.residual_m, 2, 1e-15);
}

TEST(SolveContacts, WithoutContactsHasNoForce) {
  EXPECT_EQ(solve_contacts(ContactMatrix(0, 0), ContactVector(0), kPlenty).force_N.size(), 0);
}

TEST(SolveContacts, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const ContactMatrix compliance =
      ContactMatrix::Identity(kContactsMax, kContactsMax) + ContactMatrix::Constant(kContactsMax, kContactsMax, 0.5);
  const ContactVector gap = ContactVector::LinSpaced(kContactsMax, -1, 0.5);
  const test::AllocationGuard guard;
  const auto found = solve_contacts(compliance, gap, kPlenty);
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_LT(found.residual_m, 1e-12);
}

}  // namespace
}  // namespace forcebound::tissue
