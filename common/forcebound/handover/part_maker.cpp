#include "forcebound/handover/internal/part_maker.hpp"

#include <set>

#include "forcebound/handover/internal/proto_values.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::handover {
namespace {

/// @param used the geometries of parts
void check_coarse_levels(const v1::SceneManifest& manifest, const std::set<std::uint32_t>& used) {
  std::set<std::uint32_t> coarse;
  for (int i = 0; i < manifest.geometries_size(); ++i) {
    const v1::Geometry& geometry = manifest.geometries(i);
    if (geometry.coarse_of() == 0) continue;
    const bool of_a_part = used.contains(geometry.coarse_of()) &&
                           manifest.geometries(static_cast<int>(geometry.coarse_of()) - 1).triangles() > 0;
    if (!of_a_part || geometry.triangles() == 0 || used.contains(static_cast<std::uint32_t>(i) + 1) ||
        !coarse.insert(geometry.coarse_of()).second) {
      throw HandoverError("a coarse level of the manifest must be the only one of a part's mesh, and no part's own");
    }
  }
}

}  // namespace

std::string one_line(const std::string& from) {
  constexpr std::size_t kBytesMax = 200;
  return text::printable(from.substr(0, kBytesMax));
}

void check_manifest(const v1::SceneManifest& manifest, const Limits& limits) {
  const auto parts =
      static_cast<std::size_t>(manifest.objects_size()) + static_cast<std::size_t>(manifest.fields_size());
  if (parts > limits.parts || static_cast<std::size_t>(manifest.geometries_size()) > limits.parts) {
    throw HandoverError("the scene has " + std::to_string(parts) + " parts and " +
                        std::to_string(manifest.geometries_size()) + " geometries, at most " +
                        std::to_string(limits.parts) + " of each are accepted");
  }
  // Each use of a geometry makes a shape of it.
  std::set<std::uint32_t> used;
  for (const auto* const list : {&manifest.objects(), &manifest.fields()}) {
    for (const v1::ScenePart& part : *list) {
      if (static_cast<std::size_t>(part.effects_size()) > limits.effects_of_a_part) {
        throw HandoverError("part '" + one_line(part.name()) + "' has " + std::to_string(part.effects_size()) +
                            " effects, at most " + std::to_string(limits.effects_of_a_part) + " are accepted");
      }
      if (part.geometry() > static_cast<std::uint32_t>(manifest.geometries_size())) {
        throw HandoverError("part '" + one_line(part.name()) + "' refers to a geometry that the manifest lacks");
      }
      if (part.geometry() != 0 && !used.insert(part.geometry()).second) {
        throw HandoverError("part '" + one_line(part.name()) + "' refers to the geometry of another part");
      }
    }
  }
  check_coarse_levels(manifest, used);
  const int rows = manifest.degrees_of_freedom();
  if (rows < 0 || rows > 3) {
    throw HandoverError("the scene has " + std::to_string(rows) + " degrees of freedom, 0 (any) to 3 are accepted");
  }
}

scene::SceneObject without_shape(const v1::ScenePart& part, bool is_object, const scene::Registry& registry,
                                 Eigen::Index axes) {
  scene::SceneObject made{.name = one_line(part.name())};
  for (const v1::SceneEffect& effect : part.effects()) {
    add_effect(made, effect_kind(registry, effect.name(), is_object, made), values_of(effect.values()), axes);
  }
  if (!is_object) return made;
  check_effects(made);
  made.shape_kind = part.shape();
  made.shape_values = values_of(part.shape_values());
  return made;
}

}  // namespace forcebound::handover
