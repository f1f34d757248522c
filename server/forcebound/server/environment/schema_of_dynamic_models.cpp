#include "forcebound/server/dynamics/bodies/description.hpp"
#include "forcebound/server/dynamics/tissue/corotational_options.hpp"
#include "forcebound/server/dynamics/tissue/tissue_contact.hpp"
#include "forcebound/server/environment/schema.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

SchemaKey place(std::string_view key, std::string_view meaning) {
  return described(scene::PointParameter{.key = key, .meaning = meaning});
}

SchemaKey positive(std::string_view key, std::string_view meaning) {
  return described(scene::NumberParameter{.key = key, .meaning = meaning, .least = 0, .least_excluded = true});
}

SchemaKey positive(std::string_view key, std::string_view meaning, double preset) {
  return described(
      scene::NumberParameter{.key = key, .meaning = meaning, .preset = preset, .least = 0, .least_excluded = true});
}

SchemaKey not_negative(std::string_view key, std::string_view meaning, double preset) {
  return described(scene::NumberParameter{.key = key, .meaning = meaning, .preset = preset, .least = 0});
}

SchemaKey size() { return {"size_m", "from face to face, along the axes", "a list of numbers, each > 0"}; }

SchemaKey name() { return {"name", "for errors, logs and `--explain`", "1 to 64 printable characters"}; }

std::vector<SchemaKey> coupling_keys() {
  const Coupling preset;
  return {positive("stiffness_N_per_m", "of the spring between device and probe", preset.stiffness_N_per_m),
          not_negative("damping_N_s_per_m", "of the damper beside it", preset.damping_N_s_per_m)};
}

/// @param ...preset where the scene is silent
std::vector<SchemaKey> solver_keys(const char* solver, const char* iterations, const char* tolerance) {
  return {{"solver", "MuJoCo's, of the forces in contacts and joints", "`\"newton\"`, `\"cg\"` or `\"pgs\"`", solver},
          {"iterations", "of the solver, at most", "a whole number from 1 to " + std::to_string(kIterationsMost),
           iterations},
          {"tolerance", "the solver ends with the first iteration that improves less",
           ">= 0 and <= " + text::to_text(kToleranceMost), tolerance}};
}

SchemaTable setting_table() {
  const BodiesDescription preset;
  SchemaTable table{"`[bodies]`",
                    "What holds for all bodies with shapes, and for the ball that is the device among them. The table "
                    "may be left out.",
                    {{"gravity_m_per_s2", "of all bodies", "a vector", "[0, 0, -9.80665]"},
                     described(scene::NumberParameter{.key = "timestep_s",
                                                      .meaning = "of MuJoCo",
                                                      .preset = preset.timestep_s,
                                                      .least = kTimestepLeast_s,
                                                      .most = kTimestepMost_s}),
                     {"contact_time_s", "in which a contact pushes apart what has sunk in: the less the harder",
                      "at least two time steps, <= 1", text::to_text(preset.contact_time_s)},
                     positive("probe_radius_m", "of the ball", preset.probe.radius_m),
                     positive("probe_mass_kg", "of the ball", preset.probe.mass_kg)}};
  for (SchemaKey& key : coupling_keys()) table.keys.push_back(std::move(key));
  for (SchemaKey& key : solver_keys("`\"newton\"`", "100", "1e-08")) table.keys.push_back(std::move(key));
  return table;
}

SchemaTable mjcf_table() {
  SchemaTable table{
      "`[[body]]` of an MJCF model",
      "A world of its own, as MuJoCo reads it, of integrator `Euler` or `implicit`. The device drags one of "
      "its bodies by the center of mass.",
      {name(),
       {"mjcf", "the model, one of the two", "a file beside the scene's", "`mjcf_text`"},
       {"mjcf_text", "the same in the scene itself", "`<mujoco>...</mujoco>`", "`mjcf`"},
       {"probes", "what devices drag, one each; in a shared scene as many as clients", "a list of names"}}};
  for (SchemaKey& key : coupling_keys()) table.keys.push_back(std::move(key));
  for (SchemaKey& key : solver_keys("the model's", "the model's", "the model's")) table.keys.push_back(std::move(key));
  return table;
}

std::string most_skin() {
  return "> 0 and <= " + text::to_text(CorotationalOptions::kSkinMost) +
         " `young_Pa` / (1 - `poisson`^2) / `probe_radius_m`";
}

SchemaTable tissue_table() {
  const ProbeOptions preset;
  return {
      "`[[tissue]]`",
      "An elastic body of tetrahedra, quasi-static, without friction.",
      {name(),
       {"shape", "a table, see below", "a table"},
       {"held", "what does not move; a table, see below", "a table"},
       positive("young_Pa", "Young's modulus: 1e3 for brain, 1e4 for liver, 1e5 for skin"),
       {"poisson", "Poisson's ratio; what is above 0.45 locks, and `--explain` says so", ">= 0 and <= 0.4999"},
       not_negative("probe_radius_m",
                    "of the sphere that touches it; 0: a point, which sinks in the deeper the finer the mesh",
                    preset.radius_m),
       {"contact_stiffness_N_per_m", "of each contact, in series with the tissue; not of a sphere with `large_motion`",
        "> 0; of a point with `large_motion` <= " + text::to_text(CorotationalOptions::kContactStiffnessMost_N_per_m),
        text::to_text(preset.contact_stiffness_N_per_m) + "; with `large_motion` " +
            text::to_text(CorotationalOptions{}.contact_stiffness_N_per_m)},
       {"contact_stiffness_Pa_per_m",
        "of a sphere's skin with `large_motion`, in series with the tissue: pressure by depth", most_skin(),
        text::to_text(CorotationalOptions::kSkin) +
            " of these: it gives way by 2 % of a depth of the radius, 4 % of a quarter"},
       {"contacts_max", "at once; with `large_motion` nothing limits them",
        "a whole number from 1 to " + std::to_string(kContactsMax), std::to_string(preset.contacts_max)},
       {"large_motion",
        "whether it may bend far, under a point or a sphere: so much dearer that a thousand tetrahedra may take the "
        "whole tick, as "
        "`--explain` says",
        "`true` or `false`", "`false`"}}};
}

std::vector<SchemaKey> keys_of_file() {
  std::vector<SchemaKey> keys{{"file", "Gmsh, ASCII of version 1, 2 or 4.1", "a file beside the scene's"}};
  for (SchemaKey& key : placement_keys()) keys.push_back(std::move(key));
  return keys;
}

}  // namespace

std::vector<SchemaTable> dynamic_model_tables() {
  return {
      {"`[[body]]` with a shape",
       "A rigid body that moves, or that others rest on. All of them are one world.",
       {name(),
        {"shape", "a table, see below", "a table"},
        {"mass_kg", "of a body that moves", "> 0", "`fixed`"},
        {"fixed", "whether it does not move; then it has no mass", "`true` or `false`", "`false`"},
        not_negative("friction", "coefficient; between two bodies, the larger", BodyDescription{}.friction)}},
      {"`shape` of a `[[body]]`",
       "`kind` is `\"box\"` or `\"sphere\"`, with a center, or `\"capsule\"` or `\"cylinder\"`, with two ends.",
       {{"kind", "see above", "a name"},
        {"center_m", "of a box or a sphere", "a point", "`from_m`, `to_m`"},
        size(),
        {"from_m", "one end of the axis", "a point", "`center_m`"},
        {"to_m", "the other end", "a point", "`center_m`"},
        positive("radius_m", "of all but a box")}},
      setting_table(),
      mjcf_table(),
      tissue_table(),
      {"`shape = { kind = \"mesh\", ... }` of a `[[tissue]]`", "Tetrahedra from a file.", keys_of_file()},
      {"`shape = { kind = \"block\", ... }` of a `[[tissue]]`",
       "A block along the axes, of cells of six tetrahedra each.",
       {place("center_m", "its center"),
        size(),
        rotation_key(
            "roll, pitch and yaw: turned about its center and the directions of the scene's x, then y, then z axis"),
        {"cells", "along each axis", "a list of whole numbers from 1 to 64"}}},
      {"`held` of a `[[tissue]]`",
       "The nodes on or below a plane, or those in a block, where the tissue lies in the scene.",
       {{"through_m", "a point of the plane", "a point", "`center_m`"},
        {"normal", "out of what is held", "a direction", "`size_m`"},
        {"center_m", "of the block", "a point", "`through_m`"},
        {"size_m", "from face to face, along the axes", "a list of numbers, each > 0", "`normal`"}}},
  };
}

}  // namespace forcebound::server
