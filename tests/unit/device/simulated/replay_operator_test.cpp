#include "forcebound/device/simulated/replay_operator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/text/numbers.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::device {
namespace {

using testing::HasSubstr;

std::string replay_refusal(const std::string& text, int dof) {
  try {
    (void)parse_motion(text, "hand.csv", dof);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "accepted";
}

ReplayOperator replay(const std::string& text, int dof, const std::string& settings = "") {
  return {OperatorSettings("replay:hand.csv", settings), dof, parse_motion(text, "hand.csv", dof)};
}

constexpr const char* kHand =
    "time_s,x_m,y_m,z_m,fx_N\n1.0,0.00,0,0.5,9\n1.1,0.01,0,0.5,x\r\n1.2,0.03,-0.01,0.5,\n1.4,0.02,0,0.5,1\n\n";

TEST(ParseMotion, TakesTheFirstColumnsOfTheDevicesDegreesOfFreedomAndCountsTimeFromTheFirstRow) {
  const auto motion = parse_motion(kHand, "hand.csv", 2);
  ASSERT_EQ(motion.size(), 4U);
  EXPECT_EQ(motion[0].time_s, 0);
  EXPECT_NEAR(motion[3].time_s, 0.4, 1e-15);
  EXPECT_EQ(motion[2].position.size(), 2);
  EXPECT_EQ(motion[2].position[1], -0.01);
}

TEST(ParseMotion, RefusalNamesFileAndLine) {
  EXPECT_THAT(replay_refusal("", 1),
              HasSubstr("hand.csv:1: the header must begin with 'time_s,x_m' for 1 degree of freedom, got"));
  EXPECT_THAT(replay_refusal("time_s,x_m\n0,0\n1,1\n", 2), HasSubstr("must begin with 'time_s,x_m,y_m' for 2"));
  EXPECT_THAT(replay_refusal("t,x\n0,0\n", 1), HasSubstr("got 't,x'"));
  EXPECT_EQ(replay_refusal("time_s,x_m\n0,0\n1,two\n", 1), "hand.csv:3: expected 2 finite numbers, got '1,two'");
  EXPECT_EQ(replay_refusal("time_s,x_m\n0,0\n1\n", 1), "hand.csv:3: expected 2 finite numbers, got '1'");
  EXPECT_EQ(replay_refusal("time_s,x_m\n0,inf\n", 1), "hand.csv:2: expected 2 finite numbers, got '0,inf'");
  EXPECT_EQ(replay_refusal("time_s,x_m\n0,0\n1,1\n1,2\n", 1),
            "hand.csv:4: time_s must increase from row to row, got '1,2'");
  EXPECT_EQ(replay_refusal("time_s,x_m\n0,0\n", 1), "hand.csv:2: needs at least two rows, got 1");
  EXPECT_THAT(replay_refusal(kHand, 6),
              HasSubstr("a recorded hand has at most 3 degrees of freedom, the device has 6"));
}

TEST(ReplayOperator, PassesThroughEveryRow) {
  const ReplayOperator hand = replay(kHand, 3);
  EXPECT_NEAR(hand.target(0).position[0], 0, 1e-16);
  EXPECT_NEAR(hand.target(0.1).position[0], 0.01, 1e-16);
  EXPECT_NEAR(hand.target(0.2).position[1], -0.01, 1e-16);
  EXPECT_NEAR(hand.target(0.4).position[0], 0.02, 1e-16);
}

TEST(ReplayOperator, VelocityIsTheDerivativeAndContinuous) {
  const ReplayOperator hand = replay(kHand, 2);
  constexpr double kStep = 1e-7;
  for (double t = 0.003; t < 1.7; t += 0.0173) {
    const Vector numeric = (hand.target(t + kStep).position - hand.target(t - kStep).position) / (2 * kStep);
    ASSERT_LT((numeric - hand.target(t).velocity).norm(), 1e-6) << "at " << t << " s";
  }
  for (const double row : {0.1, 0.2, 0.4, 0.8}) {
    EXPECT_LT((hand.target(row + 1e-9).velocity - hand.target(row - 1e-9).velocity).norm(), 1e-6) << row;
  }
}

TEST(ReplayOperator, PlaysBackwardsAtTheEndAndForwardsAgainAtTheBeginning) {
  const ReplayOperator hand = replay(kHand, 1);
  for (const double t : {0.05, 0.17, 0.33}) {
    EXPECT_NEAR(hand.target(0.8 - t).position[0], hand.target(t).position[0], 1e-15);
    EXPECT_NEAR(hand.target(0.8 - t).velocity[0], -hand.target(t).velocity[0], 1e-13);
    EXPECT_NEAR(hand.target(0.8 * 1000 + t).position[0], hand.target(t).position[0], 1e-12);
  }
}

// A hand that goes 60 mm in 0.1 s at most, in units of which two are wrong.
TEST(ReplayOperator, InOtherUnitsThanSecondsAndMetresSaysWhich) {
  const auto doubt = [](double time_unit, double length_unit, const std::string& settings = "") {
    std::string rows = "time_s,x_m\n";
    for (int i = 0; i < 100; ++i) {
      rows += text::to_text(1e-3 * i * time_unit) + "," + text::to_text(0.05 * std::sin(0.01 * i) * length_unit) + "\n";
    }
    const ReplayOperator hand = replay(rows, 1, settings);
    EXPECT_EQ(hand.doubt().empty(), hand.description().find("; it ") == std::string::npos);
    return hand.doubt();
  };
  EXPECT_EQ(doubt(1, 1), "");
  EXPECT_EQ(doubt(1, 1000), "moves at up to 500 m/s: are its positions in mm?");
  EXPECT_EQ(doubt(1, 1000, "scale=0.001"), "");
  EXPECT_EQ(doubt(1e3, 1), "has rows 1 s apart, 1000 times the period of 0.001 s: are its times in ms?");
  EXPECT_EQ(doubt(1e3, 1e3), doubt(1e3, 1));
  EXPECT_THAT(doubt(1e6, 1), HasSubstr("are its times in us?"));
  EXPECT_THAT(doubt(1e9, 1), HasSubstr("are its times in ns?"));
  EXPECT_EQ(doubt(100, 1), "");  // ten rows a second
  EXPECT_THAT(doubt(1e-3, 1), HasSubstr("is the period in ms?"));
}

TEST(ReplayOperator, MayRestForLongWithoutAQuestionOfItsUnits) {
  EXPECT_EQ(replay(kHand + std::string("600,0.02,0,0.5\n"), 3).doubt(), "");
}

TEST(ReplayOperator, BeginsAtRestAndScalesBeforeItMoves) {
  const ReplayOperator hand = replay(kHand, 2, "scale=0.5,offset_x_m=0.1,offset_y_m=-0.2");
  EXPECT_EQ(hand.target(0).velocity.norm(), 0);
  EXPECT_NEAR(hand.target(0.2).position[0], 0.1 + 0.015, 1e-15);
  EXPECT_NEAR(hand.target(0.2).position[1], -0.2 - 0.005, 1e-15);
}

TEST(ReplayOperator, RecordedHandMovesTheDeviceAlongAndThroughTheSphere) {
  const auto file = recorded_data("motion/hand-guided-a.csv");
  if (!file) GTEST_SKIP() << "no recorded motion; set FORCEBOUND_DATA";
  SimulatedDevice device(load_device("omni"), make_operator("replay:" + file->string() + ",offset_x_m=0.01", 3));
  double nearest = 1;
  double lag = 0;
  for (int tick = 0; tick < 9000; ++tick) {
    (void)device.read(std::chrono::milliseconds(tick));
    const Vector tip = device.truth().position;
    nearest = std::min(nearest, tip.norm());
    lag = std::max(lag, (tip - device.hand().target(tick * 1e-3).position).norm());
  }
  EXPECT_LT(nearest, 0.02);
  EXPECT_LT(lag, 0.02);
}

}  // namespace
}  // namespace forcebound::device
