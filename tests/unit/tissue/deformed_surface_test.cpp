#include "forcebound/tissue/deformed_surface.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::tissue {
namespace {

constexpr double kStiffness_N_per_m = 700;

/// Two triangles that share an edge, the diagonal, with a ridge along it.
class Roof {
 public:
  Roof() : surface_({{0, 0, 0}, {1, 0, 0.1}, {1, 1, 0}, {0, 1, 0.15}}, {{0, 1, 2}, {0, 2, 3}}) {
    displacement_m_.resize(12);
    displacement_m_ << 0.02, 0, 0.01, 0, 0.03, -0.02, 0.01, 0.01, 0.2, -0.02, 0, 0.03;
  }

  [[nodiscard]] DeformedSurface deformed() const { return {surface_, displacement_m_}; }

  /// With which a tie that has slid pushes the nodes.
  [[nodiscard]] Eigen::VectorXd push_N(SurfaceTie tie, const Eigen::VectorXd& moved_m) const {
    const Eigen::VectorXd there_m = displacement_m_ + moved_m;
    const DeformedSurface deformed(surface_, there_m);
    tie.place = deformed.slid(tie).place;
    Eigen::VectorXd all_N = Eigen::VectorXd::Zero(12);
    deformed.add_at(tie.place, kStiffness_N_per_m * deformed.stretch_m(tie), all_N);
    return all_N;
  }

  /// A tie at the place nearest to a probe.
  [[nodiscard]] SurfaceTie tie_to(const scene::Point& probe_m, bool slides = true) const {
    SurfaceTie tie{.place = {.triangle = 0, .weight = {0.4, 0.3, 0.3}}, .probe_m = probe_m, .slides = slides};
    tie.place = deformed().slid(tie).place;
    tie.balanced_m = deformed().stretch_m(tie);
    return tie;
  }

 private:
  TissueSurface surface_;
  Eigen::VectorXd displacement_m_;
};

TEST(DeformedSurface, ATieSlidesToTheNearestPlaceOverTheEdge) {
  const Roof roof;
  const SurfaceTie tie = roof.tie_to({0.2, 0.6, -0.05});
  EXPECT_EQ(tie.place.triangle, 1);
  for (const int triangle : {0, 1}) {
    const Eigen::Matrix3d corners_m = roof.deformed().corners_m(triangle);
    for (int n = 0; n <= 20; ++n) {
      for (int m = 0; m + n <= 20; ++m) {
        const scene::Point weight(0.05 * n, 0.05 * m, 1 - 0.05 * (n + m));
        EXPECT_GE((tie.probe_m - corners_m * weight).norm(), tie.balanced_m.norm() - 1e-12);
      }
    }
  }
}

TEST(DeformedSurface, ATieThatDoesNotSlideStays) {
  const Roof roof;
  const SurfaceTie tie = roof.tie_to({0.2, 0.6, -0.05}, false);
  EXPECT_EQ(tie.place.triangle, 0);
  EXPECT_EQ(tie.place.weight, scene::Point(0.4, 0.3, 0.3));
}

TEST(DeformedSurface, PullsWhereTheProbeIsOutside) {
  const Roof roof;
  EXPECT_FALSE(roof.deformed().pulls(roof.tie_to({0.6, 0.3, -0.1})));
  EXPECT_TRUE(roof.deformed().pulls(roof.tie_to({0.6, 0.3, 0.5})));
}

TEST(DeformedSurface, ResistanceIsTheDerivativeOfThePush) {
  const Roof roof;
  Eigen::VectorXd moved_m(12);
  moved_m << 0.3, -0.7, 0.2, 0.9, -0.1, 0.5, -0.4, 0.6, -0.8, 0.1, 0.2, -0.3;
  // Inside a triangle, on the edge and in a corner, and held.
  const scene::Point under_triangle(0.7, 0.3, -0.05);
  for (const SurfaceTie& tie : {roof.tie_to(under_triangle), roof.tie_to({0.2, 0.6, -0.05}),
                                roof.tie_to({-0.2, -0.2, -0.05}), roof.tie_to(under_triangle, false)}) {
    SCOPED_TRACE(tie.place.weight.transpose());
    Eigen::VectorXd resistance = Eigen::VectorXd::Zero(12);
    roof.deformed().add_resistance(tie, kStiffness_N_per_m, moved_m, resistance);
    constexpr double kStep = 1e-6;
    const Eigen::VectorXd difference =
        (roof.push_N(tie, -kStep * moved_m) - roof.push_N(tie, kStep * moved_m)) / (2 * kStep);
    EXPECT_GT(difference.norm(), 1);
    EXPECT_LT((resistance - difference).norm(), 1e-5 * difference.norm()) << resistance.transpose() << "\n"
                                                                          << difference.transpose();
  }
}

TEST(DeformedSurface, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const Roof roof;
  const SurfaceTie tie = roof.tie_to({0.7, 0.3, -0.05});
  const Eigen::VectorXd moved_m = Eigen::VectorXd::Ones(12);
  Eigen::VectorXd resistance = Eigen::VectorXd::Zero(12);
  const test::AllocationGuard guard;
  roof.deformed().add_resistance(tie, kStiffness_N_per_m, moved_m, resistance);
  const auto slid = roof.deformed().slid(tie);
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_GT(slid.square_m2, 0);
}

}  // namespace
}  // namespace forcebound::tissue
