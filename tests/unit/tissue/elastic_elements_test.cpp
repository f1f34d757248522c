#include "forcebound/tissue/elastic_elements.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "forcebound/tissue/elasticity.hpp"
#include "forcebound/tissue/held_stiffness.hpp"
#include "forcebound/tissue/tissue_contact.hpp"
#include "tests/support/tissue_block.hpp"

namespace forcebound::tissue {
namespace {

constexpr double kBeamHeight_m = 0.01;
constexpr double kBeamLength_m = 0.1;

enum class Element { box, ten_nodes, four_nodes };

// Cubes, that many in the height and width.
TetrahedralMesh beam_of(Element element, std::size_t cells) {
  const double cell_m = kBeamHeight_m / static_cast<double>(cells);
  TetrahedralSoup soup = test::tetrahedra_of({.cubes = {10 * cells, cells, cells}, .cube_m = cell_m});
  if (element != Element::box) soup.boxes.clear();
  TetrahedralMesh mesh(soup);
  return element == Element::ten_nodes ? mesh.with_middles() : mesh;
}

// Held at one end, under a force across it spread over the other.
double beam_stiffness_N_per_m(const TetrahedralMesh& mesh, const ElasticMaterial& material) {
  const FreeCoordinates free(static_cast<int>(mesh.nodes_m().size()),
                             nodes_below(mesh, {1e-9, 0, 0}, scene::Point::UnitX()));
  SparseCholesky cholesky;
  factorise(cholesky, free.reduced(stiffness_matrix(mesh, material)), mesh.name());
  Eigen::VectorXd load = Eigen::VectorXd::Zero(free.count());
  for (std::size_t node = 0; node < mesh.nodes_m().size(); ++node) {
    if (mesh.nodes_m()[node].x() > kBeamLength_m - 1e-9) load[free.first_of(static_cast<int>(node)) + 2] = 1;
  }
  load /= load.sum();
  return 1 / load.dot(cholesky.solve(load));
}

// Of a square section, with the shear coefficient of Cowper 1966.
double timoshenko_N_per_m(const ElasticMaterial& material) {
  const double area_m2 = kBeamHeight_m * kBeamHeight_m;
  const double coefficient = 10 * (1 + material.poisson) / (12 + 11 * material.poisson);
  const double bends = std::pow(kBeamLength_m, 3) / (3 * material.young_Pa * area_m2 * area_m2 / 12);
  return 1 / (bends + kBeamLength_m / (coefficient * area_m2 * material.mu_Pa()));
}

double beam_ratio(Element element, std::size_t cells, double poisson) {
  const ElasticMaterial material{.young_Pa = 1e5, .poisson = poisson};
  return beam_stiffness_N_per_m(beam_of(element, cells), material) / timoshenko_N_per_m(material);
}

TEST(ElasticElements, ACantileverOfBoxesBendsAsTimoshenkoSaysFromOneInItsHeightOn) {
  for (const double poisson : {0.0, 0.3, 0.4, 0.45, 0.49, 0.499}) {
    for (const std::size_t cells : {1U, 2U, 3U}) {
      EXPECT_NEAR(beam_ratio(Element::box, cells, poisson), 1, 0.05) << cells << ", poisson " << poisson;
    }
  }
}

TEST(ElasticElements, ACantileverOfTetrahedraOfTenNodesBendsAsTimoshenkoSaysFromTwoInItsHeightOn) {
  for (const double poisson : {0.0, 0.3, 0.4, 0.45, 0.49, 0.499}) {
    EXPECT_NEAR(beam_ratio(Element::ten_nodes, 2, poisson), 1, 0.05) << "poisson " << poisson;
  }
}

// So it stays known what they cost.
TEST(ElasticElements, OneOfTetrahedraOfFourNodesIsMuchTooStiff) {
  EXPECT_GT(beam_ratio(Element::four_nodes, 1, 0.3), 4);
  EXPECT_GT(beam_ratio(Element::four_nodes, 2, 0.3), 1.9);
  EXPECT_GT(beam_ratio(Element::four_nodes, 2, 0.49), 9);
}

TEST(ElasticElements, ABlockThatIsTurnedIsAsStiff) {
  const ElasticMaterial material{.young_Pa = 1e5, .poisson = 0.4};
  const BlockDescription block{.cells = {2, 1, 1}, .size_m = {0.03, 0.01, 0.02}};
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(1, scene::Point(1, 2, -2).normalized()));
  const TetrahedralMesh straight(tetrahedral_block(block));
  const TetrahedralMesh turned(tetrahedral_block(block), {.rotation = turn});
  const Eigen::MatrixXd expected = stiffness_matrix(straight, material);
  const Eigen::MatrixXd found = stiffness_matrix(turned, material);
  for (Eigen::Index a = 0; a < expected.rows(); a += 3) {
    for (Eigen::Index b = 0; b < expected.cols(); b += 3) {
      const Eigen::Matrix3d back = turn.transpose() * found.block<3, 3>(a, b) * turn;
      EXPECT_LT((back - expected.block<3, 3>(a, b)).norm(), 1e-12 * expected.norm());
    }
  }
}

// Of a sphere on a layer that is bonded to its bed (Dimitriadis et al., Biophysical Journal 82, 2002, equation 11).
double layer_force_N(const ElasticMaterial& material, double radius_m, double depth_m, double thickness_m) {
  const double nu = material.poisson;
  const double a = (1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu) / M_PI;
  const double b = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1 - nu) / M_PI;
  const double x = std::sqrt(radius_m * depth_m) / thickness_m;
  const double hertz_N = 4 * material.young_Pa / (3 * (1 - nu * nu)) * std::sqrt(radius_m) * std::pow(depth_m, 1.5);
  return hertz_N * (1 + 2 * a * x + 4 * a * a * x * x + 8 * (a * a * a - 4 * b / 15) * x * x * x);
}

// The mesh of the scene palpation, and its sphere.
TEST(ElasticElements, ASphereIsHeldOffAsHertzSaysFromFourTenthsOfItsRadiusOn) {
  constexpr double kRadius_m = 0.01;
  const TetrahedralMesh mesh(
      tetrahedral_block({.cells = {15, 15, 7}, .from_m = {-0.03, -0.03, -0.03}, .size_m = {0.06, 0.06, 0.03}}));
  const std::vector<int> held = nodes_below(mesh, {0, 0, -0.03}, scene::Point::UnitZ());
  for (const double poisson : {0.4, 0.499}) {
    const ElasticMaterial material{.young_Pa = 15000, .poisson = poisson};
    const TissueModel model(LinearTissue(mesh, material, held), {.radius_m = kRadius_m, .contacts_max = 16});
    for (const scene::Point& over_m : {scene::Point(0, 0, 0), scene::Point(0.001, 0.0016, 0)}) {
      TissueState state{};
      static_cast<void>(model.step(state, over_m + scene::Point(0, 0, 2 * kRadius_m)));
      for (const double depth_m : {0.004, 0.005}) {
        const scene::Point center_m = over_m + scene::Point(0, 0, kRadius_m - depth_m);
        TissueResult result;
        for (int n = 0; n < 3; ++n) result = model.step(state, center_m);
        EXPECT_NEAR(result.force_N.z() / layer_force_N(material, kRadius_m, depth_m, 0.03), 1, 0.11)
            << depth_m << ", poisson " << poisson;
      }
    }
  }
}

}  // namespace
}  // namespace forcebound::tissue
