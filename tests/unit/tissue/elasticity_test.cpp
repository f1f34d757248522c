#include "forcebound/tissue/elasticity.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <limits>
#include <random>
#include <stdexcept>

#include "tests/support/tissue_block.hpp"

namespace forcebound::tissue {
namespace {

using test::kSoft;

/// A block whose inner nodes lie anywhere, so that no two tetrahedra are alike.
TetrahedralMesh irregular_block() {
  auto soup = test::tetrahedra_of({.cubes = {3, 3, 3}, .cube_m = 0.01});
  soup.boxes.clear();
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> shift_m(-0.002, 0.002);
  for (scene::Point& node : soup.nodes) {
    if (node.minCoeff() < 0.001 || node.maxCoeff() > 0.029) continue;
    node += scene::Point(shift_m(random), shift_m(random), shift_m(random));
  }
  return TetrahedralMesh(soup);
}

Eigen::VectorXd linear_field(const TetrahedralMesh& mesh, const Eigen::Matrix3d& gradient) {
  Eigen::VectorXd field(3 * static_cast<Eigen::Index>(mesh.nodes_m().size()));
  for (std::size_t n = 0; n < mesh.nodes_m().size(); ++n) {
    field.segment<3>(3 * static_cast<Eigen::Index>(n)) = gradient * mesh.nodes_m()[n];
  }
  return field;
}

Eigen::Matrix3d some_gradient() {
  Eigen::Matrix3d gradient;
  gradient << 0.01, -0.02, 0.03, 0.004, -0.005, 0.006, 0.07, 0.008, -0.009;
  return gradient;
}

/// Of boxes of unequal edges, turned.
TetrahedralMesh block_of_boxes() {
  return TetrahedralMesh(tetrahedral_block({.cells = {3, 3, 3}, .size_m = {0.03, 0.05, 0.02}}),
                         {.rotation = Eigen::AngleAxisd(1, scene::Point(1, 2, -2).normalized()).toRotationMatrix()});
}

std::vector<TetrahedralMesh> of_each_element() {
  return {irregular_block(), irregular_block().with_middles(), block_of_boxes()};
}

void expect_patch_test(const TetrahedralMesh& mesh) {
  const Eigen::VectorXd field = linear_field(mesh, some_gradient());
  const FreeCoordinates free(static_cast<int>(mesh.nodes_m().size()), mesh.surface_nodes());
  ASSERT_GE(free.count(), 24);
  const Eigen::SparseMatrix<double> all = stiffness_matrix(mesh, kSoft);
  Eigen::VectorXd boundary = field;
  Eigen::VectorXd inside(free.count());
  for (int node = 0; node < static_cast<int>(mesh.nodes_m().size()); ++node) {
    if (free.first_of(node) == FreeCoordinates::kHeld) continue;
    inside.segment<3>(free.first_of(node)) = field.segment<3>(3 * node);
    boundary.segment<3>(3 * node).setZero();
  }
  const Eigen::VectorXd pushed = all * boundary;
  Eigen::VectorXd load(free.count());
  for (int node = 0; node < static_cast<int>(mesh.nodes_m().size()); ++node) {
    if (free.first_of(node) != FreeCoordinates::kHeld)
      load.segment<3>(free.first_of(node)) = -pushed.segment<3>(3 * node);
  }
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> cholesky(free.reduced(all));
  const Eigen::VectorXd solved = cholesky.solve(load);
  EXPECT_LT((solved - inside).norm(), 1e-10 * inside.norm());
}

TEST(Elasticity, PassesThePatchTest) {
  for (const TetrahedralMesh& mesh : of_each_element()) expect_patch_test(mesh);
}

TEST(Elasticity, ForcesOnTheBoundaryAreThoseOfHookesLaw) {
  const TetrahedralMesh mesh = irregular_block();
  const Eigen::VectorXd force = stiffness_matrix(mesh, kSoft) * linear_field(mesh, some_gradient());
  const Eigen::Matrix3d strain = 0.5 * (some_gradient() + some_gradient().transpose());
  const Eigen::Matrix3d stress_Pa =
      2 * kSoft.mu_Pa() * strain + kSoft.lambda_Pa() * strain.trace() * Eigen::Matrix3d::Identity();
  scene::Point top_N = scene::Point::Zero();
  for (std::size_t n = 0; n < mesh.nodes_m().size(); ++n) {
    if (mesh.nodes_m()[n].z() > 0.0299) top_N += force.segment<3>(3 * static_cast<Eigen::Index>(n));
  }
  // The nodes of the top's rim also carry a share of the sides' tractions: a node's share is a third of each triangle.
  scene::Point expected_N = scene::Point::Zero();
  for (const auto& triangle : mesh.triangles()) {
    const auto corner = [&](std::size_t a) { return mesh.nodes_m()[triangle[a]]; };
    const scene::Point area_m2 = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (std::size_t a = 0; a < 3; ++a) {
      if (corner(a).z() > 0.0299) expected_N += stress_Pa * area_m2 / 3;
    }
  }
  EXPECT_LT((top_N - expected_N).norm(), 1e-12 * expected_N.norm());
}

TEST(Elasticity, StiffnessIsSymmetricAndFreeOfForceUnderRigidMotion) {
  for (const TetrahedralMesh& mesh : of_each_element()) {
    const Eigen::MatrixXd stiffness = stiffness_matrix(mesh, kSoft);
    EXPECT_LT((stiffness - stiffness.transpose()).norm(), 1e-13 * stiffness.norm());
    Eigen::Matrix3d turn;
    turn << 0, -1, 2, 1, 0, -3, -2, 3, 0;
    Eigen::VectorXd motion = linear_field(mesh, turn);
    for (Eigen::Index row = 0; row < motion.size(); ++row) motion[row] += 0.1 * static_cast<double>(row % 3);
    EXPECT_LT((stiffness * motion).norm(), 1e-13 * stiffness.norm() * motion.norm());
  }
}

TEST(Elasticity, NothingButRigidMotionIsFreeOfEnergy) {
  for (const TetrahedralMesh& mesh : of_each_element()) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen{Eigen::MatrixXd(stiffness_matrix(mesh, kSoft))};
    const double largest = eigen.eigenvalues().maxCoeff();
    EXPECT_GT(eigen.eigenvalues()[0], -1e-12 * largest);
    EXPECT_LT(eigen.eigenvalues()[5], 1e-12 * largest);
    EXPECT_GT(eigen.eigenvalues()[6], 1e-4 * largest);
  }
}

TEST(ElasticMaterial, RefusesInvalidMaterials) {
  EXPECT_NO_THROW((ElasticMaterial{.young_Pa = 1, .poisson = 0.4999}.check()));
  EXPECT_NO_THROW((ElasticMaterial{.young_Pa = 1, .poisson = -0.5}.check()));
  for (const double poisson : {0.5, 0.7, -1.0, std::nan("")}) {
    EXPECT_THROW((ElasticMaterial{.young_Pa = 1, .poisson = poisson}.check()), std::invalid_argument) << poisson;
  }
  for (const double young_Pa : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((ElasticMaterial{.young_Pa = young_Pa, .poisson = 0.3}.check()), std::invalid_argument) << young_Pa;
  }
}

TEST(FreeCoordinates, RefuseANodeThatDoesNotExist) {
  EXPECT_THROW(FreeCoordinates(4, {0, 4}), std::invalid_argument);
  EXPECT_THROW(FreeCoordinates(4, {-1}), std::invalid_argument);
  const FreeCoordinates free(4, {1, 1});
  EXPECT_EQ(free.count(), 9);
  EXPECT_EQ(free.first_of(1), FreeCoordinates::kHeld);
  EXPECT_EQ(free.first_of(2), 3);
}

}  // namespace
}  // namespace forcebound::tissue
