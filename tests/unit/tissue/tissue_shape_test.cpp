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

enum class OfElements { boxes, tetrahedra, quadratic };

TetrahedralMesh mesh_of(OfElements elements) {
  TetrahedralSoup soup = test::tetrahedra_of(test::kThickBlock);
  if (elements != OfElements::boxes) soup.boxes.clear();
  const TetrahedralMesh mesh(soup);
  return elements == OfElements::quadratic ? mesh.with_middles() : mesh;
}

TissueDynamicModel block_of(double radius_m, OfElements elements = OfElements::boxes, bool large_motion = false) {
  TetrahedralMesh mesh = mesh_of(elements);
  std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ());
  return TissueDynamicModel({.mesh = std::move(mesh),
                             .material = test::kSoft,
                             .held_nodes = std::move(held),
                             .probe = {.radius_m = radius_m, .contact_stiffness_N_per_m = 1000},
                             .large_motion = large_motion});
}

scene::PartDescription part_of(double radius_m, OfElements elements = OfElements::boxes) {
  return block_of(radius_m, elements).part_at_client();
}

std::unique_ptr<scene::Shape> made(const config::Values& values) {
  const scene::ShapeKind kind = tissue_shape();
  return kind.make(config::completed(kind.parameters, values), {});
}

/// Why it is refused with other values.
std::string refusal(const config::Values& others, OfElements elements) {
  config::Values values = part_of(0, elements).shape->values;
  for (const auto& [key, value] : others.all()) values.set(key, value);
  try {
    (void)made(values);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

std::string refusal(std::string_view key, const config::Value& value, OfElements elements = OfElements::tetrahedra) {
  return refusal({{std::string(key), value}}, elements);
}

config::Rows rows_with(std::string_view key, double value, OfElements elements = OfElements::tetrahedra) {
  config::Rows rows = part_of(0, elements).shape->values.rows(key);
  rows.at(rows.size() / 2).at(0) = value;
  return rows;
}

TEST(TissueShape, IsNotMadeOfWhatBendsFar) {
  EXPECT_TRUE(block_of(0).fits_client());
  EXPECT_FALSE(block_of(0, OfElements::boxes, true).fits_client());
}

TEST(TissueShape, SaysWithoutBeingMadeThatItFitsAClient) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const TissueDynamicModel model = block_of(0.01);
  const test::AllocationGuard guard;
  EXPECT_TRUE(model.fits_client());
  EXPECT_EQ(guard.heap_operations(), 0U);
}

/// Of what is made of what the server sends; the server's own tissue is that of `mesh_of`.
class TissueShapeOfElements : public testing::TestWithParam<OfElements> {};

TEST_P(TissueShapeOfElements, GivesTheServersForceToTheBit) {
  for (const double radius_m : {0.0, 0.012}) {
    const TetrahedralMesh mesh = mesh_of(GetParam());
    const std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ());
    const ProbeOptions probe{.radius_m = radius_m, .contact_stiffness_N_per_m = 1000};
    const TissueModel server(LinearTissue(mesh, test::kSoft, held), probe);
    const auto client = made(part_of(radius_m, GetParam()).shape->values);
    TissueState there{};
    TissueState here{};
    int touched = 0;
    for (int tick = 0; tick < 300; ++tick) {
      const scene::Point device_m(0.021 + 6e-5 * tick, 0.033, test::kThickTop_m + radius_m + 0.001 - 2e-5 * tick);
      const TissueResult expected = server.step(there, device_m);
      const scene::SurfacePoint felt = client->nearest(device_m, reinterpret_cast<std::byte*>(&here));
      if (expected.contacts == 0) continue;
      ++touched;
      ASSERT_EQ(felt.penetration_m, expected.force_N.norm() / probe.contact_stiffness_N_per_m) << tick;
      ASSERT_EQ(felt.normal, expected.normal) << tick;
    }
    EXPECT_GT(touched, 200);
  }
}

INSTANTIATE_TEST_SUITE_P(OfAll, TissueShapeOfElements,
                         testing::Values(OfElements::boxes, OfElements::tetrahedra, OfElements::quadratic));

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
  EXPECT_THAT(refusal("tetrahedra", config::Rows(kShapeElementsMost + 1, {0, 1, 7, 49})), HasSubstr("expected 1 to"));
  EXPECT_THAT(refusal("young_Pa", kNaN), HasSubstr("young_Pa"));
  EXPECT_THAT(refusal("young_Pa", -1.0), HasSubstr("young_Pa"));
  EXPECT_NE(refusal("poisson", 0.5), "accepted");
  EXPECT_NE(refusal("poisson", -1.0), "accepted");
  EXPECT_THAT(refusal("contact_stiffness_N_per_m", 0.0), HasSubstr("contact_stiffness_N_per_m"));
  EXPECT_THAT(refusal("contacts_max", 1e6), HasSubstr("contacts_max"));
}

TEST(TissueShape, RefusesBoxesAndMiddlesThatAHostileServerMayHandOver) {
  constexpr auto kBoxes = OfElements::boxes;
  EXPECT_EQ(refusal({}, kBoxes), "accepted");
  EXPECT_EQ(refusal({}, OfElements::quadratic), "accepted");
  for (const double node : {1e6, -1.0, 0.5})
    EXPECT_THAT(refusal("boxes", rows_with("boxes", node, kBoxes), kBoxes), HasSubstr("refer to node"));
  EXPECT_NE(refusal("boxes", rows_with("boxes", std::numeric_limits<double>::quiet_NaN(), kBoxes), kBoxes), "accepted");
  EXPECT_THAT(refusal("boxes", rows_with("boxes", 0, kBoxes), kBoxes), HasSubstr("tissue"));
  EXPECT_THAT(refusal("nodes_m", rows_with("nodes_m", 0.0301, kBoxes), kBoxes), HasSubstr("alike but for their place"));
  EXPECT_THAT(refusal("boxes", config::Rows{}, kBoxes), HasSubstr("expected 1 to"));
  EXPECT_THAT(refusal("boxes", config::Rows(kShapeElementsMost + 1, std::vector<double>(8)), kBoxes),
              HasSubstr("expected 1 to"));
  EXPECT_THAT(refusal("boxes", part_of(0).shape->values.rows("boxes")), HasSubstr("without tetrahedra"));
  EXPECT_THAT(refusal("middles", true, kBoxes), HasSubstr("without tetrahedra or middles"));
  config::Rows twice = part_of(0).shape->values.rows("boxes");
  twice.back() = twice.front();
  EXPECT_NE(refusal("boxes", twice, kBoxes), "accepted");
  config::Rows inverted = part_of(0).shape->values.rows("boxes");
  for (std::vector<double>& box : inverted) {
    for (std::size_t corner = 0; corner < 8; corner += 2) std::swap(box[corner], box[corner + 1]);
  }
  EXPECT_THAT(refusal("boxes", inverted, kBoxes), HasSubstr("right-handed"));
  config::Rows sheared = part_of(0).shape->values.rows("nodes_m");
  for (std::vector<double>& node_m : sheared) node_m[0] += 0.1 * node_m[2];
  EXPECT_THAT(refusal("nodes_m", sheared, kBoxes), HasSubstr("right-angled"));
  // Among the middles some can be held, but none beyond them, and none that no tetrahedron has.
  EXPECT_THAT(refusal("held", rows_with("held", 1e6, OfElements::quadratic), OfElements::quadratic),
              HasSubstr("refer to node"));
  const TetrahedralMesh quadratic = mesh_of(OfElements::quadratic);
  config::Rows with_middles;
  for (const scene::Point& node_m : quadratic.nodes_m()) with_middles.push_back({node_m.x(), node_m.y(), node_m.z()});
  EXPECT_THAT(refusal("nodes_m", with_middles, OfElements::quadratic), HasSubstr("no element has"));
}

}  // namespace
}  // namespace forcebound::tissue
