#include "forcebound/view/scene_parts.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>

#include "forcebound/control/rotation.hpp"
#include "forcebound/page/json_member.hpp"

namespace forcebound::view {
namespace {

using Json = nlohmann::json;
using record::ScenePart;
using Kind = ScenePart::Kind;

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kLongest_m = 1e3;

std::optional<double> length_at(const Json& shape, const char* key) {
  const Json& value = page::json_member(shape, key);
  if (!value.is_number()) return std::nullopt;
  const auto number = value.get<double>();
  return number > 0 && number <= kLongest_m ? std::optional(number) : std::nullopt;
}

/// One to three numbers; axes that the scene lacks are 0.
/// @param endless taken for null
std::optional<Eigen::Vector3d> point_at(const Json& shape, const char* key, double endless = 0) {
  const Json& value = page::json_member(shape, key);
  if (!value.is_array() || value.empty() || value.size() > 3) return std::nullopt;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (std::size_t axis = 0; axis < value.size(); ++axis) {
    const Json& number = value[axis];
    if (!number.is_number() && !number.is_null()) return std::nullopt;
    point[static_cast<Eigen::Index>(axis)] = number.is_null() ? endless : number.get<double>();
  }
  return point;
}

Eigen::Quaterniond turn_to(const Eigen::Vector3d& axis) {
  return control::turn_between(Eigen::Vector3d::UnitZ(), axis);
}

bool read_plane(const Json& shape, ScenePart& part) {
  const auto through = point_at(shape, "through_m");
  const auto normal = point_at(shape, "normal");
  if (!through || !normal || !(normal->norm() > 0)) return false;
  part.kind = Kind::plane;
  part.place_m = *through;
  part.turn = turn_to(*normal);
  return true;
}

bool read_ball(const Json& shape, Kind kind, ScenePart& part) {
  const auto middle = point_at(shape, "center_m");
  const auto radius = length_at(shape, "radius_m");
  if (!middle || !radius) return false;
  part.kind = kind;
  part.place_m = *middle;
  part.size_m.setConstant(2 * *radius);
  return true;
}

bool read_box(const Json& shape, ScenePart& part) {
  const auto middle = point_at(shape, "center_m");
  auto size = point_at(shape, "size_m", kEndless);
  if (!middle || !size) return false;
  for (double& edge_m : *size) edge_m = edge_m > 0 ? edge_m : kEndless;  // axes that the scene lacks
  part.kind = Kind::box;
  part.place_m = *middle;
  part.size_m = *size;
  return true;
}

bool read_rod(const Json& shape, Kind kind, ScenePart& part) {
  const auto from = point_at(shape, "from_m");
  const auto to = point_at(shape, "to_m");
  const auto radius = length_at(shape, "radius_m");
  if (!from || !to || !radius || !((*to - *from).norm() > 0)) return false;
  part.kind = kind;
  part.place_m = 0.5 * (*from + *to);
  part.turn = turn_to(*to - *from);
  part.size_m = {2 * *radius, 2 * *radius, (*to - *from).norm()};
  return true;
}

bool read_torus(const Json& shape, ScenePart& part) {
  constexpr std::uint32_t kAround = 48;
  constexpr std::uint32_t kThrough = 16;
  constexpr double kTurn = 2 * std::numbers::pi;
  const auto middle = point_at(shape, "center_m");
  const auto axis = point_at(shape, "axis");
  const auto major = length_at(shape, "major_radius_m");
  const auto minor = length_at(shape, "minor_radius_m");
  if (!middle || !axis || !major || !minor || !(axis->norm() > 0)) return false;
  const Eigen::Quaterniond turn = turn_to(*axis);
  for (std::uint32_t i = 0; i < kAround; ++i) {
    for (std::uint32_t j = 0; j < kThrough; ++j) {
      const double around = kTurn * i / kAround;
      const double through = kTurn * j / kThrough;
      const double out_m = *major + *minor * std::cos(through);
      const Eigen::Vector3d vertex(out_m * std::cos(around), out_m * std::sin(around), *minor * std::sin(through));
      part.vertices_m.emplace_back(*middle + turn * vertex);
      const std::uint32_t next = (i + 1) % kAround * kThrough;
      const std::uint32_t above = (j + 1) % kThrough;
      part.triangles.push_back({i * kThrough + j, next + j, next + above});
      part.triangles.push_back({i * kThrough + j, next + above, i * kThrough + above});
    }
  }
  return true;
}

bool read_shape(const Json& shape, ScenePart& part) {
  const Json& kind = page::json_member(shape, "kind");
  if (kind == "half_space") return read_plane(shape, part);
  if (kind == "sphere") return read_ball(shape, Kind::sphere, part);
  if (kind == "cavity") return read_ball(shape, Kind::cavity, part);
  if (kind == "box") return read_box(shape, part);
  if (kind == "cylinder") return read_rod(shape, Kind::cylinder, part);
  if (kind == "capsule") return read_rod(shape, Kind::capsule, part);
  if (kind == "torus") return read_torus(shape, part);
  return false;
}

bool read_mesh(const Json& mesh, ScenePart& part) {
  const Json& vertices = page::json_member(mesh, "vertices_m");
  const Json& triangles = page::json_member(mesh, "triangles");
  if (!vertices.is_array() || !triangles.is_array()) return false;
  const auto number = [](const Json& value) { return value.is_number() ? value.get<double>() : 0.0; };
  for (std::size_t i = 0; i + 2 < vertices.size(); i += 3) {
    part.vertices_m.emplace_back(number(vertices[i]), number(vertices[i + 1]), number(vertices[i + 2]));
  }
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Json& corner = triangles[i + k];
      if (!corner.is_number_unsigned() || corner.get<std::uint64_t>() >= part.vertices_m.size()) return false;
      corners.at(k) = corner.get<std::uint32_t>();
    }
    part.triangles.push_back(corners);
  }
  return true;
}

template <class Read>
void add_parts(const std::string& list, Read read, std::vector<ScenePart>& parts) {
  const Json elements = Json::parse("[" + list + "]", nullptr, false);
  if (!elements.is_array()) return;
  for (const Json& element : elements) {
    if (!element.is_object()) continue;
    ScenePart part;
    const Json& name = page::json_member(element, "name");
    if (name.is_string()) part.name = name.get<std::string>();
    part.moves = page::json_member(element, "moves") == true;
    if (read(element, part)) parts.push_back(std::move(part));
  }
}

}  // namespace

std::vector<record::ScenePart> parts_of(const ShownScene& shown) {
  std::vector<ScenePart> parts;
  add_parts(shown.shapes, read_shape, parts);
  add_parts(shown.meshes, read_mesh, parts);
  return parts;
}

}  // namespace forcebound::view
