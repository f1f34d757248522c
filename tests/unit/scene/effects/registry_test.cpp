#include "forcebound/scene/effects/registry.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "forcebound/scene/effects/surface.hpp"

namespace forcebound::scene {
namespace {

TEST(EffectRegistry, FindsByName) {
  const EffectRegistry registry = EffectRegistry::standard();
  ASSERT_NE(registry.find("surface"), nullptr);
  EXPECT_EQ(registry.find("surface")->name, "surface");
  EXPECT_EQ(registry.find("Surface"), nullptr);
}

TEST(EffectRegistry, RefusesANameTwice) {
  EffectRegistry registry = EffectRegistry::standard();
  EXPECT_THROW(registry.add(surface_effect()), std::invalid_argument);
}

}  // namespace
}  // namespace forcebound::scene
