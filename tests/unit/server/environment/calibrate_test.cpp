#include "forcebound/server/environment/calibrate.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/own_effects.hpp"

namespace forcebound::server {
namespace {

/// A clock that advances by 3200 ns at each reading.
class CountingClock final : public time::Clock {
 public:
  [[nodiscard]] time::Nanoseconds now() const noexcept override { return time::Nanoseconds{3200 * ++looks_}; }

 private:
  mutable std::int64_t looks_ = 0;
};

TEST(Calibrate, MeasuresEachPartAloneAndTheWhole) {
  const auto scene = test::scene_with_own_effects(test::table("table", "'surface'") +
                                                  "[[field]]\nname = 'fog'\neffects = ['clock']\n");
  const Calibration found = calibrate(scene, CountingClock());
  ASSERT_EQ(found.parts.size(), 2U);
  for (const MeasuredCost& cost : {found.parts[0], found.parts[1], found.whole}) {
    EXPECT_EQ(cost.median_ns, 100) << "32 motions between two looks at the clock";
    EXPECT_EQ(cost.p99_ns, 100);
  }
}

/// Counts how often it was asked for a local model.
class AskedModel final : public scene::DynamicModel {
 public:
  explicit AskedModel(int& asked) : asked_(asked) {}
  [[nodiscard]] std::unique_ptr<scene::DynamicModelState> make_state(int) const override {
    return std::make_unique<State>(asked_);
  }
  [[nodiscard]] scene::DynamicModelFacts facts() const override { return {}; }

 private:
  class State final : public scene::DynamicModelState {
   public:
    explicit State(int& asked) : asked_(asked) {}
    int join() override { return 0; }
    void leave(int) override {}
    void move(int, const scene::Point&, const scene::Point&) noexcept override {}
    void advance(double) noexcept override {}
    scene::ModelTouch touch(int) noexcept override { return {}; }
    [[nodiscard]] bool describe(int, local_model::LocalModel&) noexcept override {
      ++asked_;
      return false;
    }

   private:
    int& asked_;
  };

  int& asked_;
};

TEST(Calibrate, MeasuresWhatLocalModelsTakeToo) {
  int asked = 0;
  scene::SceneParts parts;
  parts.dynamic_models.push_back({.name = "asked", .text = "", .dynamic_model = std::make_unique<AskedModel>(asked)});
  const auto scene =
      std::make_shared<const scene::Scene>(scene::SceneFacts{.name = "asked", .description = ""}, std::move(parts));
  (void)calibrate(scene, CountingClock());
  EXPECT_GT(asked, 0);
}

TEST(Calibrate, OfAnEmptySceneHasOnlyTheWhole) {
  const Calibration found = calibrate(load_scene("free"), CountingClock());
  EXPECT_TRUE(found.parts.empty());
  EXPECT_EQ(found.whole.median_ns, 100);
}

}  // namespace
}  // namespace forcebound::server
