#include <gmock/gmock.h>

#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>

#include "forcebound/driver/driver_device.hpp"
#include "forcebound/driver/driver_library.hpp"

namespace forcebound::driver {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

const std::string kSliderOfVersion1 = std::string(FORCEBOUND_TEST_DRIVERS) + "/version_1/forcebound-device-slider.so";
const std::string kArmDriver = std::string(FORCEBOUND_TEST_DRIVERS) + "/robots/forcebound-device-arm.so";

TEST(DriverOfVersion1, LoadsAndWorksUnchanged) {
  const auto library = std::make_shared<const DriverLibrary>(kSliderOfVersion1, "slider");
  EXPECT_EQ(library->functions().describe_robot, nullptr) << "its table ends before";
  EXPECT_EQ(library->functions().resume, nullptr);
  DriverDevice slider(library, DriverRequest::parse("slider:axes=2,fault=warm"));
  EXPECT_EQ(slider.facts().name, "slider 7");
  EXPECT_EQ(slider.facts().degrees_of_freedom(), 2);
  EXPECT_EQ(slider.safety().rms_force_N_max, 0.5) << "the last of the facts";
  slider.start();
  for (auto now = 1s + 0ms; now < 1100ms; now += 1ms) {
    EXPECT_EQ(slider.read(now).status, device::Reading::Status::ok);
    slider.apply(now, Vector::Ones(2));
  }
  const device::Reading reading = slider.read(1200ms);
  EXPECT_GT(reading.position[1], 1e-3);
  EXPECT_EQ(reading.handle.buttons, 2U);
  EXPECT_EQ(slider.released_at(), 1109ms) << "the last of a reading";
}

TEST(DriverLibrary, SaysWhereADriverBelongsThatIsLoadedForAnotherPurpose) {
  for (const std::string& file :
       {kSliderOfVersion1, std::string(FORCEBOUND_TEST_DRIVERS) + "/forcebound-device-slider.so"}) {
    EXPECT_THAT([&] { const DriverLibrary library(file, "slider", DriverPurpose::robot); },
                ThrowsMessage<std::runtime_error>(
                    AllOf(HasSubstr(file), HasSubstr("is for haptic devices, not for robots"), Not(HasSubstr("\n")))));
  }
  EXPECT_THAT(
      [] { const DriverLibrary library(kArmDriver, "arm"); },
      ThrowsMessage<std::runtime_error>(AllOf(HasSubstr(kArmDriver), HasSubstr("is for robots, not for haptic devices"),
                                              HasSubstr("--follower driver:FILE.so"), Not(HasSubstr("\n")))));
}

TEST(DriverLibrary, OfARobotMayHaveAnyNameButEachFunction) {
  EXPECT_NO_THROW(DriverLibrary(kArmDriver, "another", DriverPurpose::robot));
  const std::string lame = std::string(FORCEBOUND_TEST_DRIVERS) + "/robots/forcebound-device-lame.so";
  EXPECT_THAT([&] { const DriverLibrary library(lame, "lame", DriverPurpose::robot); },
              ThrowsMessage<std::runtime_error>(HasSubstr("lacks the function 'resume'")));
}

}  // namespace
}  // namespace forcebound::driver
