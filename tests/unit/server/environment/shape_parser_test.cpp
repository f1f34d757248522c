#include "forcebound/server/environment/part_parser.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "forcebound/server/environment/scene_parser.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;

std::string scene_text(const std::string& shape, int degrees_of_freedom) {
  return "[scene]\nname = 'x'\ndescription = ''\ndegrees_of_freedom = " + std::to_string(degrees_of_freedom) +
         "\n[[object]]\nname = 'thing'\neffects = ['surface']\nshape = { " + shape +
         " }\nsurface = { stiffness_N_per_m = 1 }\n";
}

std::string shape_error(const std::string& shape, int degrees_of_freedom = 3) {
  try {
    (void)parse_scene(scene_text(shape, degrees_of_freedom), "x.toml");
  } catch (const SceneError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ShapeParser, ReadsEveryShapeInSpace) {
  for (const auto* const shape :
       {"kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1]",
        "kind = 'sphere', center_m = [0, 0, 0], radius_m = 1", "kind = 'cavity', center_m = [0, 0, 0], radius_m = 1",
        "kind = 'box', center_m = [0, 0, 0], size_m = [1, 1, 1]",
        "kind = 'capsule', from_m = [0, 0, 0], to_m = [0, 0, 1], radius_m = 1",
        "kind = 'cylinder', from_m = [0, 0, 0], to_m = [0, 0, 1], radius_m = 1",
        "kind = 'torus', center_m = [0, 0, 0], axis = [0, 0, 1], major_radius_m = 2, "
        "minor_radius_m = 1",
        "kind = 'height_field', origin_m = [0, 0, 0], spacing_m = 1, heights_m = [[0, 0], "
        "[0, 0]]"}) {
    EXPECT_EQ(shape_error(shape), "no error");
  }
}

TEST(ShapeParser, CapsuleAndCylinderLieInAPlaneToo) {
  EXPECT_EQ(shape_error("kind = 'capsule', from_m = [0, 0], to_m = [0, 1], radius_m = 1", 2), "no error");
  EXPECT_EQ(shape_error("kind = 'cylinder', from_m = [0, 0], to_m = [0, 1], radius_m = 1", 2), "no error");
}

TEST(ShapeParser, RefusesShapesThatNeedMoreAxes) {
  EXPECT_EQ(
      shape_error("kind = 'capsule', from_m = [0], to_m = [1], radius_m = 1", 1),
      "x.toml:8: object 'thing', shape: a capsule needs a scene of at least 2 degrees of freedom, this one has 1");
  EXPECT_THAT(shape_error("kind = 'cylinder', from_m = [0], to_m = [1], radius_m = 1", 1), HasSubstr("at least 2"));
  EXPECT_THAT(
      shape_error("kind = 'torus', center_m = [0, 0], axis = [0, 1], major_radius_m = 2, minor_radius_m = 1", 2),
      HasSubstr("a torus needs a scene of at least 3 degrees of freedom, this one has 2"));
  EXPECT_THAT(shape_error("kind = 'height_field', origin_m = [0, 0], spacing_m = 1, heights_m = [[0, 0], [0, 0]]", 2),
              HasSubstr("a height_field needs a scene of at least 3 degrees of freedom, this one has 2"));
}

TEST(ShapeParser, RefusesAStraightOfOnePoint) {
  EXPECT_EQ(shape_error("kind = 'capsule', from_m = [0, 1, 2], to_m = [0, 1, 2], radius_m = 1"),
            "x.toml:8: object 'thing', shape: to_m must differ from from_m, got [0, 1, 2]");
  EXPECT_THAT(shape_error("kind = 'cylinder', from_m = [0, 1, 2], to_m = [0, 1, 2], radius_m = 1"),
              HasSubstr("to_m must differ from from_m"));
}

TEST(ShapeParser, RefusesATorusWithoutAHoleOrAxis) {
  EXPECT_EQ(
      shape_error("kind = 'torus', center_m = [0, 0, 0], axis = [0, 0, 1], major_radius_m = 1, minor_radius_m = 1"),
      "x.toml:8: object 'thing', shape: minor_radius_m must be < major_radius_m, got 1");
  EXPECT_THAT(
      shape_error("kind = 'torus', center_m = [0, 0, 0], axis = [0, 0, 0], major_radius_m = 2, minor_radius_m = 1"),
      HasSubstr("axis must not be zero"));
  EXPECT_THAT(
      shape_error("kind = 'torus', center_m = [0, 0, 0], axis = [0, 0, 1], major_radius_m = -2, minor_radius_m = 1"),
      HasSubstr("major_radius_m must be > 0 and <= 1000, got -2"));
}

TEST(ShapeParser, RefusesPlacesOutOfReach) {
  EXPECT_EQ(shape_error("kind = 'sphere', center_m = [1e308, 0, 0], radius_m = 0.01"),
            "x.toml:8: object 'thing', shape: center_m must be >= -1000 and <= 1000 on every axis, got [1e+308, 0, 0]");
  EXPECT_THAT(shape_error("kind = 'sphere', center_m = [0, 0, 0], radius_m = 1e308"),
              HasSubstr("radius_m must be > 0 and <= 1000, got 1e+308"));
  EXPECT_THAT(shape_error("kind = 'box', center_m = [0, 0, 0], size_m = [1, 1e308, 1]"),
              HasSubstr("size_m must be > 0 and <= 1000 on every axis, got [1, 1e+308, 1]"));
  EXPECT_THAT(shape_error("kind = 'half_space', through_m = [0, 0, -1e308], normal = [0, 0, 1]"),
              HasSubstr("through_m must be >= -1000"));
}

TEST(ShapeParser, SuggestsTheNearestKind) {
  EXPECT_THAT(shape_error("kind = 'capsul'"), HasSubstr("unknown kind 'capsul', did you mean 'capsule'?"));
}

}  // namespace
}  // namespace forcebound::server
