#include "forcebound/local_model/local_model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/sample_local_model.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::local_model {
namespace {

using test::kInfinity;
using test::kNaN;
using test::pad;
using test::puck;
using test::sample_local_model;

/// The numbers of a sample model, each to be replaced by one that cannot be.
std::vector<std::function<double&(LocalModel&)>> all_numbers() {
  std::vector<std::function<double&(LocalModel&)>> numbers;
  const auto points = std::array<Point& (*)(LocalModel&), 13>{
      [](LocalModel& m) -> Point& { return m.surfaces[0].force_N; },
      [](LocalModel& m) -> Point& { return m.surfaces[0].place_m; },
      [](LocalModel& m) -> Point& { return m.surfaces[0].normal; },
      [](LocalModel& m) -> Point& { return m.surfaces[0].velocity_m_per_s; },
      [](LocalModel& m) -> Point& { return m.surfaces[0].acceleration_m_per_s2; },
      [](LocalModel& m) -> Point& { return m.mass.force_N; },
      [](LocalModel& m) -> Point& { return m.mass.place_m; },
      [](LocalModel& m) -> Point& { return m.mass.body.velocity_m_per_s; },
      [](LocalModel& m) -> Point& { return m.mass.body.bias_m_per_s2; },
      [](LocalModel& m) -> Point& { return m.mass.contacts[0].normal; },
      [](LocalModel& m) -> Point& { return m.mass.contacts[0].met.velocity_m_per_s; },
      [](LocalModel& m) -> Point& { return m.mass.contacts[0].met.bias_m_per_s2; },
      [](LocalModel& m) -> Point& { return m.field.place_m; }};
  for (const auto point : points) {
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      numbers.emplace_back([point, axis](LocalModel& m) -> double& { return point(m)[axis]; });
  }
  for (Eigen::Index i = 0; i < 9; ++i) {
    numbers.emplace_back([i](LocalModel& m) -> double& { return m.surfaces[0].stiffness_N_per_m.data()[i]; });
    numbers.emplace_back([i](LocalModel& m) -> double& { return m.mass.body.mobility_per_kg.data()[i]; });
    numbers.emplace_back([i](LocalModel& m) -> double& { return m.mass.contacts[1].met.mobility_per_kg.data()[i]; });
    numbers.emplace_back([i](LocalModel& m) -> double& { return m.field.jacobian_N_per_m.data()[i]; });
  }
  numbers.emplace_back([](LocalModel& m) -> double& { return m.surfaces[0].damping_N_s_per_m; });
  numbers.emplace_back([](LocalModel& m) -> double& { return m.surfaces[0].relaxing_N_per_m; });
  numbers.emplace_back([](LocalModel& m) -> double& { return m.surfaces[0].relaxation_s; });
  numbers.emplace_back([](LocalModel& m) -> double& { return m.surfaces[0].relaxed_N; });
  numbers.emplace_back([](LocalModel& m) -> double& { return m.surfaces[0].friction; });
  numbers.emplace_back([](LocalModel& m) -> double& { return m.surfaces[0].radius_m; });
  numbers.emplace_back([](LocalModel& m) -> double& { return m.mass.stiffness_N_per_m; });
  numbers.emplace_back([](LocalModel& m) -> double& { return m.mass.damping_N_s_per_m; });
  numbers.emplace_back([](LocalModel& m) -> double& { return m.mass.radius_m; });
  for (double Body::*const number : {&Body::spring_N_per_m, &Body::damper_N_s_per_m, &Body::dry_friction_N}) {
    numbers.emplace_back([number](LocalModel& m) -> double& { return m.mass.body.*number; });
    numbers.emplace_back([number](LocalModel& m) -> double& { return m.mass.contacts[0].met.*number; });
  }
  for (double Contact::*const number : {&Contact::gap_m, &Contact::compliance_per_kg, &Contact::stiffness_per_s2,
                                        &Contact::damping_per_s, &Contact::friction})
    numbers.emplace_back([number](LocalModel& m) -> double& { return m.mass.contacts[1].*number; });
  numbers.emplace_back([](LocalModel& m) -> double& { return m.field.radius_m; });
  return numbers;
}

TEST(LocalModel, IsSoundAsTheSample) {
  EXPECT_TRUE(is_sound({}));
  EXPECT_TRUE(is_sound(sample_local_model()));
}

TEST(LocalModel, IsNotSoundWithAnyNumberNotFiniteOrBeyondAllBounds) {
  const auto numbers = all_numbers();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (const double bad : {kNaN, kInfinity, -kInfinity, 1e30, -1e30}) {
      LocalModel model = sample_local_model();
      numbers[i](model) = bad;
      EXPECT_FALSE(is_sound(model)) << "number " << i << " is " << bad;
    }
  }
  for (double Contact::*const end : {&Contact::radius_m, &Contact::travel_m, &Contact::return_m}) {
    LocalModel nowhere = sample_local_model();
    for (const double bad : {kNaN, -1.0}) {
      nowhere.mass.contacts[0].*end = bad;
      EXPECT_FALSE(is_sound(nowhere));
    }
    nowhere.mass.contacts[0].*end = kInfinity;
    EXPECT_TRUE(is_sound(nowhere)) << "nothing ends it";
  }
}

TEST(LocalModel, HasNoForceThatRelaxesWhereNothingDoes) {
  LocalModel model = sample_local_model();
  model.surfaces[0].relaxing_N_per_m = 0;
  model.surfaces[0].relaxation_s = 0;
  for (const double bad : {kNaN, kInfinity, -1e30, 0.25}) {
    model.surfaces[0].relaxed_N = bad;
    EXPECT_FALSE(is_sound(model)) << bad;
  }
  model.surfaces[0].relaxed_N = 0;
  EXPECT_TRUE(is_sound(model));
}

TEST(LocalModel, NeedsAStiffnessThatIsSymmetricAndPushesBackInEveryDirection) {
  LocalModel model = sample_local_model();
  model.surfaces[0].stiffness_N_per_m = Point(1000, 1000, -1).asDiagonal();
  EXPECT_FALSE(is_sound(model));
  model.surfaces[0].stiffness_N_per_m = Point(1000, 1000, -0.01).asDiagonal();
  EXPECT_TRUE(is_sound(model)) << "rounding";
  model.surfaces[0].stiffness_N_per_m(0, 1) = 500;
  EXPECT_FALSE(is_sound(model));
  model.surfaces[0].stiffness_N_per_m << 0, 1000, 0, 1000, 0, 0, 0, 0, 0;
  EXPECT_FALSE(is_sound(model)) << "eigenvalues 1000 and -1000";
}

TEST(LocalModel, NeedsBodiesThatNoForceMovesAgainstIt) {
  LocalModel model = sample_local_model();
  model.mass.body.mobility_per_kg = Point(8, 8, -1).asDiagonal();
  EXPECT_FALSE(is_sound(model));
  model = sample_local_model();
  model.mass.contacts[0].met.mobility_per_kg(0, 1) = 2;
  EXPECT_FALSE(is_sound(model)) << "not symmetric";
}

TEST(LocalModel, NeedsUnitNormalsAndNoMoreThanThereIsRoomFor) {
  LocalModel model = sample_local_model();
  model.surfaces[0].normal *= 1.01;
  EXPECT_FALSE(is_sound(model));
  model = sample_local_model();
  model.surface_count = LocalModel::kSurfacesMax + 1;
  EXPECT_FALSE(is_sound(model));
  model = sample_local_model();
  model.mass.contact_count = Mass::kContactsMax + 1;
  EXPECT_FALSE(is_sound(model));
}

TEST(LocalModel, TellsOfAStateAtMostASecondFromTheReading) {
  using namespace std::chrono_literals;
  LocalModel model = sample_local_model();
  for (const std::chrono::nanoseconds before : {-1s + 0ns, 0s + 0ns, 1s + 0ns}) {
    model.before_reading = before;
    EXPECT_TRUE(is_sound(model)) << before.count();
    EXPECT_EQ(model.state_time(3s), 3s - before);
  }
  for (const std::chrono::nanoseconds before :
       {1s + 1ns, -1s - 1ns, std::chrono::nanoseconds::min(), std::chrono::nanoseconds::max()}) {
    model.before_reading = before;
    EXPECT_FALSE(is_sound(model)) << before.count();
    EXPECT_LE(std::abs((model.state_time(3s) - 3s).count()), 1'000'000'000) << "also of what is unsound";
  }
}

TEST(LocalModel, TakesOtherPartsAsLongAsThereIsRoomForAllOfThem) {
  LocalModel one;
  one.surfaces[0] = pad();
  one.surfaces[1] = pad();
  one.surface_count = 2;
  LocalModel all;
  EXPECT_TRUE(add(one, all));
  EXPECT_EQ(all.surface_count, 2U);
  EXPECT_FALSE(add(one, all));
  EXPECT_EQ(all.surface_count, 2U);
  LocalModel moved;
  moved.mass = puck();
  moved.has_mass = true;
  EXPECT_TRUE(add(moved, all));
  EXPECT_FALSE(add(moved, all)) << "there is one already";
  EXPECT_TRUE(all.force_N().isApprox(2 * pad().force_N + puck().force_N));
  EXPECT_TRUE(is_sound(all));
}

TEST(LocalModel, IsCheckedWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const LocalModel model = sample_local_model();
  const test::AllocationGuard guard;
  EXPECT_TRUE(is_sound(model));
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::local_model
