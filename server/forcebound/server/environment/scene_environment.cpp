#include "forcebound/server/environment/scene_environment.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/server/environment/explain.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"
#include "forcebound/server/offer/scene_answers.hpp"
#include "forcebound/view/shown_scene.hpp"

namespace forcebound::server {
namespace {

/// How a scene looks is made once somebody asks, for all of its clients.
struct Appearance {
  std::shared_ptr<const view::Description> all{};
  std::shared_ptr<const view::Description> not_handed_over{};
};

view::Description describe(const scene::SceneState& state, view::Which which) {
  const scene::Scene& scene = state.scene();
  std::vector<std::vector<scene::VisiblePart>> models;
  for (const auto& model : state.dynamic_models()) {
    models.push_back(model->state().visible());
    const std::string& name = model->dynamic_model().name;
    for (scene::VisiblePart& part : models.back()) {
      if (part.kind == scene::VisiblePart::Kind::surface) part.name = name;
    }
  }
  view::ShownScene shown = view::shown(scene, which);
  shown.begin_m = place_to_begin(scene);
  return view::describe(std::move(shown), models);
}

class SceneEnvironment final : public SceneAnswers {
 public:
  SceneEnvironment(scene::SceneState state, std::shared_ptr<Appearance> appearance, bool shows_torque)
      : SceneAnswers(std::move(state)), appearance_(std::move(appearance)), shows_torque_(shows_torque) {}

  std::shared_ptr<const view::Description> appearance(view::Which which) override {
    auto& made = which == view::Which::all ? appearance_->all : appearance_->not_handed_over;
    if (!made) made = std::make_shared<const view::Description>(describe(state(), which));
    return made;
  }

  Answer respond(const Motion& motion) noexcept override {
    Answer answer = SceneAnswers::respond(motion);
    if (!shows_torque_) answer.torque_N_m.resize(0);
    return answer;
  }

 private:
  std::shared_ptr<Appearance> appearance_;
  bool shows_torque_;
};

/// The dynamic models of a shared scene, kept as long as a client uses them.
class SharedDynamicModels {
 public:
  scene::SceneState enter(const std::shared_ptr<const scene::Scene>& scene, std::uint32_t degrees_of_freedom) {
    scene::DynamicModelsNow there;
    for (const auto& model : last_begun_) there.push_back(model.lock());
    const bool can_be_entered = !there.empty() && std::ranges::all_of(there, [](const auto& model) {
      return model != nullptr && model->state().sound();
    });
    if (can_be_entered) return {scene, degrees_of_freedom, there};
    there = scene::begin_dynamic_models(*scene, scene->facts().clients_max);
    last_begun_.assign(there.begin(), there.end());
    return {scene, degrees_of_freedom, there};
  }

 private:
  std::vector<std::weak_ptr<scene::DynamicModelNow>> last_begun_;
};

std::vector<std::uint32_t> accepted_by(const scene::Scene& scene) {
  std::vector<std::uint32_t> accepted;
  for (std::uint32_t rows = 1; rows <= control::kDofMax; ++rows) {
    if (scene.accepts(rows)) accepted.push_back(rows);
  }
  // All of them is "any".
  if (accepted.size() == control::kDofMax) accepted.clear();
  return accepted;
}

/// What is made of a scene once, for all of its clients.
struct Shared {
  explicit Shared(const scene::Scene& scene) : packed(handover::pack(scene)) {}
  std::shared_ptr<const handover::PackedScene> packed;
  std::shared_ptr<Appearance> appearance = std::make_shared<Appearance>();
};

MadeEnvironment made(const scene::Scene& scene, const Shared& shared, scene::SceneState state, bool shows_torque) {
  return {.environment = std::make_unique<SceneEnvironment>(std::move(state), shared.appearance, shows_torque),
          .simulated = summary(scene),
          .hash = scene.facts().hash,
          .packed = shared.packed,
          .least_rendering = scene.least_rendering(),
          .tool_m = scene.facts().tool_m};
}

}  // namespace

EnvironmentKind scene_environment(const std::shared_ptr<const scene::Scene>& scene) {
  EnvironmentKind kind{.name = scene->facts().name,
                       .degrees_of_freedom = accepted_by(*scene),
                       .wants_round_trip = scene->accuracy() != nullptr,
                       .make = {}};
  if (scene->facts().shared) {
    kind.sessions_max = static_cast<std::size_t>(scene->facts().clients_max);
    kind.make = [scene, shared = Shared(*scene),
                 models = std::make_shared<SharedDynamicModels>()](const ClientFacts& client) {
      return made(*scene, shared, models->enter(scene, client.degrees_of_freedom), client.shows_torque);
    };
    return kind;
  }
  if (const scene::AutoAccuracy* const accuracy = scene->accuracy()) {
    std::map<const scene::Scene*, Shared> of_levels;
    for (const scene::AccuracyLevel& level : accuracy->levels) of_levels.emplace(level.scene.get(), *level.scene);
    kind.make = [scene, accuracy, of_levels = std::move(of_levels)](const ClientFacts& client) {
      const scene::AutoAccuracy::Client asking{.round_trip_s = time::to_seconds(client.round_trip),
                                               .renders_locally = client.renders_locally};
      const scene::AccuracyLevel& picked = accuracy->best(asking);
      MadeEnvironment level = made(*picked.scene, of_levels.at(picked.scene.get()),
                                   {picked.scene, client.degrees_of_freedom}, client.shows_torque);
      level.choice = accuracy->text(picked, asking);
      return level;
    };
    return kind;
  }
  kind.make = [scene, shared = Shared(*scene)](const ClientFacts& client) {
    return made(*scene, shared, {scene, client.degrees_of_freedom}, client.shows_torque);
  };
  return kind;
}

}  // namespace forcebound::server
