#include "forcebound/control/assertion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <string_view>

#include "forcebound/control/energy_sum.hpp"

namespace forcebound::control {
namespace {

class ToldOnStderr final : public LastResort {
 public:
  explicit ToldOnStderr(bool fails = false) : fails_(fails) {}
  void make_safe() noexcept override {
    std::fputs("made safe, ", stderr);
    FORCEBOUND_ASSERT(!fails_, "making safe works");
  }
  [[nodiscard]] std::size_t describe(std::span<char> words) const noexcept override {
    constexpr std::string_view kState = "state active, seed 7";
    std::ranges::copy(kState, words.begin());
    return kState.size();
  }

 private:
  bool fails_;
};

TEST(AssertionDeathTest, SaysWhatIsFalseAndWhere) {
  const int legs = 5;
  EXPECT_DEATH(FORCEBOUND_ASSERT(legs == 4, "a dog has four legs"),
               "assertion_test.cpp:[0-9]+: a bug of Forcebound: 'legs == 4' is false .a dog has four legs.");
}

TEST(AssertionDeathTest, MakesSafeBeforeItPrintsAnything) {
  ToldOnStderr resort;
  const LastResortScope scope(resort);
  EXPECT_DEATH(FORCEBOUND_ASSERT(false, "x"), "^made safe, .*'false' is false .x.; state active, seed 7");
}

TEST(AssertionDeathTest, ASecondFailureOnTheWayEndsAtOnce) {
  ToldOnStderr resort(true);
  const LastResortScope scope(resort);
  EXPECT_DEATH(FORCEBOUND_ASSERT(false, "x"), "^made safe, .*'!fails_' is false .making safe works.\n$");
}

TEST(AssertionDeathTest, HandsBackToTheResortBefore) {
  ToldOnStderr outer;
  const LastResortScope outer_scope(outer);
  {
    ToldOnStderr inner(true);
    const LastResortScope inner_scope(inner);
  }
  EXPECT_DEATH(FORCEBOUND_ASSERT(false, "x"), "seed 7");
}

TEST(AssertionDeathTest, AnEnergyThatIsNoNumberEndsTheProgram) {
  EnergySum sum;
  EXPECT_DEATH(sum.add(std::numeric_limits<double>::quiet_NaN()), "the ledger stays one");
}

TEST(Assertion, LetsPassWhatHolds) {
  int evaluated = 0;
  FORCEBOUND_ASSERT(++evaluated == 1, "it is evaluated once");
  EXPECT_EQ(evaluated, 1);
}

}  // namespace
}  // namespace forcebound::control
