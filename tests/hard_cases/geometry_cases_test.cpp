// Cases 20 to 30: triangle meshes as they occur in practice, and points without a nearest direction.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "forcebound/scene/geometry/distance_field.hpp"
#include "forcebound/scene/geometry/mesh_shape.hpp"
#include "forcebound/server/environment/mesh_file.hpp"
#include "tests/support/follower.hpp"
#include "tests/support/process.hpp"
#include "tests/support/shape_client.hpp"
#include "tests/support/special_numbers.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::server {
namespace {

using test::Follower;
using test::kInfinity;
using test::kNaN;
using test::ShapeClient;
using test::shared_mesh;
using test::Soup;
using test::spring_force;
using testing::StartsWith;

/// Slides over the square [-0.9, 0.9]^2 of a plane that `motion` has turned, through its middle, and expects the plane.
void expect_a_plane(Follower& follower, const Eigen::Isometry3d& motion, double depth_m) {
  const scene::Point normal = motion.linear().col(2);
  (void)follower.to(motion * scene::Point(-0.9, -0.3, 0.1));
  for (int i = 0; i <= 3600; ++i) {
    const double along = -0.9 + 5e-4 * i;
    const scene::SurfacePoint found = follower.to(motion * scene::Point(along, along / 3, -depth_m));
    ASSERT_LT((spring_force(found) - depth_m * normal).norm(), 1e-9 * depth_m) << "tick " << i;
  }
}

TEST(HardCase20, SliversAreDroppedAndCountedAndNotFelt) {
  Soup soup = test::square(1, 6);
  const auto corner = [&](double x, double y, double z = 0) {
    soup.vertices.emplace_back(x, y, z);
    return static_cast<std::uint32_t>(soup.vertices.size() - 1);
  };
  std::mt19937 random(20);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 100; ++i) {
    const double x = 0.9 * unit(random);
    const double y = 0.9 * unit(random);
    soup.triangles.push_back({corner(x, y), corner(x + 0.1, y), corner(x + 0.2, y)});
    soup.triangles.push_back({corner(x, y), corner(x, y), corner(x, y + 0.1)});
    soup.triangles.push_back({corner(x, y), corner(x, y + 0.1), corner(x, y + 0.05, 1e-14)});
  }
  const auto motion = test::askew();
  Follower follower(soup.moved(motion));
  const scene::MeshReport& report = follower.object().bvh().mesh().report();
  EXPECT_EQ(report.slivers, 300U) << scene::to_text(report);
  EXPECT_EQ(report.triangles, 72U);
  expect_a_plane(follower, motion, 0.01);
}

TEST(HardCase20, TrianglesJustThickEnoughToKeepAreNotFeltEither) {
  // A strip of needles across the way, each thinner than a millionth of the square.
  Soup soup = test::square(1, 6);
  constexpr double kThin = 1e-7;
  for (int i = 0; i < 20; ++i) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const auto& [x, y] :
         {std::pair(0.0, -0.5), std::pair(kThin, -0.5), std::pair(kThin, 0.5), std::pair(0.0, 0.5)}) {
      soup.vertices.emplace_back(0.3 + i * kThin + x, y, 0);
    }
    soup.add_quad(first, first + 1, first + 2, first + 3);
  }
  const auto motion = test::askew();
  Follower follower(soup.moved(motion));
  EXPECT_EQ(follower.object().bvh().mesh().report().slivers, 0U);
  expect_a_plane(follower, motion, 0.01);
}

TEST(HardCase21, DuplicateAndUnreferencedVerticesAreMendedAndCounted) {
  Soup soup;
  for (const scene::Triangle& t : test::square(1, 10).triangles) {
    const Soup square = test::square(1, 10);
    soup.add({{square.vertices[t[0]], square.vertices[t[1]], square.vertices[t[2]], {7, 7, 7}}, {{0, 1, 2}}});
  }
  const auto motion = test::askew();
  Follower follower(soup.moved(motion));
  const scene::MeshReport& report = follower.object().bvh().mesh().report();
  EXPECT_EQ(report.vertices, 121U);
  EXPECT_EQ(report.welded_vertices, 600U - 121U + 199U);
  EXPECT_EQ(report.unreferenced_vertices, 1U);
  EXPECT_EQ(report.open_edges, 40U) << "the triangles are one surface again";
  expect_a_plane(follower, motion, 0.01);
}

TEST(HardCase22, OneSidedContactWorksWhateverTheMeshIs) {
  Soup disagreeing = test::block({1, 1, 1});
  std::swap(disagreeing.triangles[0][1], disagreeing.triangles[0][2]);
  Soup open = test::block({1, 1, 1});
  open.triangles.erase(open.triangles.begin());
  Soup fins = test::block({1, 1, 1});
  fins.vertices.emplace_back(2, 2, -2);
  fins.triangles.push_back({0, 1, 8});
  for (const Soup& soup : {disagreeing, open, fins}) {
    const auto mesh = shared_mesh(soup);
    SCOPED_TRACE(scene::to_text(mesh->report()));
    EXPECT_FALSE(mesh->report().closed());
    ShapeClient client(scene::make_mesh(mesh));
    (void)client.at({0.2, 0.3, 2 + mesh->origin_m().z()});
    const scene::SurfacePoint found = client.at({0.2, 0.3, 0.9});
    EXPECT_NEAR(found.penetration_m, 0.1, 1e-12);
    EXPECT_LT((found.normal - scene::Point::UnitZ()).norm(), 1e-9);
    try {
      (void)scene::make_distance_field(mesh, {.spacing_m = 0.1});
      ADD_FAILURE() << "an inside of an open mesh";
    } catch (const scene::GeometryError& error) {
      EXPECT_THAT(error.what(), StartsWith("test.obj: has no inside, since it is not closed: "));
    }
  }
}

TEST(HardCase23, SharedEdgesAndVerticesOfAPlaneAreNotFelt) {
  const auto motion = test::askew();
  Follower follower(test::square(1, 8).moved(motion));
  const scene::Point normal = motion.linear().col(2);
  constexpr double kDepth_m = 0.01;
  (void)follower.to(motion * scene::Point(-0.9, -0.9, 0.1));
  // Along the diagonals, along the sides, and from vertex to vertex.
  for (const scene::Point& way :
       {scene::Point(1, 1, 0), scene::Point(1, 0, 0), scene::Point(0, 1, 0), scene::Point(1, -1, 0)}) {
    for (int i = -800; i <= 800; ++i) {
      const scene::Point goal = 1.0 / 1024 * i * way + scene::Point(0, 0, -kDepth_m);
      ASSERT_LT((spring_force(follower.to(motion * goal)) - kDepth_m * normal).norm(), 1e-9 * kDepth_m)
          << goal.transpose();
    }
  }
  for (int i = 0; i < 200; ++i) {
    const scene::Point vertex(0.25 * (i % 7 - 3), 0.25 * (i / 7 % 7 - 3), -kDepth_m);
    ASSERT_LT((spring_force(follower.to(motion * vertex)) - kDepth_m * normal).norm(), 1e-9 * kDepth_m);
  }
}

TEST(HardCase24, AConcaveCornerHoldsWithoutChatter) {
  const auto motion = test::askew();
  Follower follower(test::block({1, 1, 1}).inside_out().moved(motion));
  (void)follower.to(motion * scene::Point(0, 0, 0));
  std::mt19937 random(24);
  std::uniform_real_distribution<double> unit(-1, 1);
  scene::Point goal(1.2, 1.2, 1.2);
  for (int i = 0; i < 20000; ++i) {
    goal += 1e-3 * scene::Point(unit(random), unit(random), unit(random));
    goal = goal.cwiseMax(0.8).cwiseMin(1.5);
    (void)follower.to(motion * goal);
    // In a box's inside the nearest point is known, whether one wall holds or three.
    ASSERT_LT((motion.inverse() * follower.at_m() - goal.cwiseMin(1.0)).norm(), 1e-12) << "tick " << i;
  }
}

/// Two planes that meet along the y axis at an angle, from -1 to 1; `lift` is how high their outer edges are.
Soup two_planes(double lift) {
  Soup soup{{{-1, -1, lift}, {0, -1, 0}, {0, 1, 0}, {-1, 1, lift}, {1, -1, lift}, {1, 1, lift}}, {}};
  soup.add_quad(0, 1, 2, 3);
  soup.add_quad(1, 4, 5, 2);
  return soup;
}

TEST(HardCase24, TwoPlanesATenthOfADegreeApartDoNotChatter) {
  const double slope = std::tan(0.05 / 180 * std::numbers::pi);
  const auto motion = test::askew();
  for (const double sign : {1.0, -1.0}) {
    SCOPED_TRACE(sign > 0 ? "a valley" : "a ridge");
    Follower follower(two_planes(sign * slope).moved(motion));
    (void)follower.to(motion * scene::Point(-1e-3, 0.1, 0.1));
    constexpr double kDepth_m = 0.05;
    (void)follower.to(motion * scene::Point(-1e-3, 0.1, -kDepth_m));
    scene::Point before = motion.inverse() * follower.at_m();
    for (int i = -1000; i <= 1000; ++i) {
      const scene::Point goal(1e-6 * i, 0.1, -kDepth_m);
      (void)follower.to(motion * goal);
      const scene::Point at = motion.inverse() * follower.at_m();
      ASSERT_NEAR(at.y(), 0.1, 1e-12);
      ASSERT_NEAR(at.z(), sign * slope * std::abs(at.x()), 1e-12) << "on the planes";
      ASSERT_LT((at - before).norm(), 2e-4) << "tick " << i;
      if (sign > 0) {
        // The nearest point of a valley: on one plane, or at the bottom if it is behind it on both.
        const double along = (std::abs(goal.x()) - slope * kDepth_m) / (1 + slope * slope);
        ASSERT_NEAR(at.x(), std::copysign(std::max(0.0, along), goal.x()), 1e-12) << "tick " << i;
      } else if (i > -1000) {
        ASSERT_GE(at.x(), before.x()) << "never back, tick " << i;
      }
      (void)follower.to(motion * goal);
      ASSERT_LT((motion.inverse() * follower.at_m() - at).norm(), 1e-12) << "stays where it is";
      before = at;
    }
  }
}

TEST(HardCase25, AThinWallLetsNothingThroughAtAnySpeed) {
  const auto motion = test::askew();
  constexpr double kTick_s = 1e-3;
  for (const double speed_m_per_s : {0.1, 0.3, 1.0, 3.0, 10.0}) {
    for (const double slant : {0.0, 0.5, 5.0}) {
      // A plate of 1 m x 1 m and 0.1 mm.
      Follower follower(test::block({0.5, 0.5, 0.5e-4}).moved(motion));
      const scene::Point way = scene::Point(slant, 0.3 * slant, -1).normalized();
      double deepest_m = 0;
      for (double gone_m = 0; gone_m < 0.2; gone_m += speed_m_per_s * kTick_s) {
        const scene::Point goal = scene::Point(-0.2, -0.1, 0.01) + gone_m * way;
        const scene::SurfacePoint found = follower.to(motion * goal);
        const scene::Point at = motion.inverse() * follower.at_m();
        ASSERT_GE(at.z(), 0.5e-4 - 1e-11) << speed_m_per_s << " m/s, after " << gone_m;
        ASSERT_NEAR(found.penetration_m, std::max(0.0, 0.5e-4 - goal.z()), 1e-11);
        deepest_m = std::max(deepest_m, found.penetration_m);
      }
      EXPECT_GT(deepest_m, 1e-3) << "it never went beyond the wall: the test is void";
    }
  }
}

TEST(HardCase26, CoincidentSurfacesGiveOneForce) {
  const auto motion = test::askew();
  // The same triangles twice, the same plane in other triangles, and once more just off it by rounding.
  Soup soup = test::square(1, 7);
  soup.add(test::square(1, 7)).add(test::square(1, 5)).add(test::square(1, 3));
  for (std::size_t i = soup.vertices.size() - 16; i < soup.vertices.size(); ++i) soup.vertices[i].z() = 1e-15;
  Follower follower(soup.moved(motion));
  EXPECT_EQ(follower.object().bvh().mesh().report().duplicate_triangles, 98U);
  expect_a_plane(follower, motion, 0.01);
}

TEST(HardCase27, TheCentreOfASphereHasTheLastValidNormalFlagged) {
  const auto expect_old_normal = [](std::unique_ptr<scene::Shape> shape, const scene::Point& center_m) {
    ShapeClient client(std::move(shape));
    const scene::SurfacePoint before = client.at(center_m + scene::Point(0.003, 0.004, 0));
    EXPECT_FALSE(before.normal_is_old);
    const scene::SurfacePoint at_center = client.at(center_m);
    EXPECT_TRUE(at_center.normal_is_old);
    EXPECT_EQ(at_center.normal, before.normal);
    EXPECT_TRUE(std::isfinite(at_center.penetration_m));
  };
  expect_old_normal(scene::make_sphere({0.1, 0, 0}, 0.02), {0.1, 0, 0});
  expect_old_normal(scene::make_cavity({0.1, 0, 0}, 0.02), {0.1, 0, 0});
  // A grid whose middle is the middle of a cell, with an odd number of steps.
  expect_old_normal(scene::make_distance_field(shared_mesh(test::block({0.02, 0.02, 0.02})), {.spacing_m = 0.04 / 21}),
                    {0, 0, 0});
}

TEST(HardCase28, MeshesOfAnySizeAndPlaceGiveTheSameRelativeAnswer) {
  const Soup ball = test::ball(1, 24).moved(test::askew());
  for (int power = -6; power <= 6; ++power) {
    const double scale = std::pow(10, power);
    for (const scene::Point& offset_m : {scene::Point(0, 0, 0), scene::Point(1e4, -1e4, 1e4)}) {
      SCOPED_TRACE("scale " + std::to_string(scale) + ", offset " + std::to_string(offset_m.x()));
      Follower unit(ball);
      Follower follower(ball.mesh("test.obj", {.scale = scale, .offset_m = offset_m}));
      const scene::Point origin_m = follower.object().bvh().mesh().origin_m();
      for (int i = 0; i < 400; ++i) {
        const double height = i == 0 ? 2 : 0.9;
        const scene::Point goal_m =
            origin_m +
            scale * scene::Point(height * std::sin(0.02 * i), 0.3 * std::sin(0.05 * i), height * std::cos(0.02 * i));
        // The same goal, rounded in the scene's frame so far from its origin.
        const scene::Point goal = (goal_m - origin_m) / scale + unit.object().bvh().mesh().origin_m();
        const scene::Point expected = spring_force(unit.to(goal));
        ASSERT_LT((spring_force(follower.to(goal_m)) / scale - expected).norm(), 1e-9) << "goal " << i;
        ASSERT_EQ(expected.norm() > 0, i > 0);
      }
    }
  }
}

TEST(HardCase29, NaNInAMeshIsRefusedAndInAQueryHarmsNobodyElse) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    Soup soup = test::block({1, 1, 1});
    soup.vertices[5].z() = bad;
    EXPECT_THAT([&] { (void)soup.mesh("cube.off"); },
                testing::ThrowsMessage<scene::GeometryError>("cube.off: vertex 5 is not finite"));
    ShapeClient mesh(scene::make_mesh(shared_mesh(test::block({1, 1, 1})), {.reach_m = 1}));
    ShapeClient field(scene::make_distance_field(shared_mesh(test::block({1, 1, 1})), {.spacing_m = 0.2}));
    for (ShapeClient* client : {&mesh, &field}) {
      (void)client->at({0.1, 0.2, 1.1});
      const scene::SurfacePoint before = client->at({0.1, 0.2, 0.9});
      EXPECT_GT(before.penetration_m, 0);
      EXPECT_LE(client->at({bad, 0.2, 0.9}).penetration_m, 0) << bad;
      EXPECT_TRUE(client->at({0.1, bad, 0.9}).normal.allFinite());
      const scene::SurfacePoint after = client->at({0.1, 0.2, 0.9});
      EXPECT_EQ(after.penetration_m, before.penetration_m) << "goes on as before";
      EXPECT_EQ(after.normal, before.normal);
    }
  }
}

TEST(HardCase30, MalformedMeshFilesAreRefusedWithFileAndLine) {
  struct Malformed {
    const char* file;
    std::string content;
    const char* complaint;  // behind the path
  };
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::vector<Malformed> files{
      {"index.obj", points + "f 1 2 4\n", ":4: vertex '4' is not one of the 3"},
      {"nan.obj", points + "v nan 0 0\nf 1 2 3\n", ":4: 'nan' is not a finite number"},
      {"word.obj", points + "f 1 two 3\n", ":4: 'two' is not the index of a vertex"},
      {"control.obj", points + "f 1 2 \x1b[2J\n", ":4: '?[2J' is not the index of a vertex"},
      {"flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", ": no triangles, but for 1 without an area"},
      {"empty.obj", "", ": "},
      {"short.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", ":6: the file ends after 1 of 2 faces"},
      {"index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", ":6: vertex '-1' is not one of 0 to 2"},
      {"many.off", "OFF\n99999999999 1 0\n0 0 0\n", ":3: the file ends after 1 of 99999999999 vertices"},
      {"short.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", ":4: the file ends without endsolid"},
      {"number.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1e99\n", ":4: '1e99' is more than"},
      {"cut.stl", std::string(80, ' ') + std::string("\2\0\0\0", 4) + std::string(70, '\0'), ": ends after 1 of 2"},
  };
  const test::TemporaryFolder folder;
  for (const auto& [file, content, complaint] : files) {
    const std::string path = folder.file(file);
    test::write_file(path, content);
    try {
      (void)server::load_mesh(path);
      ADD_FAILURE() << file << " was accepted";
    } catch (const scene::GeometryError& error) {
      EXPECT_THAT(error.what(), StartsWith(path + complaint));
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

TEST(HardCase30, EveryTruncationOfAMeshFileIsReadOrRefused) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  const std::string off = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  const test::TemporaryFolder folder;
  for (const auto& [name, content] : {std::pair("a.obj", obj), std::pair("a.off", off)}) {
    int refused = 0;
    for (std::size_t length = 0; length < content.size(); ++length) {
      test::write_file(folder.file(name), content.substr(0, length));
      try {
        EXPECT_GT(server::load_mesh(folder.file(name)).report().triangles, 0U);
      } catch (const scene::GeometryError& error) {
        EXPECT_THAT(error.what(), StartsWith(folder.file(name)));
        ++refused;
      }
    }
    EXPECT_GT(refused, 30);
  }
}

TEST(HardCase30, DuplicateVerticesOfAnStlAreWelded) {
  const auto path = recorded_data("meshes/malformed/duplicate_vertices.stl");
  if (!path) GTEST_SKIP() << "no meshes/malformed/duplicate_vertices.stl in FORCEBOUND_DATA";
  const scene::TriangleMesh mesh = server::load_mesh(path->string());
  EXPECT_GT(mesh.report().welded_vertices, 0U) << scene::to_text(mesh.report());
  EXPECT_EQ(mesh.report().vertices + mesh.report().welded_vertices + mesh.report().unreferenced_vertices,
            3 * (mesh.report().triangles + mesh.report().slivers + mesh.report().duplicate_triangles));
}

}  // namespace
}  // namespace forcebound::server
