#include <gmock/gmock.h>

#include <cmath>

#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

TEST(Replay, AnswersEachRowAsItComesSoThatASimulatorCanCloseTheLoop) {
  Process replay(kForcebound, {"replay", "--law", "fba-more", "--damping", "30", "--input", "-", "--output", "-"},
                 Process::Input::pipe);
  replay.write("time_s,x0_m,fe0_N\n");
  // The answer to a row is waited for before the next is written: a wall of 10 kN/m, entered at 0.1 m/s.
  constexpr int kRows = 50;
  for (int i = 0; i < kRows; ++i) {
    const double x = 1e-4 * i;
    replay.write(std::to_string(1e-3 * i) + "," + std::to_string(x) + "," + std::to_string(-1e4 * x) + "\n");
    const auto end = std::chrono::steady_clock::now() + 10s;
    while (lines(replay.out()) < static_cast<std::size_t>(i) + 2 && std::chrono::steady_clock::now() < end) {
    }
    ASSERT_EQ(lines(replay.out()), static_cast<std::size_t>(i) + 2) << "row " << i;
  }
  replay.close_input();
  EXPECT_EQ(replay.wait(10s), 0);
  EXPECT_THAT(replay.out(), testing::StartsWith("time_s,f0_N,energy_J,xi\n"));
  EXPECT_EQ(replay.err(), "");
}

TEST(LabReproduce, WritesTheDocumentedKeysOfEachRunAndDrawsItsFigures) {
  const TemporaryFolder folder;
  const Ran lab =
      run(kLab, {"reproduce", "wall", "--json", folder.file("runs.json"), "--figures", folder.file("figures")}, 120s);
  ASSERT_EQ(lab.exit_code, 0) << lab.err;
  const nlohmann::json runs = nlohmann::json::parse(content(folder.file("runs.json")));
  ASSERT_TRUE(runs.is_array());
  ASSERT_FALSE(runs.empty());
  for (const nlohmann::json& run : runs) {
    SCOPED_TRACE(run["law"].dump() + " at " + run["stiffness_N_per_m"].dump());
    for (const char* key : {"experiment",
                            "law",
                            "stiffness_N_per_m",
                            "encoder_m",
                            "one_way_delay_s",
                            "ringing_s",
                            "direction_error_rad_max",
                            "hand",
                            "device",
                            "operator",
                            "scene",
                            "duration_s",
                            "ticks",
                            "period_us",
                            "late_ticks",
                            "sent",
                            "received",
                            "lost",
                            "duplicated",
                            "reordered",
                            "stale_ticks",
                            "force_age_ms",
                            "rtt_us",
                            "compute_us",
                            "force_N",
                            "penetration_m",
                            "displayed_stiffness_N_per_m",
                            "bounded_fraction",
                            "passivity",
                            "ledger",
                            "faults"}) {
      EXPECT_TRUE(run.contains(key)) << key;
    }
    EXPECT_EQ(run["experiment"], "wall");
    if (run["stiffness_N_per_m"] != 50e3) continue;
    EXPECT_NEAR(run["displayed_stiffness_N_per_m"]["mean"].get<double>(), 50e3, 500);
  }
  int figures = 0;
  for (const auto& figure : std::filesystem::directory_iterator(folder.file("figures"))) {
    if (figure.path().extension() != ".png") continue;
    ++figures;
    EXPECT_THAT(content(figure.path()), testing::StartsWith("\x89PNG\r\n\x1a\n"));
    EXPECT_THAT(lab.out, HasSubstr(figure.path().string()));
  }
  EXPECT_EQ(figures, 3);
}

}  // namespace
}  // namespace forcebound::test
