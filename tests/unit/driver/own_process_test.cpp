#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "forcebound/driver/driver_device.hpp"
#include "forcebound/driver/driver_library.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/support/becomes_true.hpp"
#include "tests/support/drivers/stand_in_cable.hpp"
#include "tests/support/process.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::driver {
namespace {

using namespace std::chrono_literals;

constexpr const char* kSocket = "FORCEBOUND_STAND_IN_SOCKET";

std::unique_ptr<DriverDevice> openhaptics() {
  const std::string file = std::string(FORCEBOUND_DRIVERS) + "/forcebound-device-openhaptics.so";
  const std::string library = std::string(FORCEBOUND_TEST_DRIVERS) + "/libstand_in_hd.so";
  return std::make_unique<DriverDevice>(std::make_shared<const DriverLibrary>(file, "openhaptics"),
                                        DriverRequest::parse("openhaptics:library=" + library));
}

/// Not a test, but the client of those below: commands a force until it is killed.
TEST(ClientOfAnOwnProcess, DISABLED_CommandsUntilItIsKilled) {
  const auto device = openhaptics();
  device->start();
  const time::SteadyClock clock;
  for (;;) {
    (void)device->read(clock.now());
    device->apply(clock.now(), Vector::Ones(3));
    std::this_thread::sleep_for(1ms);
  }
}

/// A device beyond a cable, which holds the last force for ever:
///
///     test -- kills --> client ==(shared memory)== openhaptics' own process, with libHD --(socket)-- device
class OwnProcess : public testing::Test {
 protected:
  OwnProcess() : device_(FORCEBOUND_STAND_IN_DEVICE, {socket_}), cable_(listening_at(socket_)) {
    ::setenv(kSocket, socket_.c_str(), 1);
  }
  ~OwnProcess() override { ::unsetenv(kSocket); }

  void start_client() {
    client_ = std::make_unique<test::Process>(
        "/proc/self/exe",
        std::vector<std::string>{"--gtest_also_run_disabled_tests", "--gtest_filter=ClientOfAnOwnProcess.*"});
    wait_for_force(1);
  }

  void wait_for_force(double force_N) const {
    EXPECT_TRUE(test::becomes_true([&] { return cable_->look().force_N[2] == force_N; }));
  }

  /// Waits until it listens.
  static std::unique_ptr<test::StandIn> listening_at(const std::string& socket) {
    std::unique_ptr<test::StandIn> cable;
    EXPECT_TRUE(test::becomes_true([&] {
      try {
        cable = test::plug_into(socket);
      } catch (const std::runtime_error&) {  // not yet
      }
      return cable != nullptr;
    }));
    return cable;
  }

  /// Those that a process has started, but for `other`.
  static std::vector<pid_t> children_of(pid_t parent, pid_t other = 0) {
    const std::string pid = std::to_string(parent);
    std::istringstream words(test::content("/proc/" + pid + "/task/" + pid + "/children"));
    std::vector<pid_t> all;
    for (pid_t child = 0; words >> child;) {
      if (child != other) all.push_back(child);
    }
    return all;
  }

  test::TemporaryFolder folder_;
  std::string socket_ = folder_.file("device.socket");
  test::Process device_;
  std::unique_ptr<test::StandIn> cable_;
  std::unique_ptr<test::Process> client_;
};

TEST_F(OwnProcess, EndsTheForceOfAClientThatIsKilledAndThenItself) {
  start_client();
  const auto processes = children_of(client_->pid());
  ASSERT_EQ(processes.size(), 1U);
  client_->signal(SIGKILL);
  wait_for_force(0);
  ASSERT_TRUE(client_->wait());
  const auto lives = [&] {
    const std::string state = test::content("/proc/" + std::to_string(processes.front()) + "/stat");
    return !state.empty() && state.find(") Z") == std::string::npos;
  };
  EXPECT_TRUE(test::becomes_true([&] { return !lives(); }));
}

TEST_F(OwnProcess, EndsTheForceOfAClientThatIsStoppedAndGoesOnWithIt) {
  start_client();
  client_->signal(SIGSTOP);
  wait_for_force(0);
  client_->signal(SIGCONT);
  wait_for_force(1);
}

TEST_F(OwnProcess, OutlivesASignalFromTheTerminalThatTheClientIsToEndWith) {
  start_client();
  const auto processes = children_of(client_->pid());
  ASSERT_EQ(processes.size(), 1U);
  ASSERT_EQ(::kill(processes.front(), SIGINT), 0);
  client_->signal(SIGKILL);
  wait_for_force(0);
}

TEST_F(OwnProcess, ThatIsKilledItselfIsAnUnpluggedDevice) {
  const auto device = openhaptics();
  device->start();
  const time::SteadyClock clock;
  const auto reads = [&](device::Reading::Status status) {
    return test::becomes_true([&] { return device->read(clock.now()).status == status; });
  };
  EXPECT_TRUE(reads(device::Reading::Status::ok));
  const auto processes = children_of(::getpid(), device_.pid());
  ASSERT_EQ(processes.size(), 1U);
  ASSERT_EQ(::kill(processes.front(), SIGKILL), 0);
  EXPECT_TRUE(reads(device::Reading::Status::failed));
  EXPECT_EQ(device->last_error(), "the process that has Touch X 0042 ended");
}

}  // namespace
}  // namespace forcebound::driver
