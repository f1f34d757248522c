// Cases 31, 37 and 38 for soft tissue.

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <stdexcept>

#include "forcebound/tissue/tissue_contact.hpp"
#include "tests/support/tissue_block.hpp"

namespace forcebound::tissue {
namespace {

using test::kThickTop_m;
using test::tetrahedra_of;

LinearTissue tissue_of(const ElasticMaterial& material) {
  TetrahedralMesh mesh(tetrahedra_of(test::kThickBlock));
  const std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ());
  return {std::move(mesh), material, held};
}

// A sphere is pressed in slowly and taken out again, and every step is checked.
template <typename Look>
void press(const TissueModel& model, double depth_m, const Look& look) {
  constexpr int kSteps = 400;
  TissueState state{};
  for (int n = 0; n <= kSteps; ++n) {
    const double share = 1 - std::abs(2.0 * n / kSteps - 1);
    const double z_m = kThickTop_m + model.options().radius_m + 0.0005 - (depth_m + 0.0005) * share;
    look(model.step(state, {0.0312, 0.0291, z_m}));
  }
}

TEST(HardCase31, MoreContactsThanTheTissueHoldsAreCountedAndTheDeepestStillPush) {
  const LinearTissue tissue = tissue_of(test::kSoft);
  for (const int contacts_max : {1, 2, 4, 16}) {
    SCOPED_TRACE(contacts_max);
    int left_out = 0;
    double most_N = 0;
    press(TissueModel(tissue, {.radius_m = 0.02, .contacts_max = contacts_max}), 0.004,
          [&](const TissueResult& result) {
            EXPECT_LE(result.contacts, contacts_max);
            EXPECT_EQ(result.converged, result.contacts_left_out == 0) << "a contact left out is always counted";
            EXPECT_TRUE(result.force_N.allFinite());
            left_out += result.contacts_left_out;
            most_N = std::max(most_N, result.force_N.z());
          });
    EXPECT_EQ(left_out > 0, contacts_max < 16);
    EXPECT_GT(most_N, 0.1);
  }
}

TEST(HardCase37, TissueUnderUniformStrainPassesThePatchTest) {
  TetrahedralSoup soup = tetrahedra_of({.cubes = {2, 2, 2}, .cube_m = 0.01});
  soup.boxes.clear();
  // The one inner node almost on a face of its tetrahedra, so that some of them are slivers.
  soup.nodes[13] += scene::Point(0.0099, 0.0098, 0.0097);
  const TetrahedralMesh mesh(soup);
  const Eigen::SparseMatrix<double> stiffness = stiffness_matrix(mesh, {.young_Pa = 5000, .poisson = 0.45});
  Eigen::Matrix3d gradient;
  gradient << 0.02, 0.01, 0, -0.01, 0.03, 0.02, 0.005, 0, -0.04;
  Eigen::VectorXd displacement(81);
  Eigen::Index coordinate = 0;
  for (const scene::Point& node : mesh.nodes_m()) {
    displacement.segment<3>(coordinate) = gradient * node;
    coordinate += 3;
  }
  const FreeCoordinates free(27, mesh.surface_nodes());
  ASSERT_EQ(free.count(), 3);
  Eigen::VectorXd boundary = displacement;
  boundary.segment<3>(39).setZero();
  const Eigen::Vector3d load = -(stiffness * boundary).segment<3>(39);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> cholesky(free.reduced(stiffness));
  const Eigen::Vector3d solved = cholesky.solve(load);
  EXPECT_LT((solved - displacement.segment<3>(39)).norm(), 1e-10 * displacement.norm());
}

TEST(HardCase37, InvertedTetrahedraAreTurnedAndFlatOnesRefusedByName) {
  TetrahedralSoup soup = tetrahedra_of({.cubes = {2, 2, 2}, .cube_m = 0.01});
  soup.boxes.clear();
  const TetrahedralMesh mesh(soup);
  for (auto& tetrahedron : soup.tetrahedra) std::swap(tetrahedron.nodes[0], tetrahedron.nodes[2]);
  const TetrahedralMesh inverted(soup);
  EXPECT_NEAR(inverted.volume_m3(), mesh.volume_m3(), 1e-18);
  const Eigen::MatrixXd difference = stiffness_matrix(mesh, {.young_Pa = 1, .poisson = 0.3}) -
                                     stiffness_matrix(inverted, {.young_Pa = 1, .poisson = 0.3});
  EXPECT_LT(difference.norm(), 1e-15);
  soup.tetrahedra[7].nodes[3] = soup.tetrahedra[7].nodes[1];
  soup.tetrahedra[7].line = 21;
  EXPECT_THAT([&] { static_cast<void>(TetrahedralMesh(soup)); },
              testing::ThrowsMessage<std::runtime_error>(testing::StartsWith("block:21: tetrahedron 8 is flat")));
}

TEST(HardCase37, APointLoadOnASliverIsFiniteAndRight) {
  // Over a held triangle of area A at height h the apex yields by 3 h / (A mu) sideways.
  for (const double height_m : {1e-3, 1e-5, 5e-7}) {
    const TetrahedralSoup soup{.name = "sliver",
                               .nodes = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0.03, 0.03, height_m}},
                               .tetrahedra = {{.nodes = {0, 1, 2, 3}}}};
    const ElasticMaterial material{.young_Pa = 5000, .poisson = 0.49};
    const LinearTissue tissue(TetrahedralMesh(soup), material, {0, 1, 2});
    const double expected = 3 * height_m / (0.005 * material.mu_Pa());
    EXPECT_NEAR(tissue.compliance_m_per_N(3, 3)(0, 0) / expected, 1, 1e-8);
    TissueState state{};
    const TissueModel model(tissue, {});
    static_cast<void>(model.step(state, {0.03, 0.03, 2 * height_m}));
    const TissueResult pressed = model.step(state, {0.03, 0.03, 0.9 * height_m});
    EXPECT_TRUE(pressed.finite);
    EXPECT_GT(pressed.force_N.z(), 0);
  }
}

TEST(HardCase37, NearlyIncompressibleTissueDoesNotLock) {
  // Under a force on top, in which the change of volume has no part, 0.4999 gives way as 0.499 does.
  const auto yield_m_per_N = [](const LinearTissue& tissue) {
    const auto& nodes_m = tissue.surface().nodes_m();
    const auto top = std::ranges::find_if(nodes_m, [](const scene::Point& node_m) {
      return (node_m - scene::Point(0.03, 0.03, kThickTop_m)).norm() < 1e-9;
    });
    const int node = static_cast<int>(top - nodes_m.begin());
    return tissue.compliance_m_per_N(node, node)(2, 2);
  };
  const double nearly = yield_m_per_N(tissue_of({.young_Pa = 5000, .poisson = 0.4999}));
  EXPECT_NEAR(nearly / yield_m_per_N(tissue_of({.young_Pa = 5000, .poisson = 0.499})), 1, 0.02);
  EXPECT_GT(nearly / yield_m_per_N(tissue_of({.young_Pa = 5000, .poisson = 0.3})), 0.6);
  EXPECT_THROW(tissue_of({.young_Pa = 5000, .poisson = 0.5}), std::invalid_argument);
}

TEST(HardCase38, AnExhaustedBudgetReportsTheLastIterateAndItsResidual) {
  const LinearTissue tissue = tissue_of(test::kSoft);
  for (const int iterations : {1, 2, 3}) {
    SCOPED_TRACE(iterations);
    const TissueModel model(tissue, {.radius_m = 0.01, .contacts_max = 16, .iterations_max = iterations});
    TissueState state{};
    TissueResult result = model.step(state, {0.0312, 0.0291, kThickTop_m + 0.006});
    EXPECT_EQ(result.iterations, iterations);
    EXPECT_FALSE(result.converged);
    EXPECT_GT(result.residual_m, 1e-7);
    EXPECT_TRUE(result.force_N.allFinite());
    EXPECT_GT(result.force_N.z(), 0);
    // The last iterate is kept: the next steps continue from there.
    for (int n = 0; n < 20; ++n) result = model.step(state, {0.0312, 0.0291, kThickTop_m + 0.006});
    EXPECT_TRUE(result.converged);
    EXPECT_LT(result.residual_m, 1e-7);
  }
}

}  // namespace
}  // namespace forcebound::tissue
