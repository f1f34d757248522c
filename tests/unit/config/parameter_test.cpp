#include "forcebound/config/parameter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace forcebound::config {
namespace {

using testing::HasSubstr;
using Point = Eigen::Vector3d;

const std::vector<Parameter> kBall{PointParameter{.key = "center_m", .preset = Point(1, 2, 3)},
                                   NumberParameter{.key = "radius_m", .least = 0, .least_excluded = true, .most = 10},
                                   NumberParameter{.key = "pieces", .preset = 8, .least = 1, .most = 16, .whole = true},
                                   PointParameter{.key = "axis", .preset = Point::UnitX(), .is_direction = true},
                                   ChoiceParameter{.key = "colour", .choices = {"red", "green"}},
                                   FlagParameter{.key = "hollow"},
                                   TextParameter{.key = "label", .form = TextParameter::Form::name, .absent = "none"},
                                   RowsParameter{.key = "profile_m", .columns = 2, .absent = "round"}};

/// The error for a ball with these values and a radius.
std::string refusal_of(Values given) {
  if (!given.has("radius_m")) given.set("radius_m", 1.0);
  try {
    (void)completed(kBall, given);
  } catch (const ValueError& error) {
    EXPECT_THAT(error.what(), HasSubstr(error.key()));
    return error.what();
  }
  return "accepted";
}

TEST(Completed, FillsInPresets) {
  const Values ball = completed(kBall, {{"radius_m", 0.5}});
  EXPECT_EQ(ball.number("radius_m"), 0.5);
  EXPECT_EQ(ball.point("center_m"), Point(1, 2, 3));
  EXPECT_EQ(ball.whole("pieces"), 8);
  EXPECT_EQ(ball.choice("colour"), "red");
  EXPECT_FALSE(ball.flag("hollow"));
  EXPECT_FALSE(ball.has("label"));
  EXPECT_FALSE(ball.has("profile_m"));
}

TEST(Completed, RefusesMissingAndUnknownKeysAndWrongTypes) {
  EXPECT_THAT([] { (void)completed(kBall, {}); },
              testing::ThrowsMessage<ValueError>("'radius_m' is missing (accepted: > 0 and <= 10)"));
  EXPECT_THAT(refusal_of({{"colur", std::string("red")}}), HasSubstr("unknown key 'colur', did you mean 'colour'?"));
  EXPECT_THAT(refusal_of({{"radius_m", true}}),
              HasSubstr("radius_m must be > 0 and <= 10, got a value of another type"));
  EXPECT_THAT(refusal_of({{"hollow", 1.0}}), HasSubstr("hollow must be `true` or `false`"));
}

TEST(Completed, RefusesValuesOutOfRange) {
  EXPECT_EQ(refusal_of({{"radius_m", 0.0}}), "radius_m must be > 0 and <= 10, got 0");
  EXPECT_EQ(refusal_of({{"radius_m", std::numeric_limits<double>::infinity()}}),
            "radius_m must be a finite number, got inf");
  EXPECT_EQ(refusal_of({{"pieces", 1.5}}), "pieces must be a whole number from 1 to 16, got 1.5");
  EXPECT_EQ(refusal_of({{"axis", Point(0, 0, 0)}}), "axis must not be zero");
  EXPECT_EQ(refusal_of({{"colour", std::string("gren")}}),
            "unknown colour 'gren', did you mean 'green'? (known: red, green)");
  EXPECT_EQ(refusal_of({{"label", std::string("a\nb")}}),
            "label must have 1 to 64 bytes without control characters, got 'a?b'");
  EXPECT_EQ(refusal_of({{"label", std::string("a\xc2\x9b"
                                              "2J")}}),
            "label must have 1 to 64 bytes without control characters, got 'a??2J'");
  EXPECT_EQ(refusal_of({{"profile_m", Rows{{1, 2}, {3}}}}), "row 2 of profile_m must have 2 numbers, got 1");
  EXPECT_THAT(refusal_of({{"center_m", Point(0, std::nan(""), 0)}}), HasSubstr("center_m must be finite"));
}

TEST(Completed, NormalisesDirectionsAndKeepsUnitOnes) {
  const Values once = completed(kBall, {{"radius_m", 1.0}, {"axis", Point(3, 0, -4)}});
  EXPECT_NEAR(once.point("axis").norm(), 1, 1e-15);
  EXPECT_EQ(completed(kBall, once).point("axis"), once.point("axis")) << "bit by bit";
}

TEST(Completed, TakesInfinityOnlyOnAxesThatASceneLacks) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Parameter> size{
      PointParameter{.key = "size_m", .each = {.least = 0, .least_excluded = true, .most = 9}, .rest = infinity}};
  EXPECT_EQ(completed(size, {{"size_m", Point(1, 2, infinity)}}).point("size_m").z(), infinity);
  EXPECT_THAT(
      [&] {
        (void)completed(size, {{"size_m", Point(0, 2, infinity)}});
      },
      testing::ThrowsMessage<ValueError>("size_m must be > 0 and <= 9 on every axis, got [0, 2]"));
}

TEST(Parameters, DescribeAcceptedValuesAndPresets) {
  EXPECT_EQ(accepted_text(kBall[0]), "a point");
  EXPECT_EQ(accepted_text(kBall[1]), "> 0 and <= 10");
  EXPECT_EQ(accepted_text(kBall[2]), "a whole number from 1 to 16");
  EXPECT_EQ(accepted_text(kBall[3]), "a direction");
  EXPECT_EQ(accepted_text(kBall[4]), "`\"red\"`, `\"green\"`");
  EXPECT_EQ(preset_text(kBall[0]), "[1, 2, 3]");
  EXPECT_EQ(preset_text(kBall[1]), "");
  EXPECT_EQ(preset_text(kBall[4]), "`\"red\"`");
  EXPECT_EQ(preset_text(kBall[6]), "none");
  EXPECT_TRUE(may_be_left_out(kBall[5]));
  EXPECT_FALSE(may_be_left_out(kBall[1]));
}

TEST(Parameters, WriteGivenValuesInDeclarationOrder) {
  const Values given{{"radius_m", 0.5}, {"center_m", Point(0, 1, 0)}, {"hollow", true}, {"label", std::string("x")}};
  EXPECT_EQ(to_text(kBall, given, 2), "center_m [0, 1], radius_m 0.5, hollow true");
}

}  // namespace
}  // namespace forcebound::config
