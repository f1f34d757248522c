#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "forcebound/client/rendering/answer_rendering.hpp"
#include "tests/support/special_numbers.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::client {

using namespace std::chrono_literals;
using test::kInfinity;
using test::vector_of;

/// A pad at rest at z = 0, of 1 N/mm.
inline local_model::Surface resting_pad(double pressed_m) {
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

  /// From so much, with the held force, as the server is silent.
  void expect_to_fade(double z_m, double from_N) {
    EXPECT_NEAR(settled_at(z_m), from_N, 1e-9);
    EXPECT_TRUE(rendered.fades);
    for (const double left : {0.5, 0.0}) {
      share = left;
      EXPECT_NEAR(at(z_m), left * from_N, 1e-9);
    }
    EXPECT_EQ(rendered.model_N.rows(), 0);
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

}  // namespace forcebound::client
