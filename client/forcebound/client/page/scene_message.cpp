#include "forcebound/client/page/scene_message.hpp"

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

#include "forcebound/page/json_number.hpp"
#include "forcebound/scene/geometry/height_field.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::client {
namespace {

using Json = nlohmann::json;

std::string quoted(const std::string& text) { return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace); }

/// A value of a scene file. Infinite sizes, of boxes on axes that a scene lacks, are null.
Json json_of(const config::Value& value) {
  return std::visit(
      [](const auto& typed) -> Json {
        using Type = std::decay_t<decltype(typed)>;
        if constexpr (std::is_same_v<Type, Eigen::Vector3d>) {
          Json list = Json::array();
          for (const double number : typed) list.push_back(std::isfinite(number) ? Json(number) : Json(nullptr));
          return list;
        } else if constexpr (std::is_same_v<Type, double>) {
          return std::isfinite(typed) ? Json(typed) : Json(nullptr);
        } else {
          return typed;
        }
      },
      value);
}

/// The preset of a key that a file left out; null: it has none.
Json preset_of(const config::Parameter& parameter) {
  return std::visit(
      [](const auto& declared) -> Json {
        using Type = std::decay_t<decltype(declared)>;
        if constexpr (std::is_same_v<Type, config::NumberParameter>) {
          return declared.preset && std::isfinite(*declared.preset) ? Json(*declared.preset) : Json(nullptr);
        } else if constexpr (std::is_same_v<Type, config::PointParameter>) {
          return declared.preset ? json_of(config::Value(*declared.preset)) : Json(nullptr);
        } else if constexpr (std::is_same_v<Type, config::FlagParameter>) {
          return declared.preset;
        } else {
          return nullptr;
        }
      },
      parameter);
}

std::string shape_json(const scene::SceneObject& object, const scene::Registry& registry) {
  Json shape = Json::object();
  if (const scene::ShapeKind* const kind = registry.find_shape(object.shape_kind)) {
    for (const config::Parameter& parameter : kind->parameters) {
      if (Json preset = preset_of(parameter); !preset.is_null()) shape[std::string(key_of(parameter))] = preset;
    }
  }
  for (const auto& [key, value] : object.shape_values.all()) shape[key] = json_of(value);
  shape["name"] = object.name;
  shape["kind"] = object.shape_kind;
  return shape.dump(-1, ' ', false, Json::error_handler_t::replace);
}

struct Mesh {
  std::vector<scene::Point> vertices_m;
  std::vector<scene::Triangle> triangles;
};

Mesh mesh_of(const scene::TriangleMesh& mesh) {
  Mesh shown{.vertices_m = mesh.vertices_m(), .triangles = mesh.triangles()};
  for (scene::Point& vertex : shown.vertices_m) vertex += mesh.origin_m();
  return shown;
}

Mesh mesh_of(const scene::HeightGrid& grid) {
  Mesh shown;
  const std::size_t columns = grid.columns;
  const std::size_t rows = grid.heights_m.size() / columns;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      shown.vertices_m.emplace_back(grid.origin_m + scene::Point(grid.spacing_m * static_cast<double>(column),
                                                                 grid.spacing_m * static_cast<double>(row),
                                                                 grid.heights_m[row * columns + column]));
    }
  }
  for (std::size_t row = 0; row + 1 < rows; ++row) {
    for (std::size_t column = 0; column + 1 < columns; ++column) {
      const auto corner = static_cast<std::uint32_t>(row * columns + column);
      const auto above = static_cast<std::uint32_t>(corner + columns);
      shown.triangles.push_back({corner, corner + 1, above + 1});
      shown.triangles.push_back({corner, above + 1, above});
    }
  }
  return shown;
}

void add_mesh(std::string& to, const std::string& name, const Mesh& mesh) {
  to += "{\"name\":" + quoted(name) + ",\"vertices_m\":[";
  bool first = true;
  for (const scene::Point& vertex : mesh.vertices_m) {
    for (const double number : vertex) {
      if (!first) to += ',';
      page::add_number(to, number);
      first = false;
    }
  }
  to += "],\"triangles\":[";
  first = true;
  for (const scene::Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (!first) to += ',';
      to += std::to_string(corner);
      first = false;
    }
  }
  to += "]}";
}

/// Puts a text behind those that are there.
void add_words(std::string& to, const std::string& words) {
  if (words.empty()) return;
  to += (to.empty() ? "" : "; ") + words;
}

std::size_t elements_of(const scene::ShapeGeometry& geometry) {
  if (geometry.mesh) return geometry.mesh->triangles().size();
  return geometry.heights ? 2 * geometry.heights->heights_m.size() : 0;
}

std::string message(int track, const std::string& name, const std::string& shapes, const std::string& meshes,
                    const std::string& more) {
  return "{\"kind\":\"scene\",\"track\":" + std::to_string(track) + ",\"name\":" + quoted(name) + ",\"shapes\":[" +
         shapes + "],\"meshes\":[" + meshes + "],\"more\":" + quoted(more) + "}";
}

}  // namespace

std::string scene_message(int track, const scene::Scene& scene, const std::string& simulated) {
  static const scene::Registry kRegistry = scene::Registry::standard();
  std::string shapes;
  std::string meshes;
  std::string more;
  for (const scene::SceneObject& object : scene.objects()) {
    const scene::ShapeGeometry geometry = object.shape->geometry();
    const std::size_t elements = elements_of(geometry);
    if (elements > kTrianglesShownMost) {
      add_words(more, "'" + object.name + "' is not drawn: " + std::to_string(elements) + " triangles");
    } else if (geometry.kind() == scene::GeometryKind::none) {
      shapes += (shapes.empty() ? "" : ",") + shape_json(object, kRegistry);
    } else {
      meshes += meshes.empty() ? "" : ",";
      add_mesh(meshes, object.name, geometry.mesh ? mesh_of(*geometry.mesh) : mesh_of(*geometry.heights));
    }
  }
  for (const scene::SceneObject& field : scene.fields()) {
    std::string effects;
    for (const scene::RequestedEffect& effect : field.effects) effects += (effects.empty() ? "" : ", ") + effect.name;
    add_words(more, "'" + field.name + "' has no shape: " + effects);
  }
  add_words(more, simulated);
  return message(track, scene.facts().name, shapes, meshes, more);
}

std::string unknown_scene_message(int track, const std::string& name, const std::string& more) {
  return message(track, name, "", "", more);
}

}  // namespace forcebound::client
