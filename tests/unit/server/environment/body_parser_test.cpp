#include "forcebound/server/environment/body_parser.hpp"

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "forcebound/server/environment/explain.hpp"
#include "forcebound/server/environment/scene_parser.hpp"

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string with_bodies(const std::string& rest) {
  return "[scene]\nname = \"bodies\"\ndescription = \"\"\ndegrees_of_freedom = 3\n" + rest;
}

std::shared_ptr<const scene::Scene> parse(const std::string& rest) {
  return parse_scene(with_bodies(rest), "bodies.toml");
}

auto body_refused(const std::string& what) {
  return testing::ThrowsMessage<SceneError>(AllOf(StartsWith("bodies.toml:"), HasSubstr(what)));
}

const std::string kFloor =
    "[[body]]\nname = \"floor\"\nfixed = true\n"
    "shape = { kind = \"box\", center_m = [0, 0, -0.05], size_m = [1, 1, 0.1] }\n";
const std::string kBall =
    "[[body]]\nname = \"ball\"\nmass_kg = 0.1\nshape = { kind = \"sphere\", center_m = [0, 0, 0.02], radius_m = 0.02 "
    "}\n";

TEST(BodyParser, MakesOneDynamicModelOfAllBodiesWithShapes) {
  const auto scene =
      parse(kFloor + kBall +
            "[[body]]\nname = \"rod\"\nmass_kg = 0.1\n"
            "shape = { kind = \"capsule\", from_m = [0.1, 0, 0.01], to_m = [0.2, 0, 0.01], radius_m = 0.01 }\n");
  ASSERT_EQ(scene->dynamic_models().size(), 1U);
  EXPECT_EQ(scene->dynamic_models().front().text, "bodies 'floor', 'ball', 'rod'");
  EXPECT_THAT(explain(*scene), AllOf(HasSubstr("degrees of freedom, by MuJoCo in steps of 0.001 s"),
                                     HasSubstr("each client has dynamic models of its own")));
}

TEST(BodyParser, ScenesWithoutBodiesSayThatNoneAreSimulated) {
  EXPECT_THAT(explain(*parse("")), HasSubstr("bodies and tissue (there are none)"));
}

TEST(BodyParser, TakesMjcfFromTheSceneItself) {
  const auto scene = parse(
      "[[body]]\nname = \"pendulum\"\nprobes = [\"bob\"]\nmjcf_text = '''<mujoco><worldbody><body name=\"bob\">"
      "<freejoint/><geom size=\"0.1\"/></body></worldbody></mujoco>'''\n");
  ASSERT_EQ(scene->dynamic_models().size(), 1U);
  EXPECT_EQ(scene->dynamic_models().front().name, "pendulum");
  EXPECT_EQ(scene->dynamic_models().front().dynamic_model->facts().seats_max, 1);
}

TEST(BodyParser, RefusalNamesBodyAndLine) {
  EXPECT_THAT(
      [] { parse("[[body]]\nname = \"a\"\nshape = { kind = \"sphere\", center_m = [0, 0, 0], radius_m = 1 }\n"); },
      body_refused("body 'a': 'mass_kg' is missing"));
  EXPECT_THAT([] { parse(kBall + "fixed = true\n"); },
              body_refused("body 'ball': a body is either fixed or has mass_kg"));
  EXPECT_THAT([] { parse(kBall + "mas_kg = 3\n"); }, body_refused("unknown key 'mas_kg', did you mean 'mass_kg'?"));
  EXPECT_THAT([] { parse(kBall + kBall); }, body_refused("two [[body]] are named 'ball'"));
  EXPECT_THAT([] { parse("[bodies]\ntimestep_s = 0.001\n"); }, body_refused("of which there is none"));
  EXPECT_THAT([] { parse(kBall + "[bodies]\ntimestep_s = 0.1\n"); }, body_refused("timestep_s must be"));
  EXPECT_THAT([] { parse("[[body]]\nname = \"a\"\nprobes = [\"x\"]\nmjcf = \"none.xml\"\n"); },
              body_refused("none.xml"));
  EXPECT_THAT([] { parse("[[body]]\nname = \"a\"\nprobes = [\"x\"]\nmjcf_text = '<mujoco><worl/></mujoco>'\n"); },
              body_refused("mjcf_text"));
}

TEST(BodyParser, RefusesABodyWithoutShapeOrModel) {
  EXPECT_THAT(
      [] { parse("[[body]]\nname = \"a\"\nprobes = [\"x\"]\nmjcf_tex = ''\n"); },
      body_refused("body 'a': one of 'mjcf', 'mjcf_text', 'shape' must be given, is 'mjcf_tex' a misspelling of "
                   "'mjcf_text'?"));
  EXPECT_THAT([] { parse(kBall + "mjcf = 'a.xml'\nprobes = ['x']\n"); },
              body_refused("body 'ball': unknown key 'mass_kg'"));
}

TEST(BodyParser, PassesOnTheReasonThatMuJoCoGivesForABadModel) {
  const auto with = [](const std::string& model) {
    return [model] {
      parse("[[body]]\nname = \"peg\"\nprobes = [\"b\"]\nmjcf_text = '''<mujoco>" + model + "</mujoco>'''\n");
    };
  };
  const auto geom = [&](const std::string& attributes) {
    return with("<worldbody><body name=\"b\"><freejoint/><geom " + attributes + "/></body></worldbody>");
  };
  const auto peg = [](const std::string& reason) { return body_refused("body 'peg': mjcf_text: " + reason); };
  EXPECT_THAT(geom("type=\"box\" size=\"0.1\""), peg("Error: sizes must be positive in object"));
  EXPECT_THAT(geom("type=\"bax\" size=\"0.1\""), peg("XML Error: invalid keyword: 'bax'"));
  EXPECT_THAT(geom("size=\"0.1\" mass=\"-1\""), peg("Error: mass, inertia or density are negative"));
  EXPECT_THAT(geom("type=\"mesh\" mesh=\"none\""), peg("Error: mesh 'none' not found in geom"));
  EXPECT_THAT(geom("type=\"mesh\" mesh=\"none\""), body_refused("line = 1"));
  EXPECT_THAT(with("<size nstack=\"10\"/>"), peg("Error: engine error: Stack overflow"));
  EXPECT_THAT(with("<option integrator=\"RK4\"/>"), peg("integrator must be Euler or implicit, got RK4"));
}

const std::string kPendulum =
    "[[body]]\nname = \"pendulum\"\nprobes = [\"bob\"]\nmjcf_text = '''<mujoco><option solver=\"CG\" iterations=\"7\" "
    "tolerance=\"1e-5\"/><worldbody><body name=\"bob\"><freejoint/><geom "
    "size=\"0.1\"/></body></worldbody></mujoco>'''\n";

TEST(BodyParser, KeepsMuJoCosSolverUnlessTheSceneSetsOne) {
  EXPECT_THAT(explain(*parse(kFloor + kBall)),
              HasSubstr("contact forces by newton, iterations at most 100, tolerance 1e-08"));
  EXPECT_THAT(explain(*parse(kPendulum)), HasSubstr("contact forces by cg, iterations at most 7, tolerance 1e-05"));
}

TEST(BodyParser, GivesBodiesTheSolverThatTheSceneAsksFor) {
  EXPECT_THAT(explain(*parse(kFloor + kBall + "[bodies]\nsolver = \"pgs\"\niterations = 20\ntolerance = 0\n")),
              HasSubstr("contact forces by pgs, iterations at most 20, tolerance 0"));
  EXPECT_THAT(explain(*parse(kPendulum + "solver = \"newton\"\n")),
              HasSubstr("contact forces by newton, iterations at most 7, tolerance 1e-05"));
  EXPECT_THAT(explain(*parse(kPendulum + "iterations = 1\ntolerance = 0.001\n")),
              HasSubstr("contact forces by cg, iterations at most 1, tolerance 0.001"));
}

TEST(BodyParser, GivesTheProbeAGraspWhereTheSceneAsksForOne) {
  EXPECT_THAT(explain(*parse(kFloor + kBall)), testing::Not(HasSubstr("is pressed")));
  EXPECT_THAT(explain(*parse(kFloor + kBall + "[bodies]\ngrasp_button = 1\ngrasp_N_max = 4\n")),
              HasSubstr("while button 1 is pressed, a device holds the body that it touches, up to 4 N"));
  EXPECT_THAT([] { parse(kBall + "[bodies]\ngrasp_button = 32\n"); },
              body_refused("grasp_button must be a whole number from 0 to 31, got 32"));
  EXPECT_THAT([] { parse(kBall + "[bodies]\ngrasp_button = 0\ngrasp_N_max = 0\n"); },
              body_refused("grasp_N_max must be > 0"));
}

TEST(BodyParser, RefusesASolverThatMuJoCoDoesNotHave) {
  const auto with = [](const std::string& what) { return [what] { parse(kBall + "[bodies]\n" + what + "\n"); }; };
  EXPECT_THAT(with("solver = \"newtn\""),
              body_refused("bodies: unknown solver 'newtn', did you mean 'newton'? (known: newton, cg, pgs)"));
  EXPECT_THAT(with("solver = 3"), body_refused("solver must be text, got 3"));
  EXPECT_THAT(with("iterations = 0"), body_refused("iterations must be a whole number from 1 to 1000, got 0"));
  EXPECT_THAT(with("iterations = 1001"), body_refused("iterations must be a whole number from 1 to 1000, got 1001"));
  EXPECT_THAT(with("iterations = 1.5"), body_refused("iterations must be a whole number from 1 to 1000, got 1.5"));
  EXPECT_THAT(with("tolerance = -1e-9"), body_refused("tolerance must be >= 0 and <= 1"));
  EXPECT_THAT([] { parse(kPendulum + "iterations = 0\n"); },
              body_refused("body 'pendulum': iterations must be a whole number"));
}

TEST(BodyParser, RefusesAnUnstableCoupling) {
  EXPECT_THAT([] { parse(kBall + "[bodies]\nstiffness_N_per_m = 200000\n"); },
              body_refused("is unstable with an apparent mass of"));
}

TEST(BodyParser, RefusesBodiesThatBeginWithinEachOther) {
  EXPECT_THAT(
      [] {
        parse(kBall +
              "[[body]]\nname = \"twin\"\nmass_kg = 1\n"
              "shape = { kind = \"sphere\", center_m = [0.01, 0, 0.02], radius_m = 0.02 }\n");
      },
      body_refused("'ball' and 'twin' begin 0.03 m within each other"));
}

TEST(BodyParser, RefusesAProbeThatTwoDevicesWouldDrag) {
  EXPECT_THAT(
      [] {
        parse(
            "[[body]]\nname = \"a\"\nprobes = [\"x\", \"x\"]\nmjcf_text = '''<mujoco><worldbody><body name=\"x\">"
            "<freejoint/><geom size=\"0.1\"/></body></worldbody></mujoco>'''\n");
      },
      body_refused("probes must differ, got 'x' twice"));
}

TEST(BodyParser, RefusesASharedSceneThatCouldNotBeginForAllItsClients) {
  const std::string shared = "[scene]\nname = \"s\"\ndescription = \"\"\ndegrees_of_freedom = 3\nshared = true\n";
  EXPECT_NO_THROW(parse_scene(shared + kBall, "bodies.toml"));
  // The memory suffices for one client only.
  static std::size_t most_bytes = 0;
  most_bytes = 0;
  mju_user_malloc = [](std::size_t bytes) {
    most_bytes = std::max(most_bytes, bytes);
    return std::aligned_alloc(64, (bytes + 63) / 64 * 64);
  };
  (void)parse(kBall)->dynamic_models().front().dynamic_model->make_state(1);
  // What MuJoCo had got by then it forgets, and takes for the end of the program: kept here, for no leak to be told.
  static auto* const kKept = new std::vector<void*>;
  mju_user_malloc = [](std::size_t bytes) {
    if (bytes > most_bytes) return static_cast<void*>(nullptr);
    return kKept->emplace_back(std::aligned_alloc(64, (bytes + 63) / 64 * 64));
  };
  EXPECT_THAT([&] { parse_scene(shared + kBall, "bodies.toml"); }, body_refused("'bodies' for 4 clients: "));
  mju_user_malloc = nullptr;
}

TEST(BodyParser, NeedsThreeAxes) {
  EXPECT_THAT(
      [] {
        parse_scene("[scene]\nname = \"flat\"\ndescription = \"\"\ndegrees_of_freedom = 2\n" + kBall, "bodies.toml");
      },
      body_refused("bodies and tissue need a scene of 3 degrees of freedom"));
}

TEST(BodyParser, SharedScenesNeedSomethingToShareAndRoomInIt) {
  const std::string shared = "[scene]\nname = \"s\"\ndescription = \"\"\ndegrees_of_freedom = 3\nshared = true\n";
  EXPECT_THAT([&] { parse_scene(shared, "bodies.toml"); }, body_refused("of which this one has neither"));
  EXPECT_EQ(parse_scene(shared + kBall, "bodies.toml")->facts().clients_max, 4);
  EXPECT_THAT(
      [&] {
        parse_scene(
            shared +
                "[[body]]\nname = \"one\"\nprobes = [\"bob\"]\nmjcf_text = '''<mujoco><worldbody><body name=\"bob\">"
                "<freejoint/><geom size=\"0.1\"/></body></worldbody></mujoco>'''\n",
            "bodies.toml");
      },
      body_refused("'one' has room for 1 client, got clients_max 4"));
}

}  // namespace
}  // namespace forcebound::server
