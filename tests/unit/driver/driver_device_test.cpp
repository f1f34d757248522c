#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>

#include "forcebound/driver/driver_device.hpp"
#include "forcebound/driver/driver_facts.hpp"
#include "forcebound/driver/driver_family.hpp"
#include "forcebound/text/file.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::driver {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::ThrowsMessage;
using namespace std::chrono_literals;
using Status = device::Reading::Status;

const std::string kDrivers = FORCEBOUND_TEST_DRIVERS;

std::string file_of(const std::string& name) { return find_driver(name, {kDrivers}).value_or(""); }

std::unique_ptr<DriverDevice> slider(const std::string& settings = {}) {
  const DriverRequest request = DriverRequest::parse("slider:" + settings);
  return std::make_unique<DriverDevice>(std::make_shared<const DriverLibrary>(file_of("slider"), "slider"), request);
}

device::DeviceRegistry registry(std::vector<std::string> folders = {kDrivers}) {
  device::DeviceRegistry devices = device::DeviceRegistry::standard();
  devices.add(driver_family(std::move(folders)));
  return devices;
}

/// Reads and commands at 1 kHz; the readings' states.
std::vector<Status> run(DriverDevice& device, double force_N, int ticks, Nanoseconds begin = 1s) {
  std::vector<Status> states;
  const Vector force = Vector::Constant(device.facts().degrees_of_freedom(), force_N);
  for (int tick = 0; tick < ticks; ++tick) {
    const Nanoseconds now = begin + tick * 1ms;
    states.push_back(device.read(now).status);
    device.apply(now, force);
  }
  return states;
}

TEST(DriverFolders, AreThoseOfTheVariableThenTheInstalledOne) {
  EXPECT_THAT(driver_folders("/a:/b::/c", "/opt/forcebound/bin/forcebound-client"),
              ElementsAre("/a", "/b", "/c", "/opt/forcebound/lib/forcebound/devices"));
  EXPECT_THAT(driver_folders(nullptr, "/usr/bin/forcebound-client"), ElementsAre("/usr/lib/forcebound/devices"));
}

TEST(DriverFolders, TheFirstThatHasADriverCounts) {
  const test::TemporaryFolder first;
  text::write_file(first.file("forcebound-device-slider.so"), "");
  EXPECT_EQ(find_driver("slider", {first.path(), kDrivers}), first.file("forcebound-device-slider.so"));
  EXPECT_EQ(find_driver("slider", {"/nonexistent", kDrivers}), kDrivers + "/forcebound-device-slider.so");
  EXPECT_EQ(find_driver("../slider", {kDrivers}), std::nullopt);
  EXPECT_EQ(find_driver("", {kDrivers}), std::nullopt);
  EXPECT_THAT(drivers_in({kDrivers, kDrivers, "/nonexistent"}),
              ElementsAre("crashing", "empty", "faulty", "mute", "nameless", "newer", "slider", "wrist"));
}

TEST(DriverLibrary, SaysWhatIsWrongWithAFile) {
  const auto refused = [](const std::string& name, const std::string& why) {
    EXPECT_THAT(
        [&] { const DriverLibrary library(file_of(name), name); },
        ThrowsMessage<std::runtime_error>(AllOf(HasSubstr(file_of(name)), HasSubstr(why), Not(HasSubstr("\n")))));
  };
  refused("newer", "has interface 99, this program has 1");
  refused("nameless", "calls itself 'somebody else', but its file is named for 'nameless'");
  refused("mute", "lacks the function 'command'");
  refused("empty", "is no driver: it lacks the function 'forcebound_driver_entry'");
  const test::TemporaryFolder folder;
  text::write_file(folder.file("forcebound-device-text.so"), "no library");
  EXPECT_THAT([&] { const DriverLibrary library(folder.file("forcebound-device-text.so"), "text"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("cannot be loaded")));
}

TEST(DriverRequest, HasSettingsAndAFileOfFacts) {
  const DriverRequest request = DriverRequest::parse("haply:port=10001,facts=my/facts.toml,name=a=b");
  EXPECT_EQ(request.name, "haply");
  EXPECT_EQ(request.facts_file, "my/facts.toml");
  EXPECT_THAT(request.settings, ElementsAre(testing::Pair("port", "10001"), testing::Pair("name", "a=b")));
  EXPECT_THAT(DriverRequest::parse("haply").settings, IsEmpty());
  EXPECT_THROW((void)DriverRequest::parse("haply:port"), std::invalid_argument);
  EXPECT_THROW((void)DriverRequest::parse("haply:=1"), std::invalid_argument);
  EXPECT_THROW((void)DriverRequest::parse("haply:a=1,a=2"), std::invalid_argument);
  EXPECT_THROW((void)DriverRequest::parse("haply:facts="), std::invalid_argument);
}

TEST(DriverDevice, HasTheFactsThatItsDriverTells) {
  const auto device = slider("axes=2");
  EXPECT_EQ(device->facts().name, "slider 7");
  EXPECT_EQ(device->facts().degrees_of_freedom(), 2);
  EXPECT_EQ(device->facts().damping, (Matrix(5 * Matrix::Identity(2, 2))));
  EXPECT_EQ(device->facts().force_N_max, 8);
  EXPECT_EQ(device->facts().hold_s_max, 0.01);
  EXPECT_TRUE(device->facts().releases);
  EXPECT_FALSE(device->is_simulated());
  EXPECT_EQ(device->audit(), std::nullopt) << "nobody audits a person's device";
  EXPECT_THAT(device->facts_in_words(), Not(HasSubstr("not identified")));
  EXPECT_THAT(slider("fault=guessed")->facts_in_words(), HasSubstr("bounds not identified"));
}

TEST(DriverDevice, MovesAlongTheForce) {
  const auto device = slider();
  device->start();
  EXPECT_THAT(run(*device, 1, 100), testing::Each(Status::ok));
  (void)device->read(1s + 105ms);
  EXPECT_EQ(device->released_at(), std::nullopt);
  const device::Reading reading = device->read(2s);
  EXPECT_GT(reading.position[0], 0.01);
  EXPECT_EQ(reading.joint, reading.position);
  EXPECT_EQ(reading.latched, 2s);
  EXPECT_EQ(device->effective_at(), 1s + 99ms);
  EXPECT_EQ(device->released_at(), 1s + 109ms) << "10 ms after the last command";
  EXPECT_EQ(device->counters().failed_writes, 0U);
}

TEST(DriverDevice, TellsOfTheHandleWhatItsDriverHas) {
  const device::Reading reading = slider()->read(1s);
  EXPECT_EQ(reading.handle, control::Handle{.buttons = 2});
  EXPECT_TRUE(reading.handle.pressed(1));
  const auto whole = slider("fault=handle");
  EXPECT_EQ(whole->read(1s).handle, (control::Handle{.buttons = 2, .gripper = 1, .orientation = {{0, 0, 0, 1}}}));
  EXPECT_EQ(whole->counters().handle_refused, 0U);
}

TEST(DriverDevice, AnOrientationOrGripperThatCannotBeTrueIsAbsentAndCounted) {
  const auto device = slider("fault=handle");
  EXPECT_THAT(run(*device, 0, 101), testing::Each(Status::ok)) << "the rest of the reading counts";
  EXPECT_EQ(device->counters().handle_refused, 2U);
  EXPECT_THAT(std::string(device->last_error()), HasSubstr("orientation"));
  EXPECT_EQ(device->read(2s).handle, control::Handle{.buttons = 2});
}

TEST(DriverDevice, StopsAtOnce) {
  const auto device = slider();
  device->start();
  (void)run(*device, 1, 100);
  device->stop(1s + 100ms);
  const double at_m = device->read(3s).position[0];
  EXPECT_NEAR(device->read(4s).position[0], at_m, 1e-9);
}

TEST(DriverDevice, FaultyReadingsAreNotUsedAndTheNextGoodOneIs) {
  for (const auto& [fault, status, why] : std::initializer_list<std::tuple<std::string, Status, std::string>>{
           {"nan", Status::incomplete, "not finite"},
           {"backwards", Status::backwards, "backwards in time"},
           {"future", Status::future, "in the future"},
           {"stale", Status::stale, ""},
           {"fails", Status::failed, "the bus is busy"},
           {"unplugged", Status::failed, "unplugged"}}) {
    const auto device = slider("fault=" + fault);
    device->start();
    EXPECT_THAT(run(*device, 0, 100), testing::Each(Status::ok)) << fault;
    EXPECT_THAT(run(*device, 0, 100, 2s), testing::Each(status)) << fault;
    EXPECT_THAT(std::string(device->last_error()), AllOf(HasSubstr(why), Not(HasSubstr("\n")))) << fault;
    EXPECT_THAT(run(*device, 0, 100, 3s), testing::Each(Status::ok)) << fault;
  }
}

TEST(DriverDevice, CountsFailuresWithoutAReason) {
  const auto counted = [](const std::string& fault) {
    const auto device = slider("fault=" + fault);
    device->start();
    (void)run(*device, 0, 200);
    return device->counters();
  };
  EXPECT_EQ(counted("fails").unexplained, 0U) << "it says that the bus is busy";
  EXPECT_EQ(counted("unplugged").unexplained, 0U) << "that says it";
  EXPECT_EQ(counted("write").unexplained, 200U);
}

TEST(DriverDevice, AReadingOfTheSameTimeIsStale) {
  const auto device = slider();
  device->start();
  EXPECT_EQ(device->read(1s).status, Status::ok);
  EXPECT_EQ(device->read(1s).status, Status::stale);
}

TEST(DriverDevice, CountsCommandsThatFailAndShowsFaultyOnesAsZero) {
  const auto device = slider("fault=write");
  device->start();
  (void)run(*device, 1, 3);
  EXPECT_TRUE(device->write_failed());
  EXPECT_EQ(device->counters().failed_writes, 3U);
  const auto good = slider();
  good->start();
  (void)run(*good, std::numeric_limits<double>::quiet_NaN(), 100);
  good->apply(2s, Vector::Ones(3));
  EXPECT_EQ(good->counters().faulty_commands, 101U);
  EXPECT_EQ(good->read(3s).position[0], 0);
}

TEST(DriverDevice, SaysWhyItDoesNotOpenOrStart) {
  EXPECT_THAT(
      [] { (void)slider("serial=3"); },
      ThrowsMessage<std::runtime_error>(HasSubstr("driver 'slider': 'serial=3' is not accepted; accepted are")));
  EXPECT_THAT([] { (void)slider("fault=undamped"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("driver 'slider': its device's damping")));
  const auto device = slider("fault=start");
  EXPECT_THAT([&] { device->start(); }, ThrowsMessage<std::runtime_error>("driver 'slider': no power"));
}

TEST(DriverDevice, DoesNotAllocateInATick) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto device = slider("axes=3,fault=nan");
  device->start();
  const Vector force = Vector::Zero(3);
  const test::AllocationGuard guard;
  for (int tick = 0; tick < 300; ++tick) {
    (void)device->read(1s + tick * 1ms);
    device->apply(1s + tick * 1ms, force);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(DriverFacts, AreCheckedBeforeALawSeesThem) {
  forcebound_facts good{};
  good.size = sizeof good;
  good.degrees_of_freedom = 1;
  good.period_s = 1e-3;
  good.damping[0] = 2;
  good.force_N_max = 3;
  EXPECT_FALSE(facts_of(good, "pen").releases) << "no hold time: it holds a force for ever";
  EXPECT_EQ(facts_of(good, "pen").name, "pen");
  const auto refused = [&](auto change, const std::string& why) {
    forcebound_facts bad = good;
    change(bad);
    EXPECT_THAT([&] { (void)facts_of(bad, "pen"); },
                ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("driver 'pen': its device's"), HasSubstr(why))));
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  refused([](auto& facts) { facts.degrees_of_freedom = 7; }, "degrees_of_freedom must be from 1 to 6, got 7");
  refused([](auto& facts) { facts.degrees_of_freedom = 0; }, "degrees_of_freedom");
  refused([](auto& facts) { facts.damping[0] = -1; }, "damping");
  refused([](auto& facts) { facts.period_s = 1; }, "period_s must be from 0.0001 to 0.1, got 1");
  refused([](auto& facts) { facts.friction[0] = kNan; }, "friction must be finite and >= 0");
  refused([](auto& facts) { facts.force_N_max = 0; }, "force_N_max must be finite and > 0, got 0");
  refused([](auto& facts) { facts.hold_s_max = 1e-4; }, "hold_s_max");
  refused([](auto& facts) { facts.latency_s = kNan; }, "latency_s");
}

TEST(DriverFacts, TakeTheForceThatTheMotorsMayGiveForEverForTheLimitOfHeat) {
  forcebound_facts told{};
  told.size = sizeof told;
  told.force_N_max = 5;
  control::DeviceFacts facts;
  facts.force_N_max = 5;
  EXPECT_DOUBLE_EQ(safety_of(told, facts, "pen").rms_force_N_max, 3) << "an older driver: 60 % of the largest";
  told.force_N_continuous = 0.88;
  EXPECT_EQ(safety_of(told, facts, "pen").rms_force_N_max, 0.88);
  told.force_N_continuous = -1;
  EXPECT_THAT([&] { (void)safety_of(told, facts, "pen"); },
              ThrowsMessage<std::runtime_error>(
                  HasSubstr("driver 'pen': its device's force_N_continuous must be finite and >= 0, got -1")));
}

TEST(DriverFacts, ALatencyIsABound) {
  forcebound_facts told{};
  told.size = sizeof told;
  told.degrees_of_freedom = 1;
  told.period_s = 1e-3;
  told.damping[0] = 2;
  told.force_N_max = 3;
  told.latency_s = 2e-3;
  const control::DeviceFacts facts = facts_of(told, "pen");
  EXPECT_EQ(facts.latency_s, 2e-3);
  EXPECT_EQ(facts.uncertainty.latency_s, (control::Bracket{-2e-3, 0})) << "it may be none";
}

TEST(DriverFamily, MakesTheDeviceWhoseFactsWereAskedFor) {
  const device::DeviceRegistry devices = registry();
  EXPECT_EQ(devices.facts("slider:axes=2").degrees_of_freedom(), 2);
  const auto device = devices.make({.device = "slider:axes=2"});
  EXPECT_EQ(device->facts().degrees_of_freedom(), 2);
  EXPECT_EQ(devices.make({.device = "slider"})->facts().degrees_of_freedom(), 1);
  EXPECT_EQ(devices.facts("omni").degrees_of_freedom(), 3) << "the simulated ones are there as before";
}

TEST(DriverFamily, TakesAnotherRateInPlaceOfTheDrivers) {
  const auto device = registry().make({.device = "slider", .rate_Hz = 500});
  EXPECT_DOUBLE_EQ(device->facts().period_s, 1.0 / 500);
  EXPECT_THAT([] { (void)registry().make({.device = "slider", .rate_Hz = 2000}); },
              ThrowsMessage<std::invalid_argument>(
                  HasSubstr("driver 'slider' reads its device 1000 times a second: at most so many ticks are accepted, "
                            "got 2000")));
  EXPECT_THAT([] { (void)registry().make({.device = "slider", .rate_Hz = 100}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("from 500 to 4000, got 100")));
}

TEST(DriverFamily, TakesAFileOfFactsInPlaceOfTheDrivers) {
  const test::TemporaryFolder folder;
  text::write_file(folder.file("mine.toml"),
                   "kind = 'cartesian'\ndegrees_of_freedom = 1\ndamping_N_s_per_m = 3\nforce_N_max = 2\n");
  const device::DeviceRegistry devices = registry();
  const auto device = devices.make({.device = "slider:fault=guessed,facts=" + folder.file("mine.toml")});
  EXPECT_EQ(device->facts().damping(0, 0), 3);
  EXPECT_EQ(device->facts().name, devices.make({.device = "slider"})->facts().name) << "not that of the file";
  EXPECT_THAT(device->facts_in_words(), Not(HasSubstr("not identified")));
  EXPECT_THAT([&] { (void)devices.make({.device = "slider:axes=2,facts=" + folder.file("mine.toml")}); },
              ThrowsMessage<std::runtime_error>(
                  HasSubstr("has 1 axes of the tip, but the device of driver 'slider' has 2 axes")));
  EXPECT_THROW((void)devices.make({.device = "slider:facts=/nonexistent.toml"}), std::runtime_error);
}

TEST(DriverFamily, LeavesWhatTheMotorsMayGiveForEverToTheDriverUnlessAFileSaysIt) {
  const test::TemporaryFolder folder;
  const std::string facts = "kind = 'cartesian'\ndegrees_of_freedom = 1\ndamping_N_s_per_m = 3\nforce_N_max = 2\n";
  text::write_file(folder.file("mine.toml"), facts);
  text::write_file(folder.file("cool.toml"), facts + "[safety]\nrms_force_N_max = 1\n");
  const auto rms_force_N_max = [](const std::string& device) {
    return registry().make({.device = device})->safety().rms_force_N_max;
  };
  EXPECT_DOUBLE_EQ(rms_force_N_max("slider"), 0.6 * 8);
  EXPECT_EQ(rms_force_N_max("slider:fault=warm"), 0.5);
  EXPECT_EQ(rms_force_N_max("slider:fault=warm,facts=" + folder.file("mine.toml")), 0.5);
  EXPECT_EQ(rms_force_N_max("slider:fault=warm,facts=" + folder.file("cool.toml")), 1);
  EXPECT_DOUBLE_EQ(rms_force_N_max("slider:facts=" + folder.file("mine.toml")), 0.6 * 2);
}

TEST(DriverFamily, TellsThatTheBoundsOfAFileAreGuesses) {
  const test::TemporaryFolder folder;
  text::write_file(folder.file("mine.toml"),
                   "kind = 'cartesian'\ndegrees_of_freedom = 1\ndamping_N_s_per_m = 3\nforce_N_max = 2\n"
                   "identified = false\n");
  const auto device = registry().make({.device = "slider:facts=" + folder.file("mine.toml")});
  EXPECT_THAT(device->facts_in_words(), HasSubstr("bounds not identified: guesses of its file"));
}

/// A device of six axes, which turns its handle by motors.
class SixAxes : public testing::Test {
 protected:
  std::unique_ptr<device::HapticDevice> wrist(const std::string& settings = {}) {
    std::string facts =
        "kind = 'chain'\ndegrees_of_freedom = 6\njoint_inertia_kg_m2 = 1e-4\njoint_damping_N_m_s_per_rad = 0.002\n"
        "force_N_max = 4\ntorque_N_m_max = 0.3\n[chain]\ntip_m = [0, 0, 0]\n";
    // Any arm that is not singular: what it is read from is the driver's own.
    for (const auto& [name, axis, point_m] :
         {std::array{"a", "[0, 0, 1]", "[0, 0.25, -0.06]"}, std::array{"b", "[1, 0, 0]", "[0, 0.25, -0.06]"},
          std::array{"c", "[1, 0, 0]", "[0, 0.12, 0.07]"}, std::array{"d", "[0, 0, 1]", "[0, 0, 0]"},
          std::array{"e", "[1, 0, 0]", "[0, 0, 0]"}, std::array{"f", "[0, 1, 0]", "[0, 0, 0]"}}) {
      facts += std::string("[[chain.joint]]\nname = '") + name + "'\naxis = " + axis + "\npoint_m = " + point_m + "\n";
    }
    text::write_file(folder_.file("wrist.toml"), facts);
    return registry().make({.device = "wrist:" + settings + "facts=" + folder_.file("wrist.toml")});
  }

  /// Held for so long; the last reading.
  device::Reading held(device::HapticDevice& device, const std::array<double, 6>& wrench, int ticks) {
    Vector all = Eigen::Map<const Vector6>(wrench.data());
    for (int tick = 0; tick < ticks; ++tick) {
      (void)device.read(now_ += 1ms);
      device.apply(now_, all);
    }
    return device.read(now_ += 1ms);
  }

  static double turned_rad(const device::Reading& reading, int axis) {
    return 2 * std::asin(reading.handle.orientation->at(static_cast<std::size_t>(axis) + 1));
  }

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  test::TemporaryFolder folder_;
  Nanoseconds now_{1s};
};

TEST_F(SixAxes, AreReadWithOrientationAndTheAngularVelocityBelowTheTips) {
  const auto device = wrist();
  EXPECT_EQ(device->facts().translations(), 3);
  EXPECT_EQ(device->facts().rotations, 3);
  device->start();
  const device::Reading reading = held(*device, {}, 3);
  ASSERT_EQ(reading.status, Status::ok);
  EXPECT_EQ(reading.position.rows(), 3);
  EXPECT_TRUE(reading.jacobian.isApprox(Matrix::Identity(6, 6)));
  ASSERT_TRUE(reading.handle.orientation);
  EXPECT_THAT(*reading.handle.orientation, ElementsAre(1, 0, 0, 0));
}

TEST_F(SixAxes, AreCommandedAForceAndATorqueApart) {
  const auto device = wrist();
  device->start();
  const device::Reading turned = held(*device, {0, 0, 0, 0, 0.01, 0}, 200);
  EXPECT_GT(turned_rad(turned, 1), 0.1) << "about y";
  EXPECT_NEAR(turned_rad(turned, 0), 0, 1e-6);
  EXPECT_TRUE(turned.position.isZero(0)) << "its place stays";
  const device::Reading moved = held(*device, {1, 0, 0, 0, 0, 0}, 200);
  EXPECT_GT(moved.position.x(), 0.01);
  EXPECT_NEAR(moved.position.y(), 0, 1e-12);
}

TEST_F(SixAxes, WithoutAnOrientationHaveNoReading) {
  const auto device = wrist("fault=orientation,");
  device->start();
  EXPECT_EQ(held(*device, {}, 3).status, Status::no_orientation);
  EXPECT_THAT(device->last_error(),
              HasSubstr("its reading has no orientation, which a device that shows torques must tell"));
}

TEST_F(SixAxes, NeedAFileOfFacts) {
  EXPECT_THAT(
      [] { (void)registry().make({.device = "wrist"}); },
      ThrowsMessage<std::runtime_error>(HasSubstr("a device of 6 axes needs a file of facts, facts=FILE.toml")));
}

TEST(DriverFamily, ADriverThatCrashesEndsAChildAlone) {
  EXPECT_THAT([] { (void)registry().make({.device = "crashing"}); },
              ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("driver 'crashing' (" + file_of("crashing") + ")"),
                                                      HasSubstr("ends the process that does it: Aborted"))));
}

TEST(DriverFamily, SaysWhereDriversAreLookedFor) {
  EXPECT_THAT([] { (void)registry().facts("slidr"); },
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("unknown device 'slidr'"), HasSubstr("slider"),
                                                         HasSubstr("looked for in " + kDrivers))));
  EXPECT_THAT([] { (void)registry().make({.device = "slider", .hand = "press"}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("moved by a person")));
}

}  // namespace
}  // namespace forcebound::driver
