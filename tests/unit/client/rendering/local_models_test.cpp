#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"
#include "tests/tools/sim/dragged_puck.hpp"
#include "tests/unit/client/rendering/stroked_loop.hpp"
#include "tests/unit/handover/handed_over.hpp"

namespace forcebound::sim {
namespace {

constexpr const char* kPad = R"(
[[tissue]]
name = 'pad'
shape = { kind = 'block', center_m = [0, 0, -0.02], size_m = [0.1, 0.1, 0.04], cells = [4, 4, 2] }
held = { through_m = [0, 0, -0.039], normal = [0, 0, 1] }
young_Pa = 5000
poisson = 0.4
contact_stiffness_N_per_m = 500
)";

TEST(LocalRendering, RunsTissueThatOneClientHasAlone) {
  const auto scene = handover::scene_of(std::string(kFrictionPlane) + kPad);
  ASSERT_EQ(scene->rendering_of_part(1).how, scene::Rendering::at_client);
  ClosedLoop loop(settings(scene, "delay 50ms", true), {});
  loop.run(3s);
  const json summary = summary_of(loop);
  EXPECT_GT(summary["rendering"]["at_client"].get<double>(), 0.3);
  EXPECT_EQ(summary["rendering"]["modelled"].get<double>(), 0);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

TEST(LocalRendering, AddsTissueThatBendsFarByItsLocalModel) {
  const auto scene = handover::scene_of(std::string(kFrictionPlane) + kPad + "large_motion = true\n");
  ASSERT_EQ(scene->rendering_of_part(1).how, scene::Rendering::modelled);
  Watch watch;
  ClosedLoop loop(settings(scene, "delay 10ms", true), {&watch});
  loop.run(3s);
  const json summary = summary_of(loop);
  EXPECT_GT(summary["rendering"]["modelled"].get<double>(), 0.3);
  EXPECT_LT(summary["rendering"]["held"].get<double>(), 0.3);
  EXPECT_GT(summary["rendering"]["model_trust"].get<double>(), 0.5);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

/// Where the device was on each tick.
class Path final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    if (tick.position.rows() == 3) heights_m.push_back(tick.position[2]);
  }
  std::vector<double> heights_m;
};

double rms_apart_m(const Path& one, const Path& other) {
  const std::size_t ticks = std::min(one.heights_m.size(), other.heights_m.size());
  double sum = 0;
  for (std::size_t i = 0; i < ticks; ++i) sum += std::pow(one.heights_m[i] - other.heights_m[i], 2);
  return std::sqrt(sum / static_cast<double>(ticks));
}

json play(const std::shared_ptr<const scene::Scene>& scene, const std::string& netem, bool local, Path& path) {
  ClosedLoop loop(settings(scene, netem, local), {&path});
  loop.run(4s);
  return summary_of(loop);
}

/// Behind 50 ms each way, with loss, local rendering leads the hand within a tenth of what held forces lead it off.
/// @param play a hand behind that network, with local rendering or not, along the path
/// @returns the summary with local rendering
json expect_much_as_without_a_network(const std::function<json(const std::string&, bool, Path&)>& play) {
  constexpr const char* kFar = "delay 50ms 5ms loss 5%";
  Path near;
  Path far;
  Path held;
  (void)play("", false, near);
  json summary = play(kFar, true, far);
  (void)play(kFar, false, held);
  EXPECT_LT(rms_apart_m(far, near), 0.1 * rms_apart_m(held, near));
  return summary;
}

//   firm device, stroke -- session ==( 50 ms each way, loss )== server -- pad
TEST(LocalRendering, LetsAHandGoOnAPadBehindATenthOfASecondMuchAsWithoutANetwork) {
  const auto scene = handover::scene_of(R"(
[[tissue]]
name = 'pad'
shape = { kind = 'block', center_m = [0, 0, -0.02], size_m = [0.1, 0.1, 0.04], cells = [4, 4, 2] }
held = { through_m = [0, 0, -0.039], normal = [0, 0, 1] }
young_Pa = 20000
poisson = 0.4
contact_stiffness_N_per_m = 2000
)");
  const json summary = expect_much_as_without_a_network(
      [&](const std::string& netem, bool local, Path& path) { return play(scene, netem, local, path); });
  EXPECT_GT(summary["rendering"]["at_client"].get<double>(), 0.8);
  EXPECT_EQ(summary["faults"]["models_refused"], 0);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

//   firm device, stroke -- session ==( 50 ms each way, loss )== server -- puck on its coupling, stop
TEST(LocalRendering, LetsAHandPushABodyAgainstAStopBehindATenthOfASecondMuchAsWithoutANetwork) {
  if (!server::has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  const auto scene = handover::scene_of(dragged_puck(true));
  const json summary = expect_much_as_without_a_network(
      [&](const std::string& netem, bool local, Path& path) { return play(scene, netem, local, path); });
  EXPECT_GT(summary["rendering"]["modelled"].get<double>(), 0.5);
  EXPECT_EQ(summary["faults"]["models_refused"], 0);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

//   firm device, the scene's own hand -- session, scene ==( 50 ms each way, loss )== server -- dome
TEST(LocalRendering, LetsAHandStrokeTheDomeThatShipsBehindATenthOfASecondMuchAsWithoutANetwork) {
  const auto scene = server::load_scene("dome");
  const server::SuggestedHand suggested = server::suggested_hand(scene);
  const auto run = [&](const std::string& netem, bool local, Path& path) {
    ClosedLoop::Settings with_hand = settings(scene, netem, local, suggested.hand);
    with_hand.device = device::load_device(suggested.device);
    ClosedLoop loop(std::move(with_hand), {&path});
    loop.run(5s);
    return summary_of(loop);
  };
  const json summary = expect_much_as_without_a_network(run);
  EXPECT_GT(summary["rendering"]["at_client"].get<double>(), 0.8);
  EXPECT_EQ(summary["faults"]["scenes_refused"], 0);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

}  // namespace
}  // namespace forcebound::sim
