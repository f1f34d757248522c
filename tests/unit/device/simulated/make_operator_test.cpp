#include "forcebound/device/simulated/make_operator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace forcebound::device {
namespace {

using testing::HasSubstr;

std::string refusal_of_hand(const std::string& specification, int dof = 3) {
  try {
    (void)make_operator(specification, dof);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

TEST(MakeOperator, PressGoesFromFreeSpaceToItsDepthAndStays) {
  const auto press = make_operator("press:from_m=-0.01,to_m=0.02,wait_s=0.1,approach_s=0.5", 1);
  EXPECT_EQ(press->target(0).position[0], -0.01);
  EXPECT_EQ(press->target(0.1).position[0], -0.01);
  EXPECT_NEAR(press->target(0.35).position[0], 0.005, 1e-15);
  EXPECT_NEAR(press->target(0.6).position[0], 0.02, 1e-15);
  EXPECT_NEAR(press->target(100).position[0], 0.02, 1e-15);
  EXPECT_EQ(press->target(100).velocity[0], 0);
}

TEST(MakeOperator, PressMovesAlongTheAxisAskedForOnly) {
  const Operator::Target target = make_operator("press:axis=2", 3)->target(100);
  EXPECT_EQ(target.position[0], 0);
  EXPECT_EQ(target.position[1], 0);
  EXPECT_NEAR(target.position[2], 0.02, 1e-15);
}

TEST(MakeOperator, TraceCircleRunsFromTheMiddleIntoTheWallAround) {
  const auto trace = make_operator("trace-circle", 2);
  EXPECT_EQ(trace->target(0).position.norm(), 0);
  for (const double t : {1.1, 3.3, 17.0}) EXPECT_NEAR(trace->target(t).position.norm(), 0.052, 1e-15);
  EXPECT_NEAR(trace->target(10).velocity.norm(), 0.052 * 2 * M_PI / 8, 1e-14);
}

TEST(MakeOperator, TraceSphereComesFromOutsideAndPressesIn) {
  const auto trace = make_operator("trace-sphere", 3);
  EXPECT_NEAR(trace->target(0).position.norm(), 0.04, 1e-15);
  EXPECT_NEAR(trace->target(5).position.norm(), 0.0075, 1e-15);
  EXPECT_LT((trace->target(5).position - trace->target(11).position).norm(), 1e-15);  // one turn in 6 s
}

TEST(MakeOperator, StrokeComesFromAboveAndGoesToAndFroInItsDepth) {
  const auto stroke = make_operator("stroke:offset_z_m=0.1,height_m=0.02,depth_m=0.005,length_m=0.04,turn_s=2", 3);
  EXPECT_NEAR((stroke->target(0).position - Eigen::Vector3d(0, 0, 0.12)).norm(), 0, 1e-15);
  double least_m = 0;
  double most_m = 0;
  for (double t = 2; t < 4; t += 0.01) {
    const Vector position = stroke->target(t).position;
    EXPECT_NEAR(position[2], 0.095, 1e-15);
    least_m = std::min(least_m, position[0]);
    most_m = std::max(most_m, position[0]);
  }
  EXPECT_NEAR(most_m, 0.02, 1e-4);
  EXPECT_NEAR(least_m, -0.02, 1e-4);
}

TEST(MakeOperator, EveryTargetBeginsAtRestAndItsVelocityIsTheDerivative) {
  for (const char* specification :
       {"press", "stroke", "trace-circle", "trace-sphere", "carry", "wave:offset_y_m=0.01"}) {
    SCOPED_TRACE(specification);
    const auto hand = make_operator(specification, 3);
    EXPECT_EQ(hand->target(0).velocity.norm(), 0);
    for (double t = 0.0123; t < 6; t += 0.0717) {
      constexpr double kStep = 1e-5;
      const Vector numeric = (hand->target(t + kStep).position - hand->target(t - kStep).position) / (2 * kStep);
      ASSERT_LT((numeric - hand->target(t).velocity).norm(), 1e-7) << "at " << t << " s";
    }
  }
}

TEST(MakeOperator, HandIsAsTheSpecificationSays) {
  const auto press = make_operator("press:mass_kg=0.2,stiffness_N_per_m=700,damping_N_s_per_m=4", 1);
  EXPECT_EQ(press->hand().mass_kg, 0.2);
  EXPECT_EQ(press->hand().stiffness_N_per_m, 700);
  EXPECT_EQ(press->hand().damping_N_s_per_m, 4);
}

TEST(MakeOperator, DescriptionIsASpecificationThatMakesTheSameOperatorAgain) {
  const auto press = make_operator("press:to_m=0.015", 2);
  EXPECT_THAT(press->description(), HasSubstr("stiffness_N_per_m="));
  EXPECT_THAT(press->description(), HasSubstr("to_m=0.015"));
  EXPECT_EQ(make_operator(press->description(), 2)->description(), press->description());
}

TEST(MakeOperator, WorksForOneToSixDegreesOfFreedom) {
  for (int dof = 1; dof <= 6; ++dof) {
    EXPECT_EQ(make_operator("press", dof)->target(1).position.size(), dof);
    EXPECT_EQ(make_operator("wave", dof)->target(1).position.size(), dof);
  }
}

TEST(MakeOperator, RefusalsNameTheErrorAndTheAcceptedValues) {
  EXPECT_THAT(refusal_of_hand("pres"),
              HasSubstr("unknown operator 'pres', did you mean 'press'? (known: press, stroke, "
                        "trace-circle, trace-sphere, carry, wave, pointer, replay:FILE.csv)"));
  EXPECT_THAT(refusal_of_hand("press:dept_m=1"), HasSubstr("operator 'press': unknown key 'dept_m' (known: "));
  EXPECT_THAT(refusal_of_hand("press:stifness_N_per_m=1"), HasSubstr("did you mean 'stiffness_N_per_m'?"));
  EXPECT_EQ(refusal_of_hand("press:to_m"), "operator 'press': expected key=value, got 'to_m'");
  EXPECT_EQ(refusal_of_hand("press:to_m=deep"), "operator 'press': to_m must be a finite number, got 'deep'");
  EXPECT_EQ(refusal_of_hand("press:to_m=nan"), "operator 'press': to_m must be a finite number, got 'nan'");
  EXPECT_EQ(refusal_of_hand("press:to_m=1,to_m=2"), "operator 'press': to_m is given twice");
  EXPECT_EQ(refusal_of_hand("press:mass_kg=-1"), "operator 'press': mass_kg must be >= 0, got -1");
  EXPECT_EQ(refusal_of_hand("press:approach_s=0"), "operator 'press': approach_s must be > 0, got 0");
  EXPECT_EQ(refusal_of_hand("press:axis=3"), "operator 'press': axis must be a whole number from 0 to 2, got 3");
  EXPECT_EQ(refusal_of_hand("stroke", 2), "operator 'stroke': needs 3 degrees of freedom, has 2");
  EXPECT_EQ(refusal_of_hand("trace-circle", 1), "operator 'trace-circle': needs 2 degrees of freedom, has 1");
  EXPECT_EQ(refusal_of_hand("carry", 2), "operator 'carry': needs 3 degrees of freedom, has 2");
  EXPECT_EQ(refusal_of_hand("press:button=32"), "operator 'press': button must be a whole number from 0 to 31, got 32");
  EXPECT_THAT(refusal_of_hand("press:buton=1"), HasSubstr("did you mean 'button'?"));
  EXPECT_EQ(refusal_of_hand("replay:"), "operator 'replay': expected replay:FILE.csv[,KEY=VALUE...]");
  EXPECT_EQ(refusal_of_hand("replay:no/such.csv,scale=1"), "no/such.csv: cannot be read: No such file or directory");
}

TEST(MakeOperator, AHandPressesAButtonForTheTimeAskedFor) {
  const auto press = make_operator("press:button=3,button_from_s=0.5,button_until_s=2", 1);
  for (const double t : {0.0, 0.499, 2.0, 100.0}) EXPECT_EQ(press->handle(t), control::Handle{.buttons = 0}) << t;
  for (const double t : {0.5, 1.999}) EXPECT_EQ(press->handle(t), control::Handle{.buttons = 8}) << t;
  EXPECT_TRUE(make_operator("press:button_from_s=1", 1)->handle(1e6).pressed(0));  // to the end
  EXPECT_THAT(press->description(), HasSubstr("button=3,button_from_s=0.5,button_until_s=2"));
}

TEST(MakeOperator, AHandThatPressesNoButtonHasNone) {
  const auto press = make_operator("press", 1);
  EXPECT_EQ(press->handle(1), control::Handle{});
  EXPECT_THAT(press->description(), testing::Not(HasSubstr("button")));
}

TEST(MakeOperator, CarryPressesItsButtonDownThereAndLetsItGoWhereItPutsDown) {
  const auto carry = make_operator("carry:offset_z_m=0.02,height_m=0.01,depth_m=0.002,lift_m=0.03,length_m=0.05", 3);
  const auto at = [&](double t) { return Eigen::Vector3d(carry->target(t).position); };
  EXPECT_LT((at(0) - Eigen::Vector3d(0, 0, 0.03)).norm(), 1e-15);
  for (const double t : {1.0, 1.249}) EXPECT_FALSE(carry->handle(t).pressed(0)) << t;
  for (const double t : {1.25, 3.0, 5.749}) EXPECT_TRUE(carry->handle(t).pressed(0)) << t;
  EXPECT_LT((at(2.5) - Eigen::Vector3d(0, 0, 0.05)).norm(), 1e-15);
  EXPECT_LT((at(4.5) - Eigen::Vector3d(0.05, 0, 0.05)).norm(), 1e-15);
  for (const double t : {5.5, 6.0}) EXPECT_LT((at(t) - Eigen::Vector3d(0.05, 0, 0.018)).norm(), 1e-15) << t;
  EXPECT_EQ(carry->handle(5.751), control::Handle{.buttons = 0});
  EXPECT_LT((at(7) - Eigen::Vector3d(0.05, 0, 0.03)).norm(), 1e-15);
}

TEST(MakeOperator, HelpNamesEveryOperatorWithItsKeys) {
  const std::string help = operators_help();
  for (const char* word :
       {"press:", "trace-circle:", "trace-sphere:", "wave:", "replay:FILE.csv,", "scale=", "turn_s="}) {
    EXPECT_THAT(help, HasSubstr(word));
  }
}

}  // namespace
}  // namespace forcebound::device
