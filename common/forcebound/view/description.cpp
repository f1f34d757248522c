#include "forcebound/view/description.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "forcebound/page/json_member.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::view {
namespace {

using Json = nlohmann::json;

// Of a scene that anybody may send.
constexpr std::size_t kPartsMost = 2000;
constexpr std::size_t kValuesMost = 32;
constexpr std::size_t kVerticesMost = 3 * kTrianglesShownMost;

std::string dumped(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

MovingGroup group_of(const std::vector<scene::VisiblePart>& parts) {
  MovingGroup group;
  for (const scene::VisiblePart& part : parts) {
    if (part.kind == scene::VisiblePart::Kind::half_space) continue;  // it stays
    group.names.push_back(part.name);
    group.deforms = part.kind == scene::VisiblePart::Kind::surface;
    group.vertices = part.vertices_m.size();
  }
  return group;
}

std::string text_of(const ShownScene& shown, const std::vector<MovingGroup>& moving) {
  Json groups = Json::array();
  for (const MovingGroup& group : moving) {
    groups.push_back({{"names", group.names}, {"vertices", group.deforms ? group.vertices : 0}});
    if (group.values) groups.back()["values"] = true;
  }
  return "{\"name\":" + dumped(shown.name) + ",\"shapes\":[" + shown.shapes + "],\"meshes\":[" + shown.meshes +
         "],\"more\":" + dumped(shown.more) + (shown.robot.empty() ? "" : ",\"robot\":" + shown.robot) +
         place_member("tool_m", shown.tool_m) + place_member("begin_m", shown.begin_m) +
         ",\"moving\":" + dumped(groups) + "}";
}

bool is_list(const Json& value, std::size_t most) { return value.is_array() && value.size() <= most; }

bool is_text(const Json& value) { return value.is_string(); }

bool is_number(const Json& value) { return value.is_number() || value.is_null(); }

/// A text, number or flag; a list of numbers, or of such lists. Nothing deeper: to write it out takes stack.
bool is_value_of_shape(const Json& value) {
  if (!value.is_array()) return !value.is_object();
  return std::ranges::all_of(value, [](const Json& item) {
    return is_number(item) || (item.is_array() && std::ranges::all_of(item, is_number));
  });
}

bool is_shape(const Json& shape) {
  if (!shape.is_object() || shape.size() > kValuesMost) return false;
  // A lathe comes as a mesh: its number of segments, which nobody bounds here, is not for a browser.
  return is_text(page::json_member(shape, "name")) && is_text(page::json_member(shape, "kind")) &&
         shape["kind"] != "lathe" && std::ranges::all_of(shape, is_value_of_shape);
}

/// Facts of a robot: an object of texts, numbers and flags.
bool is_robot(const Json& robot) {
  return robot.is_object() && robot.size() <= kValuesMost && std::ranges::all_of(robot, [](const Json& value) {
           return is_text(value) || is_number(value) || value.is_boolean();
         });
}

bool is_mesh(const Json& mesh) {
  if (!mesh.is_object() || !is_text(page::json_member(mesh, "name"))) return false;
  const Json& vertices = page::json_member(mesh, "vertices_m");
  const Json& triangles = page::json_member(mesh, "triangles");
  if (!is_list(vertices, 3 * kVerticesMost) || !is_list(triangles, 3 * kTrianglesShownMost)) return false;
  if (vertices.size() % 3 != 0 || triangles.size() % 3 != 0) return false;
  if (mesh.size() > (page::json_member(mesh, "moves").is_boolean() ? 4U : 3U)) return false;
  const std::uint64_t count = vertices.size() / 3;
  return std::ranges::all_of(vertices, [](const Json& number) { return number.is_number(); }) &&
         std::ranges::all_of(triangles, [count](const Json& corner) {
           return corner.is_number_unsigned() && corner.get<std::uint64_t>() < count;
         });
}

/// A place on one to three axes [m], absent or not. Nothing: it is none.
std::optional<control::Vector> read_place(const Json& place) {
  constexpr std::size_t kAxes = 3;
  constexpr double kFarthest_m = 10;
  if (place.is_null()) return control::Vector();
  if (!is_list(place, kAxes) || place.empty()) return std::nullopt;
  control::Vector read = control::Vector::Zero(static_cast<Eigen::Index>(place.size()));
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (!place[i].is_number()) return std::nullopt;
    read[static_cast<Eigen::Index>(i)] = place[i].get<double>();
  }
  if (!(read.cwiseAbs().maxCoeff() <= kFarthest_m)) return std::nullopt;
  return read;
}

template <class Condition>
std::optional<std::string> elements(const Json& list, Condition is_one) {
  if (!is_list(list, kPartsMost) || !std::ranges::all_of(list, is_one)) return std::nullopt;
  std::string text;
  for (const Json& one : list) text += (text.empty() ? "" : ",") + dumped(one);
  return text;
}

std::optional<MovingGroup> read_group(const Json& group) {
  if (!group.is_object()) return std::nullopt;
  const Json& names = page::json_member(group, "names");
  const Json& vertices = page::json_member(group, "vertices");
  if (!is_list(names, kPartsMost) || !std::ranges::all_of(names, is_text)) return std::nullopt;
  if (!vertices.is_number_unsigned() || vertices.get<std::uint64_t>() > kVerticesMost) return std::nullopt;
  const Json& values = page::json_member(group, "values");
  if (!values.is_null() && !values.is_boolean()) return std::nullopt;
  MovingGroup read{.deforms = vertices.get<std::size_t>() > 0,
                   .vertices = vertices.get<std::size_t>(),
                   .values = values.is_boolean() && values.get<bool>()};
  if (read.deforms && (names.size() != 1 || read.values)) return std::nullopt;
  for (const Json& name : names) read.names.push_back(name.get<std::string>());
  return read;
}

}  // namespace

std::uint64_t hash_of(std::string_view text) noexcept {
  constexpr std::uint64_t kBasis = 0xcbf29ce484222325;
  constexpr std::uint64_t kPrime = 0x100000001b3;
  std::uint64_t hash = kBasis;
  for (const char letter : text) hash = (hash ^ static_cast<unsigned char>(letter)) * kPrime;
  return hash == 0 ? kBasis : hash;
}

std::uint32_t Description::pieces() const noexcept {
  return static_cast<std::uint32_t>((text.size() + kPieceBytes - 1) / kPieceBytes);
}

std::span<const std::byte> Description::piece(std::uint32_t number) const noexcept {
  const auto bytes = std::as_bytes(std::span(text));
  const std::size_t begin = std::min(bytes.size(), number * kPieceBytes);
  return bytes.subspan(begin, std::min(kPieceBytes, bytes.size() - begin));
}

Description describe(ShownScene objects, std::span<const std::vector<scene::VisiblePart>> models,
                     const std::vector<MovingGroup>& more) {
  Description description;
  for (const auto& parts : models) {
    for (const scene::VisiblePart& part : parts) add_part(objects, part);
    description.moving.push_back(group_of(parts));
  }
  description.moving.insert(description.moving.end(), more.begin(), more.end());
  description.text = text_of(objects, description.moving);
  if (description.text.size() > kDescriptionBytesMost) {
    objects.meshes.clear();
    add_words(objects.more, "meshes are not drawn: too many triangles in all");
    for (MovingGroup& group : description.moving) {
      if (group.deforms) group = {};
    }
    description.text = text_of(objects, description.moving);
  }
  // Only what nobody writes: thousands of objects.
  if (description.text.size() > kDescriptionBytesMost) {
    description.moving.assign(description.moving.size(), {});
    description.text = text_of({.name = objects.name, .more = "it is not drawn: too many objects"}, description.moving);
  }
  description.hash = hash_of(description.text);
  return description;
}

std::optional<Received> read_description(std::string_view text) {
  const Json description = Json::parse(text, nullptr, false);
  if (!description.is_object()) return std::nullopt;
  const Json none;
  const auto at = [&](const char* key) -> const Json& {
    const auto found = description.find(key);
    return found == description.end() ? none : *found;
  };
  const auto shapes = elements(at("shapes"), is_shape);
  const auto meshes = elements(at("meshes"), is_mesh);
  if (!is_text(at("name")) || !is_text(at("more")) || !shapes || !meshes || !is_list(at("moving"), kPartsMost)) {
    return std::nullopt;
  }
  const Json& robot = at("robot");
  if (!robot.is_null() && !is_robot(robot)) return std::nullopt;
  const auto tool_m = read_place(at("tool_m"));
  const auto begin_m = read_place(at("begin_m"));
  if (!tool_m || !begin_m) return std::nullopt;
  Received received{.shown = {.name = text::printable(at("name").get<std::string>()),
                              .shapes = *shapes,
                              .meshes = *meshes,
                              .more = text::printable(at("more").get<std::string>()),
                              .robot = robot.is_null() ? "" : dumped(robot),
                              .tool_m = *tool_m,
                              .begin_m = *begin_m}};
  std::size_t items = 0;
  for (const Json& group : at("moving")) {
    const auto read = read_group(group);
    if (!read) return std::nullopt;
    items += read->items();
    if (items > kVerticesMost) return std::nullopt;
    received.moving.push_back(*read);
  }
  return received;
}

}  // namespace forcebound::view
