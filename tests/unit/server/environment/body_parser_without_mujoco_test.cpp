#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/server/environment/scene_parser.hpp"

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string refusal_of_bodies(const std::string& bodies) {
  try {
    (void)parse_scene("[scene]\nname = 'x'\ndescription = ''\ndegrees_of_freedom = 3\n" + bodies, "x.toml");
    return "no error";
  } catch (const SceneError& error) {
    return error.what();
  }
}

TEST(BodyParserWithoutMuJoCo, RefusesEveryBodyAndSaysWhatToInstall) {
  EXPECT_FALSE(has_bodies());
  EXPECT_THAT(refusal_of_bodies("[[body]]\nname = 'peg'\nmass_kg = 1\n"),
              AllOf(StartsWith("x.toml:5: "), HasSubstr("MuJoCo"), HasSubstr("libmujoco-dev")));
  EXPECT_THAT(refusal_of_bodies("\n[bodies]\ntimestep_s = 0.001\n"),
              AllOf(StartsWith("x.toml:6: "), HasSubstr("MuJoCo")));
}

}  // namespace
}  // namespace forcebound::server
