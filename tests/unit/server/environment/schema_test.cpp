#include "forcebound/server/environment/schema.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>

#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/text/file.hpp"
#include "tests/support/process.hpp"
#include "tests/support/source_folder.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kNobodysKey = "nobodys_key";

using Keys = std::map<std::string, std::string>;

/// Every key that each kind of shape may have, with a value that fits; of two that exclude each other, the first.
const std::map<std::string, Keys> kShapes{
    {"half_space", {{"through_m", "[0, 0, 0]"}, {"normal", "[0, 0, 1]"}}},
    {"sphere", {{"center_m", "[0, 0, 0]"}, {"radius_m", "1"}}},
    {"cavity", {{"center_m", "[0, 0, 0]"}, {"radius_m", "1"}}},
    {"box", {{"center_m", "[0, 0, 0]"}, {"size_m", "[1, 1, 1]"}}},
    {"capsule", {{"from_m", "[0, 0, 0]"}, {"to_m", "[0, 0, 1]"}, {"radius_m", "1"}}},
    {"cylinder", {{"from_m", "[0, 0, 0]"}, {"to_m", "[0, 0, 1]"}, {"radius_m", "1"}}},
    {"torus", {{"center_m", "[0, 0, 0]"}, {"axis", "[0, 0, 1]"}, {"major_radius_m", "2"}, {"minor_radius_m", "1"}}},
    {"height_field", {{"origin_m", "[0, 0, 0]"}, {"spacing_m", "1"}, {"heights_m", "[[0, 0], [0, 0]]"}}},
    {"mesh",
     {{"file", "'solid.obj'"},
      {"scale", "2"},
      {"rotation_deg", "[90, 0, 45]"},
      {"offset_m", "[1, 1, 1]"},
      {"detail", "0.5"},
      {"two_sided", "true"}}},
    {"distance_field",
     {{"file", "'solid.obj'"},
      {"scale", "2"},
      {"rotation_deg", "[90, 0, 45]"},
      {"offset_m", "[1, 1, 1]"},
      {"detail", "0.5"},
      {"spacing_m", "0.5"}}},
    {"lathe", {{"profile_m", "[[0, 0], [1, 0], [0, 1]]"}, {"segments", "8"}, {"origin_m", "[1, 1, 1]"}}}};

/// The start of the error for a scene file, or "no error". A mesh lies beside it.
std::string schema_error(const std::string& scene) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.file("solid.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  try {
    (void)parse_scene(scene, folder.file("x.toml"));
  } catch (const SceneError& error) {
    return error.what();
  }
  return "no error";
}

std::string error_of_shape(const std::string& kind, const Keys& keys) {
  std::string shape = "kind = '" + kind + "'";
  for (const auto& [key, value] : keys) shape.append(", ").append(key).append(" = ").append(value);
  return schema_error(
      "[scene]\nname = 'x'\ndescription = ''\ndegrees_of_freedom = 3\n[[object]]\nname = 'thing'\n"
      "effects = ['surface']\nsurface = { stiffness_N_per_m = 1 }\nshape = { " +
      shape + " }\n");
}

/// The names that an error lists as "(known: a, b)".
std::vector<std::string> known_in(const std::string& error) {
  std::string list = error.substr(std::min(error.size(), error.find("(known: ") + 8));
  std::vector<std::string> names(1);
  for (const char c : list) {
    if (c == ')') break;
    if (c == ',') {
      names.emplace_back();
    } else if (c != ' ') {
      names.back() += c;
    }
  }
  return names;
}

std::vector<std::string> keys_of(const std::vector<config::Parameter>& parameters, std::vector<std::string> also = {}) {
  for (const config::Parameter& parameter : parameters) also.emplace_back(key_of(parameter));
  return also;
}

const std::vector<scene::ShapeKind>& all_shapes() {
  static const scene::Registry kRegistry = scene::Registry::standard();
  return kRegistry.shapes();
}

TEST(Schema, IsThePageBesideTheScenes) {
  EXPECT_EQ(text::read_file((test::source_folder() / "server/scenes/README.md").string()),
            schema(scene::Registry::standard()))
      << "what scene files may have has changed; the page is written anew by\n"
         "    forcebound-server --schema > server/scenes/README.md";
}

TEST(Schema, BeginsWithAValidScene) {
  EXPECT_EQ(schema_error(schema_example()), "no error");
  EXPECT_THAT(schema(scene::Registry::standard()), HasSubstr("```toml\n" + schema_example() + "```"));
}

TEST(Schema, HasEveryKindOfShape) {
  std::vector<std::string> kinds;
  for (const scene::ShapeKind& shape : all_shapes()) kinds.emplace_back(shape.name);
  EXPECT_EQ(known_in(error_of_shape("nobodys_kind", {})), kinds);
}

TEST(Schema, HasExactlyTheKeysThatEachShapeIsReadFrom) {
  for (const scene::ShapeKind& shape : all_shapes()) {
    const std::string name(shape.name);
    Keys keys = kShapes.at(name);
    EXPECT_EQ(error_of_shape(name, keys), "no error") << name;
    keys[kNobodysKey] = "1";
    const std::string error = error_of_shape(name, keys);
    EXPECT_THAT(known_in(error), testing::UnorderedElementsAreArray(keys_of(shape.parameters, {"kind"}))) << error;
  }
}

TEST(Schema, TellsWhichKeysOfAShapeMayBeLeftOut) {
  for (const scene::ShapeKind& shape : all_shapes()) {
    for (const config::Parameter& parameter : shape.parameters) {
      const std::string key(key_of(parameter));
      // What excludes another is not among the keys, and the other one is missed in other words.
      Keys keys = kShapes.at(std::string(shape.name));
      if (keys.erase(key) == 0 || key == "heights_m") continue;
      const std::string expected = preset_text(parameter).empty() ? "'" + key + "' is missing" : "no error";
      EXPECT_THAT(error_of_shape(std::string(shape.name), keys), HasSubstr(expected)) << shape.name;
    }
  }
}

std::string refusal_of_minus_one(const std::string& key, const std::string& accepted) {
  return key + " must be " + accepted + ", got -1";
}

TEST(Schema, TellsTheRangeThatEachNumberOfAShapeIsHeldTo) {
  int numbers = 0;
  for (const scene::ShapeKind& shape : all_shapes()) {
    for (const config::Parameter& parameter : shape.parameters) {
      const std::string accepted = accepted_text(parameter);
      if (!accepted.starts_with('>')) continue;
      const std::string key(key_of(parameter));
      Keys keys = kShapes.at(std::string(shape.name));
      keys[key] = "-1";
      EXPECT_THAT(error_of_shape(std::string(shape.name), keys), HasSubstr(refusal_of_minus_one(key, accepted)));
      ++numbers;
    }
  }
  EXPECT_GE(numbers, 10);
}

TEST(Schema, HasASectionForEveryTableOfAFile) {
  const std::string page = schema(scene::Registry::standard());
  for (const std::string& table : known_in(schema_error(std::string(kNobodysKey) + " = 1\n"))) {
    EXPECT_THAT(page, testing::AnyOf(HasSubstr("# `[" + table + "]`\n"), HasSubstr("# `[[" + table + "]]`"))) << table;
  }
}

TEST(Schema, HasExactlyTheKeysOfEveryOtherTable) {
  const std::string nobodys = std::string(kNobodysKey) + " = 1\n";
  const std::string scene = "[scene]\nname = 'x'\ndescription = ''\ndegrees_of_freedom = 1\n";
  const std::string in_space = "[scene]\nname = 'x'\ndescription = ''\ndegrees_of_freedom = 3\n";
  const std::string ball = "shape = { kind = 'sphere', center_m = [0, 0, 0], radius_m = 0.1 }\n";
  const std::string object =
      "[[object]]\nname = 'x'\neffects = ['viscosity']\nviscosity = { damping_N_s_per_m = 1 }\n"
      "shape = { kind = 'sphere', center_m = [0], radius_m = 1 }\n";
  const std::string field = "[[field]]\nname = 'x'\neffects = ['viscosity']\nviscosity = { damping_N_s_per_m = 1 }\n";
  const auto levels = [&](const std::string& of_all, const std::string& of_one) {
    const std::string level = "{ value = 1, model_error = 0.1 }";
    return scene + "accuracy = 'auto'\n" + field + "[accuracy]\nkey = 'field.x.viscosity.damping_N_s_per_m'\n" +
           "change_per_s = 1\nlevels = [" + level + ", { value = 1, model_error = 0.1" + of_one + " }]\n" + of_all;
  };
  const std::map<std::string, std::pair<std::string, std::vector<std::string>>> wrong{
      {"`[accuracy]`", {levels(nobodys, ""), {}}},
      {"A level of `[accuracy]`", {levels("", ", " + std::string(kNobodysKey) + " = 1"), {}}},
      {"`[tool]`", {in_space + "[tool]\ntip_m = [0, 0, 0]\n" + nobodys, {"part"}}},
      {"`[[tool.part]]`", {in_space + "[tool]\n[[tool.part]]\nname = 'x'\n" + ball + nobodys, {}}},
      {"`[scene]`", {scene + "shared = true\n" + nobodys, {}}},
      {"`[[object]]`", {scene + object + nobodys, {"viscosity"}}},
      {"`[[field]]`", {scene + field + nobodys, {"viscosity"}}}};
  for (const config::TableDescription& table : part_tables()) {
    const auto& [text, effects] = wrong.at(table.title);
    const std::string error = schema_error(text);
    EXPECT_THAT(known_in(error), testing::UnorderedElementsAreArray(keys_of(table.keys, effects))) << error;
  }
}

TEST(Schema, HasExactlyTheKeysOfBodiesAndTissue) {
  if (!has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  const std::string nobodys = std::string(kNobodysKey) + " = 1\n";
  const std::string scene = "[scene]\nname = 'x'\ndescription = ''\ndegrees_of_freedom = 3\n";
  const auto body = [&](const std::string& shape) {
    return scene + "[[body]]\nname = 'b'\nmass_kg = 1\nshape = { " + shape + " }\n";
  };
  const std::string sphere = "kind = 'sphere', center_m = [0, 0, 0], radius_m = 1";
  const auto tissue = [&](const std::string& shape, const std::string& held) {
    return scene + "[[tissue]]\nname = 't'\nyoung_Pa = 1000\npoisson = 0.3\nshape = { kind = 'block', " + shape +
           " }\nheld = { " + held + " }\n";
  };
  const std::string block = "center_m = [0, 0, 0.5], size_m = [1, 1, 1], cells = [1, 1, 1]";
  const std::string below = "through_m = [0, 0, 0], normal = [0, 0, 1]";
  const std::string nobodys_too = ", " + std::string(kNobodysKey) + " = 1";
  using Errors = std::vector<std::string>;
  // A table that is read in several ways has all their keys.
  const std::map<std::string, Errors> wrong{
      {"`[[body]]` with a shape", {body(sphere) + nobodys}},
      {"`[bodies]`", {body(sphere) + "[bodies]\n" + nobodys}},
      {"`[[body]]` of an MJCF model",
       {scene + "[[body]]\nname = 'b'\nprobes = ['a']\nmjcf_text = '<mujoco><worldbody><body name=\"a\"><freejoint/>" +
        "<geom size=\"1\"/></body></worldbody></mujoco>'\n" + nobodys}},
      {"`[[tissue]]`", {tissue(block, below) + nobodys}},
      {"`shape = { kind = \"block\", ... }` of a `[[tissue]]`", {tissue(block + nobodys_too, below)}}};
  for (const config::TableDescription& table : dynamic_model_tables()) {
    const auto texts = wrong.find(table.title);
    if (texts == wrong.end()) continue;  // a file of tetrahedra is read in another test
    std::set<std::string> known;
    for (const std::string& text : texts->second) {
      const std::string error = schema_error(text);
      ASSERT_THAT(error, HasSubstr("unknown key '" + std::string(kNobodysKey) + "'")) << table.title;
      for (const std::string& key : known_in(error)) known.insert(key);
    }
    known.erase("kind");
    std::vector<std::string> documented = keys_of(table.keys);
    std::erase(documented, "kind");
    EXPECT_THAT(known, testing::UnorderedElementsAreArray(documented)) << table.title;
  }
}

TEST(Schema, TakesTheKeysOfShapesForBodiesAndForWhatTissueIsHeldBy) {
  if (!has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  const std::string scene = "[scene]\nname = 'x'\ndescription = ''\ndegrees_of_freedom = 3\n";
  const auto known = [&](const std::string& text) { return known_in(schema_error(scene + text)); };
  const auto keys = [](const scene::ShapeKind& kind, std::vector<std::string> also) {
    return testing::UnorderedElementsAreArray(keys_of(kind.parameters, std::move(also)));
  };
  const auto body = [](const std::string& shape) {
    return "[[body]]\nname = 'b'\nmass_kg = 1\nshape = { " + shape + ", nobodys_key = 1 }\n";
  };
  EXPECT_THAT(known(body("kind = 'sphere', center_m = [0, 0, 0], radius_m = 1")),
              keys(scene::sphere_shape(), {"kind"}));
  EXPECT_THAT(known(body("kind = 'box', center_m = [0, 0, 0], size_m = [1, 1, 1]")),
              keys(scene::box_shape(), {"kind"}));
  const auto tissue = [](const std::string& held) {
    return "[[tissue]]\nname = 't'\nyoung_Pa = 1000\npoisson = 0.3\nshape = { kind = 'block', center_m = [0, 0, 0.5], "
           "size_m = [1, 1, 1], cells = [1, 1, 1] }\nheld = { " +
           held + ", nobodys_key = 1 }\n";
  };
  EXPECT_THAT(known(tissue("through_m = [0, 0, 0], normal = [0, 0, 1]")), keys(scene::half_space_shape(), {}));
  EXPECT_THAT(known(tissue("center_m = [0, 0, 0], size_m = [9, 9, 0.1]")), keys(scene::box_shape(), {}));
}

TEST(Schema, HasEveryEffectWithTheMeaningOfEachParameter) {
  const scene::Registry registry = scene::Registry::standard();
  const std::string page = schema(registry);
  for (const scene::EffectKind& kind : registry.effects()) {
    EXPECT_THAT(page, HasSubstr("### " + std::string(kind.name) + "\n"));
    EXPECT_THAT(page, HasSubstr("    " + std::string(kind.law) + "\n"));
    for (const config::Parameter& parameter : kind.parameters) {
      EXPECT_NE(meaning_of(parameter), "") << kind.name << ", " << key_of(parameter);
      EXPECT_THAT(page, HasSubstr("* `" + std::string(key_of(parameter)) + "` ("));
    }
  }
}

TEST(Schema, HasTheEffectsThatAProgramAdds) {
  scene::Registry registry;
  registry.add(
      {.name = "tickle",
       .purpose = "tickles",
       .law = "f = |t|",
       .parameters = {scene::NumberParameter{.key = "often", .meaning = "|t|", .preset = 3, .least = 0, .most = 9}},
       .make = {}});
  const std::string page = schema(registry);
  EXPECT_THAT(page, HasSubstr("### tickle\n\nTickles. Of surface.\n\n    f = |t|\n"));
  EXPECT_THAT(page, HasSubstr("* `often` (>= 0 and <= 9; default 3): |t|\n"));
  EXPECT_THAT(page, Not(HasSubstr("### viscosity")));
}

}  // namespace
}  // namespace forcebound::server
