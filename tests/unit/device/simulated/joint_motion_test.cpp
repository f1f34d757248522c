#include "forcebound/device/simulated/joint_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::device {
namespace {

Vector vector(std::initializer_list<double> values) {
  Vector result(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) result[i++] = value;
  return result;
}

Matrix one(double value) { return Matrix::Constant(1, 1, value); }

JointDrive drive(double length_s, const Vector& torque) {
  JointDrive drive{.length_s = length_s, .torque = torque, .hand_pull = {}};
  drive.hand_pull.fill(Vector::Zero(torque.size()));
  return drive;
}

struct Oscillator {
  double mass = 0.1;
  double damping = 0;
  double stiffness = 0;
  double friction = 0;
  double start = 0;

  [[nodiscard]] JointMotion motion() const {
    JointMotion motion(one(damping), vector({friction}), vector({start}));
    motion.set_system({one(mass), one(damping), one(stiffness)});
    return motion;
  }
};

// A piece measures from its beginning, so the spring's pull there is part of the drive.
JointDrive spring_drive(const JointMotion& motion, const Oscillator& o, double length_s, double torque = 0) {
  JointDrive result = drive(length_s, vector({torque}));
  result.hand_pull[0] = -o.stiffness * motion.position();
  return result;
}

double kinetic_and_spring(const JointMotion& motion, const Oscillator& o) {
  return 0.5 * o.mass * motion.velocity().squaredNorm() + 0.5 * o.stiffness * motion.position().squaredNorm();
}

TEST(JointMotion, DampedMassUnderConstantForceFollowsTheExponential) {
  const Oscillator o{.mass = 0.1, .damping = 30};
  JointMotion motion = o.motion();
  for (int tick = 0; tick < 20; ++tick) motion.advance(drive(1e-3, vector({2.0})));
  const double t = 0.02;
  const double decay = -std::expm1(-o.damping / o.mass * t);
  EXPECT_NEAR(motion.velocity()[0], 2.0 / 30 * decay, 1e-15);
  EXPECT_NEAR(motion.position()[0], 2.0 / 30 * (t - o.mass / o.damping * decay), 1e-16);
}

TEST(JointMotion, OscillatorKeepsItsPhaseOverTenThousandTicks) {
  Oscillator o{.mass = 0.1, .stiffness = 1e3, .start = 0.01};
  JointMotion motion = o.motion();
  for (int tick = 0; tick < 10000; ++tick) motion.advance(spring_drive(motion, o, 1e-3));
  const double phase = std::sqrt(o.stiffness / o.mass) * 10.0;
  EXPECT_NEAR(motion.position()[0], 0.01 * std::cos(phase), 1e-13);
  EXPECT_NEAR(motion.velocity()[0], -1.0 * std::sin(phase), 1e-11);
}

TEST(JointMotion, FrictionStopsASlidingMassAfterTheClosedFormDistance) {
  // v' = -g - k v from v0: stops at t = ln(1 + k v0 / g) / k after v0 / k - g t / k.
  const Oscillator o{.mass = 0.1, .damping = 0.5, .friction = 0.2};
  JointMotion motion = o.motion();
  for (int tick = 0; tick < 50; ++tick) motion.advance(drive(1e-3, vector({1.0})));
  const double v0 = motion.velocity()[0];
  const double x0 = motion.position()[0];
  for (int tick = 0; tick < 500; ++tick) motion.advance(drive(1e-3, vector({0.0})));
  const double k = o.damping / o.mass;
  const double g = o.friction / o.mass;
  const double time = std::log1p(k * v0 / g) / k;
  EXPECT_LT(time, 0.5);
  EXPECT_EQ(motion.velocity()[0], 0);
  EXPECT_NEAR(motion.position()[0] - x0, v0 / k - g * time / k, 1e-15);
}

TEST(JointMotion, SticksBelowItsFriction) {
  const Oscillator o{.friction = 0.2};
  JointMotion motion = o.motion();
  for (int tick = 0; tick < 1000; ++tick) motion.advance(drive(1e-3, vector({tick % 2 ? 0.2 : -0.2})));
  EXPECT_EQ(motion.position()[0], 0);
  EXPECT_EQ(motion.velocity()[0], 0);
  EXPECT_EQ(motion.audit().energy_J, 0);
}

TEST(JointMotion, BreaksAwayBetweenTicksWhenARisingPullReachesItsFriction) {
  // The pull 400 N/s reaches c = 0.2 N at 0.5 ms; then m x'' = 400 (t - 0.5 ms).
  const Oscillator o{.mass = 0.1, .friction = 0.2};
  JointMotion motion = o.motion();
  JointDrive ramp = drive(1e-3, vector({0.0}));
  ramp.hand_pull[1] = vector({400.0});
  motion.advance(ramp);
  EXPECT_NEAR(motion.velocity()[0], 400 / 0.1 * 0.5e-3 * 0.5e-3 / 2, 1e-13);
  EXPECT_NEAR(motion.position()[0], 400 / 0.1 * std::pow(0.5e-3, 3) / 6, 1e-16);
}

TEST(JointMotion, SpringAndFrictionLoseTheSameStretchEachHalfSwing) {
  // The amplitude shrinks by 2 c / k per half swing, and the mass rests as soon as the spring is weaker than c.
  const Oscillator o{.mass = 0.1, .stiffness = 1e3, .friction = 1.0, .start = 0.0095};
  JointMotion motion = o.motion();
  for (int tick = 0; tick < 1000; ++tick) motion.advance(spring_drive(motion, o, 1e-3));
  EXPECT_EQ(motion.velocity()[0], 0);
  EXPECT_NEAR(motion.position()[0], 0.0005, 1e-14);  // 9.5 -> -7.5 -> 5.5 -> -3.5 -> 1.5 -> 0.5 mm
}

TEST(JointMotion, EnergyBalanceCloses) {
  // P is all the device dissipated less what its motors did, so P + kinetic + spring stays what it was.
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> torque(-3, 3);
  for (const double friction : {0.0, 0.4}) {
    const Oscillator o{.mass = 0.1, .damping = 0.5, .stiffness = 300, .friction = friction, .start = 0.02};
    JointMotion motion = o.motion();
    const double before = kinetic_and_spring(motion, o);
    double turnover = before;
    for (int tick = 0; tick < 5000; ++tick) {
      motion.advance(spring_drive(motion, o, 1e-3, torque(random)));
      turnover = std::max(turnover, std::abs(motion.audit().energy_J));
    }
    const double after = kinetic_and_spring(motion, o) + motion.audit().energy_J;
    EXPECT_NEAR(after, before, 1e-12 * turnover) << "friction " << friction;
  }
}

struct Coupled {
  Matrix inertia{3, 3};
  Matrix damping{3, 3};
  Matrix stiffness{3, 3};
  Vector friction;

  explicit Coupled(double friction_scale = 0) {
    inertia << 0.12, 0.02, 0.01, 0.02, 0.1, -0.015, 0.01, -0.015, 0.09;
    damping << 1.0, 0.3, 0, 0.3, 2.0, -0.2, 0, -0.2, 0.7;
    stiffness << 200, 20, 0, 20, 300, -10, 0, -10, 150;
    friction = friction_scale * vector({0.3, 0.2, 0.25});
  }

  [[nodiscard]] JointMotion motion() const {
    JointMotion motion(damping, friction, Vector::Zero(3));
    motion.set_system({inertia, damping, stiffness});
    return motion;
  }
};

JointDrive shifted(const JointDrive& whole, double from, double length, const Matrix& stiffness, const Vector& moved) {
  JointDrive part = whole;
  part.length_s = length;
  const auto& f = whole.hand_pull;
  part.hand_pull[0] = f[0] + from * (f[1] + from * (f[2] + from * f[3])) - stiffness * moved;
  part.hand_pull[1] = f[1] + from * (2 * f[2] + 3 * from * f[3]);
  part.hand_pull[2] = f[2] + 3 * from * f[3];
  return part;
}

class JointMotionCutting : public testing::TestWithParam<double> {};

TEST_P(JointMotionCutting, DoesNotDependOnTheLengthsOfThePieces) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Coupled arm(GetParam());
  JointMotion whole = arm.motion();
  JointMotion cut = arm.motion();
  for (int tick = 0; tick < 300; ++tick) {
    const auto any = [&](double size) -> Vector {
      return size * vector({uniform(random), uniform(random), uniform(random)});
    };
    JointDrive piece = drive(1e-3, any(1.0));
    piece.hand_pull = {Vector(any(0.5) - arm.stiffness * whole.position()), any(3e2), any(1e5), any(1e7)};
    const Vector start = cut.position();
    std::array<double, 8> edges{0, 0, 0, 0, 0, 0, 0, 1e-3};
    for (std::size_t i = 1; i < 7; ++i) edges[i] = 0.5e-3 * (1 + uniform(random));
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      cut.advance(shifted(piece, edges[i], edges[i + 1] - edges[i], arm.stiffness, cut.position() - start));
    }
    whole.advance(piece);
    ASSERT_LT((whole.position() - cut.position()).norm(), 1e-12 * (0.01 + whole.position().norm())) << "tick " << tick;
    ASSERT_LT((whole.velocity() - cut.velocity()).norm(), 1e-12 * (1 + whole.velocity().norm())) << "tick " << tick;
    ASSERT_NEAR(whole.audit().energy_J, cut.audit().energy_J, 1e-12) << "tick " << tick;
    ASSERT_NEAR(whole.audit().minimum_J, cut.audit().minimum_J, 1e-12) << "tick " << tick;
  }
  EXPECT_EQ(whole.frozen_joints() + cut.frozen_joints(), 0U);
}

INSTANTIATE_TEST_SUITE_P(WithoutAndWithFriction, JointMotionCutting, testing::Values(0.0, 1.0));

TEST(JointMotion, AgreesWithTheMatrixExponential) {
  // State (q, q', F, F', F''/2, F'''/6 ...) of the linear system, its exponential by Pade approximation.
  const Coupled arm;
  constexpr double kLength = 5e-3;  // several steps of the series
  JointDrive piece = drive(kLength, vector({0.4, -0.7, 1.1}));
  piece.hand_pull = {vector({0.1, 0.2, -0.3}), vector({40, -10, 5}), vector({-3e3, 2e3, 1e3}),
                     vector({1e5, -2e5, 3e5})};
  JointMotion motion = arm.motion();
  motion.advance(drive(1e-2, vector({1.0, 0.5, -0.5})));
  Eigen::VectorXd state = Eigen::VectorXd::Zero(18);
  state.segment(3, 3) = motion.velocity();
  state.segment(6, 3) = piece.hand_pull[0] + piece.torque;
  state.segment(9, 3) = piece.hand_pull[1];
  state.segment(12, 3) = 2 * piece.hand_pull[2];
  state.segment(15, 3) = 6 * piece.hand_pull[3];
  const Eigen::Matrix3d inverse = Eigen::Matrix3d(arm.inertia).inverse();
  Eigen::MatrixXd rate = Eigen::MatrixXd::Zero(18, 18);
  rate.block(0, 3, 3, 3).setIdentity();
  rate.block(3, 0, 3, 3) = -inverse * arm.stiffness;
  rate.block(3, 3, 3, 3) = -inverse * arm.damping;
  rate.block(3, 6, 3, 3) = inverse;
  for (int order = 6; order < 15; order += 3) rate.block(order, order + 3, 3, 3).setIdentity();
  const Eigen::VectorXd expected = (rate * kLength).exp() * state;

  const Vector before = motion.position();
  motion.advance(piece);
  EXPECT_LT((motion.position() - before - Vector(expected.head(3))).norm(), 1e-13 * expected.head(3).norm());
  EXPECT_LT((motion.velocity() - Vector(expected.segment(3, 3))).norm(), 1e-13 * expected.segment(3, 3).norm());
}

class AuditBetweenTicks : public testing::TestWithParam<double> {};

TEST_P(AuditBetweenTicks, MinimumIsTheOneBruteForceFinds) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Coupled arm(GetParam());
  JointMotion whole = arm.motion();
  JointMotion fine = arm.motion();
  double brute = 0;
  for (int tick = 0; tick < 40; ++tick) {
    JointDrive piece = drive(8e-3, 4 * vector({uniform(random), uniform(random), uniform(random)}));
    piece.hand_pull[0] = -arm.stiffness * whole.position();
    constexpr int kParts = 2000;
    const Vector start = fine.position();
    for (int part = 0; part < kParts; ++part) {
      const double length = piece.length_s / kParts;
      fine.advance(shifted(piece, part * length, length, arm.stiffness, fine.position() - start));
      brute = std::min(brute, fine.audit().energy_J);
    }
    whole.advance(piece);
    ASSERT_LE(whole.audit().minimum_J, brute + 1e-12) << "tick " << tick;
    ASSERT_NEAR(whole.audit().minimum_J, brute, 1e-6) << "tick " << tick;
  }
  EXPECT_LT(brute, -1e-3);
}

INSTANTIATE_TEST_SUITE_P(WithoutAndWithFriction, AuditBetweenTicks, testing::Values(0.0, 1.0));

TEST(JointMotion, AuditIsMinusTheKineticEnergyAMotorGave) {
  const Oscillator o{.mass = 0.1, .damping = 30};
  JointMotion motion = o.motion();
  motion.advance(drive(0.1, vector({1.0})));  // to the steady 1/30 m/s
  EXPECT_NEAR(motion.audit().energy_J, -0.5 * 0.1 / 900, 1e-16);
  const double minimum = motion.audit().minimum_J;
  for (int tick = 0; tick < 100; ++tick) motion.advance(drive(1e-3, vector({0.0})));
  EXPECT_EQ(motion.audit().minimum_J, minimum);
  EXPECT_NEAR(motion.audit().energy_J, 0, 1e-16);
}

TEST(JointMotion, AuditFindsTheClosedFormMinimumInsideATick) {
  // The hand brings the mass to v0 = 0.1 m/s and then stops it with a = 200 m/s^2 against the motor's f = 1 N:
  // P = -f (v0 t - a t^2 / 2), least at v0 / a = 0.5 ms.
  const Oscillator o{.mass = 0.1};
  JointMotion motion = o.motion();
  JointDrive push = drive(0.01, vector({0.0}));
  push.hand_pull[0] = vector({1.0});
  motion.advance(push);
  JointDrive stop = drive(1e-3, vector({1.0}));
  stop.hand_pull[0] = vector({-21.0});
  motion.advance(stop);
  EXPECT_NEAR(motion.audit().minimum_J, -1.0 * 0.1 * 0.1 / (2 * 200), 1e-18);
  EXPECT_NEAR(motion.audit().energy_J, 0, 1e-16);
}

TEST(JointMotion, StickSlipBeyondTheEventLimitFreezesTheJointIsCountedAndAddsNoEnergy) {
  // 600 000 rad/s: some 190 reversals in a piece of 1 ms.
  const Oscillator o{.mass = 1e-6, .stiffness = 3.6e5, .friction = 1e-3, .start = 1e-3};
  JointMotion motion = o.motion();
  const double before = kinetic_and_spring(motion, o);
  motion.advance(spring_drive(motion, o, 1e-3));
  EXPECT_EQ(motion.frozen_joints(), 1U);
  EXPECT_EQ(motion.velocity()[0], 0);
  EXPECT_LE(kinetic_and_spring(motion, o) + motion.audit().energy_J, before * (1 + 1e-9));
  EXPECT_GT(motion.audit().energy_J, 0);
}

TEST(JointMotion, ManyJointsNeverGainEnergyFromFriction) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Coupled arm(1.0);
  JointMotion motion = arm.motion();
  double energy = 0;
  for (int tick = 0; tick < 20000; ++tick) {
    // Only friction and damping work, the motors rest: P may only rise.
    JointDrive piece = drive(1e-3, Vector::Zero(3));
    piece.hand_pull[0] =
        0.5 * vector({uniform(random), uniform(random), uniform(random)}) - arm.stiffness * motion.position();
    motion.advance(piece);
    ASSERT_GE(motion.audit().energy_J, energy) << "tick " << tick;
    energy = motion.audit().energy_J;
  }
  EXPECT_GT(energy, 1e-6);
  EXPECT_EQ(motion.audit().minimum_J, 0);
  EXPECT_EQ(motion.frozen_joints(), 0U);
}

TEST(JointMotion, AdvanceDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const Coupled arm(1.0);
  JointMotion motion = arm.motion();
  const JointDrive piece = drive(1e-3, vector({1.0, -0.3, 0.1}));
  const test::AllocationGuard guard;
  for (int tick = 0; tick < 100; ++tick) motion.advance(piece);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::device
