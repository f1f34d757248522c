#include "tests/tools/lab/rendering/live_runs.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/device/load_device.hpp"
#include "forcebound/record/recording_writer.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/tools/lab/trials/task.hpp"
#include "tests/tools/sim/closed_loop.hpp"
#include "tests/tools/temporary_folder.hpp"
#include "tests/unit/record/sample_run.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

LiveRun run_behind(double round_trip_ms, bool local, double stiffness_N_per_m) {
  return {.scene = "dome",
          .summary = {{"rendering", {{"asked", local ? "local" : "remote"}}},
                      {"rtt_us", {{"p50", 1e3 * round_trip_ms}}},
                      {"period_us", {{"p99", 1038.4}}},
                      {"ticks", 8000},
                      {"late_ticks", 8},
                      {"verdict", "passive"},
                      {"passivity", {{"minimum_J", 0.0}}}},
          .figures = {.stiffness_N_per_m = stiffness_N_per_m, .at_client = local ? 0.97 : 0, .ready_s = 0.31}};
}

TEST(LiveRunsTable, HasTheStiffnessOverThatOfTheRemoteRunWithTheLeastRoundTrip) {
  const std::string table = live_runs_table({run_behind(100.5, false, 200), run_behind(0.1, true, 9000),
                                             run_behind(0.2, false, 10e3), run_behind(101, true, 9900)},
                                            text::Colour::none);
  EXPECT_THAT(table, HasSubstr("dome\n"));
  EXPECT_THAT(table, testing::ContainsRegex("remote +100.5 +0.020 +0.0 +0 +0.31 +0.10 +1.038"));
  EXPECT_THAT(table, testing::ContainsRegex("local +0.1 +0.900 +97.0"));
  EXPECT_THAT(table, testing::ContainsRegex("remote +0.2 +1.000"));
  EXPECT_THAT(table, testing::ContainsRegex("local +101.0 +0.990"));
}

TEST(LiveRunsTable, ComparesRunsOfTheSameSceneAlone) {
  LiveRun pad = run_behind(20, true, 500);
  pad.scene = "pad";
  EXPECT_THAT(live_runs_table({run_behind(0.2, false, 10e3), pad}, text::Colour::none),
              testing::ContainsRegex("local +20.0 +- "));
}

/// A hand that presses on the plane, in virtual time, as its client would have recorded it.
LiveRun recorded_run(bool local, const std::string& network, const std::string& file) {
  sim::ClosedLoop::Settings settings{.device = device::load_device("firm-3dof"),
                                     .hand = "press:axis=2,from_m=0.01,to_m=-0.01,stiffness_N_per_m=300",
                                     .law = "fba-exact",
                                     .scene = server::load_scene("plane"),
                                     .network = network_of(network).settings,
                                     .renders_locally = local};
  record::RunInfo info;
  info.scene = "plane";
  info.rendering = local ? "local" : "remote";
  {
    record::RecordingWriter writer(file, info);
    record::test::DirectSink sink(writer);
    sim::ClosedLoop loop(std::move(settings), {&sink});
    loop.run(4s);
    writer.finish(loop.totals());
  }
  return read_live_run(file);
}

TEST(ReadLiveRun, FindsTheStiffnessOfTheSceneByTheDevicesPlaces) {
  const test::TemporaryFolder folder;
  const LiveRun beside = recorded_run(false, "none", folder.file("beside.mcap"));
  EXPECT_EQ(beside.scene, "plane");
  EXPECT_NEAR(beside.figures.stiffness_N_per_m, 2000, 100);
  EXPECT_EQ(beside.figures.at_client, 0);
  const LiveRun far_away = recorded_run(true, "delay 50ms", folder.file("far.mcap"));
  EXPECT_NEAR(displayed_over(far_away.figures, beside.figures), 1, 0.01);
  EXPECT_GT(far_away.figures.at_client, 0.99);
  EXPECT_GT(far_away.figures.ready_s, 0.1) << "a Hello, and then the scene";
  EXPECT_LT(far_away.figures.ready_s, 1);
  const LiveRun held = recorded_run(false, "delay 50ms", folder.file("held.mcap"));
  EXPECT_LT(displayed_over(held.figures, beside.figures), 0.9);
}

TEST(ReadLiveRun, RefusesARecordingOfAnotherScene) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("other.mcap");
  {
    record::RunInfo info;
    info.scene = "circle";
    record::RecordingWriter writer(file, info);
    record::test::DirectSink sink(writer);
    record::test::play_sample_run(sink, 10);
    writer.finish({});
  }
  EXPECT_THAT([&] { (void)read_live_run(file); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr(file + ": not of the scene 'circle'")));
}

}  // namespace
}  // namespace forcebound::lab
