#include "forcebound/scene/dynamic_model_coupling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "forcebound/control/translation.hpp"
#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/frail_model.hpp"

namespace forcebound::scene {
namespace {

using server::parse_scene;

using control::translation_of;
using std::chrono::milliseconds;

std::shared_ptr<const Scene> table_with_ball(bool shared) {
  return parse_scene(std::string("[scene]\nname = \"table\"\ndescription = \"\"\ndegrees_of_freedom = 3\nshared = ") +
                         (shared ? "true\nclients_max = 2\n" : "false\n") +
                         "[bodies]\ngravity_m_per_s2 = [0, 0, 0]\n"
                         "[[body]]\nname = \"ball\"\nmass_kg = 0.1\n"
                         "shape = { kind = \"sphere\", center_m = [0, 0, 0], radius_m = 0.02 }\n",
                     "table.toml");
}

Vector at(double x) { return Vector{Eigen::Vector3d(x, 0, 0)}; }

/// Strokes from -40 mm towards the ball for so many milliseconds at 0.1 m/s.
double last_force_N(SceneState& state, int motions) {
  Answer answer;
  for (int i = 0; i < motions; ++i) answer = state.answer(at(-0.04 + 1e-4 * i), milliseconds(i), milliseconds(i));
  return answer.force[0];
}

TEST(SceneWithBodies, PushesBackTheHandThatPushesABall) {
  SceneState state(table_with_ball(false), 3);
  EXPECT_NEAR(last_force_N(state, 100), 0, 0.01) << "not yet there";
  SceneState pressing(table_with_ball(false), 3);
  EXPECT_LT(last_force_N(pressing, 190), -0.01);
}

TEST(SceneWithBodies, AnswersAreTheSameBitForBitForTheSameMotions) {
  const auto scene = table_with_ball(false);
  SceneState first(scene, 3);
  SceneState second(scene, 3);
  for (int i = 0; i < 500; ++i) {
    const Answer a = first.answer(at(-0.04 + 1e-4 * i), milliseconds(i));
    const Answer b = second.answer(at(-0.04 + 1e-4 * i), milliseconds(i), milliseconds(7 * i));
    ASSERT_EQ(a.force, b.force) << "the server's time must not matter";
  }
}

TEST(SceneWithBodies, LostMotionsLoseNoSimulatedTime) {
  const auto scene = table_with_ball(false);
  SceneState all(scene, 3);
  SceneState some(scene, 3);
  Answer a;
  Answer b;
  for (int i = 0; i <= 300; ++i) {
    a = all.answer(at(-0.04 + 1e-4 * i), milliseconds(i));
    if (i % 5 == 0) b = some.answer(at(-0.04 + 1e-4 * i), milliseconds(i));
  }
  EXPECT_NEAR(a.force[0], b.force[0], 0.02);
}

TEST(SharedScene, OneClientFeelsWhatTheOtherPushes) {
  const auto scene = table_with_ball(true);
  SceneState left(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState right(scene, 3, left.dynamic_models());
  // The right hand rests against the ball's other side, the left one comes and pushes the ball at it.
  double right_N = 0;
  for (int i = 0; i < 300; ++i) {
    (void)left.answer(at(-0.04 + std::min(1e-4 * i, 0.025)), milliseconds(i), milliseconds(i));
    right_N = right.answer(at(0.023), milliseconds(i), milliseconds(i)).force[0];
  }
  EXPECT_GT(right_N, 0.05);

  SceneState alone(table_with_ball(false), 3);
  double alone_N = 1;
  for (int i = 0; i < 300; ++i) alone_N = alone.answer(at(0.0245), milliseconds(i)).force[0];
  EXPECT_NEAR(alone_N, 0, 1e-6);
}

/// A ball without weight, pressed from the left at some time and pulled back: where it is dragged to, in the end.
double pulled_N(SceneState& state, bool pressed, bool asks_for_models) {
  Answer answer;
  for (int i = 0; i < 3000; ++i) {
    const double x_m = -0.04 + 1e-4 * std::min(i, 185) - 5e-5 * std::clamp(i - 1000, 0, 600);
    const Handle handle{.buttons = pressed && i > 800 ? 1U : 0U};
    answer = state.answer(at(x_m), milliseconds(i), milliseconds(i), asks_for_models, handle);
    if (i == 1500) return answer.force[0];
  }
  return answer.force[0];
}

TEST(SceneWithBodies, AHandGraspsWithItsButton) {
  const auto scene = [](bool shared) {
    return parse_scene(std::string("[scene]\nname = \"g\"\ndescription = \"\"\ndegrees_of_freedom = 3\nshared = ") +
                           (shared ? "true\nclients_max = 2\n" : "false\n") +
                           "[bodies]\ngravity_m_per_s2 = [0, 0, 0]\ngrasp_button = 0\n"
                           "[[body]]\nname = \"wall\"\nfixed = true\n"
                           "shape = { kind = \"box\", center_m = [0.05, 0, 0], size_m = [0.06, 0.2, 0.2] }\n"
                           "[[body]]\nname = \"ball\"\nmass_kg = 2\n"
                           "shape = { kind = \"sphere\", center_m = [-0.0005, 0, 0], radius_m = 0.02 }\n",
                       "g.toml");
  };
  SceneState alone(scene(false), 3);
  EXPECT_GT(pulled_N(alone, true, false), 0.05) << "a heavy ball is pulled along";
  SceneState pushing(scene(false), 3);
  EXPECT_NEAR(pulled_N(pushing, false, false), 0, 0.01);
  for (const bool played : {false, true}) {
    const auto both = scene(true);
    SceneState shared(both, 3, begin_dynamic_models(*both, 2));
    EXPECT_GT(pulled_N(shared, true, played), 0.05) << played;
  }
}

TEST(SharedScene, TimeGoesOnceHoweverManyClientsThereAre) {
  const auto scene = table_with_ball(true);
  SceneState one(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState two_left(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState two_right(scene, 3, two_left.dynamic_models());
  for (int i = 0; i < 190; ++i) {
    const double x = -0.04 + 1e-4 * i;
    const Answer a = one.answer(at(x), milliseconds(i), milliseconds(i));
    const Answer b = two_left.answer(at(x), milliseconds(i), milliseconds(i));
    (void)two_right.answer(at(0.3), milliseconds(i), milliseconds(i));
    ASSERT_NEAR(a.force[0], b.force[0], 1e-6);
  }
}

/// To and fro in the free, 20 mm from the ball; slow enough for it to be straight between motions.
double free_x_m(int i) { return -0.06 + 0.01 * std::sin(6e-3 * i); }

/// Where the mass is that its client is told of, for motion i that arrives at a time of the server's clock.
struct Told {
  double place_m = 0;
  double read_ms = 0;  ///< of the state told of, by the device's clock
};
std::optional<Told> ask(SceneState& state, int i, milliseconds arrived) {
  const Answer answer = state.answer(at(free_x_m(i)), milliseconds(i), arrived, true);
  const local_model::LocalModel& model = answer.model;
  if (!model.has_mass) return std::nullopt;
  EXPECT_TRUE(model.by_device_clock);
  EXPECT_EQ(model.mass.others_move_it, state.scene().facts().shared);
  EXPECT_TRUE(local_model::is_sound(model));
  EXPECT_NEAR(translation_of(answer.server_parts_N).x(), model.mass.force_N.x(), 1e-12);
  return Told{.place_m = model.mass.place_m.x(),
              .read_ms = i - 1e-6 * static_cast<double>(model.before_reading.count())};
}

//   device, even -----------------------------> its own scene: what it would feel without a network
//   the same ==( 20 to 29 ms, reordered )=====> the shared scene
TEST(SharedScene, TellsOfWhatTheDevicesOwnPathDidThenHoweverUnevenlyItCame) {
  constexpr int kMotions = 3000;
  SceneState own(table_with_ball(false), 3);
  std::vector<double> own_places_m;
  own_places_m.reserve(kMotions);
  for (int i = 0; i < kMotions; ++i) own_places_m.push_back(ask(own, i, milliseconds(0)).value_or(Told{}).place_m);
  const auto scene = table_with_ball(true);
  SceneState shared(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState other(scene, 3, shared.dynamic_models());
  int newest = -1;
  int compared = 0;
  for (int now = 0; now < kMotions; ++now) {
    // Somebody else, who makes time go on.
    (void)other.answer(at(0.5), milliseconds(now), milliseconds(now));
    for (int i = newest + 1; i <= now - 20; ++i) {
      if (i + 20 + 7 * i % 10 != now) continue;
      newest = i;
      const auto told = ask(shared, i, milliseconds(now));
      if (!told || now < 2500) continue;
      ++compared;
      const auto before = static_cast<std::size_t>(told->read_ms);
      const double share = told->read_ms - static_cast<double>(before);
      const double own_m = own_places_m.at(before) + share * (own_places_m.at(before + 1) - own_places_m.at(before));
      ASSERT_NEAR(told->place_m, own_m, 6e-5) << "a millisecond at 60 mm/s, of motion " << i;
      ASSERT_LT(told->read_ms, i) << "played a little later than it came";
      ASSERT_GT(told->read_ms, i - 15);
    }
  }
  EXPECT_GT(compared, 50);
}

TEST(SharedScene, TakesMotionsAsTheyComeFromAClientThatRendersRemotely) {
  const auto scene = table_with_ball(true);
  SceneState shared(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState own(table_with_ball(false), 3);
  for (int i = 0; i < 1000; ++i) {
    const Answer a = shared.answer(at(free_x_m(i)), milliseconds(i), milliseconds(i + 40));
    const Answer b = own.answer(at(free_x_m(i)), milliseconds(i));
    ASSERT_NEAR(a.force[0], b.force[0], 1e-6);
  }
}

TEST(SharedScene, PlaysTheTimesOfAnUntrustedClientWithoutHarmToTheOthers) {
  const auto scene = table_with_ball(true);
  SceneState honest(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState untrusted(scene, 3, honest.dynamic_models());
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < 2000; ++i) {
    const double wild = (i % 2 == 0 ? 1 : -1) * std::numeric_limits<double>::max();
    const Nanoseconds read{i % 3 == 0 ? kMost : i % 3 == 1 ? -kMost : 0};
    (void)untrusted.answer(at(i % 5 == 0 ? wild : 0.0), read, milliseconds(i), true);
    const Answer answer = honest.answer(at(-0.06), milliseconds(i), milliseconds(i), true);
    ASSERT_TRUE(answer.force.allFinite());
    ASSERT_TRUE(honest.quarantined().empty());
    ASSERT_TRUE(local_model::is_sound(answer.model));
  }
}

std::shared_ptr<const Scene> shared_pad() {
  return parse_scene(
      "[scene]\nname = \"pad\"\ndescription = \"\"\ndegrees_of_freedom = 3\nshared = true\nclients_max = 2\n"
      "[[tissue]]\nname = \"pad\"\nyoung_Pa = 20000\npoisson = 0.4\nprobe_radius_m = 0.006\n"
      "shape = { kind = \"block\", center_m = [0, 0, -0.02], size_m = [0.06, 0.06, 0.04], cells = [4, 4, 3] }\n"
      "held = { through_m = [0, 0, -0.039], normal = [0, 0, 1] }\n",
      "pad.toml");
}

Vector over_pad(double x, double z) { return Vector{Eigen::Vector3d(x, 0, z)}; }

//   z = 0.1 m   jumps ----+         0.1 m at 2 m/s: 50 ms
//                         v
//   pad        rests   ===+===
TEST(SharedScene, AJumpIntoTissueReachesTheOthersNoFasterThanAHandWouldMove) {
  const auto scene = shared_pad();
  SceneState rests(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState jumps(scene, 3, rests.dynamic_models());
  const auto force_N = [&](int i, double z) {
    (void)jumps.answer(over_pad(0.012, z), milliseconds(i), milliseconds(i));
    return rests.answer(over_pad(-0.012, -0.004), milliseconds(i), milliseconds(i)).force[2];
  };
  double quiet_N = 0;
  for (int i = 0; i < 100; ++i) quiet_N = force_N(i, 0.1);
  ASSERT_GT(quiet_N, 0.1) << "the other one presses";
  for (int i = 100; i < 140; ++i) ASSERT_NEAR(force_N(i, -0.01), quiet_N, 1e-9) << i;
  double then_N = 0;
  for (int i = 140; i < 200; ++i) then_N = force_N(i, -0.01);
  EXPECT_LT(then_N, 0.99 * quiet_N) << "the surface between both has gone down";
}

TEST(SharedScene, AHandOfTheSpeedOfHandsIsWhereItIsAtOnce) {
  const auto scene = shared_pad();
  SceneState shared(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState other(scene, 3, shared.dynamic_models());
  SceneState own(scene, 3, begin_dynamic_models(*scene, 2));
  for (int i = 0; i < 200; ++i) {
    const Vector place = over_pad(0.012, 0.002 - 0.008 * std::sin(0.15 * i));
    (void)other.answer(over_pad(-0.02, 0.1), milliseconds(i), milliseconds(i));
    ASSERT_EQ(shared.answer(place, milliseconds(i), milliseconds(i)).force[2],
              own.answer(place, milliseconds(i), milliseconds(i)).force[2])
        << i;
  }
}

TEST(SharedScene, PlaysPathsWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto scene = table_with_ball(true);
  SceneState state(scene, 3, begin_dynamic_models(*scene, 2));
  for (int i = 0; i < 1000; ++i) (void)ask(state, i, milliseconds(i));
  const Vector place = at(free_x_m(1000));
  const test::AllocationGuard guard;
  for (int i = 1000; i < 1500; ++i) (void)state.answer(place, milliseconds(i), milliseconds(i), true);
  // After an outage more is due than a motion may take.
  (void)state.answer(place, milliseconds(60'000), milliseconds(60'000), true);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(SharedScene, ASeatIsFreeAgainWhenItsClientLeaves) {
  const auto scene = table_with_ball(true);
  SceneState stays(scene, 3, begin_dynamic_models(*scene, 2));
  { SceneState leaves(scene, 3, stays.dynamic_models()); }
  SceneState comes(scene, 3, stays.dynamic_models());
  EXPECT_THROW(SceneState(scene, 3, stays.dynamic_models()), std::logic_error);
}

TEST(SharedScene, InvalidMotionsOfAnUntrustedClientDoNotAffectTheOthers) {
  const auto scene = table_with_ball(true);
  SceneState honest(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState untrusted(scene, 3, honest.dynamic_models());
  for (int i = 0; i < 500; ++i) {
    const double wild = (i % 2 == 0 ? 1 : -1) * std::numeric_limits<double>::max();
    (void)untrusted.answer(at(wild), milliseconds(i % 3), milliseconds(i));
    const Answer answer = honest.answer(at(-0.03), milliseconds(i), milliseconds(i));
    ASSERT_TRUE(answer.force.allFinite());
    ASSERT_TRUE(honest.quarantined().empty());
  }
}

TEST(SceneState, QuarantinesADynamicModelByNameAndTheOthersGoOn) {
  SceneState state(test::frail_scene({.name = "s", .description = ""}, {"frail"}), 3);
  for (int i = 0; i < 6; ++i) {
    const Answer answer = state.answer(at(0), milliseconds(i));
    EXPECT_EQ(answer.force[2], i < 3 ? 1 : 0) << i;
    EXPECT_EQ(state.quarantined().empty() ? "" : *state.quarantined().front(), i == 3 ? "frail" : "") << i;
  }
  EXPECT_EQ(state.faults().quarantined, 1U);
}

TEST(SceneState, NamesAllThatAreQuarantinedOnOneMotion) {
  SceneState state(test::frail_scene({.name = "s", .description = ""}, {"first", "second"}), 3);
  std::vector<std::string> names;
  for (int i = 0; i < 6; ++i) {
    (void)state.answer(at(0), milliseconds(i));
    for (const std::string* name : state.quarantined()) names.push_back(*name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"first", "second"}));
  EXPECT_EQ(state.faults().quarantined, 2U);
}

TEST(SceneWithBodies, DoesNotAllocate) {
  SceneState state(table_with_ball(false), 3);
  (void)last_force_N(state, 10);
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const test::AllocationGuard guard;
  (void)last_force_N(state, 200);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::scene
