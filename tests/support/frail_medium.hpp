#pragma once

#include <memory>
#include <string>
#include <utility>

#include "forcebound/server/scene/scene.hpp"

namespace forcebound::test {

/// Pushes along z with 1 N, and is sound for three moments.
class FrailMedium final : public server::Medium {
 public:
  [[nodiscard]] std::unique_ptr<server::MediumState> make_state(int) const override {
    return std::make_unique<State>();
  }
  [[nodiscard]] server::MediumFacts facts() const override { return {}; }

 private:
  class State final : public server::MediumState {
   public:
    int join() override { return 0; }
    void leave(int) override {}
    void move(int, const server::Point&, const server::Point&) noexcept override {}
    void advance(double) noexcept override { ++moments_; }
    server::MediumTouch touch(int) noexcept override { return {.force_N = server::Point(0, 0, 1)}; }
    [[nodiscard]] bool sound() const noexcept override { return moments_ <= 3; }

   private:
    int moments_ = 0;
  };
};

/// A scene of such media.
inline std::shared_ptr<const server::Scene> frail_scene(const server::SceneFacts& facts,
                                                        std::initializer_list<std::string> names) {
  server::SceneParts parts;
  for (const std::string& name : names) {
    parts.media.push_back({.name = name, .text = "frail", .medium = std::make_unique<FrailMedium>()});
  }
  return std::make_shared<const server::Scene>(facts, std::move(parts));
}

}  // namespace forcebound::test
