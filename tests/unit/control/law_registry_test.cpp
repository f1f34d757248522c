#include "forcebound/control/law_registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>

#include "forcebound/control/transparent_law.hpp"

namespace forcebound::control {
namespace {

DeviceFacts one_axis() {
  DeviceFacts facts;
  facts.damping = Matrix::Identity(1, 1);
  return facts;
}

TEST(LawRegistry, KnowsThePublishedLaws) {
  const LawRegistry laws = published_laws();
  EXPECT_THAT(laws.names(), testing::ElementsAre("none", "fba-less", "fba-more"));
  for (const auto& name : laws.names()) EXPECT_EQ(laws.make(name, one_axis())->name(), name);
}

TEST(LawRegistry, ShipsTheExactLawBesideThePublishedOnes) {
  const LawRegistry laws = shipped_laws();
  EXPECT_THAT(laws.names(), testing::ElementsAre("none", "fba-less", "fba-more", "fba-exact"));
  DeviceFacts facts = one_axis();
  facts.friction = facts.encoder_step = Vector::Zero(1);
  EXPECT_EQ(laws.make("fba-exact", facts)->name(), "fba-exact");
}

TEST(LawRegistry, NamesTheKnownLawsWhenItRefusesOne) {
  try {
    (void)published_laws().make("fba-lesss", one_axis());
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "unknown law 'fba-lesss'; known are none, fba-less, fba-more");
  }
}

TEST(LawRegistry, PassesOnWhatALawRefusesAboutTheDevice) {
  DeviceFacts facts = one_axis();
  facts.period_s = 0;
  for (const auto& name : published_laws().names()) {
    EXPECT_THROW((void)published_laws().make(name, facts), std::invalid_argument) << name;
  }
}

TEST(LawRegistry, TakesALawOfOnesOwn) {
  LawRegistry laws = published_laws();
  laws.add("mine", "does nothing at all", [](const DeviceFacts& facts, const LawOptions&) {
    return std::make_unique<TransparentLaw>(facts.degrees_of_freedom(), facts.period_s);
  });
  EXPECT_EQ(laws.make("mine", one_axis())->name(), "none");
  EXPECT_THAT(laws.names(), testing::Contains("mine"));
  EXPECT_THAT(published_laws().names(), testing::Not(testing::Contains("mine"))) << "a registry is a value";
}

TEST(LawRegistry, RefusesASecondLawOfTheSameName) {
  LawRegistry laws = published_laws();
  EXPECT_THROW(laws.add("none", "again", nullptr), std::invalid_argument);
}

TEST(LawRegistry, HelpsWithALineForEachLaw) {
  LawRegistry laws;
  laws.add("a", "first", nullptr);
  laws.add("long", "second", nullptr);
  EXPECT_EQ(laws.help(), "  a     first\n  long  second\n");
}

}  // namespace
}  // namespace forcebound::control
