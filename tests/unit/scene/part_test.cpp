#include "forcebound/scene/part.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "forcebound/scene/geometry/bvh.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/meshes.hpp"

namespace forcebound::scene {
namespace {

using testing::HasSubstr;

const Registry& registry() {
  static const Registry kRegistry = Registry::standard();
  return kRegistry;
}

PartDescription ball() {
  return {
      .name = "ball",
      .shape = NamedValues{"sphere", {{"center_m", Point(0.1, 0, 0)}, {"radius_m", 0.02}}},
      .effects = {{"surface", {{"stiffness_N_per_m", 500.0}}}, {"magnet", {{"force_N_max", 1.0}, {"range_m", 0.01}}}}};
}

std::string refusal_of(const PartDescription& description, Eigen::Index axes = 3) {
  try {
    (void)make_part(description, registry(), axes);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

TEST(MakePart, MakesWhatIsDescribed) {
  const SceneObject part = make_part(ball(), registry());
  EXPECT_EQ(part.name, "ball");
  EXPECT_EQ(part.shape_text, "sphere, center_m [0.1, 0, 0], radius_m 0.02");
  ASSERT_EQ(part.effects.size(), 2U);
  EXPECT_EQ(part.effects[0].parameters, "stiffness_N_per_m 500");
  std::vector<std::byte> state(part.shape->facts().state_bytes);
  EXPECT_NEAR(part.shape->nearest({0.1, 0, 0.01}, state.data()).penetration_m, 0.01, 1e-15);
}

TEST(MakePart, KeepsWhatItWasMadeOf) {
  const SceneObject part = make_part(ball(), registry());
  EXPECT_EQ(part.shape_kind, "sphere");
  EXPECT_EQ(part.shape_values, ball().shape->values);
  EXPECT_EQ(part.effects[1].name, "magnet");
  EXPECT_EQ(part.effects[1].values, ball().effects[1].values);
}

TEST(MakePart, ChecksWhatAFileWouldBeCheckedFor) {
  PartDescription wrong = ball();
  wrong.shape->name = "bal";
  EXPECT_THAT(refusal_of(wrong), HasSubstr("unknown kind 'bal'"));
  wrong = ball();
  wrong.shape->values.set("radius_m", -1.0);
  EXPECT_EQ(refusal_of(wrong), "radius_m must be > 0 and <= 1000, got -1");
  wrong = ball();
  wrong.effects[0].values.set("stiffness_N_per_m", std::nan(""));
  EXPECT_EQ(refusal_of(wrong), "stiffness_N_per_m must be a finite number, got nan");
  wrong = ball();
  wrong.effects.push_back(wrong.effects[0]);
  EXPECT_EQ(refusal_of(wrong), "effect 'surface' is asked for twice");
  wrong = ball();
  wrong.shape.reset();
  EXPECT_THAT(refusal_of(wrong), HasSubstr("effect 'surface' needs the surface of an object"));
  wrong = ball();
  wrong.effects = {{"friction", {{"static_coefficient", 0.5}}}};
  EXPECT_THAT(refusal_of(wrong), HasSubstr("effect 'friction' needs another one that pushes"));
  wrong = ball();
  wrong.shape = NamedValues{"torus", {}};
  EXPECT_THAT(refusal_of(wrong, 2), HasSubstr("a torus needs a scene of at least 3 degrees of freedom"));
  wrong.shape = NamedValues{"mesh", {{"file", std::string("nowhere.obj")}}};
  EXPECT_EQ(refusal_of(wrong), "a shape of a mesh file needs the file's triangles");
}

TEST(MakePart, MakesAShapeOfAGivenGeometryWithoutItsFile) {
  PartDescription mesh = ball();
  mesh.shape = NamedValues{"mesh", {{"file", std::string("nowhere.obj")}}};
  const ShapeGeometry geometry{.mesh = test::shared_mesh(test::ball(0.02, 10))};
  const SceneObject part = make_part(mesh, registry(), 3, {}, geometry);
  EXPECT_EQ(part.shape_values, mesh.shape->values);
  EXPECT_EQ(part.shape->geometry().mesh, geometry.mesh);
}

/// A tree allocates while it is built, more often than while it is copied.
TEST(MakePart, BuildsNoTreeOfAMeshWhereOneIsThereAlready) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  PartDescription mesh = ball();
  const ShapeGeometry without{.mesh = test::shared_mesh(test::ball(0.02, 10))};
  ShapeGeometry with = without;
  with.tree = std::make_shared<const Bvh>(without.mesh);
  const ShapeGeometry of_another{.mesh = test::shared_mesh(test::ball(0.02, 10)), .tree = with.tree};
  const Registry& kinds = registry();  // made by the first who asks
  for (const NamedValues& shape :
       {NamedValues{"mesh", {{"file", std::string("nowhere.obj")}}},
        NamedValues{"distance_field", {{"file", std::string("nowhere.obj")}, {"spacing_m", 0.002}}}}) {
    mesh.shape = shape;
    const auto operations = [&](const ShapeGeometry& geometry) {
      const test::AllocationGuard guard;
      const SceneObject part = make_part(mesh, kinds, 3, {}, geometry);
      std::vector<std::byte> state(part.shape->facts().state_bytes);
      part.shape->begin_outside({0, 0, 0.03}, state.data());
      EXPECT_GT(part.shape->nearest({0, 0, 0.018}, state.data()).penetration_m, 0);
      return guard.heap_operations();
    };
    const std::uint64_t building = operations(without);
    EXPECT_LT(operations(with), building) << shape.name;
    EXPECT_EQ(operations(of_another), building) << shape.name;
  }
}

TEST(MakePart, RefusesAGeometryThatTheKindIsNotMadeOf) {
  const ShapeGeometry geometry{.mesh = test::shared_mesh(test::ball(0.02, 10))};
  EXPECT_THROW((void)make_part(ball(), registry(), 3, {}, geometry), std::invalid_argument);
  PartDescription relief = ball();
  relief.shape = NamedValues{"height_field", {{"origin_m", Point(0, 0, 0)}, {"spacing_m", 0.01}}};
  EXPECT_THROW((void)make_part(relief, registry(), 3, {}, geometry), std::invalid_argument);
}

}  // namespace
}  // namespace forcebound::scene
