#include "forcebound/server/follower/architecture.hpp"

#include <gtest/gtest.h>

#include "forcebound/control/rotation.hpp"

namespace forcebound::server {
namespace {

TEST(Reflection, TurnsTheHandTowardsTheToolUpToItsLargestTorque) {
  const Eigen::Quaterniond wanted = control::turn_by({0.2, -0.3, 0.1});
  const Eigen::Vector3d lag_rad(0, 0.01, -0.02);
  Reflection tie{.turn_N_m_per_rad = 100, .tool_orientation = control::turn_by(lag_rad) * wanted, .torque_N_m_max = 15};
  EXPECT_LT((tie.torque_at(wanted) - 100 * lag_rad).norm(), 1e-12);
  tie.torque_N_m_max = 0.5;
  EXPECT_NEAR(tie.torque_at(wanted).norm(), 0.5, 1e-12);
  EXPECT_GT(tie.torque_at(wanted).dot(lag_rad), 0);
  EXPECT_TRUE(tie.torque_at(tie.tool_orientation).isZero(1e-12));
  EXPECT_TRUE(Reflection{}.torque_at(wanted).isZero(0)) << "no torque unless an architecture ties orientations";
}

}  // namespace
}  // namespace forcebound::server
