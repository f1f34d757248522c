#include "forcebound/server/environment/scene_environment.hpp"

#include <algorithm>
#include <utility>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/explain.hpp"

namespace forcebound::server {
namespace {

class SceneEnvironment final : public Environment {
 public:
  explicit SceneEnvironment(scene::SceneState state) : state_(std::move(state)) {}

  Response respond(const Motion& motion) noexcept override {
    const scene::SceneAnswer answer = state_.answer(motion.position, motion.device_time, motion.server_time);
    const auto wave = [&](int i) {
      const bool any = answer.texture.amplitude_N > 0 && i < answer.texture.waves;
      return any ? state_.in_device_rows(answer.texture.waves_rad_per_m.at(static_cast<std::size_t>(i))) : Vector();
    };
    return {.force = answer.force,
            .contact_normal = answer.contact_normal,
            .penetration_m = answer.penetration_m,
            .texture_N = answer.texture.amplitude_N,
            .texture_wave = wave(0),
            .texture_across = wave(1),
            .quarantined = answer.quarantined};
  }

  EnvironmentFaults faults() const noexcept override {
    const scene::SceneFaults& faults = state_.faults();
    return {.old_normals = faults.old_normals,
            .quarantined = faults.quarantined,
            .contacts_left_out = faults.dynamic_models.contacts_left_out,
            .not_converged = faults.dynamic_models.not_converged,
            .slipped_s = faults.dynamic_models.slipped_s};
  }

 private:
  scene::SceneState state_;
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

MadeEnvironment made(const scene::Scene& scene, scene::SceneState state) {
  return {.environment = std::make_unique<SceneEnvironment>(std::move(state)),
          .simulated = summary(scene),
          .hash = scene.facts().hash};
}

}  // namespace

EnvironmentKind scene_environment(const std::shared_ptr<const scene::Scene>& scene) {
  EnvironmentKind kind{.name = scene->facts().name,
                       .degrees_of_freedom = accepted_by(*scene),
                       .wants_round_trip = scene->accuracy() != nullptr,
                       .make = {}};
  if (scene->facts().shared) {
    kind.sessions_max = static_cast<std::size_t>(scene->facts().clients_max);
    kind.make = [scene, models = std::make_shared<SharedDynamicModels>()](const ClientFacts& client) {
      return made(*scene, models->enter(scene, client.degrees_of_freedom));
    };
    return kind;
  }
  if (const scene::AutoAccuracy* const accuracy = scene->accuracy()) {
    kind.make = [scene, accuracy](const ClientFacts& client) {
      const double round_trip_s = time::to_seconds(client.round_trip);
      const scene::AccuracyLevel& picked = accuracy->best(round_trip_s);
      MadeEnvironment level = made(*picked.scene, {picked.scene, client.degrees_of_freedom});
      level.choice = accuracy->text(picked, round_trip_s);
      return level;
    };
    return kind;
  }
  kind.make = [scene](const ClientFacts& client) { return made(*scene, {scene, client.degrees_of_freedom}); };
  return kind;
}

}  // namespace forcebound::server
