#include "forcebound/handover/scene_assembly.hpp"

#include <gmock/gmock.h>

#include <sstream>

#include "forcebound/control/rotation.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/text/file.hpp"
#include "tests/support/scene_files.hpp"
#include "tests/tools/temporary_folder.hpp"
#include "tests/unit/handover/handed_over.hpp"

namespace forcebound::handover {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

/// What both scenes answer along one random way is the same to the bit.
void expect_the_same_answers(const std::shared_ptr<const Scene>& one, const std::shared_ptr<const Scene>& other,
                             double reach_m, std::uint64_t seed) {
  const auto rows = static_cast<std::uint32_t>(std::max(1, one->facts().degrees_of_freedom));
  scene::SceneState a(one, rows);
  scene::SceneState b(other, rows);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> step_m(-reach_m / 20, reach_m / 20);
  const Vector middle = one->on_surface_m(0).head(rows);
  Vector away = Vector::Zero(rows);
  int in_contact = 0;
  for (int i = 0; i < 3000; ++i) {
    // Drawn back a little, so that it meets what is small as well.
    for (Eigen::Index row = 0; row < away.rows(); ++row)
      away[row] = std::clamp(0.99 * away[row] + step_m(random), -reach_m, reach_m);
    const Vector position = middle + away;
    const auto time = i * 1ms;
    // A tool touches with its points.
    const control::Handle handle{.orientation = control::orientation_of(control::turn_by(Point(0.1, 0.2, 1e-3 * i)))};
    const scene::Answer here = a.answer(position, time, {}, false, handle);
    const scene::Answer there = b.answer(position, time, {}, false, handle);
    const bool any_at_server = here.server_parts_N.rows() > 0;
    ASSERT_EQ(any_at_server ? Vector(here.force - here.server_parts_N) : here.force, there.force)
        << "at " << position.transpose();
    ASSERT_EQ(here.torque_N_m, there.torque_N_m);
    ASSERT_EQ(here.penetration_m, there.penetration_m);
    in_contact += here.penetration_m > 0 ? 1 : 0;
  }
  EXPECT_TRUE(one->objects().empty() || in_contact > 0) << "never touched";
}

TEST(SceneAssembly, MakesEachShippedSceneThatStandsStillAgainToTheBit) {
  int handed_over = 0;
  for (const std::string& name : test::scene_files()) {
    SCOPED_TRACE(name);
    std::shared_ptr<const Scene> scene;
    try {
      scene = server::load_scene(name);
    } catch (const std::exception&) {
      continue;  // bodies, without MuJoCo
    }
    const auto packed = pack(*scene);
    if (!packed || !scene->dynamic_models().empty()) continue;
    ++handed_over;
    SceneAssembly assembly = assembled(*packed, 1);
    ASSERT_TRUE(assembly.whole());
    const AssembledScene made = assembly.build();
    EXPECT_TRUE(made.whole);
    expect_the_same_answers(scene, made.scene, 0.06, 2);
  }
  EXPECT_GE(handed_over, 25);
}

std::string as_obj(const test::Soup& soup) {
  std::ostringstream obj;
  for (const Point& vertex : soup.vertices) obj << "v " << vertex.x() << ' ' << vertex.y() << ' ' << vertex.z() << '\n';
  for (const auto& [a, b, c] : soup.triangles) obj << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  return obj.str();
}

/// An object of each kind of shape that is made of a geometry, with values of its own.
std::shared_ptr<const Scene> scene_of_geometries(const std::string& folder) {
  text::write_file(folder + "/ball.obj", as_obj(test::ball(0.02, 12)));
  text::write_file(folder + "/scene.toml", R"(
[scene]
name = 'geometries'
description = ''
degrees_of_freedom = 3
[[object]]
name = 'mesh'
shape = { kind = 'mesh', file = 'ball.obj', scale = 1.5, two_sided = true, offset_m = [0.01, 0, 0] }
effects = ['surface', 'magnet']
[object.surface]
stiffness_N_per_m = 1000
[object.magnet]
force_N_max = 0.3
range_m = 0.004
[[object]]
name = 'field'
shape = { kind = 'distance_field', file = 'ball.obj', spacing_m = 0.002 }
effects = ['surface']
[object.surface]
stiffness_N_per_m = 500
[[object]]
name = 'pot'
shape = { kind = 'lathe', profile_m = [[0, 0], [0.03, 0], [0.03, 0.01], [0, 0.01]], segments = 40 }
effects = ['surface']
[object.surface]
stiffness_N_per_m = 700
[[object]]
name = 'relief'
effects = ['surface']
[object.shape]
kind = 'height_field'
origin_m = [-0.03, -0.03, 0]
spacing_m = 0.03
heights_m = [[0, 0.01, 0], [0.01, 0, 0], [0, 0.004, 0.01]]
[object.surface]
stiffness_N_per_m = 300
)");
  return server::load_scene(folder + "/scene.toml");
}

TEST(SceneAssembly, MakesEachKindOfGeometryAgainToTheBitWithoutItsFiles) {
  std::shared_ptr<const Scene> scene;
  {
    const test::TemporaryFolder folder;
    scene = scene_of_geometries(folder.path().string());
  }
  for (std::size_t part = 0; part < scene->parts(); ++part) {
    EXPECT_EQ(scene->rendering_of_part(part).how, scene::Rendering::at_client) << part;
  }
  const auto packed = pack(*scene);
  ASSERT_TRUE(packed);
  expect_the_same_answers(scene, assembled(*packed, 5).build().scene, 0.05, 6);
}

TEST(SceneAssembly, MakesAMeshOfManyPiecesAgainToTheBit) {
  const scene::MeshPlacement placement{
      .scale = 0.05, .offset_m = {0.011, -0.02, 0.003}, .rotation = scene::rotation_from_degrees({10, 20, 30})};
  const auto scene = mesh_scene(test::ball(1, 40), placement);
  const auto packed = pack(*scene);
  EXPECT_GT(packed->announcement().pieces, 50U);
  expect_the_same_answers(scene, assembled(*packed, 3).build().scene, 0.07, 4);
}

TEST(SceneAssembly, FeelsWhatItKnowsAndTellsHowFarThatIs) {
  const auto scene = mesh_scene(test::ball(0.05, 40));
  const auto packed = pack(*scene);
  SceneAssembly assembly = assembly_of(*packed);
  const Point top(0, 0, 0.05);
  std::vector<std::size_t> order(packed->announcement().pieces);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t piece) { return packed->where_m(piece).squaredExteriorDistance(top); });
  for (std::size_t i = 0; i < order.size() / 2; ++i) assembly.add(order[i], packed->piece(order[i]));

  const AssembledScene half = assembly.build();
  EXPECT_FALSE(half.whole);
  ASSERT_EQ(half.coverage.size(), 1U);
  EXPECT_GT(half.coverage[0].known_within_m(top), 0.02);
  EXPECT_EQ(half.coverage[0].known_within_m(-top), 0);
  EXPECT_GE(assembly.known_within_m(top), half.coverage[0].known_within_m(top));
  scene::SceneState there(half.scene, 3);
  scene::SceneState here(scene, 3);
  for (int i = 0; i < 40; ++i) {
    const Vector position = Point(1e-3, 0, 0.052 - 1e-4 * i);
    EXPECT_EQ(there.answer(position, i * 1ms).force, here.answer(position, i * 1ms).force) << i;
  }
}

TEST(SceneAssembly, GoesOnInALargerPartOfAMeshWhereItWas) {
  const auto packed = pack(*mesh_scene(test::ball(0.05, 40)));
  SceneAssembly assembly = assembly_of(*packed);
  const std::size_t pieces = packed->announcement().pieces;
  const Point top(0, 0, 0.05);
  std::vector<std::size_t> order(pieces);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t piece) { return packed->where_m(piece).squaredExteriorDistance(top); });
  for (std::size_t i = 0; i < pieces / 2; ++i) assembly.add(order[i], packed->piece(order[i]));
  scene::SceneState state(assembly.build().scene, 3);
  (void)state.answer(Point(0, 0, 0.051), 0ms);
  const Vector below = Point(0, 0, 0.049);
  const Vector before_N = state.answer(below, 1ms).force;
  ASSERT_GT(before_N.z(), 0.9);
  for (std::size_t i = pieces / 2; i < pieces; ++i) assembly.add(order[i], packed->piece(order[i]));
  scene::SceneState whole(assembly.build().scene, 3);
  ASSERT_TRUE(whole.go_on_from(state));
  EXPECT_EQ(whole.answer(below, 2ms).force, before_N);
}

TEST(SceneAssembly, KeepsTheAnchorOfFrictionWhereTheFirstGeometryOfAnotherObjectArrives) {
  const test::TemporaryFolder folder;
  text::write_file(folder.file("ball.obj"), as_obj(test::ball(0.02, 10)));
  text::write_file(folder.file("scene.toml"), R"(
[scene]
name = 'test'
description = ''
degrees_of_freedom = 3
[[object]]
name = 'ball'
shape = { kind = 'mesh', file = 'ball.obj', offset_m = [0.1, 0, 0] }
effects = ['surface', 'friction']
[object.surface]
stiffness_N_per_m = 1000
[object.friction]
static_coefficient = 0.5
[[object]]
name = 'floor'
shape = { kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }
effects = ['surface', 'friction']
[object.surface]
stiffness_N_per_m = 1000
[object.friction]
static_coefficient = 0.5
)");
  const auto packed = pack(*server::load_scene(folder.file("scene.toml")));
  SceneAssembly assembly = assembly_of(*packed);
  const std::size_t of_manifest = manifest_pieces(packed->announcement().manifest_bytes);
  for (std::size_t i = 0; i < of_manifest; ++i) assembly.add(i, packed->piece(i));
  scene::SceneState without(assembly.build().scene, 3);
  (void)without.answer(Point(0, 0, -0.001), 0ms);
  const Vector aside = Point(1e-4, 0, -0.001);
  const Vector before_N = without.answer(aside, 1ms).force;
  ASSERT_NEAR(before_N.x(), -0.1, 0.01) << "it sticks";
  for (std::size_t i = of_manifest; i < packed->announcement().pieces; ++i) assembly.add(i, packed->piece(i));
  scene::SceneState with(assembly.build().scene, 3);
  ASSERT_TRUE(with.go_on_from(without));
  EXPECT_EQ(with.answer(aside, 2ms).force, before_N);
  // The ball begins from there, outside of it.
  (void)with.answer(Point(0.1, 0, 0.03), 3ms);
  EXPECT_GT(with.answer(Point(0.1, 0, 0.019), 4ms).force.z(), 0.5);
}

TEST(SceneAssembly, GoesOnInNoSceneOfOtherEffects) {
  const auto floor_with = [](const std::string& effects) {
    return scene::SceneState(scene_of(R"(
[[object]]
name = 'floor'
shape = { kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }
surface = { stiffness_N_per_m = 1000 }
effects = )" + effects),
                             3);
  };
  const std::string rough = "['surface', 'friction']\nfriction = { static_coefficient = 0.5 }";
  EXPECT_FALSE(floor_with("['surface']").go_on_from(floor_with(rough)));
  EXPECT_FALSE(floor_with(rough).go_on_from(floor_with("['surface']")));
  EXPECT_TRUE(floor_with(rough).go_on_from(floor_with(rough)));
}

TEST(SceneAssembly, TakesAPieceTwiceForOnce) {
  const auto packed = pack(*mesh_scene(test::ball(0.05, 10)));
  SceneAssembly assembly = assembly_of(*packed);
  for (int copy = 0; copy < 2; ++copy) {
    for (std::size_t i = 0; i < packed->announcement().pieces; ++i) assembly.add(i, packed->piece(i));
  }
  EXPECT_EQ(assembly.pieces_here(), packed->announcement().pieces);
  EXPECT_TRUE(assembly.build().whole);
}

TEST(SceneAssembly, TellsHowMuchItBuiltAndBuildsNothingTwice) {
  const test::Soup soup = test::ball(0.05, 10);
  const auto packed = pack(*mesh_scene(soup));
  SceneAssembly assembly = assembly_of(*packed);
  const std::size_t last = packed->announcement().pieces - 1;
  for (std::size_t i = 0; i < last; ++i) assembly.add(i, packed->piece(i));
  const AssembledScene but_one = assembly.build();
  EXPECT_GT(but_one.elements_built, soup.triangles.size()) << "with where the last piece is missing";
  const AssembledScene again = assembly.build();
  EXPECT_EQ(again.elements_built, 0U);
  const Point top(0, 0, 0.05);
  EXPECT_EQ(again.coverage.at(0).known_within_m(top), but_one.coverage.at(0).known_within_m(top));
  assembly.add(last, packed->piece(last));
  const AssembledScene whole = assembly.build();
  EXPECT_GT(whole.elements_built, 0U);
  EXPECT_LE(whole.elements_built, soup.triangles.size());
}

TEST(SceneAssembly, HasNothingToTouchWhereAllGeometryIsMissing) {
  const auto packed = pack(*mesh_scene(test::ball(0.05, 10)));
  SceneAssembly assembly = assembly_of(*packed);
  EXPECT_FALSE(assembly.can_build());
  for (std::size_t i = 0; i < manifest_pieces(packed->announcement().manifest_bytes); ++i)
    assembly.add(i, packed->piece(i));
  ASSERT_TRUE(assembly.can_build());
  const AssembledScene made = assembly.build();
  EXPECT_EQ(made.coverage.at(0).known_within_m(Point(0, 0, 0.05)), 0);
  scene::SceneState state(made.scene, 3);
  EXPECT_EQ(state.answer(Vector(Point::Zero()), 0ms).force, Vector(Point::Zero()));
}

TEST(SceneAssembly, LeavesOutWhatMovesByItself) {
  const auto tissue = server::load_scene("soft_pad");
  EXPECT_EQ(tissue->rendering_of_part(tissue->parts() - 1).how, scene::Rendering::modelled);
}

TEST(SceneAssembly, HandsOverLinearTissueOnlyToWhoHasItAlone) {
  const auto alone = server::load_scene("palpation");
  EXPECT_EQ(alone->rendering_of_part(0).how, scene::Rendering::at_client);
  const auto shared = server::load_scene("two_hands");
  EXPECT_EQ(shared->rendering_of_part(0).how, scene::Rendering::modelled);
  EXPECT_FALSE(pack(*shared));
}

/// Of the tissue alone; a hand slides to and fro over it at 0.1 m/s, 4 mm deep.
class SlidOver : public testing::TestWithParam<const char*> {};

TEST_P(SlidOver, GivesTheForceOfTheServerToRounding) {
  const std::shared_ptr<const Scene> scene = server::load_scene(GetParam());
  const auto packed = pack(*scene);
  ASSERT_TRUE(packed);
  const AssembledScene made = assembled(*packed, 1).build();
  scene::SceneState there(scene, 3);
  scene::SceneState here(made.scene, 3);
  const Point top_m = scene->on_surface_m(0);
  constexpr int kTicks = 2000;
  int touched = 0;
  for (int tick = 0; tick < kTicks; ++tick) {
    const double time_s = 1e-3 * tick;
    const Point device_m =
        top_m + Point(0.003 + 0.015 * std::sin(0.1 / 0.015 * time_s), 0.002, std::max(-0.004, 0.002 - 0.02 * time_s));
    const scene::Answer told = there.answer(Vector(device_m), tick * 1ms, 0ms, true);
    EXPECT_TRUE(told.model.empty());
    EXPECT_EQ(told.server_parts_N.rows(), 0);
    const scene::Answer felt = here.answer(Vector(device_m), tick * 1ms);
    ASSERT_LE((felt.force - told.force).norm(), 1e-12 * (1 + told.force.norm())) << tick;
    touched += told.force.isZero(0) ? 0 : 1;
  }
  EXPECT_GT(touched, kTicks / 2);
}

INSTANTIATE_TEST_SUITE_P(ByPointAndBall, SlidOver, testing::Values("pad", "palpation"));

// From here on the server lies, or something on the way is broken.

TEST(SceneAssembly, RefusesAnAnnouncementBeyondTheLimitsBeforeItTakesMemory) {
  const auto refused = [](const Announcement& announcement) {
    return refusal_of([&] { SceneAssembly(announcement, scene::Registry::standard()); });
  };
  EXPECT_THAT(refused({.manifest_bytes = std::size_t{1} << 60, .pieces = 10}), HasSubstr("bytes of manifest"));
  EXPECT_THAT(refused({.manifest_bytes = 10, .pieces = std::size_t{1} << 60}), HasSubstr("pieces, at most"));
  EXPECT_THAT(refused({.manifest_bytes = 0, .pieces = 1}), HasSubstr("fewer pieces"));
  EXPECT_THAT(refused({.manifest_bytes = 5000, .pieces = 1}), HasSubstr("fewer pieces"));
}

TEST(SceneAssembly, RefusesAManifestOfAnotherHash) {
  const auto packed =
      pack(*scene_of("[[field]]\nname = 'air'\neffects = ['viscosity']\n[field.viscosity]\ndamping_N_s_per_m = 1\n"));
  SceneAssembly assembly = assembly_of(*packed);
  std::vector<std::byte> changed(packed->piece(0).begin(), packed->piece(0).end());
  changed[3] ^= std::byte{1};
  EXPECT_THAT(refusal_of([&] { assembly.add(0, changed); }), HasSubstr("announced hash"));
}

TEST(SceneAssembly, RefusesAPieceThatWasTamperedWithIsTooLongOrHasNoPlace) {
  const auto packed = pack(*mesh_scene(test::ball(0.05, 10)));
  const std::size_t last = packed->announcement().pieces - 1;
  SceneAssembly assembly = assembly_of(*packed);
  for (std::size_t i = 0; i < last; ++i) assembly.add(i, packed->piece(i));
  std::vector<std::byte> changed(packed->piece(last).begin(), packed->piece(last).end());
  changed.back() ^= std::byte{1};
  EXPECT_THAT(refusal_of([&] { assembly.add(last, changed); }), HasSubstr("another hash"));
  EXPECT_THAT(refusal_of([&] { assembly.add(last, {}); }), HasSubstr("another hash"));
  EXPECT_THAT(refusal_of([&] { assembly.add(last + 1, changed); }), HasSubstr("piece"));
  changed.resize(kPieceBytesMax + 1);
  EXPECT_THAT(refusal_of([&] { assembly.add(last, changed); }), HasSubstr("bytes long"));
}

TEST(SceneAssembly, RefusesMoreTrianglesThanItTakes) {
  const auto packed = pack(*mesh_scene(test::ball(0.05, 40)));
  SceneAssembly assembly = assembly_of(*packed, {.triangles = 100});
  EXPECT_THAT(refusal_of([&] {
                for (std::size_t i = 0; i < packed->announcement().pieces; ++i) assembly.add(i, packed->piece(i));
              }),
              HasSubstr("more geometry than is taken"));
}

TEST(SceneAssembly, RefusesAnEndlessStreamOfGeometryWithoutItsManifest) {
  const auto packed = pack(*mesh_scene(test::ball(0.05, 10)));
  SceneAssembly assembly({.manifest_bytes = 100, .pieces = 100'000}, scene::Registry::standard());
  EXPECT_THAT(refusal_of([&] {
                for (std::size_t i = 1; i < 100'000; ++i) assembly.add(i, packed->piece(1));
              }),
              HasSubstr("without its hashes"));
}

/// So many slim triangles about one place.
test::Soup pile(std::uint32_t count) {
  test::Soup soup;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double turn = 1e-4 * i;
    soup.vertices.emplace_back(0.05 * std::cos(turn), 0.05 * std::sin(turn), 1e-9 * i);
    soup.vertices.emplace_back(-0.05 * std::cos(turn), -0.05 * std::sin(turn), 1e-9 * i);
    soup.vertices.emplace_back(1e-3 * std::sin(turn), 1e-3 * std::cos(turn), 0.01);
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return soup;
}

TEST(SceneAssembly, RefusesAPileOfTrianglesInOnePlace) {
  const auto packed = pack(*mesh_scene(pile(6000)));
  SceneAssembly assembly = assembled(*packed, 1);
  EXPECT_THAT(refusal_of([&] { (void)assembly.build(); }), HasSubstr("triangles in one place"));
}

TEST(SceneAssembly, RefusesWhatTakesTooLongToBuild) {
  const scene::PartDescription ball{
      .name = "ball",
      .shape = scene::NamedValues{"distance_field", {{"file", std::string("ball.obj")}, {"spacing_m", 0.002}}},
      .effects = {{"surface", {{"stiffness_N_per_m", 1000.0}}}}};
  scene::SceneParts parts;
  parts.objects.push_back(
      scene::make_part(ball, scene::Registry::standard(), 3, {}, {.mesh = test::shared_mesh(test::ball(0.03, 20))}));
  const auto packed = pack(Scene({.name = "ball", .description = ""}, std::move(parts)));
  const auto built_within = [&](std::uint64_t nodes) {
    return refusal_of([&] {
      SceneAssembly assembly = assembly_of(*packed, {.nodes_of_a_build = nodes});
      for (std::size_t i = 0; i < packed->announcement().pieces; ++i) assembly.add(i, packed->piece(i));
      (void)assembly.build();
    });
  };
  EXPECT_EQ(built_within(Limits().nodes_of_a_build), "accepted");
  EXPECT_THAT(built_within(10'000), HasSubstr("take too long to find"));
}

TEST(SceneAssembly, RefusesWhatTogetherWouldMakeATickLate) {
  const scene::PartDescription ball{
      .name = "ball",
      .shape = scene::NamedValues{"sphere", {{"center_m", Point(0, 0, 0)}, {"radius_m", 0.01}}},
      .effects = {{"surface", {{"stiffness_N_per_m", 1000.0}}}}};
  scene::SceneParts parts;
  for (int i = 0; i < 1000; ++i) parts.objects.push_back(scene::make_part(ball, scene::Registry::standard()));
  const Scene scene({.name = "balls", .description = ""}, std::move(parts));
  const auto packed = pack(scene);
  const auto built_within = [&](double tick_ns) {
    return refusal_of([&] {
      SceneAssembly assembly = assembly_of(*packed, {.tick_ns = tick_ns});
      for (std::size_t i = 0; i < packed->announcement().pieces; ++i) assembly.add(i, packed->piece(i));
      (void)assembly.build();
    });
  };
  EXPECT_EQ(built_within(300e3), "accepted");
  EXPECT_THAT(built_within(5e3), HasSubstr("us of each tick, at most 5 are accepted"));
  EXPECT_DOUBLE_EQ(Limits::of_period(1e-3).tick_ns, 300e3);
  EXPECT_DOUBLE_EQ(Limits::of_period(1e-4).tick_ns, 30e3) << "of a device of 10 kHz";
}

}  // namespace
}  // namespace forcebound::handover
