#include "tests/support/published_law_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace forcebound::test {
namespace {

/// Relative error; absolute near zero.
void expect_relative(double actual, double expected, double tolerance, const char* what) {
  ASSERT_LE(std::abs(actual - expected), tolerance * std::abs(expected)) << what << ": " << actual << ", " << expected;
}

}  // namespace

control::Matrix full_damping(int degrees_of_freedom, std::uint64_t seed) {
  const auto one = random_ticks({.seed = seed, .degrees_of_freedom = degrees_of_freedom, .ticks = 1});
  return to_matrix(one.front().damping_N_s_per_m);
}

void expect_agreement(std::string_view law, Reference reference, const RandomRun& run) {
  SCOPED_TRACE(testing::Message() << law << ": " << run.degrees_of_freedom << " degrees of freedom, seed " << run.seed
                                  << (run.damping_changes ? ", damping changes" : ""));
  constexpr double kForceMax_N = 15;
  const std::vector<ReferenceTick> ticks = random_ticks(run);
  const auto expected = reference(ticks, {1e-3, kForceMax_N});
  LawLoop loop(law, to_matrix(ticks.front().damping_N_s_per_m), {.force_N_max = kForceMax_N});
  int bounded = 0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "tick " << i);
    loop.set_damping(to_matrix(ticks[i].damping_N_s_per_m));
    const control::Vector request = to_vector(ticks[i].request_N);
    const control::Vector force = loop.tick(to_vector(ticks[i].position_m), request);
    const control::Vector right = to_vector(expected[i].force_N);
    ASSERT_LE((force - right).norm(), 1e-9 * right.norm()) << force.transpose() << ", not " << right.transpose();
    expect_relative(loop.energy_J(), expected[i].energy_J, 1e-9, "energy");
    expect_relative(loop.xi(), expected[i].xi, 1e-9, "xi");
    bounded += right.norm() < 0.999 * std::min(request.norm(), kForceMax_N) ? 1 : 0;
  }
  EXPECT_GT(bounded, 0) << "the law never bounded the force";
  EXPECT_GT(loop.counts().saturated, 0U);
}

namespace {

Extraction play_against(std::string_view law, int degrees_of_freedom, std::uint64_t seed, bool damping_changes,
                        const LawLoopSetting& setting) {
  LawLoop loop(law, full_damping(degrees_of_freedom, seed), setting);
  return play({.seed = seed,
               .degrees_of_freedom = degrees_of_freedom,
               .period_s = setting.period_s,
               .dampings =
                   [&](int tick) {
                     return full_damping(degrees_of_freedom,
                                         seed + (damping_changes ? static_cast<std::uint64_t>(tick) : 0U));
                   },
               .law =
                   [&](const auto& position, const auto& request, const auto& damping) {
                     loop.set_damping(damping);
                     return loop.tick(position, request);
                   }});
}

}  // namespace

void expect_passive_against_any_adversary(std::string_view law, const LawLoopSetting& setting) {
  for (const int degrees_of_freedom : {1, 3, 6}) {
    for (const bool damping_changes : {false, true}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const Extraction result = play_against(law, degrees_of_freedom, seed, damping_changes, setting);
        EXPECT_GE(result.least_J, -1e-13L * result.turnover_J)
            << law << ": " << degrees_of_freedom << " degrees of freedom, seed " << seed << ", turnover "
            << result.turnover_J << " J";
      }
    }
  }
}

void expect_direction_kept(std::string_view law) {
  for (const int degrees_of_freedom : {3, 6}) {
    const auto ticks = random_ticks({.seed = 11, .degrees_of_freedom = degrees_of_freedom, .ticks = 2000});
    LawLoop loop(law, to_matrix(ticks.front().damping_N_s_per_m), {.force_N_max = 15});
    for (const ReferenceTick& tick : ticks) {
      const control::Vector request = to_vector(tick.request_N);
      const control::Vector force = loop.tick(to_vector(tick.position_m), request);
      const double share = request.isZero(0) ? 0.0 : force.dot(request) / request.squaredNorm();
      ASSERT_GE(share, 0.0);
      ASSERT_LE(share, 1 + 1e-15);
      ASSERT_LE((force - share * request).norm(), 1e-15 * force.norm());
    }
  }
}

void expect_finite_for_hard_requests(std::string_view law) {
  const double most = std::numeric_limits<double>::max();
  const double infinite = std::numeric_limits<double>::infinity();
  const double least = std::numeric_limits<double>::denorm_min();
  for (const double size : {least, 1e-300, 1e-160, 1e160, 1e300, most, infinite, std::nan("")}) {
    SCOPED_TRACE(size);
    LawLoop loop(law, full_damping(3, 5));
    for (int i = 0; i < 50; ++i) {
      const control::Vector position = control::Vector::Constant(3, i * 1e-4);
      const control::Vector force = loop.tick(position, control::Vector::Constant(3, i % 2 == 0 ? size : -size));
      ASSERT_TRUE(force.allFinite());
      ASSERT_TRUE(std::isfinite(loop.energy_J()));
      ASSERT_TRUE(loop.xi() >= 0 && loop.xi() <= 1) << loop.xi();
      ASSERT_TRUE(std::isfinite(size) || force.isZero(0));
    }
    const control::Vector force = loop.tick(control::Vector::Constant(3, 1.0), control::Vector::Constant(3, -1e-3));
    EXPECT_GT(force.norm(), 0.0) << "did not recover";
  }
}

}  // namespace forcebound::test
