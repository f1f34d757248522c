#include "forcebound/client/page/tick_tap.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "forcebound/time/heap_operations.hpp"

namespace forcebound::client {
namespace {

control::Vector vector(std::initializer_list<double> values) {
  control::Vector made(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) made[i++] = value;
  return made;
}

record::TickRecord tick_record(std::uint64_t number) {
  record::TickRecord record;
  record.tick = number;
  record.time = std::chrono::milliseconds(number);
  record.position = vector({0.01, 0.02});
  record.request = vector({1, 2});
  record.applied = vector({0.5, 1});
  record.energy_J = 0.25;
  return record;
}

record::ForceRecord force_record(std::uint64_t motion) {
  record::ForceRecord record;
  record.force.motion_sequence = motion;
  record.force.position = vector({0.03, 0.04});
  record.force.answer.contact_normal = vector({0, 1});
  record.force.answer.penetration_m = 0.005;
  return record;
}

TEST(TickTap, CarriesHowAHandleIsTurnedItsTorqueAndWhetherItTouches) {
  TickTap tap;
  EXPECT_FALSE(tap.touches());
  record::TickRecord turned = tick_record(1);
  turned.handle.orientation = {0, 1, 0, 0};
  turned.applied_torque_N_m = vector({0, 0, 0.125});
  turned.contact = true;
  tap.on_tick(turned);
  EXPECT_TRUE(tap.touches());
  tap.on_tick(tick_record(2));
  EXPECT_FALSE(tap.touches());
  std::vector<TickSample> ticks;
  tap.drain([](const ForceSample&) {}, [&](const TickSample& sample) { ticks.push_back(sample); });
  ASSERT_EQ(ticks.size(), 2);
  EXPECT_TRUE(ticks[0].has_orientation);
  EXPECT_EQ(ticks[0].orientation, (control::Handle::Orientation{0, 1, 0, 0}));
  EXPECT_EQ(ticks[0].applied_torque_N_m, (Axes{0, 0, 0.125F}));
  EXPECT_FALSE(ticks[1].has_orientation);
}

TEST(TickTap, CarriesWhatAPageShows) {
  TickTap tap;
  tap.on_tick(tick_record(1));
  tap.on_force(force_record(1));
  tap.on_tick(tick_record(2));
  std::vector<TickSample> ticks;
  std::vector<ForceSample> forces;
  tap.drain([&](const ForceSample& sample) { forces.push_back(sample); },
            [&](const TickSample& sample) { ticks.push_back(sample); });
  ASSERT_EQ(ticks.size(), 2);
  ASSERT_EQ(forces.size(), 1);
  EXPECT_EQ(ticks[1].position_m, (Axes{0.01F, 0.02F, 0}));
  EXPECT_EQ(ticks[1].asked_N, (Axes{1, 2, 0}));
  EXPECT_EQ(ticks[1].applied_N, (Axes{0.5F, 1, 0}));
  EXPECT_EQ(ticks[1].ledger_J, 0.25);
  EXPECT_FALSE(ticks[0].has_place);
  EXPECT_TRUE(ticks[1].has_place);
  EXPECT_EQ(ticks[1].place_m, (Axes{0.03F, 0.04F, 0}));
  EXPECT_TRUE(forces[0].contact);
  EXPECT_EQ(forces[0].surface_m, (Axes{0.03F, 0.045F, 0}));
}

TEST(TickTap, ShowsTheDevicesOwnPlaceWhereTheSceneRunsAtTheClient) {
  TickTap tap;
  record::TickRecord local = tick_record(1);
  local.rendering = record::ForceOrigin::at_client;
  tap.on_force(force_record(1));
  tap.on_tick(local);
  tap.drain([](const ForceSample&) {}, [](const TickSample& sample) { EXPECT_EQ(sample.place_m, sample.position_m); });
}

TEST(TickTap, DropsAndCountsWhatFindsNoRoom) {
  TickTap tap(4);
  for (std::uint64_t i = 1; i <= 10; ++i) tap.on_tick(tick_record(i));
  EXPECT_EQ(tap.dropped(), 6);
  int taken = 0;
  tap.drain([](const ForceSample&) {}, [&](const TickSample&) { ++taken; });
  EXPECT_EQ(taken, 4);
}

TEST(TickTap, DoesNotAllocate) {
  if (!time::kCountsHeapOperations) GTEST_SKIP() << "the sanitizer's malloc does not count";
  TickTap tap(8);
  const record::TickRecord one_tick = tick_record(1);
  const record::ForceRecord one_force = force_record(1);
  const std::uint64_t before = time::heap_operations_of_this_thread();
  for (int i = 0; i < 20; ++i) {  // also when it is full
    tap.on_tick(one_tick);
    tap.on_force(one_force);
  }
  EXPECT_EQ(time::heap_operations_of_this_thread(), before);
}

}  // namespace
}  // namespace forcebound::client
