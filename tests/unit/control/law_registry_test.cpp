#include "forcebound/control/law_registry.hpp"
#include "forcebound/baselines/baselines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "forcebound/control/transparent_law.hpp"

namespace forcebound::control {
namespace {

DeviceFacts one_axis_facts() {
  DeviceFacts facts;
  facts.damping = Matrix::Identity(1, 1);
  return facts;
}

std::unique_ptr<PassivityLaw> make_transparent(const DeviceFacts& facts, const LawOptions&) {
  return std::make_unique<TransparentLaw>(facts.degrees_of_freedom(), facts.period_s);
}

TEST(LawRegistry, KnowsThePublishedLaws) {
  const LawRegistry laws = published_laws();
  EXPECT_THAT(laws.names(), testing::ElementsAre("none", "fba-less", "fba-more"));
  for (const auto& name : laws.names()) EXPECT_EQ(laws.make(name, one_axis_facts())->name(), name);
}

TEST(LawRegistry, ShipsTheExactLawBesideThePublishedOnes) {
  const LawRegistry laws = force_bounding_laws();
  EXPECT_THAT(laws.names(), testing::ElementsAre("none", "fba-less", "fba-more", "fba-exact"));
  DeviceFacts facts = one_axis_facts();
  facts.friction = facts.encoder_step = Vector::Zero(1);
  EXPECT_EQ(laws.make("fba-exact", facts)->name(), "fba-exact");
}

TEST(LawRegistry, NamesTheKnownLawsWhenItRefusesOne) {
  try {
    (void)published_laws().make("fba-lesss", one_axis_facts());
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "unknown law 'fba-lesss' (known: none, fba-less, fba-more)");
  }
}

TEST(LawRegistry, PassesOnWhatALawRefusesAboutTheDevice) {
  DeviceFacts facts = one_axis_facts();
  facts.period_s = 0;
  for (const auto& name : published_laws().names()) {
    EXPECT_THROW((void)published_laws().make(name, facts), std::invalid_argument) << name;
  }
}

TEST(LawRegistry, SaysWhyItWouldRefuseADevice) {
  const LawRegistry laws = published_laws();
  DeviceFacts facts = one_axis_facts();
  EXPECT_EQ(laws.refusal("none", facts), "");
  facts.period_s = 0;
  EXPECT_THAT(laws.refusal("none", facts), testing::HasSubstr("period"));
  EXPECT_THROW((void)laws.refusal("nun", facts), std::invalid_argument) << "no such law is no refusal";
}

TEST(LawRegistry, TakesALawOfOnesOwn) {
  LawRegistry laws = published_laws();
  laws.add({.name = "mine", .summary = "does nothing at all", .make = make_transparent});
  EXPECT_EQ(laws.make("mine", one_axis_facts())->name(), "none");
  EXPECT_THAT(laws.names(), testing::Contains("mine"));
  EXPECT_THAT(published_laws().names(), testing::Not(testing::Contains("mine"))) << "a registry is a value";
}

TEST(LawRegistry, RefusesASecondLawOfTheSameName) {
  LawRegistry laws = published_laws();
  EXPECT_THROW(laws.add({.name = "none", .summary = "again", .make = make_transparent}), std::invalid_argument);
}

TEST(LawRegistry, HelpsWithALineForEachLaw) {
  LawRegistry laws;
  laws.add({.name = "a", .summary = "first", .make = make_transparent});
  laws.add({.name = "long", .summary = "second", .reference = "Me 2000", .make = make_transparent});
  EXPECT_EQ(laws.help(), "  a     first\n  long  second (Me 2000)\n");
}

TEST(LawRegistry, RefusesALawThatCannotBeMade) {
  LawRegistry laws;
  EXPECT_THROW(laws.add({.name = "empty", .summary = "nothing", .make = nullptr}), std::invalid_argument);
}

LawRegistry with_parameters() {
  LawRegistry laws;
  laws.add({.name = "tuned",
            .summary = "has two numbers",
            .parameters = {{.name = "gain",
                            .purpose = "how much",
                            .least = 0.5,
                            .most = 2,
                            .standard = [](const DeviceFacts& facts) { return facts.period_s * 1e3; }},
                           {.name = "year",
                            .purpose = "which of the two",
                            .choices = {2002, 2004},
                            .standard = [](const DeviceFacts&) { return 2004.0; }}},
            .make = make_transparent});
  return laws;
}

std::string refusal_of_parameters(const LawParameters& chosen) {
  try {
    (void)with_parameters().make("tuned", one_axis_facts(), {.parameters = chosen});
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(LawRegistry, CompletesParametersFromTheDevice) {
  const LawParameters expected{{"gain", 1.0}, {"year", 2002.0}};
  EXPECT_EQ(with_parameters().parameters("tuned", one_axis_facts(), {{"year", 2002}}), expected);
}

TEST(LawRegistry, SaysWhatAParameterMayBe) {
  EXPECT_EQ(refusal_of_parameters({{"gain", 3}}), "law 'tuned': gain must be 0.5 to 2, got 3");
  EXPECT_EQ(refusal_of_parameters({{"gain", std::nan("")}}), "law 'tuned': gain must be 0.5 to 2, got nan");
  EXPECT_EQ(refusal_of_parameters({{"year", 2003}}), "law 'tuned': year must be 2002 or 2004, got 2003");
  EXPECT_EQ(refusal_of_parameters({{"gian", 1}}), "law 'tuned' has no parameter 'gian' (known: gain, year)");
  EXPECT_EQ(refusal_of_parameters({{"gain", 2}}), "accepted");
}

TEST(LawRegistry, TellsAllOfALaw) {
  EXPECT_EQ(with_parameters().help("tuned"),
            "tuned: has two numbers\n"
            "  promises nothing\n"
            "  gain  how much; 0.5 to 2\n"
            "  year  which of the two; 2002 or 2004\n");
}

TEST(LawRegistry, TellsWhatALawWouldDoWithADevice) {
  DeviceFacts facts = one_axis_facts();
  facts.name = "bench";
  const LawRegistry laws = with_parameters();
  EXPECT_EQ(laws.help("tuned", facts), laws.help("tuned") + "\nStandard values on 'bench':\n  gain  1\n  year  2004\n");
  EXPECT_EQ(published_laws().help("none", facts), published_laws().help("none"));
  facts.period_s = 0;
  EXPECT_THAT(published_laws().help("none", facts),
              testing::EndsWith("\nBut it refuses: period must be > 0 s, got 0\n"));
}

TEST(LawRegistry, HasNoServerSideLawForALawWithout) {
  EXPECT_EQ(baselines::shipped_laws().make_server_side("fba-less", 3), nullptr);
  EXPECT_EQ(baselines::shipped_laws().make_server_side("", 3), nullptr);
}

}  // namespace
}  // namespace forcebound::control
