#include "tests/tools/lab/check_device/device_checks.hpp"

#include <gmock/gmock.h>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/driver/driver_device.hpp"
#include "tests/tools/lab/check_device/thread_cost.hpp"
#include "tests/tools/lab/check_device/untouched.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

/// Virtual time. Calls cost nothing, since a busy machine must not fail a test, unless their real cost is asked for.
class VirtualPace final : public Pace {
 public:
  explicit VirtualPace(bool real_cost = false) : real_cost_(real_cost) {}

  Nanoseconds now() override { return now_; }
  void wait_until(Nanoseconds time) override { now_ = std::max(now_, time); }
  CallCost cost_of(const std::function<void()>& call) override {
    if (real_cost_) return thread_cost_of(call);
    call();
    return {};
  }

 private:
  bool real_cost_;
  Nanoseconds now_ = 100s;
};

std::vector<std::string> failed_of(device::HapticDevice& device, bool real_cost = false) {
  VirtualPace pace(real_cost);
  std::vector<std::string> failed;
  for (const DeviceCheck& check : check_device(device, pace, {.force_share = 1})) {
    if (check.verdict != Verdict::failed) continue;
    failed.push_back(check.name);
    std::cout << check.name << ": " << check.measured << '\n';
  }
  return failed;
}

std::vector<std::string> failed_with(const std::string& fault, bool real_cost = false) {
  const std::string file = std::string(FORCEBOUND_TEST_DRIVERS) + "/forcebound-device-faulty.so";
  driver::DriverDevice device(std::make_shared<const driver::DriverLibrary>(file, "faulty"),
                              driver::DriverRequest::parse("faulty:fault=" + fault));
  return failed_of(device, real_cost);
}

TEST(CheckDevice, PassesADriverThatIsRight) { EXPECT_THAT(failed_with("none"), IsEmpty()); }
TEST(CheckDevice, FindsAWrongSign) { EXPECT_THAT(failed_with("sign"), ElementsAre("force along +x")); }
TEST(CheckDevice, FindsSwappedAxes) { EXPECT_THAT(failed_with("axes"), ElementsAre("force along +x")); }
TEST(CheckDevice, FindsMillimetres) { EXPECT_THAT(failed_with("units"), ElementsAre("units along x")); }
TEST(CheckDevice, FindsTimesOfAnotherClock) { EXPECT_THAT(failed_with("clock"), ElementsAre("reading times")); }
TEST(CheckDevice, FindsAForceThatIsNeverLetGo) { EXPECT_THAT(failed_with("holds"), ElementsAre("hold time")); }
TEST(CheckDevice, FindsAForceThatStopLeavesOn) { EXPECT_THAT(failed_with("stop"), ElementsAre("stop")); }
TEST(CheckDevice, FindsCallsThatBlock) { EXPECT_THAT(failed_with("blocks", true), ElementsAre("calls in time")); }
TEST(CheckDevice, FindsADriftAtZeroForce) { EXPECT_THAT(failed_with("drift"), ElementsAre("rest at zero force")); }
TEST(CheckDevice, FindsAForceThatWraps) { EXPECT_THAT(failed_with("wraps"), ElementsAre("saturation")); }
TEST(CheckDevice, FindsReadingsThatAreNotFinite) { EXPECT_THAT(failed_with("nan"), ElementsAre("readings")); }

TEST(CheckDevice, PassesTheSimulatedDevices) {
  for (const std::string& name : device::shipped_device_names()) {
    SCOPED_TRACE(name);
    device::DeviceDescription description = device::load_device(name);
    auto nobody = std::make_unique<Nobody>(description.facts.degrees_of_freedom());
    device::SimulatedDevice device(std::move(description), std::move(nobody));
    EXPECT_THAT(failed_of(device), IsEmpty());
  }
}

TEST(CheckDevice, EndsWhenCancelled) {
  device::DeviceDescription description = device::load_device("omni");
  device::SimulatedDevice device(std::move(description), std::make_unique<Nobody>(3));
  VirtualPace pace;
  EXPECT_THROW((void)check_device(device, pace, {.cancelled = [] { return true; }}), std::runtime_error);
}

}  // namespace
}  // namespace forcebound::lab
