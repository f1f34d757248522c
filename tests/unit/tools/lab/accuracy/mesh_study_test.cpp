#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/meshes.hpp"
#include "tests/support/process.hpp"
#include "tests/tools/lab/accuracy/study_text.hpp"
#include "tests/unit/tools/lab/accuracy/floor_study.hpp"

namespace forcebound::lab {
namespace {

using testing::HasSubstr;

/// A ball of 50 mm of many triangles, which a hand presses on from above.
class StudyOfAMesh : public testing::Test {
 protected:
  StudyOfAMesh() {
    std::ofstream file(folder_.file("ball.obj"));
    const test::Soup ball = test::ball(0.05, 50);
    for (const test::Point& v : ball.vertices) file << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
    for (const test::Triangle& t : ball.triangles) {
      file << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    }
  }

  [[nodiscard]] StudyResult study(double round_trip_s, const std::string& details) const {
    Study study = floor_study(round_trip_s);
    study.scene_text =
        "[scene]\nname = 'ball'\ndescription = ''\ndegrees_of_freedom = 3\n"
        "[[object]]\nname = 'ball'\nshape = { kind = 'mesh', file = 'ball.obj' }\n"
        "effects = ['surface']\nsurface = { stiffness_N_per_m = 300 }\n";
    study.scene_file = folder_.file("ball.toml");
    study.sweep = parse_sweep("object.ball.shape.detail=" + details);
    study.duration_s = 1.2;
    return carry_out(study, EvenClock());
  }

  test::TemporaryFolder folder_;
};

TEST_F(StudyOfAMesh, TakesTheFilesOwnTrianglesAsExactAndIsWrongerForEachThatIsGone) {
  const StudyResult result = study(0.001, "1,0.2,0.01");
  EXPECT_THAT(result.reference_why, HasSubstr("the mesh as its file has it"));
  ASSERT_EQ(result.settings.size(), 3U);
  EXPECT_EQ(result.settings[0].value, "0.01") << "from coarse to fine";
  EXPECT_GT(result.settings[0].at_states.force, result.settings[1].at_states.force);
  EXPECT_GT(result.settings[1].at_states.force, 0);
  EXPECT_EQ(result.settings[2].at_states.force, 0);
  EXPECT_EQ(what_does_not_matter(result), "") << "nothing hides the coarsest behind 1 ms";
}

TEST_F(StudyOfAMesh, SaysThatDetailIsNegligibleBesideALongDelay) {
  EXPECT_THAT(what_does_not_matter(study(0.05, "0.2,1")),
              HasSubstr("object.ball.shape.detail is negligible beside the network's age behind every round trip"));
}

}  // namespace
}  // namespace forcebound::lab
