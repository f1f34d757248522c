#include "forcebound/client/rendering/answer_rendering.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/sample_local_model.hpp"
#include "tests/support/special_numbers.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;
using test::kInfinity;
using test::kNaN;
using test::vector_of;

/// A pad at rest at z = 0, of 1 N/mm.
local_model::Surface resting_pad(double pressed_m) {
  return {.id = 1,
          .force_N = {0, 0, 1000 * pressed_m},
          .normal = {0, 0, 1},
          .stiffness_N_per_m = Eigen::Vector3d(0, 0, 1000).asDiagonal(),
          .radius_m = 0.02};
}

/// A client on ticks of a millisecond, and its server's answers.
class RenderedAnswer : public ::testing::Test {
 protected:
  /// For a device that was so deep in the pad then; with the force of something else.
  void receive_pad(double pressed_m, double else_N = 0) {
    receive(1000 * pressed_m + else_N);
    newest.answer.model.surfaces[0] = resting_pad(pressed_m);
    newest.answer.model.surface_count = 1;
  }
  void receive(double z_N) {
    ++newest.motion_sequence;
    newest.motion_device_time = now;
    newest.answer.force = vector_of({0, 0, z_N});
    newest.answer.server_parts_N = newest.answer.force;
    newest.answer.model = {};
  }

  /// On each tick the answer of 100 ms before.
  void receive_late(const local_model::Surface& pad) {
    receive(pad.force_N.z());
    newest.motion_device_time = late();
    newest.answer.model.surfaces[0] = pad;
    newest.answer.model.surface_count = 1;
  }
  [[nodiscard]] Nanoseconds late() const { return next() - 100ms; }
  [[nodiscard]] Nanoseconds next() const { return now + 1ms; }

  /// The server's part of the request, along z.
  double at(double z_m, double x_m = 0) {
    now += 1ms;
    place = vector_of({x_m, 0, z_m});
    rendered =
        answers.render(newest, {.now = now,
                                .place = place,
                                .server_parts_alone = server_parts_alone,
                                .share = share,
                                .age = {.s = std::min(age_most_s, time::to_seconds(now - newest.motion_device_time))},
                                .force_N_max = 30});
    return share * newest.answer.force[2] + rendered.correction_N[2];
  }
  double settled_at(double z_m, double x_m = 0) {
    for (int i = 0; i < 100; ++i) (void)at(z_m, x_m);
    return at(z_m, x_m);
  }

  AnswerRendering answers;
  wire::EnvironmentForce newest;
  AnswerRendering::Rendered rendered;
  Vector place;
  Nanoseconds now{0};
  bool server_parts_alone = false;
  double share = 1;
  double age_most_s = kInfinity;
};

TEST_F(RenderedAnswer, HoldsAForceThatHasNoModelAsItIs) {
  for (const double force_N : {1.0, -3.0, 0.0, 7.0}) {
    receive(force_N);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(at(-0.001 * i), force_N);
      EXPECT_EQ(rendered.model_N.rows(), 0);
      EXPECT_EQ(rendered.held, force_N != 0);
      EXPECT_EQ(rendered.trust, std::nullopt) << "there is nothing to trust";
    }
  }
}

TEST_F(RenderedAnswer, IsThatOfTheModelWhereTheDeviceIsNow) {
  receive_pad(0.002);
  EXPECT_NEAR(at(-0.002), 2, 1e-9) << "as was said, where it was";
  EXPECT_NEAR(at(-0.003), 3, 1e-9);
  EXPECT_NEAR(at(0.001), 0, 1e-9);
  EXPECT_EQ(rendered.model_N.rows(), 3);
  EXPECT_FALSE(rendered.held);
}

TEST_F(RenderedAnswer, IsFeltWhereThereWasNoContactYet) {
  receive_pad(0);
  EXPECT_NEAR(at(0.001), 0, 1e-9);
  EXPECT_NEAR(at(-0.002), 2, 1e-9);
}

TEST_F(RenderedAnswer, HoldsTheRemainderOfTheForce) {
  receive_pad(0.002, 0.5);
  EXPECT_NEAR(at(-0.003), 3.5, 1e-9);
  EXPECT_TRUE(rendered.held);
  EXPECT_NEAR(at(0.001), 0.5, 1e-9);
}

TEST_F(RenderedAnswer, FallsToTheHeldForceBeyondTheRadiusWithoutAStep) {
  receive_pad(0.002);
  double last_N = settled_at(-0.003);
  for (int i = 0; i <= 300; ++i) {
    const double force_N = at(-0.003, 1e-4 * i);
    EXPECT_LT(std::abs(force_N - last_N), 0.02) << "at " << 1e-4 * i;
    last_N = force_N;
  }
  EXPECT_NEAR(last_N, 2, 1e-9);
  EXPECT_EQ(rendered.model_N.rows(), 0);
  EXPECT_TRUE(rendered.held);
}

TEST_F(RenderedAnswer, GoesOnWhereItWasWhenAnotherAnswerSaysOtherwiseAndGetsThereSoon) {
  receive_pad(0.002);
  EXPECT_NEAR(settled_at(-0.002), 2, 1e-9);
  receive_pad(0.002);
  newest.answer.model.surfaces[0].place_m.z() = 0.001;
  newest.answer.model.surfaces[0].force_N.z() = newest.answer.force[2] = newest.answer.server_parts_N[2] = 3;
  EXPECT_NEAR(at(-0.002), 2, 1e-9);
  for (int i = 1; i <= 15; ++i) EXPECT_NEAR(at(-0.002), 3 - std::exp(-1e-3 * i / AnswerRendering::kFade_s), 1e-9);
  EXPECT_GT(at(-0.002), 2.95);
}

TEST_F(RenderedAnswer, FadesFromWhatTheDeviceShowedNotFromWhatWasAskedFor) {
  receive_pad(0.04);
  newest.answer.model.surfaces[0].radius_m = 1;
  EXPECT_NEAR(settled_at(-0.05), 30, 1e-9);
  receive(2);
  EXPECT_NEAR(at(-0.05), 30, 1e-9);
  for (int i = 1; i <= 10; ++i) EXPECT_NEAR(at(-0.05), 2 + 28 * std::exp(-1e-3 * i / AnswerRendering::kFade_s), 1e-9);
}

TEST_F(RenderedAnswer, FadesToWhatTheDeviceCanShowWhereAModelAsksForMore) {
  receive(0);
  EXPECT_EQ(settled_at(-0.05), 0);
  receive_pad(0.04);
  newest.answer.model.surfaces[0].radius_m = 1;
  EXPECT_NEAR(at(-0.05), 0, 1e-9);
  for (int i = 1; i <= 10; ++i) EXPECT_NEAR(at(-0.05), 30 - 30 * std::exp(-1e-3 * i / AnswerRendering::kFade_s), 1e-9);
}

TEST_F(RenderedAnswer, GoesOnWhereItWasWhenAnAnswerHasNoModelAnyMore) {
  receive_pad(0.002);
  EXPECT_NEAR(settled_at(-0.003), 3, 1e-9);
  receive(2);
  EXPECT_NEAR(at(-0.003), 3, 1e-9);
  EXPECT_NEAR(settled_at(-0.003), 2, 1e-6);
}

TEST_F(RenderedAnswer, GoesOnWhereAMovingSurfaceWouldBeByNowWhenAnAnswerHasNoModelAnyMore) {
  receive_pad(0.002);
  newest.answer.model.surfaces[0].velocity_m_per_s.z() = 0.1;
  for (int i = 1; i <= 5; ++i) EXPECT_NEAR(at(-0.002), 2 + 0.1 * i, 1e-9) << "it comes by 0.1 mm on each tick";
  receive(2);
  EXPECT_NEAR(at(-0.002), 2.6, 1e-9);
}

TEST_F(RenderedAnswer, GoesOnWhereItWasWhenTheCouplingOfAMassIsAnother) {
  // Too heavy to move in the time that is looked at.
  const auto receive_mass = [this](double stiffness_N_per_m) {
    receive(5);
    newest.answer.model.mass = {.id = 1,
                                .force_N = {0, 0, 5},
                                .stiffness_N_per_m = stiffness_N_per_m,
                                .body = {.mobility_per_kg = 1e-4 * Eigen::Matrix3d::Identity()},
                                .radius_m = 1};
    newest.answer.model.has_mass = true;
  };
  receive_mass(500);
  EXPECT_NEAR(settled_at(-0.01), 5, 0.01);
  receive_mass(1000);
  EXPECT_NEAR(at(-0.01), 5, 0.01);
  EXPECT_NEAR(at(-0.01), 10 - 5 * std::exp(-1e-3 / AnswerRendering::kFade_s), 0.02);
  EXPECT_NEAR(settled_at(-0.01), 10, 0.02);
}

TEST_F(RenderedAnswer, LetsWhatMovesFadeWithTheHeldForceWhenTheServerIsSilent) {
  receive_pad(0.002);
  // Slower than what would be felt.
  newest.answer.model.surfaces[0].velocity_m_per_s.x() = 1e-9;
  EXPECT_NEAR(settled_at(-0.003), 3, 1e-9);
  EXPECT_TRUE(rendered.fades);
  share = 0.5;
  EXPECT_NEAR(at(-0.003), 1.5, 1e-9);
  share = 0;
  EXPECT_NEAR(at(-0.003), 0, 1e-9);
  EXPECT_EQ(rendered.model_N.rows(), 0);
}

TEST_F(RenderedAnswer, KeepsASurfaceThatStandsStillWhenTheServerIsSilent) {
  receive_pad(0.002, 1);
  EXPECT_NEAR(settled_at(-0.003), 4, 1e-6);
  EXPECT_TRUE(rendered.fades) << "what else there is";
  answers = {};  // so that nothing was foretold
  receive_pad(0.002);
  EXPECT_NEAR(settled_at(-0.003), 3, 1e-6);
  EXPECT_FALSE(rendered.fades);
  for (const double left : {0.5, 0.0}) {
    share = left;
    EXPECT_NEAR(at(-0.003), 3, 1e-6);
    EXPECT_NEAR(at(-0.001), 1, 1e-6);
    EXPECT_NEAR(rendered.model_N[2], 1, 1e-6);
    EXPECT_NEAR(at(-0.003, 1), left * 2, 1e-6) << "beyond its radius there is what was held";
  }
}

TEST_F(RenderedAnswer, KeepsADraggedMassButNotWhatElsePullsAtItWhenTheServerIsSilent) {
  receive(0);
  newest.answer.model.mass = {.id = 1,
                              .stiffness_N_per_m = 500,
                              .damping_N_s_per_m = 20,
                              .body = {.bias_m_per_s2 = {0, 0, 1}, .mobility_per_kg = Eigen::Matrix3d::Identity()},
                              .radius_m = 1};
  newest.answer.model.has_mass = true;
  (void)at(0);
  for (int i = 0; i < 10; ++i) (void)settled_at(0);
  EXPECT_NEAR(at(0), 1, 0.01) << "it hangs from the device";
  share = 0;
  for (int i = 0; i < 10; ++i) (void)settled_at(0);
  EXPECT_NEAR(at(0), 0, 0.01);
  EXPECT_NEAR(settled_at(0.01), 0, 5.1) << "it follows the device";
  EXPECT_LT(at(0.02), -1) << "it is still there";
}

TEST_F(RenderedAnswer, TellsThatWhatMovesWouldFadeAlsoWhereTheAnswerHadNoForceOfIt) {
  server_parts_alone = true;
  receive_pad(0);
  newest.answer.server_parts_N.resize(0);
  EXPECT_NEAR(at(-0.002), 2, 1e-9);
  EXPECT_FALSE(rendered.fades) << "it stands still";
  receive_pad(0);
  newest.answer.server_parts_N.resize(0);
  newest.answer.model.surfaces[0].velocity_m_per_s.x() = 1e-9;
  EXPECT_NEAR(at(-0.002), 2, 1e-9);
  EXPECT_TRUE(rendered.fades);
}

TEST_F(RenderedAnswer, LetsWhatOthersCanMoveFadeWhenTheServerIsSilentAlsoAtRest) {
  receive_pad(0.002);
  newest.answer.model.surfaces[0].others_move_it = true;
  EXPECT_NEAR(settled_at(-0.003), 3, 1e-9);
  EXPECT_TRUE(rendered.fades);
  share = 0.5;
  EXPECT_NEAR(at(-0.003), 1.5, 1e-9);
  share = 0;
  EXPECT_NEAR(at(-0.003), 0, 1e-9);
  EXPECT_EQ(rendered.model_N.rows(), 0);
}

TEST_F(RenderedAnswer, LetsAMassThatOthersCanMoveFadeWhenTheServerIsSilent) {
  receive(0);
  newest.answer.model.mass = {.id = 1,
                              .stiffness_N_per_m = 500,
                              // Too heavy to move in the time that is looked at.
                              .body = {.mobility_per_kg = 1e-4 * Eigen::Matrix3d::Identity()},
                              .radius_m = 1,
                              .others_move_it = true};
  newest.answer.model.has_mass = true;
  EXPECT_NEAR(settled_at(-0.01), 5, 0.01);
  EXPECT_TRUE(rendered.fades);
  share = 0.5;
  EXPECT_NEAR(at(-0.01), 2.5, 0.01);
  share = 0;
  EXPECT_NEAR(at(-0.01), 0, 1e-9);
}

TEST_F(RenderedAnswer, CountsAndLeavesOutWhatIsUnsoundAndHoldsItsForce) {
  std::uint64_t refused = 0;
  const std::function<void(local_model::LocalModel&)> spoils[]{
      [](auto& model) { model.surfaces[0].place_m.z() = kNaN; },
      [](auto& model) { model.surfaces[0].stiffness_N_per_m(2, 2) = -1000; },
      [](auto& model) { model.surfaces[0].stiffness_N_per_m(2, 2) = kInfinity; },
      [](auto& model) { model.surfaces[0].radius_m = 0; },
      [](auto& model) { model.surfaces[0].normal.setZero(); },
      [](auto& model) { model.surface_count = 4; }};
  for (const auto& spoil : spoils) {
    receive_pad(0.002);
    spoil(newest.answer.model);
    EXPECT_NEAR(settled_at(-0.003), 2, 1e-6);
    EXPECT_EQ(rendered.model_N.rows(), 0);
    EXPECT_EQ(answers.refused(), ++refused) << "once for each answer";
  }
}

TEST_F(RenderedAnswer, BlamesTheAnswerThatTurnsOutNotToBeFiniteAndNotTheNext) {
  receive_pad(0.002);
  newest.answer.force[2] = kInfinity;
  (void)at(-0.003);
  EXPECT_EQ(answers.refused(), 0U);
  receive_pad(0.002);
  EXPECT_NEAR(at(-0.003), 3, 1e-9) << "at once: there is nothing that could fade";
  EXPECT_EQ(rendered.model_N.rows(), 3);
  EXPECT_EQ(answers.refused(), 1U);
  receive_pad(0.002);
  EXPECT_NEAR(at(-0.003), 3, 1e-9);
  EXPECT_EQ(answers.refused(), 1U);
}

TEST_F(RenderedAnswer, TakesTheRestAloneWhereTheSceneRunsAtTheClient) {
  server_parts_alone = true;
  receive_pad(0.002);
  newest.answer.force[2] += 5;  // of parts that run at the client
  EXPECT_NEAR(at(-0.003) - 5, 3, 1e-9);
  EXPECT_FALSE(rendered.held);
}

// A force of 2 N that never changes, told 100 ms late, with a model that foretells up to twice as much.
TEST_F(RenderedAnswer, GivesUpAModelThatForetellsWorseThanHolding) {
  const auto receive_wrong = [this] {
    receive_late(resting_pad(0.002));
    newest.answer.model.surfaces[0].radius_m = 0.1;
  };
  receive_wrong();
  EXPECT_NEAR(at(-0.004), 4, 1e-6);
  EXPECT_EQ(rendered.trust, 1) << "nothing was compared yet";
  for (int i = 0; i < 500; ++i) {
    receive_wrong();
    (void)at(-0.004);
  }
  EXPECT_EQ(rendered.trust, 0);
  EXPECT_NEAR(at(-0.004), 2, 1e-6) << "as was said";
  EXPECT_EQ(rendered.model_N.rows(), 0);
  EXPECT_TRUE(rendered.held);
  EXPECT_TRUE(rendered.fades);
}

// A pad that goes up and down by 5 mm once a second. Its velocity alone would leave a third of the held force's error.
TEST_F(RenderedAnswer, FadesFromTheFrictionOfTheAnswerBefore) {
  double x_m = 0;
  const auto slide = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) (void)at(-0.002, x_m += 5e-5);
    return rendered.correction_N[0];
  };
  receive_pad(0.002);
  newest.answer.model.surfaces[0].friction = 0.5;
  EXPECT_NEAR(slide(40), -1, 1e-6);
  receive_pad(0.002);
  newest.motion_device_time = {};  // nothing was foretold of that time
  newest.answer.model.surfaces[0].friction = 0.1;
  EXPECT_NEAR(slide(1), -1, 0.2) << "no step";
  EXPECT_NEAR(slide(60), -0.2, 1e-3);
}

TEST_F(RenderedAnswer, OfACarriedPadIsThatOfWhereItIsNowButForItsJerk) {
  constexpr double kRate_per_s = 2 * std::numbers::pi;
  constexpr double kUp_m = 0.005;
  constexpr double kDevice_m = -0.01;
  double squares = 0;
  double squares_held = 0;
  for (int i = 0; i < 2000; ++i) {
    const double phase = kRate_per_s * time::to_seconds(late());
    local_model::Surface pad = resting_pad(kUp_m * std::sin(phase) - kDevice_m);
    pad.place_m.z() = kUp_m * std::sin(phase);
    pad.velocity_m_per_s.z() = kUp_m * kRate_per_s * std::cos(phase);
    pad.acceleration_m_per_s2.z() = -kUp_m * kRate_per_s * kRate_per_s * std::sin(phase);
    pad.radius_m = 0.1;
    receive_late(pad);
    const double there_N = 1000 * (kUp_m * std::sin(kRate_per_s * time::to_seconds(next())) - kDevice_m);
    squares_held += std::pow(pad.force_N.z() - there_N, 2);
    squares += std::pow(at(kDevice_m) - there_N, 2);
  }
  EXPECT_LT(std::sqrt(squares / squares_held), 0.1);
}

// A spring of 1 N/mm beside one of 1 N/mm with a damper in series, of 0.2 s, pressed at 2 Hz: by its closed form.
TEST_F(RenderedAnswer, OfAViscoelasticPadIsThatOfTheDevicesOwnMotion) {
  constexpr double kRate_per_s = 4 * std::numbers::pi;
  constexpr double kRelaxation_s = 0.2;
  constexpr double kRateTimesTime = kRate_per_s * kRelaxation_s;
  const double lead = std::atan(1 / kRateTimesTime);
  const auto pressed_m = [](Nanoseconds then) {
    return 0.003 + 0.002 * std::sin(kRate_per_s * time::to_seconds(then));
  };
  const auto relaxed_N = [&](Nanoseconds then) {
    return 1000 * 0.002 * std::cos(lead) * std::sin(kRate_per_s * time::to_seconds(then) + lead);
  };
  for (int i = 0; i < 2000; ++i) {
    local_model::Surface pad = resting_pad(pressed_m(late()));
    pad.force_N.z() += relaxed_N(late());
    pad.relaxing_N_per_m = 1000;
    pad.relaxation_s = kRelaxation_s;
    pad.relaxed_N = relaxed_N(late());
    pad.radius_m = 0.1;
    receive_late(pad);
    const double there_N = std::max(0.0, 1000 * pressed_m(next()) + relaxed_N(next()));
    const double felt_N = at(-pressed_m(next()));
    if (i <= 1000) continue;
    EXPECT_NEAR(felt_N, there_N, 0.05) << "after " << i << " ms; held, by up to 2 N";
  }
}

// It comes at 1 mm/s, and goes on for 0.25 s of an outage of 2 s.
TEST_F(RenderedAnswer, RelaxesFromTheMotionThatWasRenderedAlone) {
  age_most_s = 0.25;
  const auto receive_coming = [this](double force_N) {
    receive_pad(0.003, force_N - 3);
    newest.answer.model.surfaces[0].force_N.z() = force_N;
    local_model::Surface& pad = newest.answer.model.surfaces[0];
    pad.velocity_m_per_s.z() = 0.001;
    pad.relaxing_N_per_m = 1000;
    pad.relaxation_s = 10;
  };
  receive_coming(3);
  for (int i = 0; i < 2000; ++i) (void)at(-0.003);
  const double foretold_N = at(-0.003);
  EXPECT_NEAR(foretold_N, 3.25 + 0.25 * std::exp(-0.19), 0.01);
  receive_coming(foretold_N);
  EXPECT_NEAR(settled_at(-0.003), 3.1 + 0.25 * std::exp(-0.2) + 0.1, 0.01);
}

TEST_F(RenderedAnswer, StaysFiniteAndDoesNotAllocateWhateverComes) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  std::mt19937_64 random(1);
  const auto wild = [&random]() -> double {
    const auto sign = random() % 2 == 0 ? 1.0 : -1.0;
    return sign * std::ldexp(1.0, static_cast<int>(random() % 40) - 20);
  };
  receive(1);
  (void)at(0);
  for (int i = 0; i < 20000; ++i) {
    if (i % 3 == 0) receive(wild());
    newest.answer.model = test::sample_local_model();
    newest.answer.model.surfaces[0].place_m = {wild(), wild(), wild()};
    newest.answer.model.surfaces[0].radius_m = std::abs(wild());
    newest.answer.model.mass.place_m.x() = wild();
    newest.answer.model.mass.body.velocity_m_per_s.y() = wild();
    newest.answer.model.mass.body.mobility_per_kg *= std::abs(wild());
    newest.answer.model.mass.contacts[0].gap_m = wild();
    newest.answer.model.mass.contacts[0].stiffness_per_s2 = std::abs(wild());
    newest.answer.model.mass.contacts[0].met.bias_m_per_s2.x() = wild();
    newest.answer.model.field.jacobian_N_per_m(0, 1) = wild();
    place.resize(3);
    const test::AllocationGuard tick;
    const double force_N = at(wild(), wild());
    EXPECT_EQ(tick.heap_operations(), 0U);
    EXPECT_TRUE(std::isfinite(force_N));
    EXPECT_TRUE(rendered.correction_N.allFinite());
  }
}

}  // namespace
}  // namespace forcebound::client
