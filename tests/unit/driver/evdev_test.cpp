#include <gmock/gmock.h>

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "forcebound/driver/driver_device.hpp"
#include "forcebound/driver/driver_library.hpp"

namespace forcebound::driver {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Its own events are in evdev_state_test.cpp; an input device is only there where the machine has one.
class Evdev : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kFile)) GTEST_SKIP() << "built without libevdev";
  }

  static void open(const std::string& settings) {
    const DriverDevice device(std::make_shared<const DriverLibrary>(kFile, "evdev"),
                              DriverRequest::parse("evdev:" + settings));
  }

  inline static const std::string kFile = std::string(FORCEBOUND_DRIVERS) + "/forcebound-device-evdev.so";
};

TEST_F(Evdev, SaysWhatItFoundAtAPath) {
  EXPECT_THAT([] { open("path=/dev/null"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("/dev/null: not an input device; path=FILE names one")));
  EXPECT_THAT([] { open("path=/nonexistent"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("/nonexistent: No such file or directory")));
}

TEST_F(Evdev, TakesALinkAsThoseOfDevInputById) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / std::string(200, 'd');
  std::filesystem::create_directories(folder);
  const std::filesystem::path link = folder / "usb-3Dconnexion_SpaceNavigator-event-mouse";
  std::filesystem::remove(link);
  std::filesystem::create_symlink("/dev/null", link);
  EXPECT_THAT([&] { open("path=" + link.string()); },
              ThrowsMessage<std::runtime_error>(HasSubstr("path=FILE names one")));
  std::filesystem::remove_all(folder);
}

TEST_F(Evdev, RefusesSettingsSayingWhatIsAccepted) {
  for (const char* settings :
       {"speed=1", "plane=yz", "count_m=-1", "count_m=0", "width_m=nan", "width_m=11", "path="}) {
    EXPECT_THAT([settings] { open(settings); },
                ThrowsMessage<std::runtime_error>(AllOf(HasSubstr(std::string("'") + settings + "' is not accepted"),
                                                        HasSubstr("accepted are path=FILE, plane=xy or xz"))));
  }
}

}  // namespace
}  // namespace forcebound::driver
