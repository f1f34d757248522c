#include "forcebound/server/environment/body_parser.hpp"

#include <algorithm>
#include <array>

#include "forcebound/server/dynamics/bodies/body_dynamic_model.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

constexpr Eigen::Index kAxes = 3;

double positive(CheckedTable& table, std::string_view key) {
  return table.number({.key = key, .least = 0, .least_excluded = true});
}

double positive(CheckedTable& table, std::string_view key, double preset) {
  return table.number({.key = key, .preset = preset, .least = 0, .least_excluded = true});
}

void parse_ends(CheckedTable& shape, BodyDescription& body) {
  const scene::Point from_m = shape.point("from_m", kAxes);
  const scene::Point to_m = shape.point("to_m", kAxes);
  if (from_m == to_m) shape.fail(shape.at("to_m"), "to_m must differ from from_m, got " + as_written(shape.at("to_m")));
  body.position_m = 0.5 * (from_m + to_m);
  body.half_axis_m = 0.5 * (to_m - from_m);
}

void parse_shape(CheckedTable& shape, BodyDescription& body) {
  using Shape = BodyDescription::Shape;
  static constexpr std::array<std::string_view, 4> kKinds{"box", "sphere", "capsule", "cylinder"};
  (void)shape.at("kind");
  const std::string kind = shape.choice("kind", kKinds);
  body.shape = kind == "box"       ? Shape::box
               : kind == "sphere"  ? Shape::sphere
               : kind == "capsule" ? Shape::capsule
                                   : Shape::cylinder;
  if (body.shape == Shape::box) {
    body.position_m = shape.point("center_m", kAxes);
    body.size_m = shape.point("size_m", kAxes);
    const toml::node& size = shape.at("size_m");
    if (!(body.size_m.minCoeff() > 0)) shape.fail(size, "size_m must be > 0 on every axis, got " + as_written(size));
    return;
  }
  if (body.shape == Shape::sphere) {
    body.position_m = shape.point("center_m", kAxes);
  } else {
    parse_ends(shape, body);
  }
  body.size_m = scene::Point::Constant(2 * positive(shape, "radius_m"));
}

BodyDescription parse_body(CheckedTable& table, const std::string& name) {
  BodyDescription body{.name = name};
  CheckedTable shape(table.table("shape"), table.file(), table.place() + ", shape");
  parse_shape(shape, body);
  shape.refuse_unknown_keys();
  // Which of the two is said, so that a mass that was forgotten is no wall.
  if (!table.flag("fixed", false)) {
    body.mass_kg = positive(table, "mass_kg");
  } else if (const toml::node* mass = table.find("mass_kg")) {
    table.fail(*mass, "a body is either fixed or has mass_kg");
  }
  body.friction = table.number({.key = "friction", .preset = body.friction, .least = 0});
  return body;
}

/// How the device is tied to its probe.
Coupling parse_coupling(CheckedTable& table) {
  const Coupling preset;
  return {
      .stiffness_N_per_m = positive(table, "stiffness_N_per_m", preset.stiffness_N_per_m),
      .damping_N_s_per_m = table.number({.key = "damping_N_s_per_m", .preset = preset.damping_N_s_per_m, .least = 0})};
}

SolverOptions parse_solver(CheckedTable& table) {
  using Kind = SolverOptions::Kind;
  static constexpr std::array<Kind, 3> kKinds{Kind::newton, Kind::cg, Kind::pgs};
  SolverOptions solver;
  if (table.find("solver") != nullptr) {
    std::array<std::string_view, kKinds.size()> words;
    std::ranges::transform(kKinds, words.begin(), name_of);
    const std::string word = table.choice("solver", words);
    solver.kind = kKinds.at(static_cast<std::size_t>(std::ranges::find(words, word) - words.begin()));
  }
  if (table.find("iterations") != nullptr) {
    solver.iterations = table.whole({.key = "iterations", .least = 1, .most = kIterationsMost});
  }
  if (table.find("tolerance") != nullptr) {
    solver.tolerance = table.number({.key = "tolerance", .least = 0, .most = kToleranceMost});
  }
  return solver;
}

/// [bodies]: what holds for all bodies with shapes.
BodiesDescription parse_setting(CheckedTable& table) {
  BodiesDescription all;
  if (table.find("gravity_m_per_s2") != nullptr) all.gravity_m_per_s2 = table.point("gravity_m_per_s2", kAxes);
  all.timestep_s =
      table.number({.key = "timestep_s", .preset = all.timestep_s, .least = kTimestepLeast_s, .most = kTimestepMost_s});
  all.contact_time_s =
      table.number({.key = "contact_time_s", .preset = all.contact_time_s, .least = 2 * all.timestep_s, .most = 1});
  all.solver = parse_solver(table);
  all.probe.radius_m = positive(table, "probe_radius_m", all.probe.radius_m);
  all.probe.mass_kg = positive(table, "probe_mass_kg", all.probe.mass_kg);
  all.coupling = parse_coupling(table);
  table.refuse_unknown_keys();
  return all;
}

std::vector<std::string> parse_probes(CheckedTable& table) {
  std::vector<std::string> probes;
  for (const toml::node& node : table.array("probes")) {
    const auto probe = node.value_exact<std::string>();
    if (!probe) table.fail(node, "probes must be names of bodies, got " + as_written(node));
    if (std::find(probes.begin(), probes.end(), *probe) != probes.end()) {
      table.fail(node, "probes must differ, got '" + *probe + "' twice");
    }
    probes.push_back(*probe);
  }
  if (probes.empty()) table.fail(table.at("probes"), "probes must name at least one body that the device drags");
  return probes;
}

scene::SceneDynamicModel parse_mjcf(CheckedTable& table, const std::string& name) {
  const bool is_file = table.find("mjcf") != nullptr;
  if (is_file && table.find("mjcf_text") != nullptr) {
    table.fail(table.at("mjcf_text"), "a body has either mjcf, a file, or mjcf_text");
  }
  const std::vector<std::string> probes = parse_probes(table);
  const Coupling coupling = parse_coupling(table);
  const SolverOptions solver = parse_solver(table);
  const std::string source = is_file ? table.path("mjcf") : table.text("mjcf_text");
  return table.built_at(table.at(is_file ? "mjcf" : "mjcf_text"), [&] {
    ModelPointer model = is_file ? load_mjcf(source) : compile_mjcf(source, "mjcf_text");
    return scene::SceneDynamicModel{
        .name = name,
        .text = "bodies, MJCF" + (table.values_text().empty() ? "" : ", " + table.values_text()),
        .dynamic_model = std::make_unique<BodyDynamicModel>(std::move(model), probes, coupling,
                                                            is_file ? source : std::string("mjcf_text"), solver)};
  });
}

bool is_mjcf(const toml::table& body) { return body.contains("mjcf") || body.contains("mjcf_text"); }

}  // namespace

bool has_bodies() noexcept { return true; }

std::vector<scene::SceneDynamicModel> parse_bodies(CheckedTable& file) {
  std::vector<scene::SceneDynamicModel> dynamic_models;
  const toml::node* setting = file.find("bodies");
  BodiesDescription all;
  std::string names;
  file.each("body", [&](const toml::table& body) {
    const std::string name = CheckedTable(body, file.file(), "body").name("name");
    CheckedTable table(body, file.file(), "body '" + name + "'");
    (void)table.at("name");
    if (is_mjcf(body)) {
      dynamic_models.push_back(parse_mjcf(table, name));
    } else {
      all.bodies.push_back(parse_body(table, name));
      names += (names.empty() ? "'" : ", '") + name + "'";
    }
    table.refuse_unknown_keys();
    return name;
  });
  if (all.bodies.empty()) {
    if (setting != nullptr) file.fail(*setting, "[bodies] sets up every [[body]] with a shape, of which there is none");
    return dynamic_models;
  }
  static const toml::table kNothing;
  CheckedTable checked(setting != nullptr ? file.table("bodies") : kNothing, file.file(), "bodies");
  std::vector<BodyDescription> bodies = std::move(all.bodies);
  all = parse_setting(checked);
  all.bodies = std::move(bodies);
  const toml::node& where = setting != nullptr ? *setting : file.at("body");
  dynamic_models.push_back(file.built_at(where, [&] {
    return scene::SceneDynamicModel{.name = "bodies",
                                    .text = "bodies " + names,
                                    .dynamic_model = std::make_unique<BodyDynamicModel>(std::move(all), "bodies")};
  }));
  return dynamic_models;
}

}  // namespace forcebound::server
