#include "forcebound/client/app/device_in_words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"

namespace forcebound::client {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Not simulated, and never touched.
class Thing final : public device::HapticDevice {
 public:
  explicit Thing(bool identified) : identified_(identified) {
    facts_.name = "thing";
    facts_.damping = device::Matrix::Identity(1, 1);
  }
  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return facts_; }
  [[nodiscard]] bool bounds_are_identified() const noexcept override { return identified_; }
  device::Reading read(device::Nanoseconds) noexcept override { return {}; }
  void apply(device::Nanoseconds, const device::Vector&) noexcept override {}
  [[nodiscard]] std::optional<device::Nanoseconds> released_at() const noexcept override { return std::nullopt; }

 private:
  control::DeviceFacts facts_;
  bool identified_;
};

device::SimulatedDevice simulated(const char* name) {
  return {device::load_device(name), device::make_operator("wave", 3)};
}

std::string exact_law_promises() { return baselines::shipped_laws().guarantee("fba-exact"); }

TEST(FirstWords, SayWhetherTheDeviceIsSimulated) {
  EXPECT_EQ(first_words(simulated("omni"), "wave"), "device 'omni' and its hand 'wave' are simulated");
  EXPECT_EQ(first_words(Thing(true), ""), "device 'thing' is not simulated");
}

TEST(FirstWords, SayThatTheBoundsOfARealDeviceAreNotIdentified) {
  EXPECT_EQ(first_words(Thing(false), ""),
            "device 'thing' is not simulated, its bounds not identified (forcebound identify measures them)");
}

TEST(FirstWords, ASimulationHasExactlyItsBoundsWhetherThoseOfTheRealDeviceAreGuessesOrNot) {
  ASSERT_FALSE(device::load_device("falcon").identified);
  EXPECT_EQ(first_words(simulated("falcon"), "wave"), "device 'falcon' and its hand 'wave' are simulated");
  EXPECT_EQ(guarantee_with(simulated("falcon"), exact_law_promises()), exact_law_promises());
}

TEST(GuaranteeWith, GuessedBoundsIsNone) {
  EXPECT_EQ(guarantee_with(Thing(true), exact_law_promises()), exact_law_promises());
  EXPECT_THAT(guarantee_with(Thing(false), exact_law_promises()),
              StartsWith("nothing while this device's bounds are guesses"));
  EXPECT_EQ(guarantee_with(Thing(false), ""), "") << "a law that guarantees nothing guarantees no more then";
}

TEST(DeviceInWords, NeverCallsPassiveWhatNobodyAudited) {
  for (const bool identified : {true, false}) {
    const Thing thing(identified);
    ASSERT_EQ(thing.audit(), std::nullopt);
    EXPECT_THAT(first_words(thing, ""), Not(HasSubstr("passive")));
    EXPECT_THAT(guarantee_with(thing, exact_law_promises()), Not(HasSubstr("passive")));
  }
}

}  // namespace
}  // namespace forcebound::client
