#include "tests/tools/lab/identification/study.hpp"

#include <gtest/gtest.h>

namespace forcebound::lab::identification {
namespace {

TEST(IdentificationStudy, NoBoundOfTenHiddenDevicesIsWrongAndTheLawIsPassiveWithThem) {
  const auto devices = study_devices({.devices = 10, .seed = 3}, [](std::uint64_t) {});
  ASSERT_EQ(devices.size(), 10U);
  int complete = 0;
  for (const StudyDevice& device : devices) {
    SCOPED_TRACE(testing::Message() << device.kind << ", seed " << device.seed);
    complete += device.complete;
    EXPECT_EQ(device.above, 0);
    EXPECT_FALSE(device.wrong_step);
    EXPECT_FALSE(device.time_outside);
    EXPECT_GE(device.least_P_J.value_or(0), -1e-9);
    EXPECT_LE(device.latency_excess_s.value_or(0), 100e-6);
    EXPECT_EQ(device.least_P_J.has_value(), device.complete);
  }
  EXPECT_GE(complete, 8);
  EXPECT_FALSE(any_wrong(devices));
}

TEST(IdentificationStudy, CountsABoundAboveTheTruth) {
  StudyDevice wrong{.kind = "1 axis", .bounds = 2, .above = 1};
  EXPECT_TRUE(any_wrong({wrong}));
  EXPECT_NE(study_text({wrong}, text::Colour::none).find("1 of 2"), std::string::npos);
  wrong.above = 0;
  EXPECT_FALSE(any_wrong({wrong}));
  wrong.least_P_J = -1e-6;
  EXPECT_TRUE(any_wrong({wrong}));
}

}  // namespace
}  // namespace forcebound::lab::identification
