#pragma once

#include <utility>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/offer/environment.hpp"

namespace forcebound::server {

/// The answers of one client's state of a scene. Real time, as SceneState.
class SceneAnswers : public Environment {
 public:
  explicit SceneAnswers(scene::SceneState state) : state_(std::move(state)) {}

  [[nodiscard]] std::size_t sample(std::size_t group, std::size_t first, std::span<float> to) const noexcept override {
    return state_.sample(group, first, to);
  }

  [[nodiscard]] Answer respond(const Motion& motion) noexcept override {
    return state_.answer(motion.position, motion.device_time, motion.server_time, motion.wants_model, motion.handle);
  }

  [[nodiscard]] std::span<const std::string* const> quarantined() const noexcept override {
    return state_.quarantined();
  }

  [[nodiscard]] EnvironmentFaults faults() const noexcept override {
    const scene::SceneFaults& faults = state_.faults();
    return {.old_normals = faults.old_normals,
            .quarantined = faults.quarantined,
            .contacts_left_out = faults.dynamic_models.contacts_left_out,
            .not_converged = faults.dynamic_models.not_converged,
            .slipped_s = faults.dynamic_models.slipped_s};
  }

 protected:
  [[nodiscard]] const scene::SceneState& state() const noexcept { return state_; }

 private:
  scene::SceneState state_;
};

}  // namespace forcebound::server
