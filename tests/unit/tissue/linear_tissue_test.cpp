#include "forcebound/tissue/linear_tissue.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>

#include "tests/support/tissue_block.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::tissue {
namespace {

using test::BlockOfCubes;
using test::tetrahedra_of;

constexpr double kYoung_Pa = 5000;

// Where the surface's nodes go under forces on them.
Eigen::VectorXd displacement_m(const LinearTissue& tissue, const Eigen::VectorXd& force_N) {
  return tissue.compliance_m_per_N() * force_N;
}

LinearTissue block_on_the_ground(const BlockOfCubes& block, double poisson) {
  TetrahedralMesh mesh(tetrahedra_of(block));
  const std::vector<int> held = nodes_below(mesh, block.from_m, scene::Point::UnitZ());
  return {std::move(mesh), {.young_Pa = kYoung_Pa, .poisson = poisson}, held};
}

// As the elements' shape functions share out a stress on top of cubes: a quarter of a box's side to each of its
// corners, a third of a tetrahedron's to each of them, or to each middle between them.
Eigen::VectorXd pull_at_top(const LinearTissue& tissue, const BlockOfCubes& block, const scene::Point& stress_Pa) {
  const TetrahedralMesh& mesh = tissue.mesh();
  Eigen::VectorXd force_N = Eigen::VectorXd::Zero(3 * tissue.surface_nodes());
  const double top_m = block.cube_m * static_cast<double>(block.cubes[2]) - 1e-9;
  const auto share_out = [&](const auto& corners, const auto& to, double area_m2) {
    const auto is_on_top = [&](int node) { return mesh.nodes_m()[node].z() > top_m; };
    const auto sharing = std::ranges::count_if(to, is_on_top);
    if (std::ranges::count_if(corners, is_on_top) < 3) return;
    for (const int node : to) {
      if (!is_on_top(node)) continue;
      const auto on_surface = std::ranges::lower_bound(mesh.surface_nodes(), node) - mesh.surface_nodes().begin();
      force_N.segment<3>(3 * on_surface) += area_m2 / static_cast<double>(sharing) * stress_Pa;
    }
  };
  const double side_m2 = block.cube_m * block.cube_m;
  for (const auto& box : mesh.boxes()) share_out(box, box, side_m2);
  for (std::size_t t = 0; mesh.boxes().empty() && t < mesh.tetrahedra().size(); ++t) {
    const auto& corners = mesh.tetrahedra()[t];
    if (mesh.middles().empty()) {
      share_out(corners, corners, side_m2 / 2);
    } else {
      share_out(corners, mesh.middles()[t], side_m2 / 2);
    }
  }
  return force_N;
}

TEST(LinearTissue, ABarWithoutLateralContractionStretchesByForceOverYoungTimesArea) {
  const BlockOfCubes block{.cubes = {2, 2, 5}, .cube_m = 0.01};
  const TetrahedralMesh of_boxes(tetrahedra_of(block));
  TetrahedralSoup soup = tetrahedra_of(block);
  soup.boxes.clear();
  const TetrahedralMesh of_four_nodes(soup);
  for (const TetrahedralMesh& mesh : {of_boxes, of_four_nodes, of_four_nodes.with_middles()}) {
    const LinearTissue tissue(mesh, {.young_Pa = kYoung_Pa, .poisson = 0}, nodes_below(mesh, {0, 0, 0}, {0, 0, 1}));
    const Eigen::VectorXd moved_m = displacement_m(tissue, pull_at_top(tissue, block, {0, 0, 100}));
    for (int node = 0; node < tissue.surface_nodes(); ++node) {
      const scene::Point expected_m(0, 0, 100 / kYoung_Pa * tissue.surface().nodes_m()[node].z());
      EXPECT_LT((moved_m.segment<3>(3 * node) - expected_m).norm(), 1e-10 * 0.001);
    }
  }
}

TEST(LinearTissue, ComplianceIsSymmetricAndHeldNodesDoNotMove) {
  const LinearTissue tissue = block_on_the_ground({.cubes = {3, 2, 2}}, 0.4);
  const Eigen::MatrixXd& compliance = tissue.compliance_m_per_N();
  EXPECT_EQ(compliance, compliance.transpose());
  for (int node = 0; node < tissue.surface_nodes(); ++node) {
    const bool held = tissue.surface().nodes_m()[node].z() == 0;
    EXPECT_EQ(compliance.middleRows<3>(3 * node).isZero(0), held);
  }
}

TEST(LinearTissue, CompressesAPointOfASliverAsItsClosedFormSays) {
  // Over a held triangle of area A at height h: A (lambda + 2 mu) / (3 h) upwards, A mu / (3 h) sideways.
  for (const double height_m : {1e-2, 1e-4, 1e-5, 5e-7}) {
    const TetrahedralSoup soup{.name = "sliver",
                               .nodes = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0.03, 0.03, height_m}},
                               .tetrahedra = {{.nodes = {0, 1, 2, 3}}}};
    const ElasticMaterial material{.young_Pa = kYoung_Pa, .poisson = 0.3};
    const LinearTissue tissue(TetrahedralMesh(soup), material, {0, 1, 2});
    const double per_height_m = 0.005 / (3 * height_m);
    const scene::Point compliance = tissue.compliance_m_per_N().diagonal().tail<3>();
    const double normal = 1 / (per_height_m * (material.lambda_Pa() + 2 * material.mu_Pa()));
    const double lateral = 1 / (per_height_m * material.mu_Pa());
    EXPECT_NEAR(compliance.z() / normal, 1, 1e-8) << height_m;
    EXPECT_NEAR(compliance.x() / lateral, 1, 1e-8) << height_m;
    EXPECT_NEAR(compliance.y() / lateral, 1, 1e-8) << height_m;
  }
}

TEST(LinearTissue, RefusesTissueThatNothingHolds) {
  const auto held_by = [](const std::vector<int>& nodes) -> std::string {
    try {
      const LinearTissue tissue(TetrahedralMesh(tetrahedra_of({.cubes = {2, 2, 2}})), {.young_Pa = 1, .poisson = 0.3},
                                nodes);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "accepted";
  };
  constexpr const char* kRefusal =
      "block: the held nodes leave the tissue free to move or to turn: hold at least three nodes, not in a line, of "
      "each connected part";
  EXPECT_EQ(held_by({}), kRefusal);
  EXPECT_EQ(held_by({5}), kRefusal);
  EXPECT_EQ(held_by({0, 1, 2}), kRefusal) << "in a line";
  EXPECT_EQ(held_by({0, 1, 3}), "accepted");
  std::vector<int> all(27);
  for (int node = 0; node < 27; ++node) all[node] = node;
  EXPECT_EQ(held_by(all), "block: all nodes are held: expected some that can move");
}

TEST(LinearTissue, RefusesAPartThatIsNotHeld) {
  TetrahedralSoup soup = tetrahedra_of({});
  soup.boxes.clear();
  for (const TetrahedralSoup& other : {tetrahedra_of({.from_m = {0.05, 0, 0}})}) {
    for (auto tetrahedron : other.tetrahedra) {
      for (auto& node : tetrahedron.nodes) node += 8;
      soup.tetrahedra.push_back(tetrahedron);
    }
    soup.nodes.insert(soup.nodes.end(), other.nodes.begin(), other.nodes.end());
  }
  EXPECT_THROW(LinearTissue(TetrahedralMesh(soup), {.young_Pa = 1, .poisson = 0.3}, {0, 1, 2, 3}), std::runtime_error);
  EXPECT_NO_THROW(LinearTissue(TetrahedralMesh(soup), {.young_Pa = 1, .poisson = 0.3}, {0, 1, 2, 8, 9, 10}));
}

TEST(LinearTissue, RefusesAComplianceThatDoesNotFit) {
  try {
    const LinearTissue tissue(TetrahedralMesh(tetrahedra_of({})), {.young_Pa = 1, .poisson = 0.3}, {0, 1, 2}, 4000);
    ADD_FAILURE() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(),
                 "block: the compliance of its 8 surface nodes would take 4608 bytes: expected at most 4000, so a "
                 "coarser mesh");
  }
}

TEST(LinearTissue, SaysHowMuchMemoryItTakes) {
  const LinearTissue tissue = block_on_the_ground({.cubes = {3, 3, 3}}, 0.3);
  EXPECT_GE(tissue.memory_bytes(), 72U * 56 * 56);
  EXPECT_LT(tissue.memory_bytes(), 72U * 56 * 56 + 20000);
}

TEST(LinearTissue, TakesTheLiver) {
  const auto path = recorded_data("meshes/liver.msh");
  if (!path) GTEST_SKIP() << "meshes/liver.msh is not there";
  const TetrahedralMesh mesh = TetrahedralMesh(load_gmsh(path->string()), {.scale = 0.01}).with_middles();
  const std::vector<int> held = nodes_below(mesh, {0, 0, 0}, scene::Point::UnitZ());
  for (const double poisson : {0.3, 0.45, 0.49, 0.4999}) {
    const LinearTissue tissue(mesh, {.young_Pa = kYoung_Pa, .poisson = poisson}, held);
    EXPECT_TRUE(tissue.compliance_m_per_N().allFinite());
  }
}

}  // namespace
}  // namespace forcebound::tissue
