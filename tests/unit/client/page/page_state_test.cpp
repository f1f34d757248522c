#include "forcebound/client/page/page_state.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace forcebound::client {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

PageState state() {
  return {.choices = {.laws = {{"none", "shows the force as it is"}, {"fba-exact", "exact"}},
                      .scenes = {"sphere", "wall"},
                      .devices = {"omni", "wall-1dof"},
                      .beside = true,
                      .stiffness = true},
          .choice = {.law = "fba-exact", .scene = "wall", .device = "omni"},
          .simulated = true,
          .pointer = true};
}

std::string refusal(const page::Choose& choice, const PageChoices& choices) {
  try {
    (void)changed(state().choice, choice, choices);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(PageChoice, ChangesOneSetting) {
  const PageState now = state();
  const auto with = [&](const std::string& setting, auto value) {
    return changed(now.choice, {.setting = setting, .value = value}, now.choices);
  };
  EXPECT_EQ(with("law", std::string("none")).law, "none");
  EXPECT_EQ(with("scene", std::string("sphere")).scene, "sphere");
  EXPECT_EQ(changed(now.choice, {.setting = "scene"}, now.choices).scene, "") << "the server's default";
  EXPECT_EQ(with("device", std::string("wall-1dof")).device, "wall-1dof");
  EXPECT_EQ(with("stiffness_N_per_m", 200.0).stiffness_N_per_m, 200.0);
  const PageChoice beside = with("law_beside", std::string("none"));
  EXPECT_EQ(beside.law_beside, "none");
  EXPECT_EQ(changed(beside, {.setting = "law_beside"}, now.choices).law_beside, std::nullopt);
}

TEST(PageChoice, IsRefusedWithWhatWouldBeAccepted) {
  const PageChoices choices = state().choices;
  EXPECT_THAT(refusal({"law", std::string("fba-exakt")}, choices), HasSubstr("fba-exact"));
  EXPECT_THAT(refusal({"law", 7.0}, choices), HasSubstr("law must be a name, got 7"));
  EXPECT_THAT(refusal({.setting = "law"}, choices), HasSubstr("law must be a name, got no value"));
  EXPECT_THAT(refusal({"scene", std::string("/etc/passwd")}, choices), HasSubstr("unknown scene"));
  EXPECT_THAT(refusal({"stiffness_N_per_m", 1e9}, choices), HasSubstr("10 to 5000"));
  EXPECT_THAT(refusal({"stiffness_N_per_m", std::string("soft")}, choices),
              HasSubstr("a number from 10 to 5000 N/m, got 'soft'"));
  EXPECT_THAT(refusal({"colour", std::string("red")}, choices), HasSubstr("(known: law, law_beside"));
  EXPECT_THAT(refusal({"scene", std::string("wall")}, {}), HasSubstr("cannot be chosen"));
  EXPECT_THAT(refusal({.setting = "scene"}, {}), HasSubstr("cannot be chosen"));
  EXPECT_THAT(refusal({"law_beside", std::string("none")}, {}), HasSubstr("simulated device"));
  EXPECT_THAT(refusal({"stiffness_N_per_m", 100.0}, {}), HasSubstr("simulated hand"));
}

TEST(Hello, TellsWhatIsChosenAndWhatCanBe) {
  PageState now = state();
  now.choice.law_beside = "none";
  now.network = page::Network{.delay_ms = 50, .jitter_ms = 10, .loss_percent = 5};
  const Json hello = Json::parse(hello_message(now, 1.5));
  EXPECT_EQ(hello["kind"], "hello");
  EXPECT_EQ(hello["protocol"], 1);
  EXPECT_EQ(hello["program"], "client");
  EXPECT_EQ(hello["time_s"], 1.5);
  EXPECT_EQ(hello["settings"]["law"], "fba-exact");
  EXPECT_EQ(hello["settings"]["law_beside"], "none");
  EXPECT_EQ(hello["settings"]["network"]["delay_ms"], 50);
  EXPECT_TRUE(hello["settings"]["stiffness_N_per_m"].is_null());
  EXPECT_EQ(hello["choices"]["laws"][0]["about"], "shows the force as it is");
  EXPECT_EQ(hello["choices"]["scenes"], Json({"sphere", "wall"}));
  EXPECT_EQ(hello["tracks"].size(), 2);
  EXPECT_TRUE(hello["recording"].is_null());
}

TEST(Hello, HasNoNetworkWithoutARelayAndOneTrackWithoutALawBeside) {
  PageState now = state();
  now.recording_file = "run.mcap";
  const Json hello = Json::parse(hello_message(now, 0));
  EXPECT_TRUE(hello["settings"]["network"].is_null());
  EXPECT_TRUE(hello["settings"]["law_beside"].is_null());
  EXPECT_EQ(hello["tracks"].size(), 1);
  EXPECT_EQ(hello["recording"], "run.mcap");
}

TEST(Messages, AreJsonWhateverTheirText) {
  const std::string text = "a \"quote\", \xff no UTF-8 and a \n";
  EXPECT_EQ(Json::parse(event_message(1, 2, "error", text))["level"], "error");
  EXPECT_EQ(Json::parse(refused_message("law", text))["about"], "law");
}

}  // namespace
}  // namespace forcebound::client
