#include "forcebound/driver/crash.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include "forcebound/control/vector.hpp"
#include "forcebound/driver/driver_family.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/signal_stack.hpp"
#include "tests/support/becomes_true.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::driver {
namespace {

using namespace std::chrono_literals;

#if defined(__SANITIZE_THREAD__)
constexpr bool kForksWithThreads = false;
#else
constexpr bool kForksWithThreads = true;
#endif

struct Crash {
  const char* fault;
  const char* words;
  bool stopped = true;  ///< by `stop`, which the driver leaves a note of
};

/// A program that opens a driver, starts it, ticks it on a thread of its own and ends.
void open_and_tick(const std::string& folder, const std::string& fault) {
  const auto device =
      driver_family({FORCEBOUND_TEST_DRIVERS}).make({.device = "faulty:fault=" + fault + ",control=" + folder});
  device->start();
  std::thread([&] {
    const time::SignalStack stack;
    for (int tick = 0; tick < 200; ++tick) {
      const time::Nanoseconds now = std::chrono::steady_clock::now().time_since_epoch();
      (void)device->read(now);
      device->apply(now, control::Vector::Constant(3, 1));
      if (tick == 100) text::write_file(folder + "/fault", "");
      std::this_thread::sleep_for(1ms);
    }
  }).join();
}

class ACrash : public testing::TestWithParam<Crash> {};

TEST_P(ACrash, EndsTheProgramWithZeroForceAndTheNameOfDriverAndCall) {
  if (!kForksWithThreads) GTEST_SKIP() << "ThreadSanitizer knows no threads of a child process";
  const test::TemporaryFolder folder;
  const std::string path = folder.path().string();
  EXPECT_EXIT(open_and_tick(path, GetParam().fault), testing::ExitedWithCode(kCrashExit),
              std::string("driver 'faulty' ") + GetParam().words + "\n");
  EXPECT_EQ(std::filesystem::exists(folder.file("stopped")), GetParam().stopped);
}

INSTANTIATE_TEST_SUITE_P(
    OfADriver, ACrash,
    testing::Values(Crash{"crash-reopen", "crashed in open .Segmentation fault.", false},
                    Crash{"crash-start", "crashed in start .Segmentation fault.; it was stopped", false},
                    Crash{"crash", "crashed in read .Aborted.; it was stopped"},
                    Crash{"overflow", "crashed in read .Segmentation fault.; it was stopped"},
                    Crash{"crash-push", "crashed in command .Segmentation fault.; it was stopped"},
                    Crash{"exit", "ended the program by exit.. in command; it was stopped"},
                    Crash{"crash-thread", "crashed in a thread of its own .Segmentation fault.; it was stopped"},
                    Crash{"crash-stop",
                          "crashed in stop .Segmentation fault.; its stop crashed too, so that a force may "
                          "be left",
                          false},
                    Crash{"crash-close", "crashed in close .Segmentation fault."}),
    [](const auto& tried) {
      std::string name = tried.param.fault;
      std::erase(name, '-');
      return name;
    });

TEST(Crash, OfNoDriverStopsWhatOneHasOpenedAndEndsTheProgramAsEver) {
  if (!kForksWithThreads) GTEST_SKIP() << "ThreadSanitizer knows no threads of a child process";
  const auto stopped_and_crashed = [] {
    catch_crashes();
    const StopAtCrash stop([] { std::fputs("stopped\n", stderr); });
    std::raise(SIGBUS);
  };
  EXPECT_EXIT(stopped_and_crashed(), testing::KilledBySignal(SIGBUS),
              "stopped\n[^']*crashed, in no call or thread of driver '.*' .Bus error.; it was stopped\n");
}

TEST(Crash, LeavesWhoLooksForItToEndTheProgram) {
  if (!kForksWithThreads) GTEST_SKIP() << "ThreadSanitizer knows no threads of a child process";
  const auto attend = [] {
    catch_crashes();
    std::thread([] {
      const CallInProgress in_call("pen", "read");
      std::raise(SIGFPE);
    }).detach();
    (void)test::becomes_true([] { return !crash_in_words().empty(); });
    std::fprintf(stderr, "%s", std::string(crash_in_words()).c_str());
    std::_Exit(has_crashed() ? 7 : 1);
  };
  EXPECT_EXIT(attend(), testing::ExitedWithCode(7), "^driver 'pen' crashed in read .Floating point exception.$");
}

}  // namespace
}  // namespace forcebound::driver
