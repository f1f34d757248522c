#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>

#include "forcebound/answer/answer.hpp"
#include "forcebound/local_model/local_model.hpp"
#include "library/source/callback_environment.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/vector_of.hpp"

/// The environment of a program's callbacks, as the server sees it.
namespace forcebound::library {
namespace {

using test::vector_of;

constexpr std::array<double, 9> kStiffness_N_per_m{300, 20, 5, 20, 200, 0, 5, 0, 100};

server::Vector force_at_N(const server::Vector& x_m) {
  server::Vector force_N = server::Vector::Zero(x_m.rows());
  for (Eigen::Index row = 0; row < std::min<Eigen::Index>(x_m.rows(), 3); ++row) {
    for (Eigen::Index column = 0; column < std::min<Eigen::Index>(x_m.rows(), 3); ++column) {
      force_N[row] -= kStiffness_N_per_m.at(3 * row + column) * x_m[column];
    }
  }
  return force_N;
}

class SpringsInCpp final : public server::Environment {
 public:
  server::Answer respond(const server::Motion& motion) noexcept override {
    server::Answer answer{.force = force_at_N(motion.position), .penetration_m = 1e-3};
    answer.contact_normal = server::Vector::Unit(motion.position.rows(), 0);
    if (motion.handle.pressed(3)) answer.torque_N_m = vector_of({0.1, 0.2, 0.3});
    return answer;
  }
};

fb_status springs_in_c(void* /*own*/, const fb_client_motion* motion, fb_answer* answer) {
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      answer->force_N[row] -= kStiffness_N_per_m.at(3 * row + column) * motion->position_m[column];
    }
  }
  answer->has = FB_HAS_STIFFNESS | FB_HAS_CONTACT;
  answer->normal[0] = 1;
  answer->depth_m = 1e-3;
  std::copy(kStiffness_N_per_m.begin(), kStiffness_N_per_m.end(), answer->stiffness_N_per_m);
  answer->radius_m = 0.02;
  if ((motion->has & FB_HAS_BUTTONS) == 0 || motion->buttons != 8) return FB_OK;
  answer->has |= FB_HAS_TORQUE;
  for (int k = 0; k < 3; ++k) answer->torque_N_m[k] = (k + 1) / 10.0;
  return FB_OK;
}

std::unique_ptr<server::Environment> environment_of(decltype(fb_environment::update) update) {
  fb_environment environment = FB_INIT(fb_environment);
  environment.update = update;
  const server::EnvironmentKind kind = kind_of(std::make_shared<EnvironmentCallbacks>(environment));
  return kind.make({.device = "a device", .degrees_of_freedom = 3}).environment;
}

TEST(CallbackEnvironment, AnswersAsTheSameEnvironmentInCpp) {
  SpringsInCpp in_cpp;
  const auto in_c = environment_of(springs_in_c);
  for (const auto& position : {vector_of({0.01}), vector_of({0.01, -0.02}), vector_of({0.01, -0.02, 0.03}),
                               vector_of({0.01, -0.02, 0.03, 0.1, 0.2, 0.3})}) {
    SCOPED_TRACE(position.rows());
    for (const unsigned buttons : {0U, 8U}) {
      const server::Motion motion{.position = position, .handle = {.buttons = buttons}};
      const server::Answer answer = in_c->respond(motion);
      const server::Answer expected = in_cpp.respond(motion);
      EXPECT_TRUE(answer::is_sound(answer, position.rows()));
      EXPECT_TRUE(answer.force.isApprox(expected.force, 1e-15)) << answer.force.transpose();
      EXPECT_EQ(answer.torque_N_m, expected.torque_N_m);
      EXPECT_EQ(answer.contact_normal, expected.contact_normal);
      EXPECT_EQ(answer.penetration_m, expected.penetration_m);
      EXPECT_TRUE(answer.model.empty()) << "nobody wants it";
    }
  }
}

TEST(CallbackEnvironment, ItsStiffnessGivesTheForceBesideThePlaceToo) {
  const auto in_c = environment_of(springs_in_c);
  for (const auto& position : {vector_of({0.01}), vector_of({0.01, -0.02, 0.03})}) {
    const server::Answer answer = in_c->respond({.position = position, .wants_model = true});
    ASSERT_TRUE(local_model::is_sound(answer.model));
    ASSERT_TRUE(answer.model.has_field);
    const local_model::Field& field = answer.model.field;
    EXPECT_EQ(field.radius_m, 0.02);
    const Eigen::Index rows = position.rows();
    const server::Vector beside = position + server::Vector::Constant(rows, 0.003);
    const Eigen::VectorXd there_N =
        (field.force_N + field.jacobian_N_per_m * (local_model::Point::Zero() - field.place_m)).head(rows);
    EXPECT_NEAR(there_N.norm(), 0, 1e-12) << "the springs end at the origin";
    const Eigen::VectorXd force_N =
        field.force_N.head(rows) + field.jacobian_N_per_m.topLeftCorner(rows, rows) * (beside - position);
    EXPECT_TRUE(force_N.isApprox(Eigen::VectorXd(force_at_N(beside)), 1e-12));
  }
}

TEST(CallbackEnvironment, WhatFailsIsAnUnsoundAnswer) {
  for (const auto update : {+[](void*, const fb_client_motion*, fb_answer*) -> fb_status { return FB_FAILED; },
                            +[](void*, const fb_client_motion*, fb_answer*) -> fb_status { throw 1; }}) {
    const auto environment = environment_of(update);
    EXPECT_FALSE(answer::is_sound(environment->respond({.position = vector_of({0, 0, 0})}), 3));
  }
}

TEST(CallbackEnvironment, AnAnswerDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto environment = environment_of(springs_in_c);
  const server::Vector position = vector_of({0.01, -0.02, 0.03});
  const test::AllocationGuard guard;
  for (int n = 0; n < 100; ++n) (void)environment->respond({.position = position, .wants_model = true});
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::library
