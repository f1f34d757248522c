#include "forcebound/view/shown_scene.hpp"

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
#include "forcebound/scene/registry.hpp"
#include "forcebound/scene/rendering.hpp"

namespace forcebound::view {
namespace {

using Json = nlohmann::json;

std::string shown_json(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json json_of(const scene::Point& point) {
  Json list = Json::array();
  for (const double number : point) list.push_back(std::isfinite(number) ? Json(number) : Json(nullptr));
  return list;
}

/// A value of a scene file. Infinite sizes, of boxes on axes that a scene lacks, are null.
Json json_of(const config::Value& value) {
  return std::visit(
      [](const auto& typed) -> Json {
        using Type = std::decay_t<decltype(typed)>;
        if constexpr (std::is_same_v<Type, Eigen::Vector3d>) {
          return json_of(scene::Point(typed));
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
  for (const config::Parameter& parameter : registry.find_shape(object.shape_kind)->parameters) {
    if (Json preset = preset_of(parameter); !preset.is_null()) shape[std::string(key_of(parameter))] = preset;
  }
  for (const auto& [key, value] : object.shape_values.all()) shape[key] = json_of(value);
  shape["name"] = object.name;
  shape["kind"] = object.shape_kind;
  return shown_json(shape);
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

template <class Triangles>
void add_mesh(ShownScene& to, const std::string& name, const std::vector<scene::Point>& vertices_m,
              const Triangles& triangles, bool moves) {
  std::string& text = to.meshes;
  text += (text.empty() ? "" : ",") + std::string("{\"name\":") + shown_json(name);
  text += moves ? ",\"moves\":true,\"vertices_m\":[" : ",\"vertices_m\":[";
  bool first = true;
  for (const scene::Point& vertex : vertices_m) {
    for (const double number : vertex) {
      if (!first) text += ',';
      page::add_number(text, number);
      first = false;
    }
  }
  text += "],\"triangles\":[";
  first = true;
  for (const auto& triangle : triangles) {
    for (const std::uint32_t corner : triangle) {
      if (!first) text += ',';
      text += std::to_string(corner);
      first = false;
    }
  }
  text += "]}";
}

void add_shape(ShownScene& to, const std::string& shape) { to.shapes += (to.shapes.empty() ? "" : ",") + shape; }

std::size_t elements_of(const scene::ShapeGeometry& geometry) {
  if (geometry.mesh) return geometry.mesh->triangles().size();
  return geometry.heights ? 2 * geometry.heights->heights_m.size() : 0;
}

void add_too_large(ShownScene& to, const std::string& name, std::size_t triangles) {
  add_words(to.more, "'" + name + "' is not drawn: " + std::to_string(triangles) + " triangles");
}

void add_object(ShownScene& to, const scene::SceneObject& object, const scene::Registry& registry) {
  const scene::ShapeGeometry geometry = object.shape->geometry();
  if (const std::size_t elements = elements_of(geometry); elements > kTrianglesShownMost) {
    add_too_large(to, object.name, elements);
  } else if (geometry.kind() == scene::GeometryKind::none) {
    // No page knows other kinds. Tissue that a client runs is drawn as its server tells.
    if (registry.find_shape(object.shape_kind) != nullptr) add_shape(to, shape_json(object, registry));
  } else {
    const Mesh mesh = geometry.mesh ? mesh_of(*geometry.mesh) : mesh_of(*geometry.heights);
    add_mesh(to, object.name, mesh.vertices_m, mesh.triangles, false);
  }
}

}  // namespace

void add_words(std::string& to, const std::string& words) {
  if (words.empty()) return;
  to += (to.empty() ? "" : "; ") + words;
}

ShownScene shown(const scene::Scene& scene, Which which) {
  static const scene::Registry kRegistry = scene::Registry::standard();
  ShownScene shown{.name = scene.facts().name, .tool_m = scene.facts().tool_m};
  const auto is_wanted = [which](const scene::SceneObject& part) {
    return which == Which::all || scene::rendering_of(part, kRegistry).how != scene::Rendering::at_client;
  };
  for (const scene::SceneObject& object : scene.objects()) {
    if (is_wanted(object)) add_object(shown, object, kRegistry);
  }
  for (const scene::SceneObject& field : scene.fields()) {
    if (!is_wanted(field)) continue;
    std::string effects;
    for (const scene::RequestedEffect& effect : field.effects) effects += (effects.empty() ? "" : ", ") + effect.name;
    add_words(shown.more, "'" + field.name + "' has no shape: " + effects);
  }
  return shown;
}

void add_part(ShownScene& to, const scene::VisiblePart& part) {
  using Kind = scene::VisiblePart::Kind;
  if (part.kind == Kind::surface || part.kind == Kind::mesh) {
    if (part.triangles.size() > kTrianglesShownMost) return add_too_large(to, part.name, part.triangles.size());
    return add_mesh(to, part.name, part.vertices_m, part.triangles, true);
  }
  Json shape{{"name", part.name}, {"moves", true}};
  const scene::Point axis = scene::Point::UnitZ() * part.half_m.z();
  switch (part.kind) {
    case Kind::half_space:
      shape["kind"] = "half_space";
      shape["through_m"] = json_of(part.place_m);
      shape["normal"] = json_of(scene::Point(part.turn * scene::Point::UnitZ()));
      break;
    case Kind::sphere:
      shape["kind"] = "sphere";
      shape["center_m"] = json_of(part.place_m);
      shape["radius_m"] = part.half_m.x();
      break;
    case Kind::capsule:
    case Kind::cylinder:
      shape["kind"] = part.kind == Kind::capsule ? "capsule" : "cylinder";
      shape["from_m"] = json_of(scene::Point(part.place_m - axis));
      shape["to_m"] = json_of(scene::Point(part.place_m + axis));
      shape["radius_m"] = part.half_m.x();
      break;
    default:
      shape["kind"] = "box";
      shape["center_m"] = json_of(part.place_m);
      shape["size_m"] = json_of(scene::Point(2 * part.half_m));
  }
  add_shape(to, shown_json(shape));
}

void add_frame(ShownScene& to, const std::string& name, double scale) {
  add_shape(to, shown_json({{"name", name}, {"kind", "frame"}, {"scale", scale}, {"moves", true}}));
}

ShownScene joined(ShownScene first, const ShownScene& second) {
  const auto add = [](std::string& to, const std::string& more) {
    if (!more.empty()) to += (to.empty() ? "" : ",") + more;
  };
  add(first.shapes, second.shapes);
  add(first.meshes, second.meshes);
  add_words(first.more, second.more);
  if (first.robot.empty()) first.robot = second.robot;
  if (first.tool_m.rows() == 0) first.tool_m = second.tool_m;
  if (first.begin_m.rows() == 0) first.begin_m = second.begin_m;
  return first;
}

std::string place_member(const std::string& key, const control::Vector& place_m) {
  if (place_m.rows() == 0) return {};
  std::string text = ",\"" + key + "\":";
  page::add_numbers(text, std::span<const double>(place_m.data(), static_cast<std::size_t>(place_m.rows())));
  return text;
}

std::string scene_message(int track, const ShownScene& shown) {
  return "{\"kind\":\"scene\",\"track\":" + std::to_string(track) + ",\"name\":" + shown_json(shown.name) +
         ",\"shapes\":[" + shown.shapes + "],\"meshes\":[" + shown.meshes + "],\"more\":" + shown_json(shown.more) +
         (shown.robot.empty() ? "" : ",\"robot\":" + shown.robot) + place_member("tool_m", shown.tool_m) + "}";
}

}  // namespace forcebound::view
