#include "forcebound/server/bodies/body_medium.hpp"

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <filesystem>

#include "forcebound/server/bodies/body_world.hpp"
#include "tests/support/allocation_guard.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;

constexpr double kGravity = 9.80665;

BodyDescription floor_plate() {
  return {.name = "floor", .size_m = {1, 1, 0.1}, .mass_kg = 0, .position_m = {0, 0, -0.05}};
}

BodyDescription cube(double mass_kg, const Point& position_m) {
  return {.name = "cube", .size_m = {0.04, 0.04, 0.04}, .mass_kg = mass_kg, .position_m = position_m};
}

/// A device that goes where the test says, a motion every millisecond.
class Hand {
 public:
  explicit Hand(MediumState& state) : state_(state), seat_(state.join()) {}

  MediumTouch to(const Point& position_m) {
    const Point velocity_m_per_s = moved_ ? Point((position_m - last_m_) / 1e-3) : Point(Point::Zero());
    moved_ = true;
    last_m_ = position_m;
    state_.move(seat_, position_m, velocity_m_per_s);
    state_.advance(1e-3);
    return state_.touch(seat_);
  }

  /// In steps of at most 0.1 mm.
  MediumTouch along(const Point& from_m, const Point& to_m) {
    const int steps = static_cast<int>(std::ceil((to_m - from_m).norm() / 1e-4));
    MediumTouch touch;
    for (int i = 1; i <= steps; ++i) touch = to(from_m + (to_m - from_m) * (static_cast<double>(i) / steps));
    return touch;
  }

  MediumTouch rest_at(const Point& position_m, int milliseconds) {
    MediumTouch touch;
    for (int i = 0; i < milliseconds; ++i) touch = to(position_m);
    return touch;
  }

 private:
  MediumState& state_;
  int seat_;
  bool moved_ = false;
  Point last_m_ = Point::Zero();
};

std::string error_of(const BodiesDescription& description) {
  try {
    const BodyMedium medium(description, "scene.toml: bodies");
  } catch (const BodiesError& error) {
    return error.what();
  }
  return "no error";
}

TEST(BodyMedium, ProbeAtRestInFreeSpaceFeelsNothing) {
  const BodyMedium medium({.bodies = {floor_plate()}}, "test");
  const auto state = medium.make_state(1);
  EXPECT_LT(Hand(*state).rest_at({0, 0, 0.1}, 200).force_N.norm(), 1e-9);
}

TEST(BodyMedium, ProbePressedIntoTheFloorFeelsTheCouplingsSpring) {
  const BodyMedium medium({.bodies = {floor_plate()}}, "test");
  const auto state = medium.make_state(1);
  Hand hand(*state);
  (void)hand.along({0, 0, 0.01}, {0, 0, 0});
  // The probe's ball of 4 mm rests on the floor; its middle is held 4 mm above where the device is.
  const MediumTouch touch = hand.rest_at({0, 0, 0}, 500);
  EXPECT_NEAR(touch.force_N.z(), 600 * 0.004, 0.05);
  EXPECT_LT(touch.force_N.head(2).norm(), 1e-3);
  EXPECT_NEAR(touch.normal.z(), 1, 1e-3);
  EXPECT_NEAR(touch.penetration_m, 0.004, 1e-4);
}

TEST(BodyMedium, LiftedCubeWeighsWhatItWeighs) {
  // Held from below, without a floor: the hand feels the weight.
  const BodyMedium medium({.bodies = {cube(0.1, {0, 0, 0.0245})}, .probe = {.radius_m = 0.004}}, "test");
  const auto state = medium.make_state(1);
  const MediumTouch touch = Hand(*state).rest_at({0, 0, 0}, 400);
  EXPECT_NEAR(touch.force_N.z(), -0.1 * kGravity, 0.1);
}

TEST(BodyMedium, PushedCubeSlidesAlong) {
  const BodyMedium medium({.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02})}}, "test");
  const auto state = medium.make_state(1);
  Hand hand(*state);
  const MediumTouch touch = hand.along({-0.05, 0, 0.02}, {0.03, 0, 0.02});
  EXPECT_LT(touch.force_N.x(), -0.2) << "friction of 0.5 and a weight of 1 N, less the slack of the contacts";
  EXPECT_GT(touch.force_N.x(), -1.5);
}

TEST(BodyMedium, TwoProbesFeelTheSameCubeAndNotEachOther) {
  const BodyMedium medium({.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02})}}, "test");
  const auto state = medium.make_state(2);
  Hand one(*state);
  Hand other(*state);
  (void)other.to({0, 0.1, 0.1});
  EXPECT_EQ(state->join(), -1) << "both seats are taken";
  (void)one.along({-0.05, 0, 0.02}, {0.02, 0, 0.02});
  // The cube has gone from the origin to x = 44 mm; the other hand finds it there.
  const MediumTouch found = other.along({0.1, 0, 0.02}, {0.06, 0, 0.02});
  EXPECT_GT(found.force_N.x(), 0.1);
}

TEST(BodyMedium, ASeatLeftIsFreeAndItsProbeIsGone) {
  const BodyMedium medium({.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02})}}, "test");
  const auto state = medium.make_state(1);
  {
    Hand hand(*state);
    (void)hand.to({0.1, 0, 0.1});
  }
  state->leave(0);
  for (int i = 0; i < 100; ++i) state->advance(1e-3);
  EXPECT_TRUE(state->sound());
  EXPECT_EQ(state->join(), 0);
}

TEST(BodyMedium, StepsAreOfFixedLengthAndWhatCannotBeMadeUpForIsCounted) {
  const BodyMedium medium({.bodies = {cube(1, {0, 0, 10})}, .timestep_s = 2e-3}, "test");
  const auto state = medium.make_state(1);
  for (int i = 0; i < 100; ++i) state->advance(1e-3);
  EXPECT_EQ(state->faults().slipped_s, 0);
  state->advance(1);
  EXPECT_NEAR(state->faults().slipped_s, 1 - 50 * 2e-3, 1e-9);
}

TEST(BodyMedium, AnUnstableCouplingIsRefusedWithTheNumbers) {
  BodiesDescription stiff{.bodies = {floor_plate()}};
  stiff.probe.mass_kg = 0.001;
  stiff.coupling = {.stiffness_N_per_m = 5000, .damping_N_s_per_m = 0};
  EXPECT_EQ(error_of(stiff),
            "scene.toml: bodies: the probe's coupling of 5000 N/m and 0 N s/m is unstable with a mass of 0.001 kg in "
            "steps of 0.001 s (1.25 of what is stable): take a softer one, a heavier probe or shorter steps");
}

TEST(Coupling, AtItsLimitIsTheLimitOfTheRecursion) {
  // The semi-implicit step itself: just below the limit it stays, just above it grows.
  const auto grows = [](double stiffness_N_per_m, double damping_N_s_per_m) {
    double x = 1;
    double v = 0;
    for (int i = 0; i < 20000; ++i) {
      v += 1e-3 / 0.01 * (-stiffness_N_per_m * x - damping_N_s_per_m * v);
      x += 1e-3 * v;
    }
    return std::abs(x) > 10;
  };
  for (const double damping : {1.0, 4.0, 9.0}) {
    const double limit = (4 - 2e-3 * damping / 0.01) * 0.01 / 1e-6;
    EXPECT_FALSE(grows(0.999 * limit, damping));
    EXPECT_TRUE(grows(1.001 * limit, damping));
    EXPECT_NEAR((Coupling{limit, damping}.share_of_stable(0.01, 1e-3)), 1, 1e-9);
  }
}

TEST(BodyMedium, MjcfIsDraggedByItsProbe) {
  const std::string text = R"(<mujoco><option timestep="0.001" gravity="0 0 0"/><worldbody>
    <body name="block" pos="0 0 0"><freejoint/><geom type="box" size="0.02 0.02 0.02" mass="0.2"/></body>
  </worldbody></mujoco>)";
  const BodyMedium medium(compile_mjcf(text, "block.xml"), {"block"},
                          {.stiffness_N_per_m = 300, .damping_N_s_per_m = 10}, "block.xml");
  const auto state = medium.make_state(1);
  Hand hand(*state);
  const MediumTouch begin = hand.along({0, 0, 0}, {0.002, 0, 0});
  EXPECT_LT(begin.force_N.x(), -0.01) << "its mass is felt";
  EXPECT_LT(hand.rest_at({0.002, 0, 0}, 2000).force_N.norm(), 1e-3) << "it has come after";
}

TEST(BodyMedium, MjcfErrorsNameFileAndBody) {
  try {
    (void)compile_mjcf("<mujoco><worldbody><bdy/></worldbody></mujoco>", "broken.xml");
    FAIL();
  } catch (const BodiesError& error) {
    EXPECT_THAT(error.what(), HasSubstr("broken.xml: XML Error: Schema violation: unrecognized element"));
    EXPECT_THAT(error.what(), HasSubstr("line 1"));
  }
  ModelPointer model = compile_mjcf(
      R"(<mujoco><worldbody><body name="peg"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>)", "peg.xml");
  try {
    const BodyMedium medium(std::move(model), {"pegg"}, {}, "peg.xml");
    FAIL();
  } catch (const BodiesError& error) {
    EXPECT_STREQ(error.what(), "peg.xml: no body 'pegg' to be the probe, did you mean 'peg'? (known: peg)");
  }
  EXPECT_THROW((void)load_mjcf("/no/such.xml"), BodiesError);
}

TEST(CompileMjcf, RefusesWhatWouldEndMuJoCoOrItsFirstStep) {
  const auto refusal = [](const std::string& option) -> std::string {
    try {
      (void)compile_mjcf(
          "<mujoco>" + option + R"(<worldbody><body name="a"><freejoint/><geom size="1"/></body></worldbody></mujoco>)",
          "a.xml");
    } catch (const BodiesError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal(""), "accepted");
  EXPECT_EQ(refusal(R"(<option timestep="0"/>)"), "a.xml: timestep must be >= 1e-04 and <= 0.01 s, got 0");
  EXPECT_EQ(refusal(R"(<option timestep="-1"/>)"), "a.xml: timestep must be >= 1e-04 and <= 0.01 s, got -1");
  EXPECT_THAT(refusal(R"(<option timestep="nan"/>)"), testing::HasSubstr("timestep must be >= 1e-04"));
  EXPECT_THAT(refusal(R"(<option gravity="0 0 1e300"/>)"), testing::HasSubstr("cannot take the first step"));
  EXPECT_THAT(refusal(R"(<size nstack="10"/>)"), testing::StartsWith("a.xml: "));
  try {
    (void)compile_mjcf("", "empty.xml");
    ADD_FAILURE() << "accepted";
  } catch (const BodiesError& error) {
    EXPECT_STREQ(error.what(), "empty.xml: is empty, expected <mujoco>...</mujoco>");
  }
}

TEST(BodyMedium, DoesNotAllocateOncePlaced) {
  const BodyMedium medium({.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02})}}, "test");
  const auto state = medium.make_state(1);
  const int seat = state->join();
  state->move(seat, {-0.03, 0, 0.02}, Point::Zero());
  state->advance(1e-3);
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const test::AllocationGuard guard;
  for (int i = 0; i < 100; ++i) {
    state->move(seat, {-0.03 + 1e-4 * i, 0, 0.02}, {0.1, 0, 0});
    state->advance(1e-3);
    (void)state->touch(seat);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(BodyMedium, StateThatIsNoNumberAnyMoreIsSaidAndWritesNoLogFile) {
  const bool before = std::filesystem::exists("MUJOCO_LOG.TXT");
  const BodyMedium medium({.bodies = {floor_plate()}}, "test");
  const auto state = medium.make_state(1);
  auto& world = dynamic_cast<BodyWorld&>(*state);
  world.data().qvel[0] = std::nan("");
  EXPECT_TRUE(state->sound());
  (void)Hand(*state).to({0, 0, 0.1});
  EXPECT_TRUE(state->sound()) << "placing the probe has set its velocity";
  world.data().qvel[0] = std::nan("");
  state->advance(1e-3);
  EXPECT_FALSE(state->sound());
  state->advance(1e-3);
  EXPECT_FALSE(state->sound()) << "and it stays so";
  EXPECT_EQ(std::filesystem::exists("MUJOCO_LOG.TXT"), before);
}

TEST(BodyMedium, ADeviceThatJumpsFarAwayPullsNoHarderThanItsReach) {
  const BodyMedium medium({.bodies = {floor_plate()}}, "test");
  const auto state = medium.make_state(1);
  Hand hand(*state);
  (void)hand.to({0, 0, 0.1});
  (void)hand.to({0, 0, 1e6});
  for (int i = 0; i < 1000; ++i) (void)hand.to({0, 0, 0.1});
  EXPECT_TRUE(state->sound());
}

}  // namespace
}  // namespace forcebound::server
