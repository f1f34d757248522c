#pragma once

#include <memory>
#include <string>
#include <utility>

#include "forcebound/scene/scene.hpp"

namespace forcebound::test {

/// Pushes along z with 1 N, and is sound for three steps only.
class FrailModel final : public scene::DynamicModel {
 public:
  [[nodiscard]] std::unique_ptr<scene::DynamicModelState> make_state(int) const override {
    return std::make_unique<State>();
  }
  [[nodiscard]] scene::DynamicModelFacts facts() const override { return {}; }

 private:
  class State final : public scene::DynamicModelState {
   public:
    int join() override { return 0; }
    void leave(int) override {}
    void move(int, const scene::Point&, const scene::Point&) noexcept override {}
    void advance(double) noexcept override { ++moments_; }
    scene::ModelTouch touch(int) noexcept override { return {.force_N = scene::Point(0, 0, 1)}; }
    [[nodiscard]] bool sound() const noexcept override { return moments_ <= 3; }

   private:
    int moments_ = 0;
  };
};

/// A scene of such dynamic models.
inline std::shared_ptr<const scene::Scene> frail_scene(const scene::SceneFacts& facts,
                                                       std::initializer_list<std::string> names) {
  scene::SceneParts parts;
  for (const std::string& name : names) {
    parts.dynamic_models.push_back({.name = name, .text = "frail", .dynamic_model = std::make_unique<FrailModel>()});
  }
  return std::make_shared<const scene::Scene>(facts, std::move(parts));
}

}  // namespace forcebound::test
