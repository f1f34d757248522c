#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "forcebound/server/robot/robot_description.hpp"
#include "forcebound/server/robot/serial_chain.hpp"
#include "tests/support/allocation_guard.hpp"

namespace forcebound::server {
namespace {

/// Joints anywhere, about any axes.
SerialChain::Description any_chain(std::mt19937_64& random, int joints) {
  std::uniform_real_distribution<double> share(-1, 1);
  const auto any_vector = [&] { return Eigen::Vector3d(share(random), share(random), share(random)); };
  std::vector<DescribedJoint> told;
  told.reserve(static_cast<std::size_t>(joints));
  for (int i = 0; i < joints; ++i) {
    told.push_back({.axis = any_vector(),
                    .point_m = any_vector(),
                    .centre_m = any_vector(),
                    .mass_kg = 2 + share(random),
                    .inertia_kg_m2 = 0.1 * Eigen::Matrix3d::Identity()});
  }
  SerialChain::Description chain;
  chain.name = "any";
  chain.links = links_of(told);
  chain.tool = tool_of(told, any_vector(), any_vector());
  chain.limits.lowest = Vector::Constant(joints, -3);
  chain.limits.highest = Vector::Constant(joints, 3);
  chain.limits.speed_max = Vector::Ones(joints);
  chain.limits.torque_max = Vector::Ones(joints);
  chain.rest = Vector::Zero(joints);
  return chain;
}

double potential_J(const SerialChain& chain, const std::vector<ChainLink>& links, const Vector& q) {
  const LinkFrames frames = chain.link_frames(q);
  double energy_J = 0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    energy_J += links[i].mass_kg * kGravity_m_per_s2 * (frames.at(i) * links[i].centre).z();
  }
  return energy_J;
}

TEST(SerialChain, GravityIsTheSlopeOfThePotentialEnergy) {
  constexpr double kStep = 1e-5;
  std::mt19937_64 random{3};
  std::uniform_real_distribution<double> angle(-3, 3);
  for (int joints = 1; joints <= control::kJointsMax; ++joints) {
    const SerialChain::Description description = any_chain(random, joints);
    const SerialChain chain(description);
    Vector q(joints);
    for (double& joint : q) joint = angle(random);
    const Vector gravity = chain.gravity(q);
    for (Eigen::Index i = 0; i < joints; ++i) {
      Vector ahead = q;
      Vector behind = q;
      ahead[i] += kStep;
      behind[i] -= kStep;
      const double slope =
          (potential_J(chain, description.links, ahead) - potential_J(chain, description.links, behind)) / (2 * kStep);
      EXPECT_NEAR(gravity[i], slope, 1e-6) << "joint " << i + 1 << " of " << joints;
    }
  }
}

TEST(SerialChain, GravityDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  std::mt19937_64 random{3};
  const SerialChain chain(any_chain(random, control::kJointsMax));
  const Vector q = Vector::Ones(control::kJointsMax);
  const test::AllocationGuard guard;
  (void)chain.gravity(q);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::server
