#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <set>
#include <span>
#include <stdexcept>
#include <string>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/support/hand_on_surface.hpp"
#include "tests/support/scene_files.hpp"
#include "tests/tools/sim/closed_loop.hpp"

// A run in virtual time has the same digits whatever has compiled it: one hash for each scene and each law, for g++ and
// clang++, with and without sanitizers, on every Debian.
namespace forcebound {
namespace {

using namespace std::chrono_literals;

/// FNV-1a of what is felt.
class TrajectoryHash final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    add(tick.position);
    add(tick.applied);
    add(tick.energy_J);
    add(tick.audit_J);
  }
  [[nodiscard]] std::string text() const {
    std::array<char, 20> digits{};
    std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(hash_));
    return digits.data();
  }

 private:
  void add(const control::Vector& vector) noexcept {
    for (const double number : std::span(vector.data(), static_cast<std::size_t>(vector.rows()))) add(number);
  }
  void add(double number) noexcept {
    std::array<unsigned char, sizeof number> bytes{};
    std::memcpy(bytes.data(), &number, sizeof number);
    for (const unsigned char byte : bytes) hash_ = (hash_ ^ byte) * 0x100000001b3U;
  }

  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

struct Run {
  const char* scene;
  const char* law;
  const char* hash;
};

std::string name_of(const testing::TestParamInfo<Run>& info) {
  std::string name = std::string(info.param.scene) + "_" + info.param.law;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '-'; }, '_');
  return name;
}

/// A Cartesian device that the scene accepts: every law takes one.
device::DeviceDescription device_for(const scene::Scene& scene) {
  for (const char* const name : {"firm-3dof", "cartesian-2dof", "wall-1dof"}) {
    device::DeviceDescription device = device::load_device(name);
    if (scene.accepts(static_cast<std::uint32_t>(device.facts.translations()))) return device;
  }
  throw std::invalid_argument("no device for the scene");
}

class Trajectory : public testing::TestWithParam<Run> {};

TEST_P(Trajectory, HasTheDigitsThatItHasEverywhere) {
  std::shared_ptr<const scene::Scene> scene;
  try {
    scene = server::load_scene(GetParam().scene);
  } catch (const server::SceneError& error) {
    GTEST_SKIP() << error.what();
  }
  TrajectoryHash hash;
  const device::DeviceDescription device = device_for(*scene);
  sim::ClosedLoop::Settings settings{
      .device = device,
      .hand = "wave:amplitude_m=0.02,frequency_Hz=3" + test::offset_on_surface(*scene, device.facts.translations()),
      .law = GetParam().law,
      .scene = scene,
      .seed = 1};
  settings.network.up.delay.mean = 10ms;
  sim::ClosedLoop loop(std::move(settings), {&hash});
  loop.run(1s);
  EXPECT_EQ(hash.text(), GetParam().hash);
}

constexpr Run kRuns[] = {
    {"adhesion", "fba-exact", "98984020873f1eca"},
    {"assembly", "fba-exact", "e61b7b37c8fba046"},
    {"attractor", "fba-exact", "4af37e9a21b789ab"},
    {"blade", "fba-exact", "2c8d75356b588e90"},  // a tool, which a device that does not turn does not feel
    {"block_and_stop", "fba-exact", "752d0b177ef9a85e"},
    {"blocks", "fba-exact", "b46386e5a98821fb"},
    {"box", "fba-exact", "c61a49b701c43dff"},
    {"capsule", "fba-exact", "de67756b39ad63a5"},
    {"circle", "fba-exact", "31cca6f3a1d49053"},
    {"constant_force", "fba-exact", "b6e753d8b30039b4"},
    {"cylinder", "fba-exact", "ad8f6ff64bcaf1f2"},
    {"dome", "fba-exact", "8988ec57c92664ab"},
    {"drive", "fba-exact", "2c8d75356b588e90"},
    {"flap", "fba-exact", "978a31844e1b4d3e"},
    {"flow", "fba-exact", "0c54cae15cfed252"},
    {"free", "fba-exact", "2c8d75356b588e90"},
    {"friction", "fba-exact", "388ee5ceca7805a1"},
    {"grasp", "fba-exact", "2c8d75356b588e90"},
    {"gravity", "fba-exact", "44918fc03599d863"},
    {"guidance", "fba-exact", "cfd563790be8050c"},
    {"height_field", "fba-exact", "0bb7b260d7f4dfbc"},
    {"magnet", "fba-exact", "cd4b9025df4c523c"},
    {"microsurgery", "fba-exact", "6c6c2d60638096c2"},
    {"pad", "fba-exact", "b2df4942bfb078d3"},
    {"palpation", "fba-exact", "30b3d38e515a346a"},
    {"peg_in_hole", "fba-exact", "90c0aa3c8a1cb374"},
    {"pick_and_place", "fba-exact", "0704a167e2db85e8"},
    {"plane", "fba-exact", "4241d449cebd3273"},
    {"pottery", "fba-exact", "984ebb9dc94a1a04"},
    {"soft_pad", "fba-exact", "54cb72aac446b83c"},
    {"sphere", "fba-exact", "906646b310b6e182"},
    {"spring_to_line", "fba-exact", "dde33bc5ed01a4a1"},
    {"spring_to_plane", "fba-exact", "cdf1d5d8a8d78831"},
    {"spring_to_point", "fba-exact", "a24f856e828c5b05"},
    {"stick_slip", "fba-exact", "7b06ae657e43e88d"},
    {"texture", "fba-exact", "9bea817f0680c438"},
    {"torus", "fba-exact", "2c8d75356b588e90"},
    {"two_hands", "fba-exact", "6dbaa462de0c5b84"},
    {"two_on_a_block", "fba-exact", "166041fb7874bd19"},
    {"vibration", "fba-exact", "312995fe819cee47"},
    {"viscosity", "fba-exact", "7ffb0f4dc925c3f0"},
    {"wall", "fba-exact", "ae552addaaf950dd"},
    {"workspace_limit", "fba-exact", "2c8d75356b588e90"},
    {"sphere", "none", "6d7bf8d9823ea10b"},
    {"sphere", "fba-less", "0eb6d2b38228d10a"},
    {"sphere", "fba-more", "66dff000e0f02cad"},
    {"sphere", "aol", "7e5db06d82668d97"},
    {"sphere", "eba", "f402a433a8c140c3"},
    {"sphere", "iss", "bf9a44a281b67008"},
    {"sphere", "mbpa", "9055266ddc32ba69"},
    {"sphere", "pspm", "4cb3814ee20a9b7f"},
    {"sphere", "sfa", "4b9552390dcae1f1"},
    {"sphere", "tdpa", "18ddf238ca99e05a"},
    {"sphere", "tdpa-2port", "9514b90d3981a439"},
    {"sphere", "tdpa-er", "987264515a461bb8"},
    {"sphere", "tdpa-priority", "6075b5c1f015b423"},
    {"sphere", "tla", "5c035d205bd2b0bb"},
    {"sphere", "vc", "6d3d7a771734553f"},
    {"sphere", "wave", "8ea651dc8047008c"},
};

TEST(Trajectories, AreOfEverySceneAndEveryLawThatShip) {
  std::set<std::string> scenes;
  std::set<std::string> laws;
  for (const auto& run : kRuns) {
    scenes.insert(run.scene);
    laws.insert(run.law);
  }
  EXPECT_THAT(scenes, testing::ElementsAreArray(test::scene_files()));
  EXPECT_THAT(laws, testing::UnorderedElementsAreArray(baselines::shipped_laws().names()));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Trajectory, testing::ValuesIn(kRuns), name_of);

}  // namespace
}  // namespace forcebound
