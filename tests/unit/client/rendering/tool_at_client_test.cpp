// The torque of a tool with a shape: of the server's answers until its scene runs at the client, then of that.

#include <gtest/gtest.h>

#include "forcebound/client/rendering/request_rendering.hpp"
#include "forcebound/control/rotation.hpp"
#include "tests/unit/handover/handed_over.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

/// A blade that is pressed askew into a plane, 0.5 mm deeper than when the server answered.
class AToolAtTheClient : public ::testing::Test {
 protected:
  [[nodiscard]] Answer felt_at(double height_m) const {
    return scene::SceneState(scene, 3).answer(scene::Point(0, 0, height_m), now, {}, false, handle);
  }

  RequestRendering::Request tick() {
    now += 1ms;
    const Vector tip_m = scene::Point(0, 0, kNow_m);
    return rendering.render(newest, {.now = now,
                                     .read_at = now,
                                     .elapsed_s = 1e-3,
                                     .position = tip_m,
                                     .place = tip_m,
                                     .share = 1,
                                     .handle = handle,
                                     .arm_m = arm_m});
  }

  void hand_over() {
    const handover::Announcement& a = packed->announcement();
    local.begin(1, {.manifest_sha256 = a.hash,
                    .manifest_bytes = static_cast<std::uint32_t>(a.manifest_bytes),
                    .pieces = static_cast<std::uint32_t>(a.pieces)});
    local.builder().work();
    for (std::uint32_t i = 0; i < a.pieces; ++i)
      local.receive({.session = 1, .transmission = i + 1, .number = i, .content = packed->piece(i)});
    local.builder().work();
  }

  /// About the grip.
  [[nodiscard]] Eigen::Vector3d expected_N_m(const Answer& answer) const {
    return scene::Point(answer.torque_N_m) + arm_m.cross(scene::Point(answer.force));
  }

  static constexpr double kThen_m = -2e-3;
  static constexpr double kNow_m = -2.5e-3;
  std::shared_ptr<const scene::Scene> scene = handover::scene_of(
      "[tool]\ntip_m = [0, 0, -0.03]\nspacing_m = 0.02\ncontact = 'penalty'\n[[tool.part]]\nname = 'blade'\n"
      "shape = { kind = 'box', center_m = [0.005, 0, 0.002], size_m = [0.06, 0.02, 0.004] }\n"
      "[[object]]\nname = 'table'\nshape = { kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }\n"
      "effects = ['surface']\nsurface = { stiffness_N_per_m = 100 }\n");
  std::shared_ptr<const handover::PackedScene> packed = handover::pack(*scene);
  control::Handle handle{.orientation = control::orientation_of(control::turn_by(scene::Point(0.02, 0.05, 0.3)))};
  Eigen::Vector3d arm_m = control::quaternion_of(*handle.orientation) * scene::Point(0, 0, -0.03);
  LocalRendering local{{.degrees_of_freedom = 3}};
  RequestRendering rendering{&local, {.most = 8}, {.most = 0.3}};
  Nanoseconds now{1s};
  std::optional<wire::EnvironmentForce> newest = [this] {
    wire::EnvironmentForce force;
    force.session = 1;
    force.motion_sequence = 1;
    force.motion_device_time = now;
    force.position = scene::Point(0, 0, kThen_m);
    force.answer = felt_at(kThen_m);
    return force;
  }();
};

TEST_F(AToolAtTheClient, TurnsTheHandAsTheServerSaysUntilItsSceneRunsThere) {
  const RequestRendering::Request request = tick();
  EXPECT_FALSE(request.local);
  EXPECT_GT(newest->answer.torque_N_m.norm(), 1e-3) << "or it is not askew";
  EXPECT_LT((request.torque_N_m - expected_N_m(newest->answer)).norm(), 1e-12);
}

TEST_F(AToolAtTheClient, GoesOnFromThatWithoutAJumpToWhatItsSceneSays) {
  const RequestRendering::Request before = tick();
  hand_over();
  const Answer truth = felt_at(kNow_m);
  const double way_N_m = (expected_N_m(truth) - before.torque_N_m).norm();
  ASSERT_GT(way_N_m, 1e-3);
  const RequestRendering::Request first = tick();
  ASSERT_TRUE(first.local);
  EXPECT_LT((first.torque_N_m - before.torque_N_m).norm(), 1e-9 + 0.01 * way_N_m);
  RequestRendering::Request last = first;
  for (int i = 0; i < 12; ++i) {
    const RequestRendering::Request next = tick();
    EXPECT_LT((next.torque_N_m - last.torque_N_m).norm(), 0.11 * way_N_m) << i;
    last = next;
  }
  EXPECT_LT((last.torque_N_m - expected_N_m(truth)).norm(), 1e-12);
  EXPECT_LT((scene::Point(last.force_N) - scene::Point(truth.force)).norm(), 1e-12);
}

TEST_F(AToolAtTheClient, StaysWhereTheServerIsSilent) {
  (void)tick();
  hand_over();
  for (int i = 0; i < 500; ++i) (void)tick();
  EXPECT_LT((tick().torque_N_m - expected_N_m(felt_at(kNow_m))).norm(), 1e-12);
}

}  // namespace
}  // namespace forcebound::client
