#include "forcebound/server/follower/received_energy.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace forcebound::server {
namespace {

TEST(ReceivedEnergy, CountsFromTheFirstSumThatIsHeard) {
  ReceivedEnergy energy({.power_scale = 2});
  EXPECT_EQ(energy.receive(5), 0) << "what was given before belongs to somebody else";
  EXPECT_EQ(energy.receive(5.5), 1);
  EXPECT_EQ(energy.receive(5.5), 0) << "doubled";
  EXPECT_EQ(energy.receive(6), 1) << "what was lost between is in the sum";
  EXPECT_EQ(energy.received_J(), 2);
}

TEST(ReceivedEnergy, ASumThatWasOvertakenCountsNothingTwice) {
  ReceivedEnergy energy({});
  (void)energy.receive(5);
  EXPECT_EQ(energy.receive(6), 1);
  EXPECT_EQ(energy.receive(5.5), 0) << "older than what was heard";
  EXPECT_EQ(energy.receive(6), 0);
  energy.begin();
  EXPECT_EQ(energy.receive(1), 0) << "another leader";
  EXPECT_EQ(energy.receive(2), 1);
  EXPECT_EQ(energy.received_J(), 2);
}

TEST(ReceivedEnergy, NoNumberMakesMoreThanTheRobotKeeps) {
  ReceivedEnergy energy({.power_scale = 3, .most_J = 2});
  (void)energy.receive(-std::numeric_limits<double>::max());
  EXPECT_EQ(energy.receive(std::numeric_limits<double>::max()), 2);
  EXPECT_EQ(energy.received_J(), 2);
}

TEST(ReceivedEnergy, ThePortIsLeastWhereTheRobotIs) {
  ReceivedEnergy energy({});
  (void)energy.receive(0);
  energy.update({.energy_J = 0.5, .minimum_J = 0});
  EXPECT_EQ(energy.port().minimum_J, 0);
  (void)energy.receive(2);
  energy.update({.energy_J = -1, .minimum_J = -1.5});
  EXPECT_EQ(energy.port().energy_J, 1);
  EXPECT_EQ(energy.port().minimum_J, 0) << "it spent less than it received";
  energy.update({.energy_J = -1, .minimum_J = -2.5});
  EXPECT_EQ(energy.port().minimum_J, -0.5) << "between two ticks it spent more";
}

TEST(ReceivedEnergy, ThePortHoldsWhatItBeganWith) {
  ReceivedEnergy energy({.initial_J = 0.25});
  EXPECT_EQ(energy.received_J(), 0) << "nobody gave it";
  EXPECT_EQ(energy.port().energy_J, 0.25);
  energy.update({.energy_J = -0.25, .minimum_J = -0.25});
  EXPECT_EQ(energy.port().minimum_J, 0) << "it spent all of it";
  energy.update({.energy_J = 0, .minimum_J = -0.375});
  EXPECT_EQ(energy.port().energy_J, 0.25);
  EXPECT_EQ(energy.port().minimum_J, -0.125) << "and more than that";
}

}  // namespace
}  // namespace forcebound::server
