#include "forcebound/client/app/live_track.hpp"

#include <gtest/gtest.h>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/client/app/known_devices.hpp"

namespace forcebound::client {
namespace {

/// A client that was started with a device of three axes, for the server's default scene.
class StartedWithThreeAxes : public ::testing::Test {
 protected:
  StartedWithThreeAxes() {
    options.device.device = "cartesian-3dof";
    options.device.hand = "pointer";
  }
  [[nodiscard]] PageChoice chosen(const std::string& scene, const std::string& device) const {
    return {.law = "fba-exact", .scene = scene, .device = device};
  }

  Options options;
  control::LawRegistry laws = baselines::shipped_laws();
  device::DeviceRegistry devices = known_devices();
  TrackMaker maker{options, laws, devices};
};

TEST_F(StartedWithThreeAxes, GetsTheScenesDeviceAndBackAtTheServersDefaultItsOwn) {
  const PageChoice start = chosen("", "cartesian-3dof");
  const PageChoice circle = maker.suited(chosen("circle", "cartesian-3dof"), start);
  EXPECT_EQ(devices.facts(circle.device).translations(), 2);
  EXPECT_EQ(maker.suited(chosen("", circle.device), circle).device, "cartesian-3dof");
}

TEST_F(StartedWithThreeAxes, KeepsADeviceThatHasAsManyAxesOrWasChosen) {
  const PageChoice sphere = chosen("sphere", "omega-3");
  EXPECT_EQ(maker.suited(chosen("", "omega-3"), sphere).device, "omega-3");
  EXPECT_EQ(maker.suited(chosen("", "cartesian-2dof"), chosen("", "cartesian-3dof")).device, "cartesian-2dof");
}

TEST(WordsOfChange, NameWhatIsAndWhatWas) {
  const PageChoice before{.law = "fba-exact", .scene = "sphere"};
  PageChoice after = before;
  EXPECT_EQ(words_of_change(before, after), "");
  after.law = "none";
  after.scene.clear();
  EXPECT_EQ(words_of_change(before, after),
            "law none instead of fba-exact, scene the server's default instead of sphere");
  EXPECT_EQ(words_of_change(after, before),
            "law fba-exact instead of none, scene sphere instead of the server's default");
  PageChoice beside = before;
  beside.law_beside = "none";
  EXPECT_EQ(words_of_change(before, beside), "law beside none");
  EXPECT_EQ(words_of_change(beside, before), "no law beside instead of none");
}

}  // namespace
}  // namespace forcebound::client
