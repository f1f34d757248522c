#include "forcebound/client/rendering/answer_rendering.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/unit/client/rendering/rendered_answer.hpp"

namespace forcebound::client {
namespace {

// A pad that goes up and down by 5 mm once a second. Its velocity alone would leave a third of the held force's error.
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

}  // namespace
}  // namespace forcebound::client
