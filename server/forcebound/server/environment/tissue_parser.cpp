#include "forcebound/server/environment/tissue_parser.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "forcebound/server/dynamics/tissue/tetrahedral_block.hpp"
#include "forcebound/server/dynamics/tissue/tissue_dynamic_model.hpp"
#include "forcebound/server/environment/placement_parser.hpp"

namespace forcebound::server {
namespace {

constexpr Eigen::Index kTissueAxes = 3;

scene::Point sizes(CheckedTable& table, std::string_view key) {
  const scene::Point size_m = table.point(key, kTissueAxes);
  const toml::node& node = table.at(key);
  if (!(size_m.minCoeff() > 0))
    table.fail(node, std::string(key) + " must be > 0 on every axis, got " + as_written(node));
  return size_m;
}

TetrahedralMesh parse_block(CheckedTable& shape) {
  constexpr double kCellsMost = 64;
  const scene::Point center_m = shape.point("center_m", kTissueAxes);
  BlockDescription block{.cells = {}, .from_m = {}, .size_m = sizes(shape, "size_m")};
  scene::MeshPlacement placement{.rotation = parse_rotation(shape)};
  block.from_m = center_m - 0.5 * block.size_m;
  if (placement.turns()) {  // about its centre
    block.from_m = -0.5 * block.size_m;
    placement.offset_m = center_m;
  }
  const scene::Point cells = shape.point("cells", kTissueAxes);
  for (std::size_t axis = 0; axis < block.cells.size(); ++axis) {
    const double count = cells[static_cast<Eigen::Index>(axis)];
    if (!(count >= 1 && count <= kCellsMost) || count != std::floor(count)) {
      shape.fail(shape.at("cells"), "cells must be whole numbers from 1 to 64, got " + as_written(shape.at("cells")));
    }
    block.cells[axis] = static_cast<std::size_t>(count);
  }
  return shape.built_at(shape.at("size_m"), [&] { return TetrahedralMesh(tetrahedral_block(block), placement); });
}

TetrahedralMesh parse_mesh(CheckedTable& shape) {
  const std::string path = shape.path("file");
  const scene::MeshPlacement placement = parse_placement(shape);
  return shape.built_at(shape.at("file"), [&] { return TetrahedralMesh(load_gmsh(path), placement); });
}

TetrahedralMesh parse_shape(CheckedTable& tissue, std::string& text) {
  static constexpr std::array<std::string_view, 2> kKinds{"mesh", "block"};
  CheckedTable shape(tissue.table("shape"), tissue.file(), tissue.place() + ", shape");
  (void)shape.at("kind");
  TetrahedralMesh mesh = shape.choice("kind", kKinds) == "mesh" ? parse_mesh(shape) : parse_block(shape);
  shape.refuse_unknown_keys();
  text += shape.values_text();
  return mesh;
}

/// What lies below a plane, or within a box.
std::vector<int> parse_held(CheckedTable& tissue, const TetrahedralMesh& mesh) {
  CheckedTable held(tissue.table("held"), tissue.file(), tissue.place() + ", held");
  std::vector<int> nodes;
  if (held.find("center_m") != nullptr) {
    const scene::Point center_m = held.point("center_m", kTissueAxes);
    nodes = nodes_in_box(mesh, center_m, sizes(held, "size_m"));
  } else {
    const scene::Point through_m = held.point("through_m", kTissueAxes);
    nodes = nodes_below(mesh, through_m, held.direction("normal", kTissueAxes));
  }
  held.refuse_unknown_keys();
  return nodes;
}

ElasticMaterial parse_material(CheckedTable& tissue) {
  return {.young_Pa = tissue.number({.key = "young_Pa", .least = 0, .least_excluded = true}),
          .poisson = tissue.number({.key = "poisson", .least = 0, .most = 0.4999})};
}

/// @param large_motion under which a tie takes the place of a point's contact
ProbeOptions parse_probe(CheckedTable& tissue, bool large_motion) {
  ProbeOptions probe;
  double stiffness_N_per_m_most = std::numeric_limits<double>::infinity();
  probe.radius_m = tissue.number({.key = "probe_radius_m", .preset = probe.radius_m, .least = 0});
  if (large_motion && probe.radius_m == 0) {
    probe.contact_stiffness_N_per_m = CorotationalOptions{}.contact_stiffness_N_per_m;
    stiffness_N_per_m_most = CorotationalOptions::kContactStiffnessMost_N_per_m;
  }
  probe.contact_stiffness_N_per_m = tissue.number({.key = "contact_stiffness_N_per_m",
                                                   .preset = probe.contact_stiffness_N_per_m,
                                                   .least = 0,
                                                   .least_excluded = true,
                                                   .most = stiffness_N_per_m_most});
  probe.contacts_max =
      tissue.whole({.key = "contacts_max", .preset = probe.contacts_max, .least = 1, .most = kContactsMax});
  return probe;
}

scene::SceneDynamicModel parse_tissue(CheckedTable& table, const toml::table& where, const std::string& name) {
  (void)table.at("name");
  std::string text = "tissue, ";
  TetrahedralMesh mesh = parse_shape(table, text);
  std::vector<int> held = parse_held(table, mesh);
  const bool large_motion = table.flag("large_motion", false);
  const double skin_Pa_per_m =
      table.number({.key = "contact_stiffness_Pa_per_m", .preset = 0, .least = 0, .least_excluded = true});
  TissueDescription tissue{.mesh = std::move(mesh),
                           .material = parse_material(table),
                           .held_nodes = std::move(held),
                           .probe = parse_probe(table, large_motion),
                           .large_motion = large_motion,
                           .skin_Pa_per_m = skin_Pa_per_m};
  text += ", " + table.values_text();
  table.refuse_unknown_keys();
  return table.built_at(where, [&] {
    return scene::SceneDynamicModel{
        .name = name, .text = text, .dynamic_model = std::make_unique<TissueDynamicModel>(std::move(tissue))};
  });
}

}  // namespace

std::vector<scene::SceneDynamicModel> parse_tissues(CheckedTable& file) {
  std::vector<scene::SceneDynamicModel> dynamic_models;
  file.each("tissue", [&](const toml::table& tissue) {
    const std::string name = CheckedTable(tissue, file.file(), "tissue").name("name");
    CheckedTable table(tissue, file.file(), "tissue '" + name + "'");
    dynamic_models.push_back(parse_tissue(table, tissue, name));
    return name;
  });
  return dynamic_models;
}

}  // namespace forcebound::server
