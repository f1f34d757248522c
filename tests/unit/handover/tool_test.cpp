// A tool in the hand is handed over with the scene that it touches.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "forcebound/control/rotation.hpp"
#include "forcebound/scene/tool/tool.hpp"
#include "forcebound/v1/handover.pb.h"
#include "tests/unit/handover/handed_over.hpp"

namespace forcebound::handover {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

const std::string kFeltByTool =
    "effects = ['surface', 'friction']\nsurface = { stiffness_N_per_m = 500, damping_N_s_per_m = 1 }\n"
    "friction = { static_coefficient = 0.4 }\n";
const std::string kToolScene =
    "[tool]\ntip_m = [0, 0, -0.05]\nspacing_m = 0.003\n[[tool.part]]\nname = 'rod'\n"
    "shape = { kind = 'cylinder', from_m = [0, 0, 0], to_m = [0.001, 0.002, 0.03], radius_m = 0.0041 }\n"
    "[[tool.part]]\nname = 'ball'\nshape = { kind = 'sphere', center_m = [0, 0.003, 0.03], radius_m = 0.0077 }\n"
    "[[object]]\nname = 'table'\nshape = { kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }\n" +
    kFeltByTool +
    "[[object]]\nname = 'block'\nshape = { kind = 'box', center_m = [0, 0, 0], size_m = [0.02, 0.02, 0.02] }\n" +
    kFeltByTool;

TEST(AToolThatIsHandedOver, FeelsToTheBitWhatTheServersFeels) {
  const auto scene = scene_of(kToolScene);
  const AssembledScene made = assembled(PackedScene(*scene), 3).build();
  ASSERT_NE(made.scene->facts().tool, nullptr);
  EXPECT_TRUE(std::ranges::equal(made.scene->facts().tool->points(), scene->facts().tool->points()));
  ASSERT_EQ(scene->facts().tool->parts().size(), 2U);
  EXPECT_TRUE(std::ranges::equal(made.scene->facts().tool->parts(), scene->facts().tool->parts()));
  scene::SceneState at_server(scene, 3);
  scene::SceneState at_client(made.scene, 3);
  double turned_N_m = 0;
  for (int i = 0; i < 500; ++i) {
    const double turn = 0.01 * i;
    const Vector tip_m = scene::Point(0.02 * std::cos(turn), 0.02 * std::sin(turn), 0.01 * std::sin(3 * turn));
    const control::Handle handle{.orientation =
                                     control::orientation_of(control::turn_by(scene::Point(turn, 0.2, 0.5 * turn)))};
    const auto there = at_server.answer(tip_m, milliseconds{i}, {}, false, handle);
    const auto here = at_client.answer(tip_m, milliseconds{i}, {}, false, handle);
    EXPECT_EQ(here.force, there.force) << i;
    EXPECT_EQ(here.torque_N_m, there.torque_N_m) << i;
    turned_N_m = std::max(turned_N_m, here.torque_N_m.norm());
  }
  EXPECT_GT(turned_N_m, 1e-3) << "or nothing was compared";
}

std::string refusal_of_points(std::initializer_list<double> numbers, const std::vector<v1::ToolPart>& parts = {}) {
  v1::SceneManifest manifest;
  manifest.set_name("hostile");
  manifest.set_degrees_of_freedom(3);
  (void)manifest.mutable_tool();
  for (const double number : numbers) manifest.mutable_tool()->add_point(number);
  for (const v1::ToolPart& part : parts) *manifest.mutable_tool()->add_part() = part;
  const std::string bytes = manifest.SerializeAsString();
  const auto raw = std::as_bytes(std::span(bytes));
  return refusal_of([&] {
    SceneAssembly assembly({.hash = hash_of(raw), .manifest_bytes = raw.size(), .pieces = 1},
                           scene::Registry::standard());
    assembly.add(0, raw);
    (void)assembly.build();
  });
}

TEST(AToolThatIsHandedOver, IsHeldToWhatASceneFilesIs) {
  EXPECT_EQ(refusal_of_points({0, 0, 0.01, 0.002}), "accepted");
  EXPECT_THAT(refusal_of_points({}), HasSubstr("at least one point"));
  EXPECT_THAT(refusal_of_points({0, 0, 0}), HasSubstr("have 3 numbers, not 4 each"));
  EXPECT_THAT(refusal_of_points({0, 0, 3, 0}), HasSubstr("within 0.5 m of its tip"));
  EXPECT_THAT(refusal_of_points({0, 0, 0, -1}), HasSubstr("within 0.5 m of its tip"));
  EXPECT_THAT(refusal_of_points({0, 0, std::nan(""), 0}), HasSubstr("within 0.5 m of its tip"));
}

TEST(AToolThatIsHandedOver, IsHeldToPartsWithAVolume) {
  v1::ToolPart ball;
  ball.set_radius(0.01);
  EXPECT_EQ(refusal_of_points({0, 0, 0, 0}, {ball}), "accepted");
  EXPECT_THAT(refusal_of_points({0, 0, 0, 0}, std::vector(65, ball)), HasSubstr("at most 64 parts, got 65"));
  v1::ToolPart none = ball;
  none.set_radius(-1);
  EXPECT_THAT(refusal_of_points({0, 0, 0, 0}, {none}), HasSubstr("has a volume within 1 m of its tip"));
  none = ball;
  none.mutable_from()->set_x(std::nan(""));
  EXPECT_THAT(refusal_of_points({0, 0, 0, 0}, {none}), HasSubstr("has a volume within 1 m of its tip"));
  none = ball;
  none.set_kind(static_cast<v1::ToolPart::Kind>(7));
  EXPECT_THAT(refusal_of_points({0, 0, 0, 0}, {none}), HasSubstr("capsule, cylinder or box, got kind 7"));
}

TEST(AToolThatIsHandedOver, IsRefusedWhereItsPointsTakeTooLong) {
  EXPECT_EQ(why_refused(*scene_of(kToolScene)), "");
  EXPECT_THAT(why_refused(*scene_of(kToolScene), Limits{.tick_ns = 5e3}), HasSubstr("us of each tick"));
}

}  // namespace
}  // namespace forcebound::handover
