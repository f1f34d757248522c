#include "forcebound/device/device_registry.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "tests/support/fake_device.hpp"

namespace forcebound::device {
namespace {

DeviceFamily fakes() {
  return {.name = "fakes",
          .names = {"still"},
          .help = "  still  stands where it is\n",
          .facts = [](const std::string&) { return test::FakeDevice(2).facts(); },
          .make = [](const DeviceRequest&) { return std::make_unique<test::FakeDevice>(2); }};
}

std::string refusal_of_family(const DeviceFamily& family) {
  DeviceRegistry devices = DeviceRegistry::standard();
  try {
    devices.add(family);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(DeviceRegistry, MakesEveryShippedDeviceWithTheHandThatGoesWithIt) {
  const DeviceRegistry devices = DeviceRegistry::standard();
  ASSERT_EQ(devices.names(), shipped_device_names());
  for (const std::string& name : devices.names()) {
    const auto device = devices.make(devices.completed({.device = name}));
    EXPECT_TRUE(device->is_simulated());
    EXPECT_EQ(device->facts().name, name);
    EXPECT_EQ(device->facts_in_words(), describe(load_device(name)));
    EXPECT_FALSE(device->hand_in_words().empty());
  }
}

TEST(DeviceRegistry, ChoosesTheDeviceThatGoesWithAHand) {
  const DeviceRegistry devices = DeviceRegistry::standard();
  EXPECT_EQ(devices.completed({}).device, "wall-1dof");
  EXPECT_EQ(devices.completed({}).hand, "press");
  EXPECT_EQ(devices.completed({.hand = "trace-circle:radius_m=0.02"}).device, "cartesian-2dof");
  EXPECT_EQ(devices.completed({.hand = "wave"}).device, "omni");
  EXPECT_EQ(devices.completed({.device = "mine.toml"}).hand, "trace-sphere");
}

TEST(DeviceRegistry, MakesADeviceThatAProgramAdded) {
  DeviceRegistry devices = DeviceRegistry::standard();
  devices.add(fakes());
  const auto device = devices.make(devices.completed({.device = "still"}));
  EXPECT_FALSE(device->is_simulated());
  EXPECT_EQ(devices.facts("still").degrees_of_freedom(), 2);
  EXPECT_NE(devices.help().find("stands where it is"), std::string::npos);
  EXPECT_TRUE(device->hand_in_words().empty());
  EXPECT_EQ(device->facts_in_words().find("fake: 2 degrees of freedom, Cartesian, damping [30 30] N s/m"), 0U)
      << device->facts_in_words();
}

TEST(DeviceRegistry, UnknownDeviceIsRefusedWithTheKnownNames) {
  DeviceRegistry devices = DeviceRegistry::standard();
  devices.add(fakes());
  try {
    (void)devices.make({.device = "stil", .hand = ""});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "unknown device 'stil', did you mean 'still'? (known: arm-6dof, cartesian-2dof, cartesian-3dof, "
                 "falcon, firm-3dof, "
                 "haply-2diy, omega-3, omni, premium-6dof, wall-1dof, still); or the path of a .toml file");
  }
  EXPECT_THROW((void)devices.facts("no/such/file.toml"), std::runtime_error);
}

TEST(DeviceRegistry, RefusesAnIncompleteOrConflictingFamily) {
  EXPECT_EQ(refusal_of_family(fakes()), "");
  DeviceFamily nameless = fakes();
  nameless.name.clear();
  EXPECT_EQ(refusal_of_family(nameless), "device family '' must have a name");
  DeviceFamily unmade = fakes();
  unmade.make = nullptr;
  EXPECT_EQ(refusal_of_family(unmade), "device family 'fakes' must have functions for facts and to make a device");
  DeviceFamily twice = fakes();
  twice.names.emplace_back("omni");
  EXPECT_EQ(refusal_of_family(twice), "device family 'fakes' has a device 'omni', which is already registered");
  DeviceFamily files = fakes();
  files.takes_files = true;
  EXPECT_EQ(refusal_of_family(files), "device family 'fakes' takes files, but another family already does");
}

TEST(HapticDevice, ReadingIsUsableOnlyIfOkFiniteAndOfTheRightSize) {
  test::FakeDevice device(2);
  const Reading good = device.read(std::chrono::seconds{1});
  EXPECT_TRUE(is_usable(good, 2));
  EXPECT_FALSE(is_usable(good, 3));
  for (const control::ReadingStatusRow& row : control::kReadingStatuses) {
    Reading reading = good;
    reading.status = row.status;
    EXPECT_EQ(is_usable(reading, 2), row.status == Reading::Status::ok) << row.name;
    EXPECT_FALSE(control::why(row.status).empty());
  }
  Reading infinite = good;
  infinite.joint[1] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(is_usable(infinite, 2));
  Reading undamped = good;
  undamped.damping = nullptr;
  EXPECT_FALSE(is_usable(undamped, 2));
}

TEST(HapticDevice, StopsWithZeroForce) {
  test::FakeDevice device(2);
  device.apply(std::chrono::seconds{1}, Vector::Constant(2, 3));
  device.stop(std::chrono::seconds{2});
  EXPECT_EQ(device.applied, Vector(Vector::Zero(2)));
  EXPECT_EQ(device.applied_at, std::chrono::seconds{2});
}

}  // namespace
}  // namespace forcebound::device
