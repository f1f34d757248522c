#include "forcebound/client/page/known_scenes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>

#include "forcebound/client/page/scene_files.hpp"
#include "forcebound/config/node.hpp"
#include "forcebound/device/simulated/make_operator.hpp"

namespace forcebound::client {
namespace {

constexpr int kSpace = 3;
constexpr int kSpaceAndRotation = 6;

std::vector<KnownScene> read_scenes() {
  std::vector<KnownScene> scenes;
  for (const text::EmbeddedText& file : scene_files()) {
    const config::Node root = config::parse_toml(file.text, std::string(file.name) + ".toml");
    const config::Node* const facts = root.find("scene");
    if (facts == nullptr) continue;
    KnownScene scene{.name = facts->text_at("name"),
                     .degrees_of_freedom = kSpace,
                     .device = facts->text_at("suggested_device"),
                     .hand = facts->text_at("suggested_hand")};
    if (const config::Node* const rows = facts->find("degrees_of_freedom")) {
      const auto* const number = rows->as<std::int64_t>();
      scene.degrees_of_freedom = number == nullptr ? 0 : static_cast<int>(*number);
    }
    if (const config::Node* const shared = facts->find("shared")) {
      const bool* const flag = shared->as<bool>();
      scene.shared = flag != nullptr && *flag;
    }
    scenes.push_back(std::move(scene));
  }
  std::ranges::sort(scenes, {}, &KnownScene::name);
  return scenes;
}

}  // namespace

bool KnownScene::accepts(int device_degrees_of_freedom) const noexcept {
  if (degrees_of_freedom == 0 || degrees_of_freedom == device_degrees_of_freedom) return true;
  return degrees_of_freedom == kSpace && device_degrees_of_freedom == kSpaceAndRotation;
}

const std::vector<KnownScene>& known_scenes() {
  static const std::vector<KnownScene> kScenes = read_scenes();
  return kScenes;
}

std::string device_for(const KnownScene& scene) {
  if (!scene.device.empty()) return scene.device;
  if (scene.degrees_of_freedom == 1) return "wall-1dof";
  return scene.degrees_of_freedom == 2 ? "cartesian-2dof" : "omni";
}

control::Vector start_in(const KnownScene* scene, int device_degrees_of_freedom) {
  if (scene != nullptr && !scene->hand.empty()) {
    try {
      return device::make_operator(scene->hand, device_degrees_of_freedom)->target(0).position;
    } catch (const std::invalid_argument&) {
      // It is for devices of other degrees of freedom.
    }
  }
  constexpr std::array<double, 3> kStart_m{-0.02, 0, 0.03};
  control::Vector start = control::Vector::Zero(device_degrees_of_freedom);
  const auto axes = std::min<Eigen::Index>(start.rows(), std::ssize(kStart_m));
  for (Eigen::Index i = 0; i < axes; ++i) start[i] = kStart_m[static_cast<std::size_t>(i)];
  return start;
}

const KnownScene* find_known_scene(const std::string& name) {
  const auto& scenes = known_scenes();
  const auto found = std::ranges::find(scenes, name, &KnownScene::name);
  return found == scenes.end() ? nullptr : &*found;
}

}  // namespace forcebound::client
