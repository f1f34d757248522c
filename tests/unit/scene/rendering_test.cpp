#include "forcebound/scene/rendering.hpp"

#include <gtest/gtest.h>

#include "forcebound/scene/part.hpp"

namespace forcebound::scene {
namespace {

/// A registry with an effect and a shape that the standard one lacks.
Registry own_registry() {
  Registry registry = Registry::standard();
  EffectKind wind = *registry.find_effect("constant_force");
  wind.name = "wind";
  registry.add(std::move(wind));
  ShapeKind pebble = *registry.find_shape("sphere");
  pebble.name = "pebble";
  registry.add(std::move(pebble));
  return registry;
}

SceneObject part_of(const std::string& shape, const std::string& field_effect) {
  PartDescription description{.name = "part"};
  if (!shape.empty()) {
    description.shape = NamedValues{shape, {{"center_m", Point(0, 0, 0)}, {"radius_m", 0.02}}};
  }
  description.effects.push_back({field_effect, {{"force_N", Point(0, 0, 1)}}});
  return make_part(description, own_registry());
}

std::string rendering_text(const SceneObject& part) { return to_text(rendering_of(part, Registry::standard())); }

TEST(RenderingOf, RunsAtTheClientWhatEveryClientHas) {
  EXPECT_EQ(rendering_text(part_of("sphere", "constant_force")), "runs at the client");
  EXPECT_EQ(rendering_text(part_of("", "constant_force")), "runs at the client");
}

TEST(RenderingOf, HoldsWhatTheServerAloneKnows) {
  EXPECT_EQ(rendering_text(part_of("sphere", "wind")),
            "computed here, held at the client: effect 'wind' is known to this server only");
  EXPECT_EQ(rendering_text(part_of("", "wind")),
            "computed here, held at the client: effect 'wind' is known to this server only");
  EXPECT_EQ(rendering_text(part_of("pebble", "constant_force")),
            "computed here, held at the client: its shape is known to this server only");
}

}  // namespace
}  // namespace forcebound::scene
