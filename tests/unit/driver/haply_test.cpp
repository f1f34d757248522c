#include <gmock/gmock.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "forcebound/driver/driver_device.hpp"
#include "forcebound/driver/driver_library.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/support/becomes_true.hpp"
#include "tests/support/process.hpp"

namespace forcebound::driver {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;
using Status = device::Reading::Status;

std::unique_ptr<DriverDevice> haply(const std::string& settings) {
  const std::string file = std::string(FORCEBOUND_DRIVERS) + "/forcebound-device-haply.so";
  return std::make_unique<DriverDevice>(std::make_shared<const DriverLibrary>(file, "haply"),
                                        DriverRequest::parse("haply:" + settings));
}

/// The driver and, in a process of its own, what stands in for the Inverse service.
class Haply : public testing::Test {
 protected:
  struct Seen {
    std::array<double, 3> force_N{};
    std::string spelling{};
    std::string basis{};
  };

  /// @param port 0: a free one
  void serve(const std::string& version = "3.5", const std::string& port = "0") {
    if (holds_for_ever) ::setenv("FORCEBOUND_STAND_IN_HOLD_S", "0", 1);
    service = std::make_unique<test::Process>(FORCEBOUND_INVERSE_SERVICE, std::vector<std::string>{port, version},
                                              test::Process::Input::pipe);
    ::unsetenv("FORCEBOUND_STAND_IN_HOLD_S");
    if (!service->wait_for("listening on port ")) throw std::runtime_error("no service");
    const std::string out = service->out();
    port_ = out.substr(out.rfind(' ') + 1);
    port_.pop_back();
  }

  [[nodiscard]] std::string address() const { return "address=127.0.0.1:" + port_; }
  [[nodiscard]] const std::string& port() const { return port_; }
  void open(const std::string& more = "") { device = haply(address() + more); }

  void send(const std::string& line) const { service->write(line + "\n"); }

  /// What the service and its device know now.
  Seen seen() {
    const std::string name = "look " + std::to_string(++looks_) + " ";
    send(name);
    std::string out;
    EXPECT_TRUE(test::becomes_true([&] {
      out = service->out();
      return out.find(name) != std::string::npos && out.back() == '\n';
    }));
    if (out.find(name) == std::string::npos) return {};
    std::istringstream line(out.substr(out.find(name) + name.size()));
    Seen now;
    line >> now.force_N[0] >> now.force_N[1] >> now.force_N[2] >> now.spelling >> now.basis;
    return now;
  }

  std::array<double, 3> felt_N() { return seen().force_N; }

  /// Reads and commands until the condition holds.
  template <class Condition>
  void tick_until(const Vector& force_N, Condition condition) {
    EXPECT_TRUE(test::becomes_true([&] {
      reading = device->read(clock.now());
      if (reading.status == Status::ok) last = reading;
      device->apply(clock.now(), force_N);
      return condition();
    }));
  }

  void tick_until_read() {
    tick_until(Vector::Zero(3), [&] { return reading.status == Status::ok; });
  }
  /// Until the device moves by less than its encoder's step in 20 ms.
  void tick_until_rest() {
    Vector before = Vector::Ones(3);
    int ticks = 0;
    tick_until(Vector::Zero(3), [&] {
      if (reading.status != Status::ok || ++ticks % 20 != 0) return false;
      return (std::exchange(before, last.position) - last.position).norm() < 1e-6;
    });
  }
  void tick_until_felt() {
    tick_until(Vector::Ones(3), [&] { return felt_N()[2] == 1; });
  }
  void tick_until_failed(std::string_view why) {
    tick_until(Vector::Ones(3), [&] {
      return reading.status == Status::failed && device->last_error().find(why) != std::string_view::npos;
    });
  }
  void wait_for_no_force() {
    EXPECT_TRUE(test::becomes_true([&] { return felt_N() == std::array<double, 3>{}; }));
  }

  bool holds_for_ever = false;  ///< the device has no watchdog, so that only the driver ends a force
  std::unique_ptr<test::Process> service;
  time::SteadyClock clock;
  std::unique_ptr<DriverDevice> device;
  device::Reading reading;
  device::Reading last;

 private:
  std::string port_;
  int looks_ = 0;
};

TEST_F(Haply, KnowsItsDeviceAndSaysThatItsBoundsAreGuesses) {
  serve();
  open(",force_N_max=7");
  EXPECT_EQ(device->facts().name, "Inverse3 04BA");
  EXPECT_EQ(device->facts().degrees_of_freedom(), 3);
  EXPECT_EQ(device->facts().force_N_max, 7);
  EXPECT_NEAR(device->facts().hold_s_max, 0.0412, 1e-4) << "20 ms old, 20 ms unanswered, 1 ms for the last attempt";
  EXPECT_THAT(device->facts_in_words(), HasSubstr("bounds not identified"));
}

TEST_F(Haply, MovesAlongTheForceInTheScenesFrame) {
  serve();
  open();
  device->start();
  tick_until_read();
  EXPECT_LT(last.position.norm(), 1e-3) << "the middle of the workspace";
  for (int axis = 0; axis < 3; ++axis) {
    tick_until_rest();
    const Vector from = last.position;
    Vector push = Vector::Zero(3);
    push[axis] = 2;
    tick_until(push, [&] { return (last.position - from).norm() > 0.01; });
    EXPECT_GT(last.position[axis] - from[axis], 0.0099) << axis;
  }
}

TEST_F(Haply, SpellsAForceAsTheServicesVersionDoes) {
  serve("3.5");
  open();
  device->start();
  tick_until_felt();
  EXPECT_EQ(seen().spelling, "vector");
  EXPECT_EQ(seen().basis, "XYZ");
  device.reset();
  serve("3.1");
  open();
  device->start();
  tick_until_felt();
  EXPECT_EQ(seen().spelling, "values");
  EXPECT_EQ(seen().basis, "none");
}

TEST_F(Haply, SpellsAForceAsItIsTold) {
  serve();
  open(",spelling=values");
  device->start();
  tick_until_felt();
  EXPECT_EQ(seen().spelling, "values");
}

TEST_F(Haply, TellsOrientationAndButtonsOfTheGripIfThereIsOne) {
  serve();
  const DriverLibrary library(std::string(FORCEBOUND_DRIVERS) + "/forcebound-device-haply.so", "haply");
  const forcebound_driver& driver = library.functions();
  const std::string value = "127.0.0.1:" + port();
  const forcebound_setting setting{.key = "address", .value = value.c_str()};
  forcebound_device* opened = nullptr;
  std::array<char, FORCEBOUND_TEXT_BYTES> error{};
  ASSERT_EQ(driver.open(&setting, 1, &opened, error.data(), error.size()), FORCEBOUND_OK) << error.data();
  ASSERT_EQ(driver.start(opened), FORCEBOUND_OK);
  const auto reported_until = [&](auto condition) {
    forcebound_reading told{};
    EXPECT_TRUE(test::becomes_true([&] {
      told = {};
      told.size = sizeof told;
      return driver.read(opened, clock.now().count(), &told) == FORCEBOUND_OK && condition(told);
    }));
    return told;
  };
  constexpr std::uint32_t kBoth = FORCEBOUND_HAS_ORIENTATION | FORCEBOUND_HAS_BUTTONS;
  send("turn 0 0.6 0 0.8");
  send("press 6");
  forcebound_reading told = reported_until([](const auto& t) { return t.buttons == 6U && t.orientation[0] == 0; });
  EXPECT_EQ(told.has, kBoth);
  EXPECT_THAT(told.orientation, ElementsAre(0, 0.6, 0, 0.8));
  send("grip wired");
  send("press 1");
  told = reported_until([](const auto& t) { return t.buttons == 1U; });
  EXPECT_EQ(told.has, kBoth);
  send("grip none");
  told = reported_until([](const auto& t) { return t.has == 0; });
  EXPECT_EQ(told.buttons, 0U);
  driver.close(opened);
}

TEST_F(Haply, GivesNoForceOnceNoCommandComes) {
  holds_for_ever = true;
  serve();
  open();
  device->start();
  tick_until_felt();
  wait_for_no_force();
}

TEST_F(Haply, StopsAtOnceAndGoesOnWithTheNextCommand) {
  holds_for_ever = true;
  serve();
  open();
  device->start();
  tick_until_felt();
  device->stop(clock.now());
  wait_for_no_force();
  tick_until_felt();
}

TEST_F(Haply, StartsAgainAfterAStop) {
  holds_for_ever = true;
  serve();
  open();
  device->start();
  tick_until_felt();
  device->stop(clock.now());
  device->start();
  wait_for_no_force();
  tick_until_felt();
}

TEST_F(Haply, FailsWhileUnpluggedAndResumesAfterwards) {
  serve();
  open();
  device->start();
  tick_until_felt();
  send("unplug");
  tick_until_failed("Inverse3 04BA is unplugged; looking for it");
  send("plug");
  tick_until_read();
  tick_until_felt();
}

TEST_F(Haply, LooksForAServiceThatEndedUntilItIsStartedAgain) {
  serve();
  open();
  device->start();
  tick_until_felt();
  service->signal(SIGKILL);
  tick_until_failed("the Inverse service at 127.0.0.1:" + port() + " does not answer; looking for it");
  serve("3.5", port());
  tick_until_felt();
}

TEST_F(Haply, LooksForAServiceThatDoesNotAnswerUntilItDoes) {
  serve();
  open();
  device->start();
  tick_until_felt();
  send("mute");
  tick_until_failed("does not answer");
  wait_for_no_force();
  send("talk");
  tick_until_felt();
}

TEST_F(Haply, FailsWhileItIsToldNothingItUnderstandsAndResumesAfterwards) {
  serve();
  open();
  device->start();
  for (const char* const nonsense :
       {"say hello", "say {", "say []", R"(say {"inverse3":{}})", R"(say {"inverse3":[{"device_id":"04BA"}]})",
        R"(say {"inverse3":[{"device_id":"04BA","state":{"cursor_position":{"x":"a","y":0,"z":0}}}]})",
        "say-bytes 60000", "say-bytes 70000", "say-bytes 30000000"}) {
    SCOPED_TRACE(nonsense);
    tick_until_felt();
    send(nonsense);
    tick_until_failed("looking for it");
    send("talk");
    tick_until_read();
  }
}

TEST_F(Haply, EndsWithZeroForce) {
  holds_for_ever = true;
  serve();
  send("keep");
  open();
  device->start();
  tick_until_felt();
  device.reset();
  wait_for_no_force();
}

TEST_F(Haply, SaysWhatIsMissing) {
  serve();
  const auto refused = [&](const std::string& settings, const auto& message) {
    EXPECT_THAT([&] { (void)haply(settings); }, ThrowsMessage<std::runtime_error>(message));
  };
  for (const char* const wrong : {"speed=1", "address=localhost", "address=:1", "address=127.0.0.1:70000",
                                  "spelling=vectors", "device_id=a b", "force_N_max=0", "x_m=2", "z_m=up"}) {
    refused(wrong, HasSubstr("driver 'haply': '" + std::string(wrong) + "' is not accepted; accepted are address="));
  }
  refused("address=localhos:7", HasSubstr("no Inverse service at localhos:7"));
  refused(address() + ",device_id=049D",
          HasSubstr("no Inverse3 049D among those that the service at 127.0.0.1:" + port() + " lists: 04BA"));
  send("unplug");
  (void)seen();
  refused(address(), HasSubstr("no Inverse3 among those that the service at 127.0.0.1:" + port() + " lists: none"));
  send(R"(say {"devices":[]})");
  (void)seen();
  refused(address(), HasSubstr("is no Inverse service 3.1 or later"));
  send("mute");
  (void)seen();
  refused(address(), HasSubstr("no answer within 2000 ms"));
  service->signal(SIGKILL);
  (void)service->wait();
  refused(address(), AllOf(HasSubstr("no Inverse service at 127.0.0.1:" + port() + " (Connection refused)"),
                           HasSubstr("it comes with Haply Hub, see docs.haply.co")));
}

}  // namespace
}  // namespace forcebound::driver
