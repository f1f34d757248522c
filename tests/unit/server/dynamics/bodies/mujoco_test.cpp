#include "forcebound/server/dynamics/bodies/mujoco.hpp"

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/tools/temporary_folder.hpp"

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* kBall =
    R"(<mujoco><worldbody><body name="a"><freejoint/><geom size="1"/></body></worldbody></mujoco>)";

template <class Call>
std::string error_of(const Call& call) {
  try {
    (void)call();
  } catch (const BodiesError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CompileMjcf, NamesFileAndLine) {
  EXPECT_THAT(error_of([] { return compile_mjcf("<mujoco><worldbody><bdy/></worldbody></mujoco>", "broken.xml"); }),
              AllOf(StartsWith("broken.xml: XML Error: Schema violation: unrecognized element"), HasSubstr("line 1")));
  EXPECT_THAT(error_of([] { return load_mjcf("/no/such.xml"); }), StartsWith("/no/such.xml: "));
}

TEST(CompileMjcf, RefusesWhatWouldEndMuJoCoOrItsFirstStep) {
  const auto refusal = [](const std::string& option) -> std::string {
    try {
      (void)compile_mjcf(
          "<mujoco>" + option + R"(<worldbody><body name="a"><freejoint/><geom size="1"/></body></worldbody></mujoco>)",
          "a.xml");
    } catch (const BodiesError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal(""), "accepted");
  EXPECT_EQ(refusal(R"(<option timestep="0"/>)"), "a.xml: timestep must be >= 1e-04 and <= 0.01 s, got 0");
  EXPECT_EQ(refusal(R"(<option timestep="-1"/>)"), "a.xml: timestep must be >= 1e-04 and <= 0.01 s, got -1");
  EXPECT_THAT(refusal(R"(<option timestep="nan"/>)"), HasSubstr("timestep must be >= 1e-04"));
  EXPECT_THAT(refusal(R"(<option gravity="0 0 1e300"/>)"), HasSubstr("cannot take the first step"));
  EXPECT_THAT(refusal(R"(<size nstack="10"/>)"), HasSubstr("a.xml: Error: engine error: Stack overflow"));
  try {
    (void)compile_mjcf("", "empty.xml");
    ADD_FAILURE() << "accepted";
  } catch (const BodiesError& error) {
    EXPECT_STREQ(error.what(), "empty.xml: is empty, expected <mujoco>...</mujoco>");
  }
}

std::string with_asset(const std::string& asset) {
  return "<mujoco><!-- <texture> --><asset>" + asset +
         "</asset><worldbody><body name='a'><freejoint/><geom size='1'/>"
         "</body></worldbody></mujoco>";
}

TEST(CompileMjcf, RefusesFacesWithVerticesThatTheMeshLacks) {
  const auto mesh = [](const std::string& face) {
    return error_of([&] {
      return compile_mjcf(with_asset("<mesh name = 'n' vertex=\"0 0 0 1 0 0 0 1 0\n0 0 1\" face='" + face + "'/>"),
                          "a.xml");
    });
  };
  EXPECT_EQ(mesh("0 2 1 0 1 3 0 3 2 1 2 3"), "no error");
  EXPECT_EQ(mesh("-100000 2 1 0 1 3"),
            "a.xml: mesh 'n': face must have numbers of its 4 vertices, from 0 on, got -100000");
  EXPECT_EQ(mesh("0 2 1 0 99999999 3"),
            "a.xml: mesh 'n': face must have numbers of its 4 vertices, from 0 on, got 99999999");
  EXPECT_EQ(mesh("0 2 1 0 1 4"), "a.xml: mesh 'n': face must have numbers of its 4 vertices, from 0 on, got 4");
}

TEST(CompileMjcf, RefusesTexturesWhoseSizeMuJoCoCannotHold) {
  const auto textures = [](const std::string& assets) {
    return error_of([&] { return compile_mjcf(with_asset(assets), "a.xml"); });
  };
  const auto texture = [&](const std::string& rest) {
    return textures("<texture name='t' builtin='checker' " + rest + "/>");
  };
  EXPECT_EQ(texture("type='2d' width='100' height='50'"), "no error");
  EXPECT_EQ(texture("type='2d' width='40000' height='40000'"),
            "a.xml: texture 't': all textures must take at most 268435456 bytes together, got 4800000000");
  EXPECT_EQ(texture("type='2d' width='&#12;40000' height='40000'"),
            "a.xml: texture 't': all textures must take at most 268435456 bytes together, got 4800000000");
  EXPECT_EQ(texture("type='2d' width='40000abc' height='40000'"),
            "a.xml: texture 't': width must be a whole number >= 0, got '40000abc'");
  EXPECT_THAT(texture("type='cube' width='40000'"), StartsWith("a.xml: texture 't': all textures must take at most"));
  const std::string half = " builtin='flat' type='2d' width='8000' height='8000'/>";
  EXPECT_THAT(textures("<texture name='s'" + half + "<texture name='t'" + half),
              StartsWith("a.xml: texture 't': all textures must take at most"));
  EXPECT_THAT(textures("<texture name='t' type='2d' file='none.png' width='16384' height='16384'/>"),
              Not(HasSubstr("must take at most")))
      << "the file's size counts";
}

TEST(CompileMjcf, RefusesHeightFieldsWhoseSizeMuJoCoCannotHold) {
  const auto field = [](const std::string& rest) {
    return error_of(
        [&] { return compile_mjcf(with_asset("<hfield name='h' size='1 1 1 1' " + rest + "/>"), "a.xml"); });
  };
  EXPECT_EQ(field("nrow='10' ncol='20'"), "no error");
  EXPECT_EQ(field("nrow='65536' ncol='65537'"),
            "a.xml: hfield 'h': all height fields must take at most 268435456 bytes together, got 17180131328");
}

TEST(LoadMjcf, ChecksIncludedFiles) {
  const test::TemporaryFolder folder;
  const std::string outer = folder.file("outer.xml");
  std::ofstream(folder.file("faces.xml"))
      << with_asset("<mesh name='n' vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='-100000 2 1'/>");
  for (const char* name : {"faces.xml", "/faces.xml"}) {
    std::ofstream(outer) << "<mujoco><include file='" << name << "'/><include file=''/></mujoco>";
    EXPECT_EQ(error_of([&] { return load_mjcf(outer); }),
              outer + ": mesh 'n': face must have numbers of its 4 vertices, from 0 on, got -100000");
  }
  std::ofstream(outer) << "<mujoco><include file='/dev/zero'/></mujoco>";
  EXPECT_THAT(error_of([&] { return load_mjcf(outer); }), HasSubstr("/dev/zero")) << "and not: reads it without end";
}

TEST(CompileMjcf, TakesTheIntegratorsThatTheCouplingIsMadeFor) {
  const auto with = [](const std::string& integrator) {
    return error_of(
        [&] { return compile_mjcf("<mujoco><option integrator='" + integrator + "'/></mujoco>", "a.xml"); });
  };
  EXPECT_EQ(with("Euler"), "no error");
  EXPECT_EQ(with("implicit"), "no error");
  EXPECT_EQ(with("RK4"), "a.xml: integrator must be Euler or implicit, got RK4");
}

TEST(CompileMjcf, GivesMuJoCosReasonWhereThereIsNoMemory) {
  (void)compile_mjcf(kBall, "ball.xml");
  mju_user_malloc = [](std::size_t) -> void* { return nullptr; };
  const std::string error = error_of([] { return compile_mjcf(kBall, "ball.xml"); });
  mju_user_malloc = nullptr;
  EXPECT_EQ(error, "ball.xml: Could not allocate memory");
  EXPECT_EQ(error_of([] { return compile_mjcf(kBall, "ball.xml"); }), "no error") << "and goes on";
}

TEST(MakeData, GivesMuJoCosReason) {
  const ModelPointer model = compile_mjcf(kBall, "ball.xml");
  const ModelPointer narrow = copy_of(*model);
  narrow->nstack = 10;
  EXPECT_EQ(error_of([&] { return make_data(*narrow); }),
            "MuJoCo cannot compute the bodies' positions: Stack overflow");
}

TEST(Step, ThatFailsInMuJoCoReturnsFalse) {
  const ModelPointer model = compile_mjcf(kBall, "ball.xml");
  const DataPointer data = make_data(*model);
  EXPECT_TRUE(step(*model, *data));
  data->nstack = 10;
  EXPECT_FALSE(step(*model, *data));
  EXPECT_FALSE(find_contacts(*model, *data));
}

TEST(ErrorHandlers, OfTheProgramHearOfItsOwnErrorsAndWarnings) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto own_error = [] {
    mju_user_warning = [](const char* warning) { std::fprintf(stderr, "the program's %s, ", warning); };
    mju_user_error = [](const char* error) {
      std::fprintf(stderr, "the program's %s", error);
      std::_Exit(3);
    };
    (void)compile_mjcf(kBall, "ball.xml");
    mju_warning("own warning");
    mju_error("own error");
  };
  EXPECT_EXIT(own_error(), testing::ExitedWithCode(3), "the program's own warning, the program's own error");
}

TEST(ErrorHandlers, WithoutAnyTheProcessEndsAndSaysWhy) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto own_error = [] {
    (void)compile_mjcf(kBall, "ball.xml");
    mju_error("its own");
  };
  EXPECT_DEATH(own_error(), "MuJoCo: its own");
}

}  // namespace
}  // namespace forcebound::server
