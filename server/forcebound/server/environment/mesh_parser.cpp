#include "forcebound/server/environment/mesh_parser.hpp"

#include <filesystem>

#include "forcebound/scene/geometry/decimate.hpp"
#include "forcebound/scene/geometry/distance_field.hpp"
#include "forcebound/scene/geometry/lathe.hpp"
#include "forcebound/scene/geometry/mesh_file.hpp"
#include "forcebound/scene/geometry/mesh_shape.hpp"

namespace forcebound::server {
namespace {

constexpr Eigen::Index kMeshAxes = 3;

scene::Point offset(CheckedTable& table, std::string_view key) {
  return table.find(key) == nullptr ? scene::Point(scene::Point::Zero()) : table.point(key, kMeshAxes);
}

std::shared_ptr<const scene::TriangleMesh> parse_file(CheckedTable& table) {
  const std::string path = table.path("file");
  const scene::MeshPlacement placement = parse_placement(table);
  const double detail = table.number(kMeshDetail);
  auto mesh = table.built_at(table.at("file"), [&] {
    return std::make_shared<const scene::TriangleMesh>(scene::decimated(scene::load_mesh(path, placement), detail));
  });
  table.note("that is", scene::to_text(mesh->report()));
  return mesh;
}

std::vector<scene::LathePoint> parse_profile(CheckedTable& table) {
  std::vector<scene::LathePoint> profile;
  for (const toml::node& node : table.array("profile_m")) {
    const toml::array* pair = node.as_array();
    if (pair == nullptr || pair->size() != 2) {
      table.fail(node, "profile_m must be a list of [radius, height], got " + as_written(node));
    }
    profile.push_back({table.finite((*pair)[0], "profile_m"), table.finite((*pair)[1], "profile_m")});
  }
  return profile;
}

}  // namespace

std::unique_ptr<scene::Shape> parse_mesh(CheckedTable& table, double reach_m) {
  const auto mesh = parse_file(table);
  const scene::MeshShapeOptions options{.two_sided = table.flag("two_sided", false), .reach_m = reach_m};
  return table.built_at(table.at("file"), [&] { return scene::make_mesh(mesh, options); });
}

std::unique_ptr<scene::Shape> parse_distance_field(CheckedTable& table, double reach_m) {
  const auto mesh = parse_file(table);
  const scene::DistanceFieldOptions options{
      .spacing_m = table.number({.key = "spacing_m", .least = 0, .least_excluded = true}), .reach_m = reach_m};
  return table.built_at(table.at("file"), [&] { return scene::make_distance_field(mesh, options); });
}

std::unique_ptr<scene::Shape> parse_lathe(CheckedTable& table, double reach_m) {
  const std::vector<scene::LathePoint> profile = parse_profile(table);
  const double segments = table.number(kLatheSegments);
  const scene::Point origin_m = offset(table, "origin_m");
  return table.built_at(table.at("profile_m"), [&] {
    auto mesh = std::make_shared<const scene::TriangleMesh>(
        scene::make_lathe("lathe", profile, static_cast<int>(segments), origin_m));
    table.note("that is", scene::to_text(mesh->report()));
    return scene::make_mesh(std::move(mesh), {.two_sided = false, .reach_m = reach_m});
  });
}

}  // namespace forcebound::server
