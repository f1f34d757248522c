#include "forcebound/server/environment/body_parser.hpp"

#include <algorithm>
#include <array>

#include "forcebound/scene/geometry/capsule.hpp"
#include "forcebound/scene/geometry/cylinder.hpp"
#include "forcebound/server/environment/body_models.hpp"

namespace forcebound::server {
namespace {

using config::CheckedTable;
using config::NumberParameter;
using config::OtherParameter;
using config::Parameter;
using config::TableDescription;
using config::TextParameter;
using config::Values;

NumberParameter positive(std::string_view key, std::string_view meaning, double preset) {
  return {.key = key, .meaning = meaning, .preset = preset, .least = 0, .least_excluded = true};
}

/// Keys of the coupling between the device and its probe.
std::vector<Parameter> coupling_parameters() {
  const Coupling preset;
  return {positive("stiffness_N_per_m", "of the spring between device and probe", preset.stiffness_N_per_m),
          NumberParameter{.key = "damping_N_s_per_m",
                          .meaning = "of the damper beside it",
                          .preset = preset.damping_N_s_per_m,
                          .least = 0}};
}

/// Texts for a model that says itself what is left out.
struct SolverPresets {
  std::string_view solver = "the model's";
  std::string_view iterations = "the model's";
  std::string_view tolerance = "the model's";
};

std::vector<Parameter> solver_parameters(const SolverPresets& preset) {
  return {config::ChoiceParameter{.key = "solver",
                                  .meaning = "MuJoCo's, of the forces in contacts and joints",
                                  .choices = {kSolverNames.begin(), kSolverNames.end()},
                                  .absent = preset.solver},
          NumberParameter{.key = "iterations",
                          .meaning = "of the solver, at most",
                          .least = 1,
                          .most = kIterationsMost,
                          .whole = true,
                          .absent = preset.iterations},
          NumberParameter{.key = "tolerance",
                          .meaning = "the solver ends with the first iteration that improves less",
                          .least = 0,
                          .most = kToleranceMost,
                          .absent = preset.tolerance}};
}

std::vector<Parameter> with(std::vector<Parameter> all, const std::vector<Parameter>& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

TableDescription body_table() {
  return {"`[[body]]` with a shape",
          "A rigid body that moves, or that others rest on. All of them are one world.",
          {config::name_of_part(),
           OtherParameter{.key = "shape",
                          .meaning = "`kind` is `\"box\"`, `\"sphere\"`, `\"capsule\"` or `\"cylinder\"`, with the "
                                     "keys of the [shape](#shapes) of that name"},
           NumberParameter{.key = "mass_kg",
                           .meaning = "of a body that moves",
                           .least = 0,
                           .least_excluded = true,
                           .absent = "`fixed`"},
           config::FlagParameter{.key = "fixed", .meaning = "whether it does not move; then it has no mass"},
           NumberParameter{.key = "friction",
                           .meaning = "coefficient; between two bodies, the larger",
                           .preset = BodyDescription{}.friction,
                           .least = 0}}};
}

TableDescription setting_table() {
  const BodiesDescription preset;
  return {
      "`[bodies]`",
      "What holds for all bodies with shapes, and for the ball that is the device among them. The table may be left "
      "out.",
      with(with({config::PointParameter{
                     .key = "gravity_m_per_s2", .meaning = "of all bodies", .preset = preset.gravity_m_per_s2},
                 NumberParameter{.key = "timestep_s",
                                 .meaning = "of MuJoCo",
                                 .preset = preset.timestep_s,
                                 .least = kTimestepLeast_s,
                                 .most = kTimestepMost_s},
                 NumberParameter{.key = "contact_time_s",
                                 .meaning = "in which a contact pushes apart what has sunk in, at least two time "
                                            "steps: the less the harder",
                                 .preset = preset.contact_time_s,
                                 .least = 2 * kTimestepLeast_s,
                                 .most = 1},
                 positive("probe_radius_m", "of the ball", preset.probe.radius_m),
                 positive("probe_mass_kg", "of the ball", preset.probe.mass_kg),
                 NumberParameter{.key = "grasp_button",
                                 .meaning = "of the device: while it is pressed, the ball holds the first body that "
                                            "moves which it touches, as that is, without a turn",
                                 .least = 0,
                                 .most = scene::Handle::kButtons - 1,
                                 .whole = true,
                                 .absent = "the ball only pushes"},
                 positive("grasp_N_max", "of that hold; under more than this for 20 ms the body slips out of it",
                          GraspDescription{}.force_N_max)},
                coupling_parameters()),
           solver_parameters({.solver = "`\"newton\"`", .iterations = "100", .tolerance = "1e-08"}))};
}

TableDescription mjcf_table() {
  return {"`[[body]]` of an MJCF model",
          "A world of its own, as MuJoCo reads it, of integrator `Euler` or `implicit`, in one text: it names no "
          "further file, its meshes have `vertex` and `face`. The device drags one of its bodies by the center of "
          "mass.",
          with(with({config::name_of_part(),
                     TextParameter{.key = "mjcf",
                                   .meaning = "the model, one of the two",
                                   .form = TextParameter::Form::file,
                                   .absent = "`mjcf_text`"},
                     TextParameter{.key = "mjcf_text",
                                   .meaning = "the same in the scene itself",
                                   .accepted = "`<mujoco>...</mujoco>`",
                                   .absent = "`mjcf`"},
                     OtherParameter{.key = "probes",
                                    .meaning = "what devices drag, one each; in a shared scene as many as clients",
                                    .accepted = "a list of names"}},
                    coupling_parameters()),
               solver_parameters({}))};
}

void parse_shape_of_body(CheckedTable& shape, BodyDescription& body) {
  static const std::array kKinds{scene::box_shape(), scene::sphere_shape(), scene::capsule_shape(),
                                 scene::cylinder_shape()};
  config::ChoiceParameter kinds{.key = "kind"};
  for (const scene::ShapeKind& kind : kKinds) kinds.choices.push_back(kind.name);
  body.shape = shape.choice(kinds);
  const Values values = shape.all(std::ranges::find(kKinds, body.shape, &scene::ShapeKind::name)->parameters);
  if (values.has("radius_m")) body.size_m = scene::Point::Constant(2 * values.number("radius_m"));
  if (values.has("size_m")) body.size_m = values.point("size_m");
  if (values.has("center_m")) {
    body.position_m = values.point("center_m");
  } else {
    shape.built_at(shape.node(), [&] { scene::check_straight(values); });
    body.position_m = 0.5 * (values.point("from_m") + values.point("to_m"));
    body.half_axis_m = 0.5 * (values.point("to_m") - values.point("from_m"));
  }
}

BodyDescription parse_body(CheckedTable& table, const std::string& name) {
  const Values values = table.all(body_table().keys);
  BodyDescription body{.name = name};
  CheckedTable shape = table.table("shape");
  parse_shape_of_body(shape, body);
  // One of the two is required, so that a forgotten mass does not fix the body.
  if (!values.flag("fixed")) {
    (void)table.at("mass_kg", "> 0, or fixed = true in its place");
    body.mass_kg = values.number("mass_kg");
  } else if (values.has("mass_kg")) {
    table.fail(table.at("mass_kg"), "a body is either fixed or has mass_kg");
  }
  body.friction = values.number("friction");
  return body;
}

Coupling coupling_of(const Values& values) {
  return {.stiffness_N_per_m = values.number("stiffness_N_per_m"),
          .damping_N_s_per_m = values.number("damping_N_s_per_m")};
}

SolverOptions solver_of(const Values& values) {
  SolverOptions solver;
  if (values.has("solver")) {
    const auto word = std::ranges::find(kSolverNames, values.text("solver"));
    solver.kind = static_cast<SolverOptions::Kind>(word - kSolverNames.begin());
  }
  if (values.has("iterations")) solver.iterations = values.whole("iterations");
  if (values.has("tolerance")) solver.tolerance = values.number("tolerance");
  return solver;
}

/// [bodies]: what holds for all bodies with shapes.
BodiesDescription parse_setting(CheckedTable& table) {
  const Values values = table.all(setting_table().keys);
  BodiesDescription all;
  all.gravity_m_per_s2 = values.point("gravity_m_per_s2");
  all.timestep_s = values.number("timestep_s");
  all.contact_time_s =
      table.number({.key = "contact_time_s", .preset = all.contact_time_s, .least = 2 * all.timestep_s, .most = 1});
  all.solver = solver_of(values);
  all.probe = {.radius_m = values.number("probe_radius_m"), .mass_kg = values.number("probe_mass_kg")};
  all.coupling = coupling_of(values);
  if (values.has("grasp_button")) {
    all.grasp = {.button = values.whole("grasp_button"), .force_N_max = values.number("grasp_N_max")};
  }
  return all;
}

std::vector<std::string> parse_probes(CheckedTable& table) {
  std::vector<std::string> probes;
  for (const config::Node& node : table.list("probes")) {
    const auto* const probe = node.as<std::string>();
    if (probe == nullptr) table.fail(node, "probes must be names of bodies, got " + written(node));
    if (std::ranges::find(probes, *probe) != probes.end()) {
      table.fail(node, "probes must differ, got '" + *probe + "' twice");
    }
    probes.push_back(*probe);
  }
  if (probes.empty()) table.fail(table.at("probes"), "probes must name at least one body that the device drags");
  return probes;
}

scene::SceneDynamicModel parse_mjcf(CheckedTable& table, const std::string& name) {
  const std::vector<Parameter> keys = mjcf_table().keys;
  const Values given = table.given(keys);
  table.refuse_unknown_keys();
  const bool is_file = given.has("mjcf");
  if (is_file && given.has("mjcf_text")) {
    table.fail(table.at("mjcf_text"), "a body has either mjcf, a file, or mjcf_text");
  }
  const Values values = completed(keys, given);
  MjcfDescription mjcf{.probes = parse_probes(table), .coupling = coupling_of(values), .solver = solver_of(values)};
  if (is_file) {
    mjcf.path = table.path_at("mjcf", values.text("mjcf"));
  } else {
    mjcf.text = values.text("mjcf_text");
  }
  const std::string text = config::to_text(keys, given);
  return table.built_at(table.at(is_file ? "mjcf" : "mjcf_text"), [&] {
    return scene::SceneDynamicModel{
        .name = name, .text = "bodies, MJCF" + (text.empty() ? "" : ", " + text), .dynamic_model = make_mjcf(mjcf)};
  });
}

}  // namespace

std::vector<TableDescription> body_tables() { return {body_table(), setting_table(), mjcf_table()}; }

std::vector<scene::SceneDynamicModel> parse_bodies(CheckedTable& file) {
  std::vector<scene::SceneDynamicModel> dynamic_models;
  constexpr std::array<std::string_view, 3> kSources{"mjcf", "mjcf_text", "shape"};
  const config::Node* const setting = file.find("bodies");
  std::vector<BodyDescription> bodies;
  std::string names;
  file.each("body", [&](CheckedTable& table, const std::string& name) {
    if (!has_bodies()) table.built_at(table.node(), [] { return make_bodies({}); });
    if (table.first_given(kSources) != kSources.back()) {
      dynamic_models.push_back(parse_mjcf(table, name));
      return;
    }
    bodies.push_back(parse_body(table, name));
    names += (names.empty() ? "'" : ", '") + name + "'";
  });
  if (bodies.empty()) {
    if (setting == nullptr) return dynamic_models;
    if (!has_bodies()) file.built_at(*setting, [] { return make_bodies({}); });
    file.fail(*setting, "[bodies] sets up every [[body]] with a shape, of which there is none");
  }
  const config::Node no_setting;
  CheckedTable table = setting != nullptr ? file.table("bodies", "bodies") : CheckedTable(no_setting, "", "");
  BodiesDescription all = parse_setting(table);
  all.bodies = std::move(bodies);
  dynamic_models.push_back(file.built_at(setting != nullptr ? *setting : file.at("body"), [&] {
    return scene::SceneDynamicModel{
        .name = "bodies", .text = "bodies " + names, .dynamic_model = make_bodies(std::move(all))};
  }));
  return dynamic_models;
}

}  // namespace forcebound::server
