#include "tests/tools/lab/figure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "tests/unit/record/sample_run.hpp"

namespace forcebound::lab {
namespace {

using record::test::TemporaryFile;
using ::testing::AllOf;
using ::testing::HasSubstr;

Figure figure_sample() {
  Panel panel{"Force", "force [N]", {}, {{1.5, "limit"}}, {}, {}};
  panel.series = {{"it's \"applied\" $x %s \\", {0, 1, 2, 3}, {1, 2, NAN, 3}}};
  return {"title", "K_1 {x}^2 'quoted'\nsecond", "time [s]", {panel, {"Empty", "y", {}, {}, {}, {}}}};
}

std::string refusal_of(const Figure& figure, const std::filesystem::path& png) {
  try {
    draw(figure, png);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

TEST(Figure, IsDrawnAsAPngWhateverItsTexts) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed (gnuplot-nox)";
  const TemporaryFile png("figure 'quoted'.png");
  draw(figure_sample(), png.path());
  std::ifstream in(png.path(), std::ios::binary);
  std::string head(24, '\0');
  in.read(head.data(), 24);
  ASSERT_TRUE(in);
  EXPECT_EQ(head.substr(1, 3), "PNG");
  const auto width = static_cast<unsigned char>(head[18]) * 256 + static_cast<unsigned char>(head[19]);
  EXPECT_EQ(width, 1400);
}

TEST(Figure, MayHaveNamesAlongItsAxis) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed (gnuplot-nox)";
  const TemporaryFile png("figure.png");
  Figure figure = figure_sample();
  figure.x_names = {"none", "it's", "[4, 4, 2]"};
  EXPECT_EQ(refusal_of(figure, png.path()), "");
  EXPECT_GT(std::filesystem::file_size(png.path()), 1000U);
}

TEST(Figure, ThatCannotBeWrittenIsRefusedByName) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed (gnuplot-nox)";
  EXPECT_THAT(refusal_of(figure_sample(), "/nowhere/figure.png"), HasSubstr("'/nowhere/figure.png'"));
}

TEST(Figure, WithoutGnuplotNamesThePackageToInstall) {
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nowhere", 1);
  const std::string refusal = refusal_of(figure_sample(), "/tmp/never.png");
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(refusal, AllOf(HasSubstr("not installed"), HasSubstr("gnuplot-nox")));
}

}  // namespace
}  // namespace forcebound::lab
