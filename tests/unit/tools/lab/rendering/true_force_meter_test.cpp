#include "tests/tools/lab/rendering/true_force_meter.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <initializer_list>

#include "forcebound/server/environment/scene_library.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;

/// Forces out of the shipped wall, by a device that is 1 mm deep in it, a tick each 2 ms.
RenderingFigures figures_of(std::initializer_list<double> applied_N, double from_s = 0) {
  TrueForceMeter meter(server::load_scene("wall"), 1, from_s);
  meter.place_of = [] { return control::Vector::Constant(1, 0.001); };
  record::TickRecord tick;
  tick.interval = 2ms;
  for (const double force_N : applied_N) {
    tick.time += tick.interval;
    tick.applied = control::Vector::Constant(1, force_N);
    meter.on_tick(tick);
  }
  return meter.figures();
}

TEST(TrueForceMeter, KnowsTheLargestChangeOfTheForcePerMillisecond) {
  EXPECT_NEAR(figures_of({-10, -9, -4, -6}).change_N_per_ms, 2.5, 1e-12);
  EXPECT_EQ(figures_of({-10}).change_N_per_ms, 0);
}

TEST(TrueForceMeter, PassesOverWhatIsBeforeItCounts) {
  const RenderingFigures late = figures_of({-10, -90, -4, -6}, 0.004);
  EXPECT_NEAR(late.change_N_per_ms, 1, 1e-12);
  EXPECT_NEAR(late.true_share, 5 * figures_of({-1}).true_share, 1e-12);
}

}  // namespace
}  // namespace forcebound::lab
