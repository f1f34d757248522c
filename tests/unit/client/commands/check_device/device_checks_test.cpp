#include "forcebound/client/commands/check_device/device_checks.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/client/commands/check_device/thread_cost.hpp"
#include "forcebound/client/commands/check_device/untouched.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/driver/driver_device.hpp"

namespace forcebound::client::commands {
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

std::vector<std::string> failed_of(device::HapticDevice& device, bool real_cost = false,
                                   const DeviceCheckSettings& settings = {.force_share = 1}) {
  VirtualPace pace(real_cost);
  std::vector<std::string> failed;
  for (const DeviceCheck& check : check_device(device, pace, settings)) {
    if (check.verdict != Verdict::failed) continue;
    failed.push_back(check.name);
    std::cout << check.name << ": " << check.measured << '\n';
  }
  return failed;
}

std::unique_ptr<driver::DriverDevice> device_with(const std::string& fault) {
  const std::string file = std::string(FORCEBOUND_TEST_DRIVERS) + "/forcebound-device-faulty.so";
  return std::make_unique<driver::DriverDevice>(std::make_shared<const driver::DriverLibrary>(file, "faulty"),
                                                driver::DriverRequest::parse("faulty:fault=" + fault));
}

std::vector<std::string> failed_with(const std::string& fault, bool real_cost = false) {
  return failed_of(*device_with(fault), real_cost);
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

TEST(CheckDevice, FindsTimesThatRunBackwards) {
  EXPECT_THAT(failed_with("backwards"), testing::Contains("times run forward"));
}
TEST(CheckDevice, FindsTimesAMillisecondInTheFutureWhichTheClientRefuses) {
  EXPECT_THAT(failed_with("ahead"), testing::Contains("times run forward"));
}
TEST(CheckDevice, FindsReadingsOfVeryDifferentAges) { EXPECT_THAT(failed_with("jitter"), ElementsAre("jitter")); }
TEST(CheckDevice, FindsReadingsThatAreSeldomNew) { EXPECT_THAT(failed_with("seldom"), testing::Contains("rate")); }
TEST(CheckDevice, FindsFailuresWithoutAReason) {
  EXPECT_THAT(failed_with("fails"), ElementsAre("readings", "last error"));
  EXPECT_THAT(failed_with("write"), ElementsAre("commands", "last error"));
}

TEST(CheckDevice, GivesNoMoreForceToATipThatIsTooFast) {
  const auto device = device_with("none");
  EXPECT_THAT(failed_of(*device, false, {.force_share = 1, .speed_m_per_s_max = 0.1}), ElementsAre("force along +x"));
  VirtualPace pace;
  const auto checks = check_device(*device_with("none"), pace, {.speed_m_per_s_max = 0.1});
  const auto hold_time = std::ranges::find(checks, "hold time", &DeviceCheck::name);
  ASSERT_NE(hold_time, checks.end());
  EXPECT_EQ(hold_time->verdict, Verdict::not_checked) << "nothing is pushed any more";
}

TEST(CheckDevice, TellsEachCheckOnceItIsJudged) {
  std::vector<std::string> told;
  VirtualPace pace;
  const auto checks = check_device(*device_with("none"), pace,
                                   {.found = [&](const DeviceCheck& check) { told.push_back(check.name); }});
  ASSERT_EQ(told.size(), checks.size());
  for (std::size_t i = 0; i < told.size(); ++i) EXPECT_EQ(told[i], checks[i].name);
}

class IdlePerson final : public Person {
 public:
  void ask(const std::string& what, double /*left_s*/) override {
    if (asked.empty() || asked.back() != what) asked.push_back(what);
  }
  bool is_done() override { return false; }

  std::vector<std::string> asked;
};

TEST(CheckDevice, APersonWhoDoesNothingFailsIt) {
  IdlePerson person;
  EXPECT_THAT(failed_of(*device_with("none"), false, {.person = &person}), ElementsAre("unplugging"));
  EXPECT_THAT(person.asked, ElementsAre("Unplug the device."));
}

TEST(CheckDevice, PassesTheSimulatedDevices) {
  for (const std::string& name : device::shipped_device_names()) {
    SCOPED_TRACE(name);
    device::DeviceDescription description = device::load_device(name);
    auto nobody = std::make_unique<Nobody>(description.facts.translations());
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
}  // namespace forcebound::client::commands
