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

}  // namespace
}  // namespace forcebound::scene
