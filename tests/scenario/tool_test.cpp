// Scenes with a tool that has a shape, on the arm that shows torques.
//
//   arm-6dof, press and turn -- session ==( 100 ms each way )== server, peg_in_hole or blade

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

#include "forcebound/control/rotation.hpp"
#include "forcebound/control/translation.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

/// The scene is at the client by then. What touched before may lie on another side there: it jams or it enters.
constexpr int kFrom_s = 1;

/// What the scene says of the pose of each tick, beside what was asked for.
class WrenchMeter final : public record::TickSink {
 public:
  explicit WrenchMeter(const std::shared_ptr<const scene::Scene>& scene)
      : tool_m_(scene->facts().tool_m), truth_(scene, 3) {}

  void on_tick(const record::TickRecord& tick) noexcept override {
    if (!tick.handle.orientation) return;
    const Eigen::Vector3d arm_m = control::quaternion_of(*tick.handle.orientation) * control::translation_of(tool_m_);
    const scene::Answer truth = truth_.answer(tick.position + arm_m, tick.time, {}, false, tick.handle);
    const Eigen::Vector3d force_N = control::translation_of(truth.force);
    const Eigen::Vector3d torque_N_m = control::translation_of(truth.torque_N_m) + arm_m.cross(force_N);
    contacts = std::max(contacts, truth_.contacts());
    if (time::to_seconds(tick.time) < kFrom_s || tick.request.rows() != 3 || tick.request_torque_N_m.rows() != 3)
      return;
    force_ += force_N.squaredNorm();
    torque_ += torque_N_m.squaredNorm();
    force_off_ += (tick.request - force_N).squaredNorm();
    torque_off_ += (tick.request_torque_N_m - torque_N_m).squaredNorm();
  }

  [[nodiscard]] double force_error() const { return std::sqrt(force_off_ / force_); }
  [[nodiscard]] double torque_error() const { return std::sqrt(torque_off_ / torque_); }
  [[nodiscard]] double torque_sum() const { return torque_; }

  std::size_t contacts = 0;

 private:
  control::Vector tool_m_;
  scene::SceneState truth_;
  double force_ = 0;
  double torque_ = 0;
  double force_off_ = 0;
  double torque_off_ = 0;
};

struct Played {
  WrenchMeter meter;
  double minimum_J = 0;
};

Played play(const std::string& name, const std::string& law, bool locally) {
  const auto scene = server::load_scene(name);
  Played played{.meter = WrenchMeter(scene)};
  ClosedLoop::Settings settings{.device = device::load_device("arm-6dof"),
                                .hand = server::suggested_hand(scene).hand + ",wait_s=" + std::to_string(kFrom_s),
                                .law = law,
                                .scene = scene,
                                .seed = 1};
  settings.renders_locally = locally;
  settings.network.up.delay.mean = 100ms;
  settings.network.down.delay.mean = 100ms;
  ClosedLoop loop(std::move(settings), {&played.meter});
  loop.run(8s);
  played.minimum_J = nlohmann::json::parse(loop.close().to_json())["passivity"]["minimum_J"].get<double>();
  return played;
}

class ASceneWithATool : public testing::TestWithParam<std::tuple<const char*, bool>> {};

TEST_P(ASceneWithATool, StaysPassiveOnSixAxesThroughATenthOfASecond) {
  const auto& [scene, locally] = GetParam();
  const Played played = play(scene, "fba-exact", locally);
  EXPECT_GE(played.minimum_J, -1e-9);
  EXPECT_GT(played.meter.contacts, 1U);
  EXPECT_GT(played.meter.torque_sum(), 1e-3) << "or nothing turned the hand";
}

INSTANTIATE_TEST_SUITE_P(Scenes, ASceneWithATool,
                         testing::Combine(testing::Values("peg_in_hole", "blade"), testing::Bool()),
                         [](const auto& named) {
                           return std::string(std::get<0>(named.param)) +
                                  (std::get<1>(named.param) ? "_locally" : "_remotely");
                         });

TEST(AToolInTheHand, IsAskedForAtTheClientAsWithoutANetwork) {
  for (const char* const scene : {"peg_in_hole", "blade"}) {
    const Played played = play(scene, "fba-exact", true);
    EXPECT_LT(played.meter.force_error(), 0.02) << scene;
    EXPECT_LT(played.meter.torque_error(), 0.02) << scene;
  }
}

TEST(AToolInTheHand, WithoutALawIsNotPassive) { EXPECT_LT(play("blade", "none", false).minimum_J, -1e-3); }

}  // namespace
}  // namespace forcebound::sim
