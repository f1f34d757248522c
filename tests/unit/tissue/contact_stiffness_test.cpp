#include "forcebound/tissue/contact_stiffness.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/tissue/tissue_dynamic_model.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/tissue_block.hpp"

namespace forcebound::tissue {
namespace {

using test::kThickTop_m;

/// A law of tissue, and how far its local model may be off where it is pressed that deep: a linear one knows its slope
/// but for the way that the contact slides, which counts with the square of the depth; one under large motion has the
/// stiffness of its nodes as they turned, not as they stretched.
struct TissueLaw {
  std::string name;
  ProbeOptions probe;
  bool large_motion;
  double off_most;
  double depth_m = 0.002;
};

const std::array<TissueLaw, 5> kTissueLaws{
    TissueLaw{.name = "BarelyPressedPoint", .probe = {}, .large_motion = false, .off_most = 0.01, .depth_m = 0.0005},
    TissueLaw{.name = "Point", .probe = {}, .large_motion = false, .off_most = 0.12},
    TissueLaw{.name = "Sphere", .probe = {.radius_m = 0.01}, .large_motion = false, .off_most = 0.1},
    TissueLaw{.name = "TiedPoint", .probe = {.contact_stiffness_N_per_m = 1e3}, .large_motion = true, .off_most = 0.2},
    TissueLaw{.name = "PressedSphere", .probe = {.radius_m = 0.01}, .large_motion = true, .off_most = 0.25}};

/// A block of 60 mm on a bed, and a probe on it.
class DescribedContact : public ::testing::TestWithParam<TissueLaw> {
 protected:
  DescribedContact() {
    TetrahedralMesh mesh(test::tetrahedra_of(test::kThickBlock));
    std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ());
    model.emplace(TissueDescription{.mesh = std::move(mesh),
                                    .material = test::kSoft,
                                    .held_nodes = std::move(held),
                                    .probe = GetParam().probe,
                                    .large_motion = GetParam().large_motion});
    state = model->make_state(1);
    seat = state->join();
  }

  scene::Point to(const scene::Point& place_m, int times = 1) {
    for (int i = 0; i < times; ++i) state->move(seat, place_m, scene::Point::Zero());
    return state->touch(seat).force_N;
  }

  scene::Point press(double depth_m) {
    constexpr int kSteps = 60;
    for (int i = 0; i <= kSteps; ++i) to(at(0.005 - (0.005 + depth_m) * i / kSteps));
    return to(at(-depth_m), 30);
  }

  [[nodiscard]] scene::Point at(double height_m) const {
    return {0.032, 0.031, kThickTop_m + GetParam().probe.radius_m + height_m};
  }

  [[nodiscard]] local_model::Surface described() {
    local_model::LocalModel told;
    EXPECT_TRUE(state->describe(seat, told));
    EXPECT_TRUE(local_model::is_sound(told));
    EXPECT_EQ(told.surface_count, 1U);
    return told.surfaces[0];
  }

  std::optional<TissueDynamicModel> model;
  std::unique_ptr<scene::DynamicModelState> state;
  int seat = -1;
};

TEST_P(DescribedContact, HasTheForceAndItsSlopeAlongTheNormal) {
  const double depth_m = GetParam().depth_m;
  constexpr double kNudge_m = 1e-4;
  const scene::Point force_N = press(depth_m);
  const local_model::Surface told = described();
  ASSERT_GT(force_N.norm(), 0.01);
  EXPECT_EQ(told.force_N, force_N);
  EXPECT_TRUE((told.stiffness_N_per_m * (told.place_m - at(-depth_m))).isApprox(force_N, 1e-6))
      << "the plane lies where this force ends";
  const scene::Point out_m = kNudge_m * told.normal;
  const scene::Point outer_N = to(at(-depth_m) + out_m, 30);
  const scene::Point inner_N = to(at(-depth_m) - out_m, 30);
  const double slope_N_per_m = (inner_N - outer_N).dot(told.normal) / (2 * kNudge_m);
  const double reported_N_per_m = told.normal.dot(told.stiffness_N_per_m * told.normal);
  EXPECT_NEAR(reported_N_per_m / slope_N_per_m, 1, GetParam().off_most);
}

TEST_P(DescribedContact, IsThereBeforeItIsTouchedWhereItWillBe) {
  to(at(0.02));
  EXPECT_EQ(to(at(0.005)), scene::Point::Zero());
  const local_model::Surface told = described();
  EXPECT_EQ(told.force_N, scene::Point::Zero());
  EXPECT_NEAR(told.place_m.z(), kThickTop_m + GetParam().probe.radius_m, 1e-9);
  EXPECT_TRUE(told.normal.isApprox(scene::Point::UnitZ(), 1e-9));
  EXPECT_GT(told.stiffness_N_per_m(2, 2), 1);
  to(at(kModelledAbove_m + 0.001));
  local_model::LocalModel none;
  EXPECT_FALSE(state->describe(seat, none)) << "that far away";
  EXPECT_TRUE(none.empty());
}

TEST_P(DescribedContact, LeavesTheTissueAsItIs) {
  press(GetParam().depth_m);
  const scene::Point once_N = to(at(-GetParam().depth_m));
  (void)described();
  (void)described();
  const scene::Point again_N = to(at(-GetParam().depth_m));
  EXPECT_LT((again_N - once_N).norm(), 1e-3 * once_N.norm());
}

TEST_P(DescribedContact, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  press(GetParam().depth_m);
  local_model::LocalModel told;
  const test::AllocationGuard guard;
  EXPECT_TRUE(state->describe(seat, told));
  EXPECT_EQ(guard.heap_operations(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Tissue, DescribedContact, ::testing::ValuesIn(kTissueLaws),
                         [](const auto& law) { return law.param.name; });

}  // namespace
}  // namespace forcebound::tissue
