#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/support/hand_on_surface.hpp"
#include "tests/tools/lab/accuracy/study.hpp"
#include "tests/tools/lab/rendering/rendering_study.hpp"
#include "tests/tools/lab/soak/soak.hpp"
#include "tests/tools/lab/soak/soak_case.hpp"
#include "tests/tools/lab/trials/option_checks.hpp"
#include "tests/tools/lab/trials/trials.hpp"

// Every scene that ships on every device that ships and that it accepts, for a tenth of a second; what it does not
// accept is refused in one line. The live page does the same in tests/process, the Python package in tests/python.
namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr double kRun_s = 0.1;

class EveryShippedScene : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    try {
      scene = server::load_scene(GetParam());
    } catch (const server::SceneError& error) {
      const std::string why = error.what();
      ASSERT_THAT(why, HasSubstr("MuJoCo"));
      GTEST_SKIP() << why;
    }
  }

  /// @param run of a device, and of a hand that moves from its first ticks on, through a surface of the scene
  void on_every_device(
      const std::function<void(const device::DeviceDescription&, const std::string& hand)>& run) const {
    for (const std::string& name : device::shipped_device_names()) {
      SCOPED_TRACE("device " + name);
      const device::DeviceDescription device = device::load_device(name);
      if (!scene->accepts(static_cast<std::uint32_t>(device.facts.translations()))) continue;
      ASSERT_NO_THROW(run(device, hand_on(device.facts)));
    }
  }

  std::shared_ptr<const scene::Scene> scene;

 private:
  [[nodiscard]] std::string hand_on(const control::DeviceFacts& facts) const {
    std::string hand = "wave:amplitude_m=0.2,frequency_Hz=5";
    if (facts.rotations > 0) hand += ",turn_x_rad=0.5,turn_y_rad=0.5,turn_Hz=2";
    return hand + test::offset_on_surface(*scene, facts.translations());
  }
};

TEST_P(EveryShippedScene, IsPlayedInTrials) {
  on_every_device([&](const device::DeviceDescription& device, const std::string& hand) {
    const std::vector<PlayedTrial> trials = play_trials({.scene = GetParam(),
                                                         .device = device.facts.name,
                                                         .hand = hand,
                                                         .network = "delay 5ms",
                                                         .laws = {"fba-exact"},
                                                         .duration_s = kRun_s},
                                                        nullptr, [](double) {});
    ASSERT_EQ(trials.size(), 3U);
    for (const PlayedTrial& trial : trials) EXPECT_EQ(trial.summary["ticks"], 100) << trial.rendering;
  });
}

TEST_P(EveryShippedScene, IsStudiedForAccuracy) {
  const server::SceneSource source = server::scene_source(GetParam());
  on_every_device([&](const device::DeviceDescription& device, const std::string& hand) {
    try {
      const StudyResult result = carry_out({.scene_text = source.text,
                                            .scene_file = source.file,
                                            .sweep = parse_sweep("rendering=remote,local"),
                                            .round_trips_s = {0.005},
                                            .hand = hand,
                                            .device = device.facts.name,
                                            .duration_s = kRun_s},
                                           time::SteadyClock());
      EXPECT_EQ(result.settings.size(), 2U);
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), AllOf(StartsWith("the hand never touches the scene"), Not(HasSubstr("\n"))));
    }
  });
}

TEST_P(EveryShippedScene, IsRenderedRemotelyAndLocally) {
  on_every_device([&](const device::DeviceDescription& device, const std::string& hand) {
    const RenderingTask task{.name = GetParam(), .group = {}, .scene = scene, .device = device, .make_hand = [&] {
                               return device::make_operator(hand, device.facts);
                             }};
    for (const bool local : {false, true}) {
      const RenderingFigures figures =
          play_rendering(task, {.name = "5 ms", .kind = "delays", .network = network_of("delay 5ms").settings},
                         {.run = time::from_seconds(kRun_s)}, local, 1);
      EXPECT_GE(figures.minimum_J, -1e-9);
    }
  });
}

TEST_P(EveryShippedScene, BreaksNoInvariantOfASoak) {
  std::uint64_t seed = 1;
  on_every_device([&](const device::DeviceDescription& device, const std::string& hand) {
    SoakCase drawn = draw_soak_case(seed++, "fba-exact");
    SCOPED_TRACE(drawn.description());
    sim::ClosedLoop::Settings& settings = drawn.settings;
    const control::Uncertainty uncertainty = settings.device.facts.uncertainty;
    settings.device = device;
    settings.device.facts.uncertainty = uncertainty;
    settings.make_hand = [&] { return device::make_operator(hand, device.facts); };
    settings.scene = scene;
    settings.network = {};
    settings.faults.clear();
    drawn.duration = time::from_seconds(kRun_s);
    EXPECT_EQ(soak(drawn).broken, "");
  });
}

TEST_P(EveryShippedScene, RefusesADeviceOfOtherAxesInOneLine) {
  for (const std::string& name : device::shipped_device_names()) {
    SCOPED_TRACE("device " + name);
    if (scene->accepts(static_cast<std::uint32_t>(device::load_device(name).facts.translations()))) {
      EXPECT_NO_THROW(expect_accepted(*scene, name));
    } else {
      EXPECT_THAT([&] { expect_accepted(*scene, name); },
                  testing::ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("'" + name + "' has "),
                                                                      HasSubstr("scene '" + GetParam() + "' accepts "),
                                                                      Not(HasSubstr("\n")))));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryShippedScene, testing::ValuesIn(server::SceneLibrary::shipped().all_names()),
                         [](const auto& named) { return named.param; });

}  // namespace
}  // namespace forcebound::lab
