#include "forcebound/tissue/corotational_elasticity.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/tissue_block.hpp"

namespace forcebound::tissue {
namespace {

using test::kSoft;

enum class OfNodes { four, eight, ten };

class Block {
 public:
  explicit Block(OfNodes nodes = OfNodes::eight) : mesh_(mesh_of(nodes)), elasticity_(mesh_, kSoft) {}

  [[nodiscard]] const CorotationalElasticity& elasticity() const { return elasticity_; }

  [[nodiscard]] DeformedBody deformed(const Eigen::VectorXd& displacement_m) const {
    DeformedBody body = elasticity_.at_rest();
    body.displacement_m = displacement_m;
    elasticity_.evaluate(body, elasticity_.at_rest());
    return body;
  }

  [[nodiscard]] Eigen::VectorXd field(const Eigen::Matrix3d& deformation, const scene::Point& shift_m) const {
    Eigen::VectorXd displacement_m = elasticity_.at_rest().displacement_m;
    Eigen::Index first = 0;
    for (const scene::Point& node : mesh_.nodes_m()) {
      displacement_m.segment<3>(first) = deformation * node + shift_m - node;
      first += 3;
    }
    return displacement_m;
  }

  [[nodiscard]] Eigen::VectorXd any(double wild_m, std::mt19937_64& random) const {
    std::uniform_real_distribution<double> any_m(-wild_m, wild_m);
    Eigen::VectorXd displacement_m = elasticity_.at_rest().displacement_m;
    for (double& one : displacement_m) one = any_m(random);
    return displacement_m;
  }

 private:
  static TetrahedralMesh mesh_of(OfNodes nodes) {
    auto soup = test::tetrahedra_of(test::kThinBlock);
    if (nodes == OfNodes::eight) return TetrahedralMesh(soup);
    soup.boxes.clear();
    const TetrahedralMesh mesh(soup);
    return nodes == OfNodes::four ? mesh : mesh.with_middles();
  }

  TetrahedralMesh mesh_;
  CorotationalElasticity elasticity_;
};

std::vector<Block> of_all_elements() { return {Block(OfNodes::four), Block(OfNodes::eight), Block(OfNodes::ten)}; }

TEST(CorotationalElasticity, RigidMotionTakesNoForce) {
  for (const Block& block : of_all_elements()) {
    for (const double angle : {0.1, 1.0, std::numbers::pi / 2, 3.1, std::numbers::pi}) {
      const Eigen::Matrix3d rotation(Eigen::AngleAxisd(angle, scene::Point(1, 2, -2).normalized()));
      const DeformedBody body = block.deformed(block.field(rotation, {0.3, -0.2, 0.1}));
      EXPECT_LT(body.energy_J, 1e-25) << angle;
      EXPECT_LT(body.force_N.norm(), 1e-12) << angle;
    }
  }
}

void expect_gradient(const Block& block, const std::vector<double>& wildnesses_m) {
  std::mt19937_64 random(3);
  for (const double wild_m : wildnesses_m) {
    const Eigen::VectorXd displacement_m = block.any(wild_m, random);
    const DeformedBody body = block.deformed(displacement_m);
    for (const Eigen::Index coordinate : {0, 17, 64, 101}) {
      const auto energy_J = [&](double step_m) {
        Eigen::VectorXd moved_m = displacement_m;
        moved_m[coordinate] += step_m;
        return block.deformed(moved_m).energy_J;
      };
      const double gradient = (energy_J(1e-8) - energy_J(-1e-8)) / 2e-8;
      EXPECT_NEAR(body.force_N[coordinate], -gradient, 1e-5 * (1 + std::abs(gradient))) << wild_m;
    }
  }
}

TEST(CorotationalElasticity, ForceIsTheGradientOfItsEnergyOfFourNodesAlsoInsideOut) {
  expect_gradient(Block(OfNodes::four), {0.001, 0.004, 0.02});
}

TEST(CorotationalElasticity, ForceIsTheGradientOfItsEnergyWhileNothingIsInsideOut) {
  expect_gradient(Block(OfNodes::eight), {0.001, 0.003});
  expect_gradient(Block(OfNodes::ten), {0.0005, 0.001});
}

void expect_derivative(const Block& block) {
  std::mt19937_64 random(5);
  const Eigen::Matrix3d turned(Eigen::AngleAxisd(2, scene::Point(1, 2, -2).normalized()));
  const Eigen::VectorXd displacement_m = block.field(turned, {0.3, -0.2, 0.1}) + block.any(0.0007, random);
  const Eigen::VectorXd moved_m = block.any(1, random);
  const DeformedBody body = block.deformed(displacement_m);
  LinearisedBody linearised = block.elasticity().make_linearised();
  block.elasticity().linearise(body, linearised);
  Eigen::VectorXd resistance = moved_m;
  block.elasticity().resist(linearised, moved_m, resistance);
  constexpr double kStep = 1e-7;
  const Eigen::VectorXd difference = (block.deformed(displacement_m - kStep * moved_m).force_N -
                                      block.deformed(displacement_m + kStep * moved_m).force_N) /
                                     (2 * kStep);
  EXPECT_LT((resistance - difference).norm(), 1e-6 * difference.norm());
}

TEST(CorotationalElasticity, ResistanceIsTheDerivativeOfTheForce) {
  for (const Block& block : of_all_elements()) expect_derivative(block);
}

TEST(CorotationalElasticity, WhereTheSearchForRotationsBeginsDoesNotMatter) {
  const Block block;
  std::mt19937_64 random(9);
  for (const double wild_m : {0.001, 0.004, 0.02}) {
    const DeformedBody from_rest = block.deformed(block.any(wild_m, random));
    DeformedBody from_elsewhere = from_rest;
    block.elasticity().evaluate(from_elsewhere, block.deformed(block.any(0.02, random)));
    EXPECT_NEAR(from_elsewhere.energy_J / from_rest.energy_J, 1, 1e-12);
    EXPECT_LT((from_elsewhere.force_N - from_rest.force_N).norm(), 1e-10 * from_rest.force_N.norm());
  }
}

TEST(CorotationalElasticity, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const Block block;
  std::mt19937_64 random(1);
  DeformedBody body = block.elasticity().at_rest();
  body.displacement_m = block.any(0.004, random);
  LinearisedBody linearised = block.elasticity().make_linearised();
  Eigen::VectorXd resistance = body.displacement_m;
  const test::AllocationGuard guard;
  block.elasticity().evaluate(body, body);
  block.elasticity().linearise(body, linearised);
  block.elasticity().resist(linearised, body.displacement_m, resistance);
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_GT(body.energy_J, 0);
}

}  // namespace
}  // namespace forcebound::tissue
