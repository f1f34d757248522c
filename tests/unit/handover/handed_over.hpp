#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "forcebound/handover/packed_scene.hpp"
#include "forcebound/handover/scene_assembly.hpp"
#include "forcebound/scene/part.hpp"
#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/support/meshes.hpp"

namespace forcebound::handover {

using control::Vector;
using scene::Scene;

inline std::shared_ptr<const Scene> scene_of(const std::string& parts) {
  return server::parse_scene("[scene]\nname = 'test'\ndescription = ''\ndegrees_of_freedom = 3\n" + parts, "test.toml");
}

/// Of one mesh with a surface of 1 N/mm.
inline std::shared_ptr<const Scene> mesh_scene(const test::Soup& soup, const scene::MeshPlacement& placement = {}) {
  const scene::PartDescription object{.name = "mesh",
                                      .shape = scene::NamedValues{"mesh", {{"file", std::string("mesh.obj")}}},
                                      .effects = {{"surface", {{"stiffness_N_per_m", 1000.0}}}}};
  scene::SceneParts parts;
  parts.objects.push_back(
      scene::make_part(object, scene::Registry::standard(), 3, {}, {.mesh = test::shared_mesh(soup, placement)}));
  return std::make_shared<const Scene>(scene::SceneFacts{.name = "mesh", .description = ""}, std::move(parts));
}

/// The one line with which something is refused; "accepted" if it is not.
inline std::string refusal_of(const std::function<void()>& what) {
  try {
    what();
  } catch (const HandoverError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  }
  return "accepted";
}

inline std::vector<std::size_t> shuffled(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::shuffle(order, std::mt19937_64(seed));
  return order;
}

inline SceneAssembly assembly_of(const PackedScene& packed, const Limits& limits = {}) {
  return {packed.announcement(), scene::Registry::standard(), limits};
}

/// All pieces, in some order.
inline SceneAssembly assembled(const PackedScene& packed, std::uint64_t seed) {
  SceneAssembly assembly = assembly_of(packed);
  for (const std::size_t number : shuffled(packed.announcement().pieces, seed))
    assembly.add(number, packed.piece(number));
  return assembly;
}

}  // namespace forcebound::handover
