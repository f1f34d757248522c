#include "forcebound/server/follower/contact_estimator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using Point = Eigen::Vector3d;

/// A tool with a noisy sensor before a plane, a millisecond after the other.
struct Felt {
  Point normal = Point(0.2, -0.1, 1).normalized();
  double stiffness = 8000;
  double friction = 0;
  double noise_N = 0.05;
  ContactEstimator estimator{};
  std::mt19937_64 random{1};
  Nanoseconds now{0};
  Point before = Point::Zero();

  /// @param place relative to a point of the plane
  const FeltSurface& touch(const Point& place) {
    std::normal_distribution<double> noise(0, noise_N);
    now += 1ms;
    const Point velocity = (place - before) / 1e-3;
    before = place;
    const double depth = std::max(0.0, -place.dot(normal));
    Point force = -stiffness * depth * normal;
    const Point along = velocity - velocity.dot(normal) * normal;
    if (along.norm() > 1e-9) force += friction * stiffness * depth * along.normalized();
    for (Eigen::Index axis = 0; axis < 3; ++axis) force[axis] += noise(random);
    return estimator.update(now, place, velocity, force);
  }
};

TEST(ContactEstimator, FindsPlaneAndStiffnessOfAWallThatIsPressed) {
  Felt felt;
  for (int n = 0; n < 1500; ++n) {
    const double depth = 1e-3 * (0.5 - 0.5 * std::cos(n * 0.01)) * std::min(1.0, n / 500.0);
    felt.touch(-depth * felt.normal);
  }
  const FeltSurface& surface = felt.estimator.surface();
  ASSERT_TRUE(surface.known);
  EXPECT_NEAR(surface.stiffness_N_per_m, 8000, 400);
  EXPECT_GT(surface.certainty, 0.9);
  EXPECT_NEAR(surface.normal.dot(felt.normal), 1, 1e-3);
  EXPECT_NEAR(surface.place_m.dot(felt.normal), 0, 5e-5) << "where the force begins";
}

TEST(ContactEstimator, TellsFrictionFromTheNormalWhileItSlides) {
  Felt felt{.normal = Point::UnitZ(), .friction = 0.3};
  for (int n = 0; n < 2000; ++n) {
    const double depth = n < 300 ? 1e-3 * n / 300.0 : 1e-3 * (1 + 0.2 * std::sin(n * 0.02));
    felt.touch({n < 300 ? 0 : 2e-5 * (n - 300), 0, -depth});
  }
  const FeltSurface& surface = felt.estimator.surface();
  EXPECT_NEAR(surface.friction, 0.3, 0.05);
  EXPECT_NEAR(surface.normal.z(), 1, 5e-3) << "friction does not tilt it";
}

TEST(ContactEstimator, FindsNoFrictionInNoiseNorMoreThanThereCanBe) {
  for (const auto& [friction, least, most] :
       {std::array{0.0, 0.0, 0.05}, std::array{0.8, 0.75, 0.85}, std::array{3.0, 0.0, 1.0}}) {
    Felt felt{.normal = Point::UnitZ(), .stiffness = 2000, .friction = friction, .noise_N = 0.2};
    for (int n = 0; n < 3000; ++n) felt.touch({n < 300 ? 0 : 2e-5 * (n - 300), 0, -1e-3 * std::min(1.0, n / 300.0)});
    EXPECT_GE(felt.estimator.surface().friction, least) << friction;
    EXPECT_LE(felt.estimator.surface().friction, most) << friction;
  }
}

TEST(ContactEstimator, StaysKnownInTheAirUntilTheToolGoesThrough) {
  Felt felt{.normal = Point::UnitZ()};
  for (int n = 0; n < 500; ++n) felt.touch({0, 0, -1e-3 * std::abs(std::sin(n * 0.02))});
  for (int n = 0; n < 500; ++n) felt.touch({0.0001 * n, 0, 0.02});
  ASSERT_TRUE(felt.estimator.surface().known);
  EXPECT_NEAR(felt.estimator.surface().place_m.z(), 0, 5e-4);
  EXPECT_NEAR(felt.estimator.surface().place_m.x(), 0.0499, 1e-3) << "below the tool";
  felt.stiffness = 0;
  felt.touch({0.5, 0, -0.02});
  EXPECT_FALSE(felt.estimator.surface().known) << "it is not there any more";
}

TEST(ContactEstimator, AnotherSurfaceHasAnotherNumber) {
  Felt felt{.normal = Point::UnitZ()};
  for (int n = 0; n < 300; ++n) felt.touch({0, 0, -1e-5 * n});
  const std::uint32_t first = felt.estimator.surface().id;
  felt.touch({0, 0, 0.01});
  felt.normal = Point::UnitX();
  for (int n = 0; n < 300; ++n) felt.touch({-1e-5 * n, 0, 0});
  EXPECT_NE(felt.estimator.surface().id, first);
  EXPECT_NEAR(felt.estimator.surface().normal.x(), 1, 1e-2);
}

TEST(ContactEstimator, WhatItTrustsIsBounded) {
  Felt felt{.normal = Point::UnitZ(), .stiffness = 1e6, .noise_N = 0.2};
  for (int n = 0; n < 2000; ++n) felt.touch({0, 0, -1e-5 * std::abs(std::sin(n * 0.01))});
  EXPECT_LE(felt.estimator.surface().stiffness_N_per_m, ContactSettings{}.stiffness_N_per_m_most);
  Felt quiet{.normal = Point::UnitZ(), .stiffness = 8000, .noise_N = 0.2};
  for (int n = 0; n < 20000; ++n) quiet.touch({0, 0, -5e-4});
  EXPECT_TRUE(std::isfinite(quiet.estimator.surface().stiffness_N_per_m));
}

}  // namespace
}  // namespace forcebound::server
