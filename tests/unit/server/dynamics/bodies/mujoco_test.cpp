#include "forcebound/server/dynamics/bodies/mujoco.hpp"

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/tools/temporary_folder.hpp"

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
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

// An integrator and an element of MuJoCo 3.
TEST(CompileMjcf, NamesItsVersionWhereTheFileMayBeOfANewerOne) {
  const std::string version = std::string("; read by MuJoCo ") + mj_versionString() + ", which knows no words of newer";
  for (const char* newer :
       {R"(<option integrator="implicitfast"/>)", R"(<deformable/>)", R"(<option autoreset="a"/>)"}) {
    const std::string text = std::string("<mujoco>") + newer + "</mujoco>";
    EXPECT_THAT(error_of([&] { return compile_mjcf(text, "new.xml"); }),
                AllOf(StartsWith("new.xml: XML Error: "), HasSubstr(version)));
  }
  EXPECT_THAT(error_of([] { return compile_mjcf(R"(<mujoco><option timestep="x"/></mujoco>)", "a.xml"); }),
              testing::Not(HasSubstr("newer")));
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

TEST(CompileMjcf, RefusesCountsThatNoModelHas) {
  const auto refusal = [](const std::string& element) {
    return error_of([&] {
      return compile_mjcf(
          "<mujoco>" + element + "<worldbody><body name='a'><freejoint/><geom size='1'/></body></worldbody></mujoco>",
          "a.xml");
    });
  };
  EXPECT_EQ(refusal("<size njmax='500' nconmax='100' nuserdata='10' nuser_body='2'/>"), "no error");
  EXPECT_EQ(refusal("<size nuserdata='2000000000'/>"),
            "a.xml: size: nuserdata must be a whole number from -1 to 1000000, got '2000000000'");
  EXPECT_EQ(refusal("<size njmax='100001'/>"),
            "a.xml: size: njmax must be a whole number from -1 to 100000, got '100001'");
  EXPECT_THAT(refusal("<size nconmax='-2'/>"), HasSubstr("nconmax must be a whole number from -1"));
  EXPECT_THAT(refusal("<size nstack='1e12'/>"), HasSubstr("nstack must be a whole number from -1"));
  EXPECT_THAT(refusal("<size nuser_geom='100000'/>"), HasSubstr("nuser_geom must be a whole number from -1"));
  EXPECT_THAT(refusal("<custom><numeric name='n' size='999999999'/></custom>"),
              HasSubstr("numeric 'n': size must be a whole number"));
}

TEST(CompileMjcf, RefusesCompositesOfTooManyBodies) {
  const auto composite = [](const std::string& count) {
    return error_of([&] {
      return compile_mjcf("<mujoco><worldbody><body name='a'><composite type='particle' count='" + count +
                              "' spacing='0.1'><geom size='0.01'/></composite></body></worldbody></mujoco>",
                          "a.xml");
    });
  };
  EXPECT_EQ(composite("2 2 2"), "no error");
  EXPECT_EQ(composite("100 100 100"),
            "a.xml: composite: count must be whole numbers with a product of at most 10000, got '100 100 100'");
  EXPECT_THAT(composite("1000000000000 1 1"), HasSubstr("count must be whole numbers"));
  EXPECT_THAT(composite("1e6 1 1"), HasSubstr("count must be whole numbers"));
}

TEST(CompileMjcf, RefusesWhatNamesAFile) {
  const auto asset = [](const std::string& element) {
    return error_of([&] { return compile_mjcf(with_asset(element), "a.xml"); });
  };
  EXPECT_EQ(asset("<mesh name='n' file='/etc/shadow.stl'/>"),
            "a.xml: mesh 'n': file '/etc/shadow.stl': a model must name no file, its meshes have vertex and face");
  EXPECT_THAT(asset("<texture name='t' type='2d' file='a.png'/>"), HasSubstr("must name no file"));
  EXPECT_THAT(asset("<texture name='t' type='cube' fileright='a.png'/>"), HasSubstr("must name no file"));
  EXPECT_THAT(asset("<hfield name='h' size='1 1 1 1' file='/dev/zero'/>"), HasSubstr("must name no file"));
  EXPECT_EQ(error_of([] { return compile_mjcf("<mujoco><include file='b.xml'/></mujoco>", "a.xml"); }),
            "a.xml: include: file 'b.xml': a model must name no file, its meshes have vertex and face");
  EXPECT_THAT(error_of([] { return compile_mjcf("<mujoco><include file=''/></mujoco>", "a.xml"); }),
              HasSubstr("must name no file"));
  EXPECT_EQ(error_of([] { return compile_mjcf("<robot name='r'><link name='l'/></robot>", "a.xml"); }),
            "a.xml: expected <mujoco>...</mujoco>, got <robot>")
      << "whose meshes are files";
}

std::string bytes_of_model(const ModelPointer& model) {
  std::string bytes(static_cast<std::size_t>(mj_sizeModel(model.get())), '\0');
  mj_saveModel(model.get(), nullptr, bytes.data(), static_cast<int>(bytes.size()));
  return bytes;
}

constexpr const char* kMany = R"(<mujoco><option timestep="0.001" gravity="0 0 -5"/><asset><mesh name="m"
  vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset><worldbody><light/><geom type="plane" size="1 1 1"/>
  <body name="a" pos="0 0 1"><freejoint/><geom type="mesh" mesh="m"/></body>
  <body name="b" pos="3 0 1"><joint name="hinge" axis="0 1 0" damping="0.1"/><geom type="box" size="0.1 0.2 0.3"/></body>
  </worldbody><actuator><motor joint="hinge"/></actuator></mujoco>)";

TEST(CompileForeignMjcf, GivesTheSameModel) {
  for (const char* text : {kBall, kMany}) {
    const ModelPointer direct = compile_mjcf(text, "a.xml");
    const ModelPointer by_a_child = compile_foreign_mjcf(text, "a.xml");
    EXPECT_EQ(bytes_of_model(direct), bytes_of_model(by_a_child));
    const DataPointer one = make_data(*direct);
    const DataPointer other = make_data(*by_a_child);
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(step(*direct, *one) && step(*by_a_child, *other));
    EXPECT_TRUE(std::equal(one->qpos, one->qpos + direct->nq, other->qpos));
  }
}

TEST(CompileForeignMjcf, GivesTheSameErrors) {
  for (const char* text : {"", "<mujoco><worldbody><bdy/></worldbody></mujoco>", "no XML",
                           "<mujoco><option timestep='0'/></mujoco>", "<mujoco><option integrator='RK4'/></mujoco>"}) {
    const std::string direct = error_of([&] { return compile_mjcf(text, "a.xml"); });
    EXPECT_THAT(direct, StartsWith("a.xml: "));
    EXPECT_EQ(error_of([&] { return compile_foreign_mjcf(text, "a.xml"); }), direct) << text;
  }
}

TEST(CompileForeignMjcf, HasATimeLimit) {
  const child::ChildLimits none{.time = std::chrono::milliseconds{0}};
  EXPECT_EQ(error_of([&] { return compile_foreign_mjcf(kBall, "a.xml", none); }),
            "a.xml: takes longer than 0 s: expected less");
}

TEST(LoadMjcf, TakesRegularFilesUpToASize) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("a.xml");
  std::ofstream(file) << kBall;
  EXPECT_EQ(error_of([&] { return load_mjcf(file); }), "no error");
  std::filesystem::resize_file(file, (std::size_t{16} << 20U) + 1);
  EXPECT_THAT(error_of([&] { return load_mjcf(file); }), HasSubstr("it has more than 16777216 bytes"));
  EXPECT_THAT(error_of([] { return load_mjcf("/dev/zero"); }), HasSubstr("it is no regular file"));
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
