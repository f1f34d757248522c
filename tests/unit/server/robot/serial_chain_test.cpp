#include "forcebound/server/robot/serial_chain.hpp"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <random>

#include "forcebound/server/dynamics/bodies/mujoco.hpp"
#include "forcebound/server/robot/arm_mjcf.hpp"
#include "forcebound/server/robot/inverse_kinematics.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/server/robot/scripted_run.hpp"

namespace forcebound::server {
namespace {

class ArmChain : public testing::Test {
 protected:
  Vector any_posture() {
    std::uniform_real_distribution<double> share(0.05, 0.95);
    Vector q = chain_.limits().lowest;
    for (Eigen::Index i = 0; i < q.rows(); ++i) {
      q[i] += share(random_) * (chain_.limits().highest[i] - chain_.limits().lowest[i]);
    }
    return q;
  }

  const Task task_ = free_task();
  const ModelPointer model_ = compile_mjcf(arm_mjcf(*task_.world), "arm");
  const ArmLayout layout_ = layout_of(*model_);
  const SerialChain chain_ = chain_of(*model_, layout_);
  std::mt19937_64 random_{1};
};

TEST_F(ArmChain, HasTheGeometryAndTheMassesOfMuJoCosModel) {
  const DataPointer data = make_data(*model_);
  for (int game = 0; game < 100; ++game) {
    const Vector q = any_posture();
    std::copy(q.begin(), q.end(), data->qpos);
    ASSERT_TRUE(find_dynamics(*model_, *data));
    const double* const tool = data->site_xpos + 3L * layout_.tool_site;
    EXPECT_LT((chain_.pose(q).position - Eigen::Map<const Eigen::Vector3d>(tool)).norm(), 1e-12);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(data->site_xmat + 9L * layout_.tool_site);
    EXPECT_LT((chain_.pose(q).orientation.toRotationMatrix() - axes).norm(), 1e-12);

    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Rows linear(3, model_->nv);
    Rows turning(3, model_->nv);
    mj_jac(model_.get(), data.get(), linear.data(), turning.data(), tool, layout_.tool_body);
    EXPECT_LT((chain_.jacobian(q).topRows(3) - linear.leftCols(7)).norm(), 1e-12);
    EXPECT_LT((chain_.jacobian(q).bottomRows(3) - turning.leftCols(7)).norm(), 1e-12);

    Rows mass(model_->nv, model_->nv);
    mj_fullM(model_.get(), mass.data(), data->qM);
    EXPECT_LT((chain_.mass_matrix(q) - mass.topLeftCorner(7, 7)).norm(), 1e-10 * mass.norm());
  }
}

TEST_F(ArmChain, HasTheTorquesOfGravityOfMuJoCosModel) {
  // The arm compensates its weight itself, so that its model has none.
  model_->opt.gravity[2] = -kGravity_m_per_s2;
  const DataPointer data = make_data(*model_);
  for (int game = 0; game < 20; ++game) {
    const Vector q = any_posture();
    std::copy(q.begin(), q.end(), data->qpos);
    ASSERT_TRUE(find_dynamics(*model_, *data));
    Eigen::VectorXd holding(model_->nv);
    mj_rne(model_.get(), data.get(), 0, holding.data());
    EXPECT_LT((chain_.gravity(q) - holding.head(7)).norm(), 1e-10 * holding.norm());
  }
}

TEST_F(ArmChain, JacobianIsTheDerivativeOfThePose) {
  constexpr double kStep = 1e-6;
  for (int game = 0; game < 20; ++game) {
    const Vector q = any_posture();
    const ToolJacobian jacobian = chain_.jacobian(q);
    for (Eigen::Index i = 0; i < q.rows(); ++i) {
      Vector ahead = q;
      Vector behind = q;
      ahead[i] += kStep;
      behind[i] -= kStep;
      const ToolPose there = chain_.pose(ahead);
      const ToolPose here = chain_.pose(behind);
      Vector6 slope;
      slope << (there.position - here.position) / (2 * kStep),
          turn_between(here.orientation, there.orientation) / (2 * kStep);
      EXPECT_LT((slope - jacobian.col(i)).norm(), 1e-7);
    }
  }
}

TEST_F(ArmChain, RestsWithTheToolStraightDownWellInsideItsLimits) {
  const ToolPose rest = chain_.pose(chain_.rest());
  EXPECT_NEAR((rest.orientation * Eigen::Vector3d::UnitZ()).z(), -1, 1e-12);
  EXPECT_GT((chain_.limits().highest - chain_.rest()).minCoeff(), 0.3);
  EXPECT_GT((chain_.rest() - chain_.limits().lowest).minCoeff(), 0.3);
}

TEST_F(ArmChain, FindsAPostureForEveryPoseThatItTook) {
  int found = 0;
  for (int game = 0; game < 50; ++game) {
    Vector q = chain_.rest();
    std::uniform_real_distribution<double> away(-0.4, 0.4);
    for (double& joint : q) joint += away(random_);
    const ToolPose pose = chain_.pose(q);
    const Posture posture = posture_for(chain_, pose);
    found += posture.reaches() ? 1 : 0;
    EXPECT_LT((chain_.pose(posture.joints).position - pose.position).norm(), 1e-6);
  }
  EXPECT_EQ(found, 50);
}

TEST_F(ArmChain, SaysHowFarAPoseIsOutOfReach) {
  const Posture posture =
      posture_for(chain_, {.position = {2, 0, 0.3}, .orientation = chain_.pose(chain_.rest()).orientation});
  EXPECT_FALSE(posture.reaches());
  EXPECT_GT(posture.off_m, 0.8);
}

TEST_F(ArmChain, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const Vector q = any_posture();
  const test::AllocationGuard guard;
  (void)chain_.pose(q);
  (void)chain_.jacobian(q);
  (void)chain_.mass_matrix(q);
  (void)chain_.gravity(q);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(SerialChain, RefusesLimitsOfAnotherNumberOfJoints) {
  SerialChain::Description description;
  description.name = "one";
  description.links.resize(1);
  try {
    const SerialChain chain(description);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "arm 'one' must have limits and a rest posture of 1 rows, got 0");
  }
}

}  // namespace
}  // namespace forcebound::server
