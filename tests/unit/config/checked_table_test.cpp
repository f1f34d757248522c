#include "forcebound/config/checked_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

namespace forcebound::config {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const std::vector<Parameter> kKeys{
    NumberParameter{.key = "stiffness_N_per_m", .least = 0},
    PointParameter{.key = "center_m", .preset = Eigen::Vector3d(0, 0, 0)},
    RowsParameter{.key = "heights_m", .absent = "flat"},
};

/// The error for a refused file.
std::string refusal_of(const std::string& text) {
  try {
    const Node node = parse_toml(text, "a.toml");
    (void)CheckedTable(node, "a.toml", "wall").all(kKeys, 2);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CheckedTable, ReadsDeclaredKeys) {
  const Node node = parse_toml("stiffness_N_per_m = 3\ncenter_m = [1, 0.5]\nheights_m = [[1, 2], [3, 4]]", "a.toml");
  const Values values = CheckedTable(node, "a.toml", "wall").all(kKeys, 2);
  EXPECT_EQ(values.number("stiffness_N_per_m"), 3);
  EXPECT_EQ(values.point("center_m"), Eigen::Vector3d(1, 0.5, 0));
  EXPECT_EQ(values.rows("heights_m"), (Rows{{1, 2}, {3, 4}}));
}

TEST(CheckedTable, RefusalNamesFileLinePlaceKeyAndValue) {
  EXPECT_EQ(refusal_of("\nstiffness_N_per_m = -2"), "a.toml:2: wall: stiffness_N_per_m must be >= 0, got -2");
  EXPECT_EQ(refusal_of("stiffness_N_per_m = 'much'"),
            "a.toml:1: wall: stiffness_N_per_m must be a finite number, got 'much'");
  EXPECT_EQ(refusal_of("stiffness_N_per_m = 2000-01-01"),
            "a.toml:1: wall: stiffness_N_per_m must be a finite number, got 2000-01-01");
  EXPECT_EQ(refusal_of("stiffness_N_per_m = 1\ncenter_m = [1, 2, 3]"),
            "a.toml:2: wall: center_m must have 2 numbers in this scene, got [1, 2, 3]");
  EXPECT_EQ(refusal_of("stiffness_N_per_m = 1\ncenter_m = { x = 1 }"),
            "a.toml:2: wall: center_m must be a list, got {x = 1}");
  EXPECT_EQ(refusal_of("stiffness_N_per_m = 1\nheights_m = [[1, 2],\n[1]]"),
            "a.toml:3: wall: row 2 of heights_m must have 2 numbers like the first, got 1");
}

TEST(CheckedTable, RefusalHasNoControlCharacters) {
  EXPECT_EQ(refusal_of("stiffness_N_per_m = \"\\u001b[2J\""),
            "a.toml:1: wall: stiffness_N_per_m must be a finite number, got '?[2J'");
  EXPECT_EQ(refusal_of("\"\\u009b2J\" = 1\nstiffness_N_per_m = 1"),
            "a.toml:1: wall: unknown key '??2J' (known: stiffness_N_per_m, center_m, heights_m)");
}

TEST(CheckedTable, MissingKeyErrorNamesASimilarKey) {
  EXPECT_EQ(refusal_of("stiffness = 1"),
            "a.toml:1: wall: 'stiffness_N_per_m' is missing, is 'stiffness' a misspelling of it? (accepted: >= 0)");
  EXPECT_EQ(refusal_of("centre_m = [1, 2]"), "a.toml:1: wall: 'stiffness_N_per_m' is missing (accepted: >= 0)");
  EXPECT_EQ(refusal_of("stiffness_N_per_m = 1\ncentre_m = [1, 2]"),
            "a.toml:2: wall: unknown key 'centre_m', did you mean 'center_m'? (known: stiffness_N_per_m, center_m, "
            "heights_m)");
}

TEST(CheckedTable, TakesNoDeclaredKeyForAMisspelling) {
  const std::vector<Parameter> keys{NumberParameter{.key = "major_radius_m", .least = 0},
                                    NumberParameter{.key = "minor_radius_m", .least = 0}};
  const Node node = parse_toml("minor_radius_m = 1", "a.toml");
  EXPECT_THAT([&] { (void)CheckedTable(node, "a.toml", "ring").all(keys); },
              ThrowsMessage<ConfigError>("a.toml:1: ring: 'major_radius_m' is missing (accepted: >= 0)"));
}

TEST(CheckedTable, ReadsAChoiceThatMustBeGiven) {
  const ChoiceParameter kind{.key = "kind", .choices = {"arm", "stage"}};
  const auto read = [&](const std::string& text) {
    const Node node = parse_toml(text, "a.toml");
    return CheckedTable(node, "a.toml", "device").choice(kind);
  };
  EXPECT_EQ(read("kind = 'stage'"), "stage");
  EXPECT_THAT([&] { (void)read(""); },
              ThrowsMessage<ConfigError>("a.toml:1: device: 'kind' is missing (accepted: \"arm\", \"stage\")"));
}

TEST(CheckedTable, TellsTheFirstGivenOfSeveralKeys) {
  constexpr std::array<std::string_view, 2> kKeysOfModel{"model", "model_text"};
  const auto read = [&](const std::string& text) {
    const Node node = parse_toml(text, "a.toml");
    return std::string(CheckedTable(node, "a.toml", "body").first_given(kKeysOfModel));
  };
  EXPECT_EQ(read("model_text = ''"), "model_text");
  EXPECT_EQ(read("model_text = ''\nmodel = ''"), "model");
  EXPECT_THAT([&] { (void)read("model_tex = ''"); },
              ThrowsMessage<ConfigError>("a.toml:1: body: one of 'model', 'model_text' must be given, is 'model_tex' a "
                                         "misspelling of 'model_text'?"));
  EXPECT_THAT([&] { (void)read(""); },
              ThrowsMessage<ConfigError>("a.toml:1: body: one of 'model', 'model_text' must be given"));
}

TEST(CheckedTable, RefusesPartsThatAreNoTables) {
  for (const char* const text : {"[object]\nname = 'x'", "object = 3", "object = [3]"}) {
    const Node node = parse_toml(text, "a.toml");
    CheckedTable file(node, "a.toml", "file");
    EXPECT_THAT([&] { file.each("object", [](CheckedTable&, const std::string&) {}); },
                ThrowsMessage<ConfigError>("a.toml:1: file: object must be tables, each [[object]]"))
        << text;
  }
}

TEST(CheckedTable, LaterErrorNamesTheLineOfItsKey) {
  const Node node = parse_toml("from_m = 1\nto_m = 1", "a.toml");
  const CheckedTable table(node, "a.toml", "wall");
  const auto of = [&](std::string_view key) {
    return
        [&table, key] { table.built_at(table.node(), [&] { throw ValueError(key, "to_m must differ from from_m"); }); };
  };
  EXPECT_THAT(of("to_m"), ThrowsMessage<ConfigError>("a.toml:2: wall: to_m must differ from from_m"));
  EXPECT_THAT(of("nobodys"), ThrowsMessage<ConfigError>("a.toml:1: wall: to_m must differ from from_m"));
}

TEST(CheckedTable, RefusesTwoPartsWithOneName) {
  const Node node = parse_toml("[[object]]\nname = 'x'\n[[field]]\nname = 'x'\n", "a.toml");
  CheckedTable file(node, "a.toml", "file");
  std::vector<std::string> names;
  const auto read = [&](CheckedTable& part, const std::string& name) {
    part.refuse_unknown_keys();
    names.push_back(name);
  };
  file.each("object", read);
  EXPECT_THAT([&] { file.each("field", read); },
              ThrowsMessage<ConfigError>("a.toml:3: file: [[object]] and [[field]] are named 'x'"));
  EXPECT_THAT(names, testing::ElementsAre("x")) << "the second is refused before it is read";
}

TEST(Node, IsWrittenAsToml) {
  const Node node = parse_toml("a = [1, 2.5, 'x', true, { b = \"it's\" }]", "a.toml");
  EXPECT_EQ(written(*node.find("a")), "[1, 2.5, 'x', true, {b = \"it's\"}]");
}

TEST(Node, RefusesInvalidToml) {
  EXPECT_THAT([] { (void)parse_toml("a = 1\nb = \n", "a.toml"); },
              ThrowsMessage<ConfigError>(testing::StartsWith("a.toml:2: not TOML: ")));
  EXPECT_THAT([] { (void)parse_toml_value("1\nb = 2", 7); },
              ThrowsMessage<ConfigError>(HasSubstr("must be a value as TOML writes it, got '1?b = 2'")));
  EXPECT_EQ(parse_toml_value("[1, 2]", 7).line, 7);
}

/// "a.a.a": a key of so many parts.
std::string key_of_parts(std::size_t parts) {
  std::string key(2 * parts - 1, 'a');
  for (std::size_t dot = 1; dot < key.size(); dot += 2) key[dot] = '.';
  return key;
}

TEST(Node, RefusesAKeyThatWouldOverflowTheStack) {
  const std::string deep = key_of_parts(50000);
  const auto refuses = [](const std::string& text) {
    EXPECT_THAT([&] { (void)parse_toml(text, "a.toml"); },
                ThrowsMessage<ConfigError>(
                    "a.toml:2: a key must have at most 8 parts, as a.b has two, got 'a.a.a.a.a.a.a.a...'"))
        << text.substr(0, 30);
  };
  refuses("\n" + deep + " = 1");
  refuses("\n" + deep);
  refuses("\n[" + deep + "]");
  refuses("\nb = { c = 1, " + deep + " = 1 }");
  refuses("\nb = { c = \"\"\"two\"\"\"\"\", " + deep + " = 1 }");
  refuses("\nb = { c = 'a\\', " + deep + " = 1 }");
  refuses("\n" + key_of_parts(9) + " = 1");
  EXPECT_THAT([&] { (void)parse_toml_value("{ " + deep + " = 1 }", 1); },
              ThrowsMessage<ConfigError>(testing::StartsWith("a key must have at most 8 parts")))
      << "the place is the caller's";
  refuses("\nb = [{ c = [1, { d = 1 }, 2], " + deep + " = 1 }]");
  refuses("\nb = { c = {}, " + deep + " = 1 }");
  EXPECT_THAT([&] { (void)parse_toml(deep + " = 1", "\x1b[2J"); },
              ThrowsMessage<ConfigError>(testing::StartsWith("?[2J:1: a key")));
}

TEST(Node, RefusesNestingThatWouldOverflowTheStack) {
  const auto lists = [](std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
  const auto tables = [](std::size_t levels) {
    std::string text;
    for (std::size_t i = 0; i < levels; ++i) text += "{ a = ";
    return text + "1" + std::string(levels, '}');
  };
  const std::string refusal = "lists and tables must be nested at most 32 deep, got more";
  for (const std::size_t levels : {kTomlLevelsMost + 1, std::size_t{50000}}) {
    for (const std::string& value : {lists(levels), tables(levels), std::string(levels, '[')}) {
      EXPECT_THAT([&] { (void)parse_toml("\na = " + value, "a.toml"); },
                  ThrowsMessage<ConfigError>("a.toml:2: " + refusal));
      EXPECT_THAT([&] { (void)parse_toml_value(value, 1); }, ThrowsMessage<ConfigError>(refusal));
    }
  }
  EXPECT_NO_THROW((void)parse_toml("a = " + lists(kTomlLevelsMost), "a.toml"));
  EXPECT_NO_THROW((void)parse_toml("a = " + tables(kTomlLevelsMost), "a.toml"));
}

TEST(Node, RefusesMoreBytesThanAFileOfOursHas) {
  const std::string comment = "#" + std::string(kTomlBytesMost, ' ');
  EXPECT_THAT([&] { (void)parse_toml(comment, "a.toml"); },
              ThrowsMessage<ConfigError>("a.toml: must have at most 16777216 bytes, got 16777217"));
  EXPECT_THAT([&] { (void)parse_toml_value("1 " + comment, 1); },
              ThrowsMessage<ConfigError>(testing::StartsWith("must have at most 16777216 bytes")));
}

TEST(Node, CountsNoPartsInValues) {
  const std::string dots = key_of_parts(20);
  for (const std::string& value : {dots, "[" + dots + "]", "[1,\n" + dots + "]", "{ b = [1, " + dots + "] }"}) {
    EXPECT_THAT([&] { (void)parse_toml("a = " + value, "a.toml"); },
                ThrowsMessage<ConfigError>(HasSubstr(": not TOML: ")))
        << value;
    EXPECT_THAT([&] { (void)parse_toml_value(value, 1); },
                ThrowsMessage<ConfigError>(HasSubstr("must be a value as TOML writes it")))
        << value;
  }
}

TEST(Node, TakesDotsInTextsCommentsAndNumbers) {
  EXPECT_NO_THROW((void)parse_toml(key_of_parts(8) + " = 1", "a.toml"));
  EXPECT_NO_THROW((void)parse_toml("a = '..........' # ..........\nb = \"\\\"..........\"\n", "a.toml"));
  EXPECT_NO_THROW((void)parse_toml("a = \"\"\"..........\n'..........\"\"\"\n\"..........\" = 1\n", "a.toml"));
  EXPECT_NO_THROW((void)parse_toml("a = [0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1]", "a.toml"));
}

}  // namespace
}  // namespace forcebound::config
