#include "forcebound/baselines/law_file.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "forcebound/baselines/baselines.hpp"

namespace forcebound::baselines {
namespace {

using control::LawParameters;

std::unique_ptr<control::PassivityLaw> make_nothing(const control::DeviceFacts&, const control::LawOptions&) {
  return nullptr;
}

control::LawRegistry laws() {
  const auto one = [](const control::DeviceFacts&) { return 1.0; };
  control::LawRegistry laws;
  laws.add({.name = "plain", .summary = "has no parameters", .make = make_nothing});
  laws.add({.name = "tuned",
            .summary = "has some",
            .parameters = {{.name = "gain", .purpose = "how much", .least = 0.5, .most = 2, .standard = one},
                           {.name = "mass_kg", .purpose = "of it", .standard = one},
                           {.name = "year", .purpose = "which", .choices = {2002, 2004}, .standard = one}},
            .make = make_nothing});
  return laws;
}

LawParameters parsed(const std::string& text, std::string_view law = "tuned") {
  return parse_law_parameters(text, "laws.toml", law, laws());
}

std::string refusal(const std::string& text, std::string_view law = "tuned") {
  try {
    (void)parsed(text, law);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(LawFile, GivesTheTableOfTheLaw) {
  EXPECT_EQ(parsed("[tuned]\ngain = 1.5\nyear = 2002\n"), (LawParameters{{"gain", 1.5}, {"year", 2002}}));
}

TEST(LawFile, GivesNothingOfALawThatItSaysNothingOf) {
  EXPECT_EQ(parsed("[tuned]\ngain = 1.5\n", "plain"), LawParameters{});
  EXPECT_EQ(parsed(""), LawParameters{});
  EXPECT_EQ(parsed("[tuned]\n[plain]\n"), LawParameters{});
}

TEST(LawFile, NamesAParameterThatTheLawDoesNotHave) {
  EXPECT_EQ(refusal("[tuned]\ngain = 1\nmass = 2\n"),
            "laws.toml:3: law 'tuned': no parameter 'mass', did you mean 'mass_kg'? (known: gain, mass_kg, year)");
  EXPECT_EQ(refusal("[plain]\ngain = 1\n", "plain"), "laws.toml:2: law 'plain': no parameter 'gain'; there are none");
}

TEST(LawFile, NamesALawThatThereIsNot) {
  EXPECT_EQ(refusal("[tuned]\n[tunde]\n"),
            "laws.toml:2: law parameters: no law 'tunde', did you mean 'tuned'? (known: plain, tuned)");
}

TEST(LawFile, ChecksTheOtherLawsAsWell) {
  EXPECT_EQ(refusal("[tuned]\ngain = 3\n", "plain"), "laws.toml:2: law 'tuned': gain must be 0.5 to 2, got 3");
}

TEST(LawFile, SaysWhatAValueMayBe) {
  EXPECT_EQ(refusal("[tuned]\ngain = 0\n"), "laws.toml:2: law 'tuned': gain must be 0.5 to 2, got 0");
  EXPECT_EQ(refusal("[tuned]\nyear = 2003\n"), "laws.toml:2: law 'tuned': year must be 2002 or 2004, got 2003");
  EXPECT_EQ(refusal("[tuned]\nmass_kg = -1\n"), "laws.toml:2: law 'tuned': mass_kg must be >= 0, got -1");
  EXPECT_EQ(refusal("[tuned]\ngain = 'much'\n"), "laws.toml:2: law 'tuned': gain must be a finite number, got 'much'");
  EXPECT_EQ(refusal("[tuned]\ngain = nan\n"), "laws.toml:2: law 'tuned': gain must be a finite number, got nan");
  EXPECT_EQ(refusal("tuned = 1\n"), "laws.toml:1: law parameters: tuned must be a table, got 1");
}

TEST(LawFile, SaysWhereItIsNoToml) { EXPECT_EQ(refusal("[tuned]\ngain =\n").substr(0, 23), "laws.toml:2: not TOML: "); }

TEST(LawFile, IsReadFromTheDisk) {
  const std::string file = testing::TempDir() + "/law_file_test.toml";
  std::ofstream(file) << "[tuned]\nmass_kg = 0.25\n";
  EXPECT_EQ(load_law_parameters(file, "tuned", laws()), (LawParameters{{"mass_kg", 0.25}}));
  std::remove(file.c_str());
  EXPECT_THROW((void)load_law_parameters(file, "tuned", laws()), std::runtime_error);
}

TEST(LawFile, IsDescribedAsText) {
  EXPECT_EQ(describe({{"mass_kg", 0.03}, {"gain", 40000}}), "gain 40000, mass_kg 0.03");
  EXPECT_EQ(describe(LawParameters{}), "");
}

}  // namespace
}  // namespace forcebound::baselines
