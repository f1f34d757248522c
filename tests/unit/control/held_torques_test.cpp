#include "forcebound/control/held_torques.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace forcebound::control {
namespace {

using Pieces = std::vector<std::pair<double, double>>;  // torque, duration

Vector one(double torque) { return Vector::Constant(1, torque); }

Pieces pieces(const HeldTorques& held, double duration_s) {
  Pieces result;
  held.each_piece(duration_s, [&](const Vector& torque, double piece_s) { result.emplace_back(torque[0], piece_s); });
  return result;
}

TEST(HeldTorques, BeginWithNone) { EXPECT_EQ(pieces(HeldTorques(1), 1.0), (Pieces{{0, 1}})); }

TEST(HeldTorques, PutATorqueIntoEffectAfterItsLatency) {
  HeldTorques held(1);
  held.command(one(2), 0.25, 10);
  EXPECT_EQ(pieces(held, 1), (Pieces{{0, 0.25}, {2, 0.75}}));
  held.pass(1);
  EXPECT_EQ(held.horizon_s(), 0);
  held.command(one(3), 0.25, 10);
  EXPECT_EQ(held.horizon_s(), 0.25);
  EXPECT_EQ(pieces(held, 1), (Pieces{{2, 0.25}, {3, 0.75}}));
}

TEST(HeldTorques, LetGoOfATorqueAfterItsLimit) {
  HeldTorques held(1);
  held.command(one(2), 0.25, 0.5);
  EXPECT_EQ(pieces(held, 2), (Pieces{{0, 0.25}, {2, 0.5}, {0, 1.25}}));
  held.pass(0.5);
  held.command(one(3), 1.0, 10);
  EXPECT_EQ(pieces(held, 2), (Pieces{{2, 0.25}, {0, 0.75}, {3, 1}})) << "between reading and command as well";
}

TEST(HeldTorques, KeepSeveralOnTheirWay) {
  HeldTorques held(1);
  held.command(one(1), 2, 100);
  held.pass(1);
  held.command(one(2), 2, 100);
  held.pass(0.5);
  held.command(one(3), 1, 100);
  EXPECT_EQ(held.horizon_s(), 1.5) << "never before an earlier one";
  EXPECT_EQ(pieces(held, 3), (Pieces{{0, 0.5}, {1, 1}, {3, 1.5}}));
}

TEST(HeldTorques, GiveTheNewestPlaceAwayWhereThereIsNoRoom) {
  HeldTorques held(1);
  for (int i = 0; i <= HeldTorques::kWaitingMax; ++i) held.command(one(i), 1 + i, 100);
  const auto all = pieces(held, 100);
  ASSERT_EQ(all.size(), 1U + HeldTorques::kWaitingMax);
  EXPECT_EQ(all.back().first, HeldTorques::kWaitingMax);
}

}  // namespace
}  // namespace forcebound::control
