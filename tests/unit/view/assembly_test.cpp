#include "forcebound/view/assembly.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

namespace forcebound::view {
namespace {

using Json = nlohmann::json;
using scene::VisiblePart;
using testing::HasSubstr;

constexpr std::uint64_t kSession = 7;

VisiblePart pad(std::size_t vertices) {
  VisiblePart part{.name = "pad", .kind = VisiblePart::Kind::surface};
  for (std::size_t i = 0; i < vertices; ++i) part.vertices_m.emplace_back(1e-3 * static_cast<double>(i), 0.01, 0.02);
  for (std::uint32_t i = 0; i + 2 < vertices; ++i) part.triangles.push_back({i, i + 1, i + 2});
  return part;
}

VisiblePart block(const std::string& name) {
  return {.name = name,
          .kind = VisiblePart::Kind::box,
          .half_m = scene::Point(0.01, 0.02, 0.03),
          .place_m = scene::Point(0.1, 0.2, 0.3)};
}

/// A pad of some pieces, a table and two blocks.
Description sample(std::size_t vertices = 500) {
  VisiblePart table{.name = "table", .kind = VisiblePart::Kind::half_space};
  const std::vector<std::vector<VisiblePart>> models{{pad(vertices)}, {block("one"), block("two"), table}};
  return describe({.name = "sample", .more = "a field"}, models);
}

Assembly::Piece piece_of(const Description& description, std::uint32_t number) {
  return {.session = kSession,
          .view = description.hash,
          .pieces = description.pieces(),
          .number = number,
          .content = description.piece(number)};
}

/// @returns whether the last one completed it
bool give_all(Assembly& assembly, const Description& description) {
  bool complete = false;
  for (std::uint32_t i = 0; i < description.pieces(); ++i) complete = assembly.add(piece_of(description, i));
  return complete;
}

bool is_taken(const std::string& text) {
  const Description description{.text = text, .hash = hash_of(text)};
  Assembly assembly;
  return give_all(assembly, description);
}

TEST(Assembly, PutsPiecesInAnyOrderTogetherAndTakesDoubledOnesOnce) {
  const Description description = sample();
  ASSERT_GT(description.pieces(), 5U);
  Assembly assembly;
  for (std::uint32_t i = description.pieces(); i-- > 0;) {
    if (i == 3) continue;  // lost
    EXPECT_FALSE(assembly.add(piece_of(description, i)));
    EXPECT_FALSE(assembly.add(piece_of(description, i)));
  }
  EXPECT_TRUE(assembly.add(piece_of(description, 3)));
  EXPECT_FALSE(give_all(assembly, description)) << "the next round is nothing new";
  const Json message = Json::parse(scene_message(1, assembly.scene()->shown));
  EXPECT_EQ(message["name"], "sample");
  EXPECT_EQ(message["more"], "a field");
  ASSERT_EQ(message["shapes"].size(), 3);
  EXPECT_EQ(message["shapes"][0]["size_m"], Json({0.02, 0.04, 0.06}));
  EXPECT_EQ(message["shapes"][2]["kind"], "half_space");
  ASSERT_EQ(message["meshes"].size(), 1);
  EXPECT_EQ(message["meshes"][0]["vertices_m"].size(), 1500);
  EXPECT_TRUE(message["meshes"][0]["moves"]);
}

TEST(Assembly, TellsWhatMovedOnceAndAllOfItAgainWhereAsked) {
  const Description description = sample(4);
  Assembly assembly;
  ASSERT_TRUE(give_all(assembly, description));
  EXPECT_EQ(assembly.take_moved(0), "");
  const std::vector<float> first{1, 2, 3, 4, 5, 6};
  const std::vector<float> rest{7, 8, 9, 10, 11, 12};
  Assembly::Piece piece{.session = kSession, .view = description.hash, .content = std::as_bytes(std::span(first))};
  (void)assembly.add(piece);
  EXPECT_EQ(assembly.take_moved(0), "") << "not before all of the surface is known";
  piece.first = 2;
  piece.content = std::as_bytes(std::span(rest));
  (void)assembly.add(piece);
  const Json moved = Json::parse(assembly.take_moved(1));
  EXPECT_EQ(moved["track"], 1);
  EXPECT_EQ(moved["meshes"][0]["name"], "pad");
  EXPECT_EQ(moved["meshes"][0]["vertices_m"], Json({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
  EXPECT_EQ(assembly.take_moved(0), "");
  (void)assembly.add(piece);
  EXPECT_EQ(assembly.take_moved(0), "") << "it stays where it is";
  const std::vector<float> place{1, 2, 3, 1, 0, 0, 0};
  (void)assembly.add({.session = kSession,
                      .view = description.hash,
                      .number = 1,
                      .first = 1,
                      .content = std::as_bytes(std::span(place))});
  const Json turned = Json::parse(assembly.take_moved(0));
  EXPECT_EQ(turned["meshes"].size(), 0);
  EXPECT_EQ(turned["bodies"],
            Json::array({{{"name", "two"}, {"position_m", {1, 2, 3}}, {"orientation", {1, 0, 0, 0}}}}));
  assembly.report_all_again();
  EXPECT_EQ(Json::parse(assembly.take_moved(0))["meshes"].size(), 1);
}

TEST(Assembly, TellsValuesByTheirNamesAndFactsOfARobot) {
  const Description description = describe({.name = "plug", .robot = R"({"architecture":"position-force"})"}, {},
                                           {{.names = {"solid"}}, {.names = {"lag_m", "state"}, .values = true}});
  Assembly assembly;
  ASSERT_TRUE(give_all(assembly, description));
  EXPECT_EQ(scene_message(0, assembly.scene()->shown),
            R"({"kind":"scene","track":0,"name":"plug","shapes":[],"meshes":[],"more":"",)"
            R"("robot":{"architecture":"position-force"}})");
  const std::vector<float> values{0.5F, 2};
  EXPECT_FALSE(assembly.add(
      {.session = kSession, .view = description.hash, .number = 1, .content = std::as_bytes(std::span(values))}));
  const Json moved = Json::parse(assembly.take_moved(0));
  EXPECT_EQ(moved["values"], (Json{{"lag_m", 0.5}, {"state", 2}}));
  EXPECT_TRUE(assembly.take_moved(0).empty()) << "once";
}

TEST(Assembly, TellsOfTheToolInTheHandAndWhereTheHandBegins) {
  ShownScene needle{.name = "needle"};
  needle.tool_m = (control::Vector(3) << 0, 0, -0.125).finished();
  needle.begin_m = (control::Vector(2) << 0.25, 0.5).finished();
  const auto received = read_description(describe(needle, {}).text);
  ASSERT_TRUE(received);
  EXPECT_EQ(received->shown.tool_m, needle.tool_m);
  EXPECT_EQ(received->shown.begin_m, needle.begin_m);
  EXPECT_EQ(Json::parse(scene_message(0, received->shown))["tool_m"], Json({0, 0, -0.125}));
}

TEST(Assembly, ForgetsTheSceneOfAnotherSession) {
  const Description description = sample();
  Assembly assembly;
  ASSERT_TRUE(give_all(assembly, description));
  Assembly::Piece piece = piece_of(description, 0);
  piece.session = kSession + 1;
  (void)assembly.add(piece);
  EXPECT_FALSE(assembly.scene().has_value());
}

TEST(Assembly, PassesOverMovementsThatDoNotFit) {
  const Description description = sample(4);
  Assembly assembly;
  ASSERT_TRUE(give_all(assembly, description));
  const std::vector<float> numbers{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  const std::vector<float> not_finite{1, 2, std::numeric_limits<float>::quiet_NaN()};
  const Assembly::Piece good{
      .session = kSession, .view = description.hash, .content = std::as_bytes(std::span(numbers))};
  const auto pass_over = [&](auto change) {
    Assembly::Piece piece = good;
    change(piece);
    (void)assembly.add(piece);
    EXPECT_EQ(assembly.take_moved(0), "");
  };
  pass_over([](auto& piece) { piece.view ^= 1; });
  pass_over([](auto& piece) { piece.number = 2; });
  pass_over([](auto& piece) { piece.first = 3; });
  pass_over([](auto& piece) { piece.first = ~0U; });
  pass_over([](auto& piece) { piece.content = piece.content.first(11); });
  pass_over([&](auto& piece) { piece.content = std::as_bytes(std::span(not_finite)); });
  (void)assembly.add(good);
  EXPECT_NE(assembly.take_moved(0), "");
}

TEST(Assembly, RefusesDescriptionsThatAreNotSound) {
  const std::string begin = R"({"name":"a","more":"","shapes":[)";
  EXPECT_TRUE(is_taken(
      begin + R"({"name":"b","kind":"box","size_m":[1,null,2],"rows":[[1,2],[3]]}],"meshes":[],"moving":[]})"));
  EXPECT_FALSE(is_taken("no JSON"));
  EXPECT_FALSE(is_taken("[]"));
  EXPECT_FALSE(is_taken(R"({"name":"a"})"));
  EXPECT_FALSE(is_taken(begin + R"({"name":"b"}],"meshes":[],"moving":[]})"));
  EXPECT_FALSE(is_taken(begin + R"({"name":"b","kind":"lathe","segments":1e9}],"meshes":[],"moving":[]})"));
  EXPECT_FALSE(is_taken(begin + R"({"name":"b","kind":"box","deep":{"a":1}}],"meshes":[],"moving":[]})"));
  EXPECT_FALSE(is_taken(begin + R"({"name":"b","kind":"box","deep":[[[1]]]}],"meshes":[],"moving":[]})"));
  const auto with_mesh = [&begin](const std::string& mesh) {
    return is_taken(begin + R"(],"meshes":[{"name":"m",)" + mesh + R"(}],"moving":[]})");
  };
  EXPECT_TRUE(with_mesh(R"("vertices_m":[0,0,0,1,1,1],"triangles":[0,1,1])"));
  EXPECT_FALSE(with_mesh(R"("vertices_m":[0,0,0,1,1],"triangles":[0,1,1])"));
  EXPECT_FALSE(with_mesh(R"("vertices_m":[0,0,0,1,1,null],"triangles":[0,1,1])"));
  EXPECT_FALSE(with_mesh(R"("vertices_m":[0,0,0,1,1,1],"triangles":[0,1,2])"));
  EXPECT_FALSE(with_mesh(R"("vertices_m":[0,0,0,1,1,1],"triangles":[0,1,-1])"));
  EXPECT_FALSE(with_mesh(R"("vertices_m":[],"triangles":[],"deep":[[[[]]]])"));
  const auto moving = [&begin](const std::string& groups) {
    return is_taken(begin + R"(],"meshes":[],"moving":[)" + groups + "]}");
  };
  EXPECT_TRUE(moving(R"({"names":["a","b"],"vertices":0})"));
  EXPECT_FALSE(moving(R"({"names":["a","b"],"vertices":5})"));
  EXPECT_FALSE(moving(R"({"names":["a"],"vertices":1000000000})"));
  EXPECT_TRUE(moving(R"({"names":["a"],"vertices":0,"values":true})"));
  EXPECT_FALSE(moving(R"({"names":["a"],"vertices":0,"values":1})"));
  EXPECT_FALSE(moving(R"({"names":["a"],"vertices":1,"values":true})"));
  const auto robot = [&begin](const std::string& facts) {
    return is_taken(begin + R"(],"meshes":[],"moving":[],"robot":)" + facts + "}");
  };
  EXPECT_TRUE(robot(R"({"name":"arm","motion_scale":2,"audited":true})"));
  EXPECT_FALSE(robot(R"(["arm"])"));
  EXPECT_FALSE(robot(R"({"name":["arm"]})"));
  for (const char* const place : {"[]", "[0,0,0,0]", "[null]", "[1e3]", "7", "[[0]]"}) {
    EXPECT_FALSE(is_taken(begin + R"(],"meshes":[],"moving":[],"begin_m":)" + place + "}")) << place;
    EXPECT_FALSE(is_taken(begin + R"(],"meshes":[],"moving":[],"tool_m":)" + place + "}")) << place;
  }
  std::string many = R"({"names":["a"],"vertices":170000})";
  EXPECT_TRUE(moving(many));
  EXPECT_FALSE(moving(many + "," + many)) << "too much memory in all";
  EXPECT_FALSE(is_taken(begin + std::string(1'000'000, '[')));
}

TEST(Assembly, TakesNoDescriptionThatIsNotWhatItsHashSays) {
  Description description = sample(4);
  ++description.hash;
  Assembly assembly;
  EXPECT_FALSE(give_all(assembly, description));
  EXPECT_FALSE(assembly.scene().has_value());
}

TEST(Assembly, TakesNoPiecesOfMoreThanADescriptionMayHave) {
  Assembly assembly;
  EXPECT_FALSE(assembly.add({.session = kSession, .view = 1, .pieces = ~0U, .number = 0}));
  EXPECT_FALSE(assembly.add({.session = kSession, .view = 1, .pieces = 2, .number = 2}));
  const std::vector<std::byte> longer(kPieceBytes + 1);
  EXPECT_FALSE(assembly.add({.session = kSession, .view = 1, .pieces = 1, .number = 0, .content = longer}));
}

TEST(Description, ThatIsNestedDeeplyIsRefusedAndTakesNoStack) {
  const std::string deep(500'000, '[');
  EXPECT_FALSE(read_description(R"({"name":"","more":"","moving":[],"meshes":[],"shapes":[{"name":)" + deep +
                                std::string(deep.size(), ']') + "}]}"));
  EXPECT_FALSE(read_description(R"({"name":"","more":"","moving":[],"shapes":[],"meshes":[{"name":"a","vertices_m":)" +
                                deep + std::string(deep.size(), ']') + R"(,"triangles":[]}]})"));
}

TEST(Description, OfMoreThanMayBeSentLeavesMeshesOutAndSaysSo) {
  const std::vector<std::vector<VisiblePart>> models{{pad(50'000)}, {pad(50'000)}, {block("one")}};
  const Description description = describe({.name = "large"}, models);
  EXPECT_LE(description.text.size(), kDescriptionBytesMost);
  const auto received = read_description(description.text);
  ASSERT_TRUE(received);
  EXPECT_EQ(received->shown.meshes, "");
  EXPECT_THAT(received->shown.more, HasSubstr("meshes are not drawn"));
  EXPECT_EQ(received->moving[0].items(), 0U);
  EXPECT_EQ(received->moving[2].items(), 1U);
}

}  // namespace
}  // namespace forcebound::view
