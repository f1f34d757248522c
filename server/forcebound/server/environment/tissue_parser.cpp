#include "forcebound/server/environment/tissue_parser.hpp"

#include "forcebound/text/numbers.hpp"
#include "forcebound/tissue/set_up.hpp"
#include "forcebound/tissue/tetrahedral_block.hpp"
#include "forcebound/tissue/tissue_dynamic_model.hpp"

namespace forcebound::server {
namespace {

using config::CheckedTable;
using config::NumberParameter;
using config::OtherParameter;
using config::Parameter;
using config::positive_number;
using config::TableDescription;
using config::TextParameter;
using config::Values;
using tissue::CorotationalOptions;
using tissue::ProbeOptions;
using tissue::TetrahedralMesh;
using tissue::TetrahedralSoup;

/// Static, because the declarations refer to these texts.
struct TissueTexts {
  const double point_N_per_m = CorotationalOptions{}.contact_stiffness_N_per_m;
  const std::string point_most = "of each contact, in series with the tissue; of a point with `large_motion` at most " +
                                 text::to_text(CorotationalOptions::kContactStiffnessMost_N_per_m) +
                                 "; without effect on a sphere with it";
  const std::string point_preset =
      text::to_text(ProbeOptions{}.contact_stiffness_N_per_m) + "; with `large_motion` " + text::to_text(point_N_per_m);
  const std::string skin =
      "of a sphere's skin with `large_motion`, in series with the tissue: pressure by depth, at "
      "most " +
      text::to_text(CorotationalOptions::kSkinMost) +
      " `young_Pa` / (1 - `poisson`^2) / `probe_radius_m`; otherwise without effect";
  const std::string skin_preset = text::to_text(CorotationalOptions::kSkin) +
                                  " of these: it gives way by 2 % of a depth of the radius, 4 % of a quarter";
};

TableDescription tissue_table() {
  static const TissueTexts kTexts;
  const ProbeOptions preset;
  return {
      "`[[tissue]]`",
      "An elastic body, quasi-static, without friction.",
      {config::name_of_part(), OtherParameter{.key = "shape", .meaning = "see below"},
       OtherParameter{.key = "held",
                      .meaning = "what does not move, where the tissue lies in the scene: the nodes on or below a "
                                 "plane, by the keys of a [half_space](#half_space), or those in a block, by the keys "
                                 "of a [box](#box)"},
       positive_number("young_Pa", "Young's modulus: 1e3 for brain, 1e4 for liver, 1e5 for skin"),
       NumberParameter{.key = "poisson", .meaning = "Poisson's ratio", .least = 0, .most = 0.4999},
       NumberParameter{
           .key = "probe_radius_m",
           .meaning = "of the sphere that touches it; 0: a point, which sinks in the deeper the finer the mesh",
           .preset = preset.radius_m,
           .least = 0},
       NumberParameter{.key = "contact_stiffness_N_per_m",
                       .meaning = kTexts.point_most,
                       .least = 0,
                       .least_excluded = true,
                       .absent = kTexts.point_preset},
       NumberParameter{.key = "contact_stiffness_Pa_per_m",
                       .meaning = kTexts.skin,
                       .least = 0,
                       .least_excluded = true,
                       .absent = kTexts.skin_preset},
       NumberParameter{.key = "contacts_max",
                       .meaning = "at once; with `large_motion` nothing limits them",
                       .preset = preset.contacts_max,
                       .least = 1,
                       .most = tissue::kContactsMax,
                       .whole = true},
       config::FlagParameter{.key = "large_motion",
                             .meaning = "whether it may bend far, under a point or a sphere: so much dearer that a "
                                        "thousand tetrahedra may take the whole tick, as `--explain` says"}}};
}

TableDescription tissue_of_file_table() {
  TableDescription table{
      "`shape = { kind = \"mesh\", ... }` of a `[[tissue]]`",
      "Tetrahedra from a file, quadratic but with `large_motion`: linear ones bend too little, and lock above "
      "`poisson` 0.45.",
      {TextParameter{
          .key = "file", .meaning = "Gmsh, ASCII of version 1, 2 or 4.1", .form = TextParameter::Form::file}}};
  for (Parameter& parameter : scene::placement_parameters()) table.keys.push_back(std::move(parameter));
  return table;
}

TableDescription tissue_block_table() {
  TableDescription table{"`shape = { kind = \"block\", ... }` of a `[[tissue]]`", "A block along the axes, of cells.",
                         scene::box_shape().parameters};
  table.keys.emplace_back(scene::rotation_parameter(
      "roll, pitch and yaw: turned about its center and the directions of the scene's x, then y, then z axis"));
  table.keys.emplace_back(config::PointParameter{
      .key = "cells", .meaning = "along each axis", .each = {.least = 1, .most = 64, .whole = true}});
  return table;
}

TetrahedralMesh make_block(const Values& values) {
  const scene::Point size_m = values.point("size_m");
  const scene::Point cells = values.point("cells");
  tissue::check_tetrahedra(6 * cells.prod());
  // A block is rotated about its centre.
  const scene::MeshPlacement turned{.offset_m = values.point("center_m"),
                                    .rotation = scene::rotation_from_degrees(values.point("rotation_deg"))};
  const bool turns = turned.turns();
  return TetrahedralMesh(
      tissue::tetrahedral_block(
          {.cells = {static_cast<std::size_t>(cells.x()), static_cast<std::size_t>(cells.y()),
                     static_cast<std::size_t>(cells.z())},
           .from_m = turns ? scene::Point(-0.5 * size_m) : scene::Point(values.point("center_m") - 0.5 * size_m),
           .size_m = size_m}),
      turns ? turned : scene::MeshPlacement{});
}

TetrahedralMesh parse_mesh_of_tissue(CheckedTable& tissue, bool large_motion, std::string& text) {
  CheckedTable shape = tissue.table("shape");
  const bool is_file = shape.choice({.key = "kind", .choices = {"mesh", "block"}}) == "mesh";
  const std::vector<Parameter> keys = (is_file ? tissue_of_file_table() : tissue_block_table()).keys;
  const Values given = shape.given(keys);
  shape.refuse_unknown_keys();
  text = config::to_text(keys, given);
  const Values values = completed(keys, given);
  return shape.built_at(shape.at(is_file ? "file" : "size_m"), [&] {
    if (!is_file) return make_block(values);
    const TetrahedralSoup soup = tissue::load_gmsh(shape.path_at("file", values.text("file")));
    tissue::check_tetrahedra(static_cast<double>(soup.tetrahedra.size()));
    TetrahedralMesh mesh(soup, scene::placement_of(values));
    return large_motion ? mesh : mesh.with_middles();
  });
}

/// The nodes below a plane, or within a box.
std::vector<int> parse_held(CheckedTable& tissue, const TetrahedralMesh& mesh) {
  CheckedTable held = tissue.table("held");
  if (held.node().find("center_m") != nullptr) {
    const Values box = held.all(scene::box_shape().parameters);
    return tissue::nodes_in_box(mesh, box.point("center_m"), box.point("size_m"));
  }
  const Values plane = held.all(scene::half_space_shape().parameters);
  return tissue::nodes_below(mesh, plane.point("through_m"), plane.point("normal"));
}

/// @throws config::ValueError if, under large motion, the tie that replaces a point's contact is too stiff
ProbeOptions probe_of(const Values& values) {
  ProbeOptions probe{.radius_m = values.number("probe_radius_m"), .contacts_max = values.whole("contacts_max")};
  const bool is_tied = values.flag("large_motion") && probe.radius_m == 0;
  if (is_tied) probe.contact_stiffness_N_per_m = CorotationalOptions{}.contact_stiffness_N_per_m;
  if (!values.has("contact_stiffness_N_per_m")) return probe;
  probe.contact_stiffness_N_per_m = values.number("contact_stiffness_N_per_m");
  if (!is_tied) return probe;
  (void)checked(positive_number("contact_stiffness_N_per_m", "", CorotationalOptions::kContactStiffnessMost_N_per_m),
                probe.contact_stiffness_N_per_m);
  return probe;
}

scene::SceneDynamicModel parse_tissue(CheckedTable& table, const std::string& name) {
  const std::vector<Parameter> keys = tissue_table().keys;
  const Values given = table.given(keys);
  table.refuse_unknown_keys();
  const Values values = completed(keys, given);
  std::string shape_text;
  TetrahedralMesh mesh = parse_mesh_of_tissue(table, values.flag("large_motion"), shape_text);
  shape_text += tissue::pieces_in_words(mesh);
  std::vector<int> held = parse_held(table, mesh);
  return table.built_at(table.node(), [&] {
    tissue::TissueDescription tissue{
        .mesh = std::move(mesh),
        .material = {.young_Pa = values.number("young_Pa"), .poisson = values.number("poisson")},
        .held_nodes = std::move(held),
        .probe = probe_of(values),
        .large_motion = values.flag("large_motion"),
        .skin_Pa_per_m = values.has("contact_stiffness_Pa_per_m") ? values.number("contact_stiffness_Pa_per_m") : 0};
    return scene::SceneDynamicModel{.name = name,
                                    .text = "tissue, " + shape_text + ", " + config::to_text(keys, given),
                                    .dynamic_model = std::make_unique<tissue::TissueDynamicModel>(std::move(tissue))};
  });
}

}  // namespace

std::vector<TableDescription> tissue_tables() { return {tissue_table(), tissue_of_file_table(), tissue_block_table()}; }

std::vector<scene::SceneDynamicModel> parse_tissues(CheckedTable& file) {
  std::vector<scene::SceneDynamicModel> dynamic_models;
  file.each("tissue", [&](CheckedTable& tissue, const std::string& name) {
    dynamic_models.push_back(parse_tissue(tissue, name));
  });
  return dynamic_models;
}

}  // namespace forcebound::server
