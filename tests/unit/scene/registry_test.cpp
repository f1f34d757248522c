#include "forcebound/scene/registry.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "forcebound/scene/effects/surface.hpp"

namespace forcebound::scene {
namespace {

TEST(Registry, FindsByName) {
  const Registry registry = Registry::standard();
  ASSERT_NE(registry.find_effect("surface"), nullptr);
  EXPECT_EQ(registry.find_effect("surface")->name, "surface");
  EXPECT_EQ(registry.find_effect("Surface"), nullptr);
  ASSERT_NE(registry.find_shape("torus"), nullptr);
  EXPECT_EQ(registry.find_shape("torus")->name, "torus");
  EXPECT_EQ(registry.find_shape("surface"), nullptr);
}

TEST(Registry, RefusesANameTwice) {
  Registry registry = Registry::standard();
  EXPECT_THROW(registry.add(surface_effect()), std::invalid_argument);
  EXPECT_THROW(registry.add(sphere_shape()), std::invalid_argument);
}

TEST(Registry, RefusesAnotherLawUnderANameOfThisLibrary) {
  Registry registry;
  EffectKind other = surface_effect();
  other.law = "f = 0";
  EXPECT_THROW(registry.add(other), std::invalid_argument);
  ShapeKind egg = sphere_shape();
  egg.description = "An egg.";
  EXPECT_THROW(registry.add(egg), std::invalid_argument);
  registry.add(surface_effect());
  registry.add(sphere_shape());
  EXPECT_NE(registry.find_effect("surface"), nullptr);
  EXPECT_NE(registry.find_shape("sphere"), nullptr);
}

}  // namespace
}  // namespace forcebound::scene
