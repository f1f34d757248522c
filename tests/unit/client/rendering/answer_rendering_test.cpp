#include "forcebound/client/rendering/answer_rendering.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/sample_local_model.hpp"
#include "tests/unit/client/rendering/rendered_answer.hpp"

namespace forcebound::client {
namespace {

using test::kNaN;

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
