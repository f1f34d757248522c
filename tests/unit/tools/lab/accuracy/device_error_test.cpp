#include "tests/tools/lab/accuracy/device_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/vector_of.hpp"

namespace forcebound::lab {
namespace {

using std::chrono::milliseconds;
using test::vector_of;

constexpr double kTurn_rad_per_s = 20;

Vector true_force(double time_s) {
  return vector_of({std::sin(kTurn_rad_per_s * time_s), std::cos(kTurn_rad_per_s * time_s)});
}

/// A device that gets the true force of `age` ms ago on every tick, and every `every` ms only.
std::vector<DeviceTick> delayed(int age, int every, double model = 1, double let_through = 1) {
  std::vector<DeviceTick> ticks;
  for (int i = 0; i < 2000; ++i) {
    DeviceTick tick{.time = milliseconds(i), .reference = true_force(1e-3 * i)};
    const int motion = i - age - (i - age) % every;
    tick.answered = true;
    tick.motion_time = milliseconds(motion);
    tick.arrived = model * true_force(1e-3 * motion);
    tick.request = tick.arrived;
    tick.applied = let_through * tick.request;
    ticks.push_back(tick);
  }
  return ticks;
}

double sum(const DeviceError& error) {
  return error.model.share + error.extrapolation.share + error.age.share + error.hold.share + error.bounding.share;
}

TEST(DeviceError, OfTheTrueForceInTimeIsNothing) {
  const DeviceError error = device_error(delayed(0, 1));
  EXPECT_NEAR(error.total, 0, 1e-12);
  EXPECT_EQ(sum(error), 0);
}

// The chord of the angle that the force turns by meanwhile: 2 sin(w t/2).
TEST(DeviceError, OfAnAgeIsWhatTheForceTurnsMeanwhile) {
  const DeviceError error = device_error(delayed(10, 1));
  EXPECT_NEAR(error.age.alone, 2 * std::sin(0.5 * kTurn_rad_per_s * 0.010), 5e-3);
  EXPECT_NEAR(error.age.share, error.total, 5e-3);
  // Before the first tick the reference is taken to have been as on it: ten ticks of two thousand.
  EXPECT_LT(error.model.alone, 0.01);
  EXPECT_EQ(error.least_age, milliseconds(10));
}

TEST(DeviceError, OfAModelThatIsTooSoftIsTheModels) {
  const DeviceError error = device_error(delayed(0, 1, 0.9));
  EXPECT_NEAR(error.total, 0.1, 1e-12);
  EXPECT_NEAR(error.model.share, 0.1, 1e-12);
}

TEST(DeviceError, OfAForceThatComesRarelyIsTheHolds) {
  const DeviceError error = device_error(delayed(0, 8));
  EXPECT_NEAR(error.age.alone, 0, 1e-12);
  EXPECT_NEAR(error.hold.share, error.total, 1e-12);
  EXPECT_GT(error.hold.share, kTurn_rad_per_s * 0.0035 * 0.9);
}

TEST(DeviceError, OfWhatTheLawTakesIsTheBoundings) {
  const DeviceError error = device_error(delayed(0, 1, 1, 0.7));
  EXPECT_NEAR(error.total, 0.3, 1e-12);
  EXPECT_NEAR(error.bounding.share, 0.3, 1e-12);
}

TEST(DeviceError, SharesAddUpToTheWholeThoughPartsMakeUpForEachOther) {
  const DeviceError error = device_error(delayed(12, 5, 1.2, 0.8));
  EXPECT_NEAR(sum(error), error.total, 1e-12);
  // A model too stiff by a fifth, bounded to four fifths: together 0.96.
  EXPECT_LT(error.model.share, 0.5 * error.model.alone);
  EXPECT_GT(error.bounding.alone, error.bounding.share);
}

/// As `delayed`, but rendered at the client: of a model of its own, by what it extrapolates of it.
std::vector<DeviceTick> rendered(double model, double extrapolation, double let_through = 1) {
  std::vector<DeviceTick> ticks = delayed(10, 1);
  for (DeviceTick& tick : ticks) {
    tick.rendering = record::ForceOrigin::at_client;
    tick.own = model * tick.reference;
    tick.request = extrapolation * tick.own;
    tick.applied = let_through * tick.request;
  }
  return ticks;
}

TEST(DeviceError, OfWhatIsRenderedAtTheClientHasNoAge) {
  const DeviceError error = device_error(rendered(0.9, 1));
  EXPECT_NEAR(error.total, 0.1, 1e-12);
  EXPECT_NEAR(error.model.share, 0.1, 1e-12);
  EXPECT_EQ(error.age.alone, 0);
  EXPECT_EQ(error.hold.alone, 0);
  EXPECT_NEAR(error.extrapolation.alone, 0, 1e-12);
}

TEST(DeviceError, OfALocalModelThatIsOffIsTheExtrapolations) {
  const DeviceError error = device_error(rendered(1, 0.8));
  EXPECT_NEAR(error.total, 0.2, 1e-12);
  EXPECT_NEAR(error.extrapolation.share, 0.2, 1e-12);
  EXPECT_EQ(error.model.alone, 0);
}

TEST(DeviceError, OfAModelThatIsNotKnownIsMeasuredAgainstTheReference) {
  std::vector<DeviceTick> ticks = rendered(1, 0.8);
  for (DeviceTick& tick : ticks) tick.own = Vector();
  EXPECT_NEAR(device_error(ticks).extrapolation.share, 0.2, 1e-12);
}

TEST(DeviceError, OfForcesThatAreHeldBesideIsTheHolds) {
  std::vector<DeviceTick> ticks = rendered(1, 0.8);
  for (DeviceTick& tick : ticks) tick.rendering = record::ForceOrigin::both;
  const DeviceError error = device_error(ticks);
  EXPECT_NEAR(error.hold.share, 0.2, 1e-12);
  EXPECT_EQ(error.extrapolation.alone, 0);
}

TEST(DeviceError, SharesAddUpWhereRenderingsTakeTurns) {
  std::vector<DeviceTick> ticks = delayed(12, 5, 1.2, 0.8);
  const std::vector<DeviceTick> at_client = rendered(1.1, 0.7, 0.9);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if (i % 7 < 4) ticks[i] = at_client[i];
    if (i % 7 == 3) ticks[i].rendering = record::ForceOrigin::both;
  }
  const DeviceError error = device_error(ticks);
  EXPECT_NEAR(sum(error), error.total, 1e-9);
  for (const DeviceError::Part& part : {error.model, error.extrapolation, error.age, error.hold, error.bounding}) {
    EXPECT_GT(part.alone, 0.01);
  }
}

TEST(DeviceError, BeforeTheFirstAnswerAllIsHeldBack) {
  std::vector<DeviceTick> ticks = delayed(0, 1);
  for (DeviceTick& tick : ticks) {
    tick.answered = false;
    tick.applied = tick.request = Vector::Zero(2);
  }
  const DeviceError error = device_error(ticks);
  EXPECT_NEAR(error.total, 1, 1e-12);
  EXPECT_NEAR(error.hold.share, 1, 1e-12);
}

TEST(DeviceError, WithoutAnyForceThereIsNone) {
  std::vector<DeviceTick> ticks = delayed(0, 1);
  for (DeviceTick& tick : ticks) tick.reference = tick.arrived = tick.request = tick.applied = Vector::Zero(2);
  EXPECT_EQ(device_error(ticks).total, 0);
  EXPECT_EQ(device_error({}).total, 0);
}

}  // namespace
}  // namespace forcebound::lab
