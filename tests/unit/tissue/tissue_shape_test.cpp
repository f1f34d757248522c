#include "forcebound/tissue/tissue_shape.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "forcebound/tissue/tissue_dynamic_model.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/tissue_block.hpp"

namespace forcebound::tissue {
namespace {

using testing::HasSubstr;

TissueDynamicModel block_of(double radius_m, bool large_motion = false) {
  TetrahedralMesh mesh(test::tetrahedra_of(test::kThickBlock));
  std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ());
  return TissueDynamicModel({.mesh = std::move(mesh),
                             .material = test::kSoft,
                             .held_nodes = std::move(held),
                             .probe = {.radius_m = radius_m, .contact_stiffness_N_per_m = 1000},
                             .large_motion = large_motion});
}

scene::PartDescription part_of(double radius_m) { return block_of(radius_m).part_at_client(); }

std::unique_ptr<scene::Shape> made(const config::Values& values) {
  const scene::ShapeKind kind = tissue_shape();
  return kind.make(config::completed(kind.parameters, values), {});
}

/// Why it is refused with another value.
std::string refusal(std::string_view key, const config::Value& value) {
  config::Values values = part_of(0).shape->values;
  values.set(key, value);
  try {
    (void)made(values);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

config::Rows rows_with(std::string_view key, double value) {
  config::Rows rows = part_of(0).shape->values.rows(key);
  rows.at(rows.size() / 2).at(0) = value;
  return rows;
}

TEST(TissueShape, IsNotMadeOfWhatBendsFar) {
  EXPECT_TRUE(block_of(0).fits_client());
  EXPECT_FALSE(block_of(0, true).fits_client());
}

TEST(TissueShape, SaysWithoutBeingMadeThatItFitsAClient) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const TissueDynamicModel model = block_of(0.01);
  const test::AllocationGuard guard;
  EXPECT_TRUE(model.fits_client());
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(TissueShape, DoesNotAllocateAsItIsSlidOver) {
  for (const double radius_m : {0.0, 0.01}) {
    const auto shape = made(part_of(radius_m).shape->values);
    ASSERT_EQ(shape->facts().state_bytes, sizeof(TissueState));
    TissueState state{};
    auto* const bytes = reinterpret_cast<std::byte*>(&state);
    shape->begin_outside({0.02, 0.03, test::kThickTop_m + radius_m + 0.001}, bytes);
    const test::AllocationGuard guard;
    double least_m = std::numeric_limits<double>::infinity();
    for (int tick = 0; tick < 200; ++tick) {
      const scene::Point device_m(0.02 + 1e-4 * tick, 0.03, test::kThickTop_m + radius_m - 0.004);
      least_m = std::min(least_m, shape->nearest(device_m, bytes).penetration_m);
    }
    EXPECT_GT(least_m, 0);
  }
}

TEST(TissueShape, LetsGoOfWhatLeapsFarAway) {
  const auto shape = made(part_of(0).shape->values);
  TissueState state{};
  auto* const bytes = reinterpret_cast<std::byte*>(&state);
  shape->begin_outside({0.03, 0.03, test::kThickTop_m + 0.001}, bytes);
  EXPECT_GT(shape->nearest({0.03, 0.03, test::kThickTop_m - 0.004}, bytes).penetration_m, 0);
  EXPECT_LT(shape->nearest({0.03, 0.03, -1}, bytes).penetration_m, 0);
}

TEST(TissueShape, RefusesWhatAHostileServerMayHandOver) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal("poisson", 0.4), "accepted");
  EXPECT_THAT(refusal("nodes_m", rows_with("nodes_m", kNaN)), HasSubstr("finite"));
  EXPECT_THAT(refusal("nodes_m", rows_with("nodes_m", 1e9)), HasSubstr("farther than any device"));
  EXPECT_THAT(refusal("tetrahedra", rows_with("tetrahedra", 1e6)), HasSubstr("refer to node"));
  EXPECT_THAT(refusal("tetrahedra", rows_with("tetrahedra", -1)), HasSubstr("refer to node"));
  EXPECT_THAT(refusal("tetrahedra", rows_with("tetrahedra", 0.5)), HasSubstr("refer to node"));
  EXPECT_THAT(refusal("held", rows_with("held", 1e6)), HasSubstr("refer to node"));
  EXPECT_THAT(refusal("held", config::Rows{}), HasSubstr("tissue"));
  EXPECT_THAT(refusal("tetrahedra", config::Rows{}), HasSubstr("expected 1 to"));
  EXPECT_THAT(refusal("tetrahedra", config::Rows(kShapeTetrahedraMost + 1, {0, 1, 7, 49})), HasSubstr("expected 1 to"));
  EXPECT_THAT(refusal("young_Pa", kNaN), HasSubstr("young_Pa"));
  EXPECT_THAT(refusal("young_Pa", -1.0), HasSubstr("young_Pa"));
  EXPECT_NE(refusal("poisson", 0.5), "accepted");
  EXPECT_NE(refusal("poisson", -1.0), "accepted");
  EXPECT_THAT(refusal("contact_stiffness_N_per_m", 0.0), HasSubstr("contact_stiffness_N_per_m"));
  EXPECT_THAT(refusal("contacts_max", 1e6), HasSubstr("contacts_max"));
}

}  // namespace
}  // namespace forcebound::tissue
