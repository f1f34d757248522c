#include "forcebound/client/commands/doctor/sleep_states.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/tools/temporary_folder.hpp"

namespace forcebound::client::commands {
namespace {

/// A folder as /sys/devices/system/cpu.
class SleepStatesTest : public testing::Test {
 protected:
  struct State {
    const char* name;
    const char* latency;
    const char* disable;
  };

  void add(const std::string& processor, int depth, const State& state) {
    const auto path = folder_.path() / processor / "cpuidle" / ("state" + std::to_string(depth));
    std::filesystem::create_directories(path);
    std::ofstream(path / "name") << state.name << '\n';
    std::ofstream(path / "latency") << state.latency << '\n';
    std::ofstream(path / "disable") << state.disable << '\n';
  }

  [[nodiscard]] std::vector<SleepState> read() const { return read_sleep_states(folder_.path()); }

  test::TemporaryFolder folder_;
};

TEST_F(SleepStatesTest, AreThoseOfAllProcessorsInTheOrderOfTheirDepth) {
  for (const char* const processor : {"cpu0", "cpu11"}) {
    add(processor, 10, {"C10", "890", "0"});
    add(processor, 0, {"POLL", "0", "0"});
    add(processor, 2, {"C6", "133", "0"});
  }
  const auto states = read();
  ASSERT_EQ(states.size(), 3U);
  EXPECT_EQ(states[0].name, "POLL");
  EXPECT_EQ(states[1].name, "C6");
  EXPECT_EQ(states[1].exit_latency_us, 133);
  EXPECT_EQ(states[2].name, "C10");
  EXPECT_EQ(longest_exit_latency_us(states), 890);
}

TEST_F(SleepStatesTest, CountAsEnabledIfOneProcessorMayEnterThem) {
  add("cpu0", 1, {"C1", "2", "1"});
  add("cpu1", 1, {"C1", "3", "0"});
  add("cpu0", 2, {"C6", "133", "1"});
  add("cpu1", 2, {"C6", "133", "1"});
  const auto states = read();
  ASSERT_EQ(states.size(), 2U);
  EXPECT_TRUE(states[0].enabled);
  EXPECT_FALSE(states[1].enabled);
  EXPECT_EQ(longest_exit_latency_us(states), 3);
}

TEST_F(SleepStatesTest, LeaveOutWhatIsNoProcessorAndNoState) {
  add("cpuidle", 0, {"POLL", "0", "0"});
  add("cpufreq", 0, {"POLL", "0", "0"});
  std::filesystem::create_directories(folder_.path() / "cpu0" / "cpuidle" / "driver");
  EXPECT_TRUE(read().empty());
}

TEST_F(SleepStatesTest, BearWhatCannotBeRead) {
  add("cpu0", 0, {"C\x1b[31m1", "soon", ""});
  const auto states = read();
  ASSERT_EQ(states.size(), 1U);
  EXPECT_EQ(states[0].name, "C?[31m1");
  EXPECT_EQ(states[0].exit_latency_us, 0);
  EXPECT_TRUE(read_sleep_states(folder_.path() / "nowhere").empty());
  EXPECT_EQ(longest_exit_latency_us({}), 0);
}

}  // namespace
}  // namespace forcebound::client::commands
