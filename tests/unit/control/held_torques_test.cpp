#include "forcebound/control/held_torques.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace forcebound::control {
namespace {

/// A band for a while.
struct Piece {
  double low = 0;
  double high = 0;
  double duration_s = 0;
};

void PrintTo(const Piece& piece, std::ostream* out) {
  *out << piece.low << " to " << piece.high << " for " << piece.duration_s;
}

MATCHER_P(Is, expected, "") {
  constexpr double kRounding = 1e-12;
  return std::abs(arg.low - expected.low) < kRounding && std::abs(arg.high - expected.high) < kRounding &&
         std::abs(arg.duration_s - expected.duration_s) < kRounding;
}

Vector one(double torque) { return Vector::Constant(1, torque); }
Bracket exactly(double value) { return {value, value}; }

/// All of it for a while, then none.
ReleaseStages after(double hold_s) { return {.full_s = exactly(hold_s), .part_s = exactly(hold_s)}; }

std::vector<Piece> pieces(const HeldTorques& held, double end_s, double begin_s = 0) {
  std::vector<Piece> result;
  held.each_piece(begin_s, end_s, [&](const Vector& mid, const Vector& spread, double piece_s) {
    result.push_back({mid[0] - spread[0], mid[0] + spread[0], piece_s});
  });
  return result;
}

#define EXPECT_PIECES(held, ...) EXPECT_THAT(held, testing::ElementsAre(__VA_ARGS__))

TEST(HeldTorques, BeginWithNone) { EXPECT_PIECES(pieces(HeldTorques(1), 1.0), Is(Piece{0, 0, 1})); }

TEST(HeldTorques, PutATorqueIntoEffectAfterItsLatency) {
  HeldTorques held(1);
  held.command(one(2), exactly(0.25), after(10));
  EXPECT_PIECES(pieces(held, 1), Is(Piece{0, 0, 0.25}), Is(Piece{2, 2, 0.75}));
  held.pass(exactly(1), 0);
  EXPECT_EQ(held.horizon_s(), 0);
  held.command(one(3), exactly(0.25), after(10));
  EXPECT_EQ(held.horizon_s(), 0.25);
  EXPECT_PIECES(pieces(held, 1), Is(Piece{2, 2, 0.25}), Is(Piece{3, 3, 0.75}));
}

TEST(HeldTorques, LetGoOfATorqueAfterItsHoldTime) {
  HeldTorques held(1);
  held.command(one(2), exactly(0.25), after(0.5));
  EXPECT_PIECES(pieces(held, 2), Is(Piece{0, 0, 0.25}), Is(Piece{2, 2, 0.5}), Is(Piece{0, 0, 1.25}));
  held.pass(exactly(0.5), 0);
  held.command(one(3), exactly(1), after(10));
  EXPECT_PIECES(pieces(held, 2), Is(Piece{2, 2, 0.25}), Is(Piece{0, 0, 0.75}), Is(Piece{3, 3, 1}));
}

TEST(HeldTorques, LetGoInStages) {
  HeldTorques held(1);
  held.command(one(2), exactly(0), {.full_s = exactly(0.5), .share = 0.25, .part_s = exactly(0.75)});
  EXPECT_PIECES(pieces(held, 2), Is(Piece{2, 2, 0.5}), Is(Piece{0.5, 0.5, 0.25}), Is(Piece{0, 0, 1.25}));
}

TEST(HeldTorques, HoldWhateverMayBeInEffectWhereTimesAreNotKnownExactly) {
  HeldTorques held(1);
  held.command(one(2), {0.2, 0.4}, {.full_s = {0.4, 0.5}, .part_s = {0.4, 0.5}});
  EXPECT_PIECES(pieces(held, 2), Is(Piece{0, 0, 0.2}), Is(Piece{0, 2, 0.2}), Is(Piece{2, 2, 0.2}), Is(Piece{0, 2, 0.3}),
                Is(Piece{0, 0, 1.1}));
  // A torque that is on its way makes three.
  held.command(one(-1), {0.3, 1}, after(10));
  EXPECT_PIECES(pieces(held, 0.7), Is(Piece{0, 0, 0.2}), Is(Piece{0, 2, 0.1}), Is(Piece{-1, 2, 0.1}),
                Is(Piece{-1, 2, 0.2}), Is(Piece{-1, 2, 0.1}));
}

TEST(HeldTorques, WidenWhatIsOnItsWayByTheClocksDrift) {
  HeldTorques held(1);
  held.command(one(2), exactly(1.5), after(10));
  held.pass({0.9, 1.1}, 0);
  EXPECT_PIECES(pieces(held, 1), Is(Piece{0, 0, 0.4}), Is(Piece{0, 2, 0.2}), Is(Piece{2, 2, 0.4}));
}

TEST(HeldTorques, KeepATorqueThatMayHaveBeenInEffectBeforeTheStamp) {
  HeldTorques held(1);
  held.command(one(2), exactly(0.5), after(10));
  held.pass(exactly(0.6), -0.25);
  EXPECT_PIECES(pieces(held, 0.5, -0.25), Is(Piece{0, 0, 0.15}), Is(Piece{2, 2, 0.6}));
}

TEST(HeldTorques, HoldWhatACommandAndTheOneBeforeItMayHaveLeftWhereItsWriteFailed) {
  HeldTorques held(1);
  held.command(one(2), exactly(0), after(10));
  held.command(one(-1), exactly(0.5), after(10), false);
  EXPECT_PIECES(pieces(held, 1), Is(Piece{2, 2, 0.5}), Is(Piece{-1, 2, 0.5}));
}

TEST(HeldTorques, KeepSeveralOnTheirWay) {
  HeldTorques held(1);
  held.command(one(1), exactly(2), after(100));
  held.pass(exactly(1), 0);
  held.command(one(2), exactly(2), after(100));
  held.pass(exactly(0.5), 0);
  held.command(one(3), exactly(1), after(100));
  EXPECT_EQ(held.horizon_s(), 1.5) << "never before an earlier one";
  EXPECT_PIECES(pieces(held, 3), Is(Piece{0, 0, 0.5}), Is(Piece{1, 1, 1}), Is(Piece{3, 3, 1.5}));
}

TEST(HeldTorques, MakeOneBandOfTheNewestWhereThereIsNoRoom) {
  HeldTorques held(1);
  for (int i = 0; i < HeldTorques::kWaitingMax + 2; ++i) held.command(one(i), exactly(1 + i), after(100));
  const auto all = pieces(held, 100);
  ASSERT_EQ(all.size(), 2U + HeldTorques::kWaitingMax);
  EXPECT_THAT(all[all.size() - 2], Is(Piece{14, 17, 2})) << "before the last can be in effect, the one before may be";
  EXPECT_THAT(all.back(), Is(Piece{15, 17, 100 - 18.0}));
}

TEST(HeldTorques, KeepTheEarliestReleaseOfWhatBecomesOneBand) {
  HeldTorques held(1);
  for (int i = 0; i < HeldTorques::kWaitingMax; ++i) held.command(one(i), exactly(1 + i), after(100));
  held.command(one(16), exactly(17), after(0.5));
  EXPECT_PIECES(pieces(held, 18, 17), Is(Piece{15, 16, 0.5}), Is(Piece{0, 16, 0.5}));
}

TEST(HeldTorques, FollowACommandWithALagThatMayBeShorter) {
  HeldTorques held(1, 0.1);
  held.command(one(1), exactly(0), after(10));
  const auto rising = pieces(held, 1);
  double time_s = 0;
  for (const Piece& piece : rising) {
    EXPECT_NEAR(piece.low, 1 - std::exp(-time_s / 0.1), 1e-12) << "as slow as the lag when the piece begins";
    EXPECT_EQ(piece.high, 1);
    time_s += piece.duration_s;
  }
  EXPECT_DOUBLE_EQ(time_s, 1);
  held.pass(exactly(0.2), 0);
  EXPECT_NEAR(pieces(held, 0.01).front().low, 1 - std::exp(-2.0), 1e-12);
  EXPECT_EQ(held.left_by_lag()[0], 1);
}

TEST(HeldTorques, LagBehindWhatMayHaveBeenInEffectWhereTheTimePassedIsNotKnownExactly) {
  HeldTorques held(1, 0.1);
  held.command(one(1), exactly(1.05), after(10));
  held.pass({1, 1.1}, 0);
  EXPECT_EQ(held.left_by_lag()[0], 1) << "it may have been in effect for 0.05 s";
}

}  // namespace
}  // namespace forcebound::control
