#include "forcebound/server/environment/explain.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/support/own_effects.hpp"

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(Explain, SaysWhatIsSimulatedWithUnits) {
  const std::string text = explain(*load_scene("plane"));
  EXPECT_THAT(text, HasSubstr("devices: 3 or 6 degrees of freedom\n"));
  EXPECT_THAT(text, HasSubstr("object 'table': half_space, through_m [0, 0, 0], normal [0, 0, 1]\n"));
  EXPECT_THAT(text, HasSubstr("effect 'surface': stiffness_N_per_m 2000, damping_N_s_per_m 1\n"));
  EXPECT_THAT(text, HasSubstr("velocity from successive motions\n"));
  EXPECT_THAT(text, HasSubstr("rendering:  runs at the client\n"));
  EXPECT_THAT(text,
              AllOf(HasSubstr("not simulated: torques; bodies and tissue (there are none); effects that the scene "
                              "does not ask for: "),
                    Not(HasSubstr("velocity (nothing needs it)"))));
}

TEST(Explain, NamesTheToolInTheHandAndTheTorquesThatItMakes) {
  const std::string text = explain(*parse_scene(
      "scene = { name = 'probe', description = '', degrees_of_freedom = 3 }\n[tool]\ntip_m = [0, 0, -0.1]\n",
      "probe.toml"));
  EXPECT_THAT(text, HasSubstr("\ntool: [0, 0, -0.1] m from the grip to its tip"));
  EXPECT_THAT(text, HasSubstr("\nnot simulated: torques but those of the tool; "));
  EXPECT_THAT(explain(*load_scene("plane")), Not(HasSubstr("tool")));
}

TEST(Explain, SaysWhatClientsRefuseToRun) {
  std::ostringstream toml;
  toml << "scene = { name = 'crowd', description = '', degrees_of_freedom = 3 }\n";
  for (int i = 0; i <= 1024; ++i) {
    toml << "[[field]]\nname = 'pull_" << i << "'\neffects = ['constant_force']\n"
         << "[field.constant_force]\nforce_N = [0, 0, 0.001]\n";
  }
  const std::string text = explain(*parse_scene(toml.str(), "crowd.toml"));
  EXPECT_THAT(text, HasSubstr("rendering:  computed here, held at the client: clients refuse the scene: the scene has "
                              "1025 parts and 0 geometries, at most 1024 of each are accepted\n"));
  EXPECT_THAT(text, Not(HasSubstr("runs at the client")));
}

TEST(Explain, SaysWhatIsNotSimulated) {
  const std::string wall = explain(*load_scene("wall"));
  EXPECT_THAT(explain(*load_scene("soft_pad")), HasSubstr("rendering:  local model with each answer\n"));
  EXPECT_THAT(explain(*load_scene("palpation")), HasSubstr("rendering:  runs at the client\n"));
  EXPECT_THAT(wall, Not(HasSubstr("velocity from")));
  EXPECT_THAT(wall, HasSubstr("not simulated: torques; velocity (nothing needs it)"));
  const std::string free = explain(*load_scene("free"));
  EXPECT_THAT(free, HasSubstr("no objects: every force is zero\n"));
  EXPECT_THAT(free, HasSubstr("effects that the scene does not ask for: surface, "));
}

TEST(Explain, SaysWhatEachPartCostsAndWhetherItCanRing) {
  const std::string text = explain(*load_scene("wall"), {.answer_bytes = 123});
  EXPECT_THAT(text, HasSubstr("passive without a law on a device with damping above 25 N s/m (b > K T/2 + B: "));
  EXPECT_THAT(text, HasSubstr("0 bytes for each client\n"));
  EXPECT_THAT(text, HasSubstr("ns predicted of the 1 ms of a tick"));
  EXPECT_THAT(text, HasSubstr("\n              margin 0.04 for a device of 1 N s/m\n"));
  EXPECT_THAT(text, HasSubstr("123 bytes an answer, 123 kB/s to each client at 1 kHz\n"));
  EXPECT_THAT(text, Not(HasSubstr("measured")));
}

TEST(Explain, ShowsWhatWasMeasuredBesideWhatWasPredicted) {
  const ExplainFacts facts{.calibration =
                               Calibration{.parts = {{1500, 2500}}, .motion = {100, 150}, .whole = {1.6e6, 2e6}}};
  const std::string text = explain(*load_scene("wall"), facts);
  EXPECT_THAT(text, AllOf(HasSubstr("predicted, 100 ns measured (p99 150 ns), besides the parts below\n"),
                          HasSubstr("predicted, 1.4 us measured (p99 2.4 us)\n")));
  EXPECT_THAT(text, HasSubstr("1.6 ms measured (p99 2 ms) of the 1 ms of a tick: by the p99 200 % for each client; at "
                              "1 kHz one core holds 0\n"));
}

TEST(Explain, ListsPredictedCostsThatAddUpToTheTotal) {
  const std::string text = explain(*load_scene("wall"));
  const auto number_after = [&](const std::string& name) {
    const std::size_t at = text.find(name);
    EXPECT_NE(at, std::string::npos) << name;
    return std::stod(text.substr(at + name.size()));
  };
  EXPECT_EQ(number_after("motion:  ") + number_after("cost:  "), number_after("total:  ")) << text;
}

TEST(Explain, MarksPartsQuarantinedDuringTheMeasurement) {
  const ExplainFacts facts{.calibration = Calibration{.parts = {{1500, 2500, true}}, .whole = {1.6e6, 2e6, true}}};
  EXPECT_THAT(explain(*load_scene("wall"), facts), HasSubstr("(p99 2.5 us), but left out during it"));
}

TEST(Explain, MarginsAreForTheGivenDeviceAndNetwork) {
  const std::string text = explain(*load_scene("plane"), {.device = {.damping_N_s_per_m = 4, .round_trip_s = 0.0195}});
  EXPECT_THAT(text, HasSubstr("damping above 2 N s/m (b > K T/2 + B: K 2000 N/m, B 1 N s/m, T 1 ms)"));
  EXPECT_THAT(text, HasSubstr("margin 2 for a device of 4 N s/m, 0.0976 behind a round trip of 19.5 ms\n"));
}

TEST(Explain, AddsUpStiffnessAtOnePlace) {
  const std::string text = explain(*load_scene("microsurgery"));
  EXPECT_THAT(text, HasSubstr("all at one place: passive without a law on a device with damping above 42.1 N s/m"));
  EXPECT_THAT(explain(*load_scene("wall")), Not(HasSubstr("all at one place")));
}

TEST(Explain, MarksEnergySources) {
  EXPECT_THAT(explain(*load_scene("drive")), HasSubstr("drives the device with energy of its own"));
  EXPECT_THAT(explain(*load_scene("gravity")), Not(HasSubstr("energy of its own")));
}

TEST(Explain, GivesTheBoundingBoxOfFiniteShapes) {
  EXPECT_THAT(explain(*load_scene("box")),
              HasSubstr("box:        [-0.03, -0.03, -0.02] to [0.03, 0.03, 0.02] m,\n              60 x 60 x 40 mm\n"));
  EXPECT_THAT(explain(*load_scene("circle")),
              HasSubstr("[-0.04, -0.04] to [0.04, 0.04] m,\n              80 x 80 mm\n"));
  EXPECT_THAT(explain(*load_scene("palpation")), HasSubstr("60 x 60 x 30 mm\n"));
  EXPECT_THAT(explain(*load_scene("plane")), Not(HasSubstr("box: "))) << "it has no end";
}

std::string ball(const std::string& radius_m, const std::string& center_m = "[0, 0, 0]", const std::string& more = "") {
  return "[scene]\nname = 's'\ndescription = ''\ndegrees_of_freedom = 3\n" + more +
         "[[object]]\nname = 'ball'\neffects = ['surface']\nsurface = { stiffness_N_per_m = 100 }\n"
         "shape = { kind = 'sphere', center_m = " +
         center_m + ", radius_m = " + radius_m + " }\n";
}

TEST(Explain, HasNoControlCharactersOfTheFile) {
  const auto scene = parse_scene(
      "[scene]\nname = 's'\ndescription = \"\\u001b[2Jowned\\nobject\"\ndegrees_of_freedom = 3\n", "s.toml");
  EXPECT_THAT(explain(*scene), HasSubstr("): ?[2Jowned?object\n"));
}

TEST(Explain, WarnsOfImplausibleSizes) {
  EXPECT_THAT(explain(*parse_scene(ball("0.5"), "s.toml")), Not(HasSubstr("warning")));
  EXPECT_THAT(explain(*parse_scene(ball("0.51"), "s.toml")), HasSubstr("warning: larger than 1 m for a hand"));
  EXPECT_THAT(explain(*parse_scene(ball("0.0005"), "s.toml")), Not(HasSubstr("warning")));
  EXPECT_THAT(explain(*parse_scene(ball("0.00049"), "s.toml")), HasSubstr("warning: smaller than 1 mm for a hand"));
}

std::string explained_with_hand(const std::string& text) {
  const auto scene = parse_scene(text, "s.toml");
  const SuggestedHand suggested = suggested_hand(scene);
  return explain(*scene, {.hand = ExplainedHand{suggested, try_hand(scene, suggested)}});
}

TEST(Explain, GivesTheSuggestedHandAndItsTrial) {
  EXPECT_THAT(explained_with_hand(ball("0.03")),
              HasSubstr("hand:         --device omni --operator stroke:offset_z_m=0.03\n"
                        "              computed from the scene; feels something after 0."));
  EXPECT_THAT(explained_with_hand(ball("0.02", "[0, 0, 0]", "suggested_hand = 'trace-sphere'\n")),
              HasSubstr("hand:         --device omni --operator trace-sphere\n"
                        "              by the scene's author; feels something after 0."));
}

TEST(Explain, WarnsOfAHandThatStartsInsideOrNeverTouches) {
  EXPECT_THAT(explained_with_hand(ball("0.03", "[0, 0, 0.02]", "suggested_hand = 'stroke'\n")),
              HasSubstr("warning: it starts inside an object\n"));
  EXPECT_THAT(explained_with_hand(ball("0.03", "[0, 0, 5]")),
              HasSubstr("warning: it feels nothing within 10 s\n"
                        "              (tried in virtual time, without a network)\n"))
      << "no omni reaches as far";
}

TEST(Explain, DistinguishesFieldsFromObjects) {
  const std::string text = explain(*test::scene_with_own_effects("[[field]]\nname = 'fog'\neffects = ['clock']\n"));
  EXPECT_THAT(text, HasSubstr("field 'fog'\n  effect 'clock'\n"));
  EXPECT_THAT(text, HasSubstr("implies:    time by the device's clock\n"));
  EXPECT_THAT(text, HasSubstr("8 bytes for each client\n"));
  EXPECT_THAT(text, HasSubstr("stability:  neither stiffness nor damping: nothing that could ring\n"));
}

TEST(Summary, IsOneLine) {
  EXPECT_EQ(summary(*load_scene("sphere")), "ball (sphere): surface stiffness_N_per_m 10000, damping_N_s_per_m 0");
  EXPECT_EQ(summary(*load_scene("free")), "no objects: every force is zero");
}

}  // namespace
}  // namespace forcebound::server
