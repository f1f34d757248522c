#include "forcebound/server/environment/calibrate.hpp"

#include <gtest/gtest.h>

#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/own_effects.hpp"

namespace forcebound::server {
namespace {

/// A clock that advances by 3200 ns at each reading.
class CountingClock final : public time::Clock {
 public:
  [[nodiscard]] time::Nanoseconds now() const noexcept override { return time::Nanoseconds{3200 * ++looks_}; }

 private:
  mutable std::int64_t looks_ = 0;
};

TEST(Calibrate, MeasuresEachPartAloneAndTheWhole) {
  const auto scene = test::scene_with_own_effects(test::table("table", "'surface'") +
                                                  "[[field]]\nname = 'fog'\neffects = ['clock']\n");
  const Calibration found = calibrate(scene, CountingClock());
  ASSERT_EQ(found.parts.size(), 2U);
  for (const MeasuredCost& cost : {found.parts[0], found.parts[1], found.whole}) {
    EXPECT_EQ(cost.median_ns, 100) << "32 motions between two looks at the clock";
    EXPECT_EQ(cost.p99_ns, 100);
  }
}

TEST(Calibrate, OfAnEmptySceneHasOnlyTheWhole) {
  const Calibration found = calibrate(load_scene("free"), CountingClock());
  EXPECT_TRUE(found.parts.empty());
  EXPECT_EQ(found.whole.median_ns, 100);
}

}  // namespace
}  // namespace forcebound::server
