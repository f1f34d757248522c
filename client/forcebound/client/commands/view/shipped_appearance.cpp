#include "forcebound/client/commands/view/shipped_appearance.hpp"

#include <algorithm>
#include <exception>
#include <memory>
#include <stdexcept>

#include "forcebound/server/environment/scene_environment.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/view/shown_scene.hpp"

namespace forcebound::client::commands {
namespace {

view::ShownScene appearance_of(const std::shared_ptr<const scene::Scene>& scene, int degrees_of_freedom) {
  const auto rows = static_cast<std::uint32_t>(degrees_of_freedom);
  if (!scene->accepts(rows)) {
    throw std::invalid_argument("scene '" + scene->facts().name + "' is for devices of " +
                                scene->accepted_degrees_of_freedom() + " degrees of freedom, the recorded one has " +
                                std::to_string(degrees_of_freedom));
  }
  const server::MadeEnvironment made = server::scene_environment(scene).make({.degrees_of_freedom = rows});
  const auto appearance = made.environment->appearance(view::Which::all);
  view::ShownScene shown = view::read_description(appearance->text)->shown;
  if (!appearance->moving.empty()) view::add_words(shown.more, "what moves is drawn as it begins: it is not recorded");
  return shown;
}

bool is_of_robot(const Recorded& recorded) {
  return std::ranges::any_of(
      recorded.forces, [](const client::ForceSample& force) { return force.follower != control::FollowerState::none; });
}

}  // namespace

std::string scene_message_of(const Recorded& recorded, const std::string& file) {
  if (!file.empty())
    return view::scene_message(0, appearance_of(server::load_scene(file), recorded.degrees_of_freedom));
  view::ShownScene shown{.name = recorded.scene()};
  try {
    const auto scene = server::SceneLibrary::shipped().find(shown.name);
    if (scene) return view::scene_message(0, appearance_of(scene, recorded.degrees_of_freedom));
    if (is_of_robot(recorded)) {
      shown.more = "work of a robot: where arm and surroundings were is not in the recording";
      return view::scene_message(0, shown);
    }
    shown.more =
        "no scene ships under that name, and this page does not read the shapes in recordings; --scene FILE.toml shows "
        "it";
  } catch (const std::exception& error) {
    shown.more = error.what();
  }
  return view::scene_message(0, shown);
}

}  // namespace forcebound::client::commands
