#include "forcebound/scene/geometry/mesh_placement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/meshes.hpp"

namespace forcebound::scene {
namespace {

TEST(RotationFromDegrees, TurnsAboutXThenYThenZByTheRightHand) {
  EXPECT_EQ(Point(rotation_from_degrees({90, 0, 0}) * Point::UnitY()), Point::UnitZ())
      << "what stood along y stands up";
  EXPECT_EQ(Point(rotation_from_degrees({0, 90, 0}) * Point::UnitZ()), Point::UnitX());
  EXPECT_EQ(Point(rotation_from_degrees({0, 0, 90}) * Point::UnitX()), Point::UnitY());
  EXPECT_EQ(Point(rotation_from_degrees({90, 0, 90}) * Point::UnitY()), Point::UnitZ()) << "about x first";
  EXPECT_EQ(Point(rotation_from_degrees({90, 90, 0}) * Point::UnitY()), Point::UnitX());
  const Point turned = rotation_from_degrees({0, 0, 30}) * Point::UnitX();
  EXPECT_NEAR(turned.x(), std::sqrt(0.75), 1e-15);
  EXPECT_NEAR(turned.y(), 0.5, 1e-15);
}

TEST(RotationFromDegrees, IsExactForQuarterTurnsHoweverOften) {
  for (const double quarter : {-6.0, -3.0, -1.0, 0.0, 1.0, 2.0, 3.0, 5.0, 4000001.0}) {
    const Eigen::Matrix3d turn = rotation_from_degrees({90 * quarter, 180, -90 * quarter});
    EXPECT_EQ(turn, Eigen::Matrix3d(turn.array().round())) << quarter;
    EXPECT_EQ(Eigen::Matrix3d(turn * turn.transpose()), Eigen::Matrix3d::Identity()) << quarter;
  }
  EXPECT_EQ(rotation_from_degrees({360, -720, 0}), Eigen::Matrix3d::Identity());
}

TEST(RotationFromDegrees, KeepsLengthsAndSides) {
  const Eigen::Matrix3d turn = rotation_from_degrees({12, -77, 160});
  EXPECT_NEAR((turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-15);
  EXPECT_NEAR(turn.determinant(), 1, 1e-15);
}

TEST(MeshPlacement, ScalesThenTurnsThenMoves) {
  MeshPlacement placement{.scale = 0.5, .offset_m = {1, 2, 3}};
  placement.rotation = rotation_from_degrees({0, 0, 90});
  const TriangleMesh mesh = test::block({4, 2, 1}).mesh("block", placement);
  const Bounds before = test::block({4, 2, 1}).mesh("block").box_m();
  const Point middle_m = test::block({4, 2, 1}).mesh("block").origin_m();
  EXPECT_EQ(mesh.box_m().sizes(), 0.5 * Point(before.sizes().y(), before.sizes().x(), before.sizes().z()));
  EXPECT_EQ(mesh.origin_m(), Point(1 - 0.5 * middle_m.y(), 2 + 0.5 * middle_m.x(), 3 + 0.5 * middle_m.z()));
  EXPECT_TRUE(mesh.report().closed());
  EXPECT_GT(mesh.report().volume_m3, 0) << "its outside is still outside";
}

TEST(MeshPlacement, IsValidIfItPlacesAnything) {
  EXPECT_TRUE(MeshPlacement{}.valid());
  EXPECT_FALSE(MeshPlacement{}.turns());
  EXPECT_FALSE(MeshPlacement{.scale = 0}.valid());
  EXPECT_FALSE(MeshPlacement{.scale = std::numeric_limits<double>::infinity()}.valid());
  EXPECT_FALSE((MeshPlacement{.offset_m = {0, std::nan(""), 0}}).valid());
  MeshPlacement placement;
  placement.rotation(1, 1) = std::nan("");
  EXPECT_FALSE(placement.valid());
}

}  // namespace
}  // namespace forcebound::scene
