#include "tests/tools/sim/closed_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/auto_scene.hpp"
#include "tests/tools/data/recorded_data.hpp"
#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/netem/trace.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

/// Invariants of every run.
class Invariants final : public record::TickSink {
 public:
  explicit Invariants(double force_N_max) : force_N_max_(force_N_max) {}

  void on_tick(const record::TickRecord& tick) noexcept override {
    finite = finite && tick.applied.allFinite() && tick.position.allFinite() && std::isfinite(tick.energy_J) &&
             std::isfinite(tick.audit_J);
    bounded = bounded && tick.applied.norm() <= force_N_max_ * (1 + 1e-12);
    last = tick;
  }

  bool finite = true;
  bool bounded = true;
  record::TickRecord last;

 private:
  double force_N_max_;
};

ClosedLoop::Settings sphere_through(const std::string& netem, const std::string& law) {
  const auto parameters = netem::parse_netem(netem);
  return {.device = device::load_device("omni"),
          .hand = "trace-sphere",
          .law = law,
          .scene = server::load_scene("sphere"),
          .network = {.up = parameters, .down = parameters, .trace = {}, .seed = 7}};
}

json summary_of(ClosedLoop& loop) { return json::parse(loop.close().to_json()); }

//   omni, trace-sphere -- session ==( delay 50ms 10ms loss 5% )== server, sphere
class LawsThroughABadNetwork : public ::testing::TestWithParam<const char*> {};

TEST_P(LawsThroughABadNetwork, StayFiniteBoundedAndPassive) {
  SCOPED_TRACE(std::string("law ") + GetParam() + ", seed 7");
  Invariants invariants(3.3);
  ClosedLoop loop(sphere_through("delay 50ms 10ms loss 5%", GetParam()), {&invariants});
  loop.run(20s);
  const json summary = summary_of(loop);
  EXPECT_TRUE(invariants.finite);
  EXPECT_TRUE(invariants.bounded);
  EXPECT_EQ(summary["ticks"], 20'000);
  EXPECT_GT(summary["force_N"]["mean"], 0.05) << "there was contact";
  if (GetParam() == std::string("none")) {
    EXPECT_LT(summary["passivity"]["minimum_J"], -0.1) << "without a law this network injects energy";
  } else {
    EXPECT_GE(summary["passivity"]["minimum_J"], -5e-3);
  }
}

TEST_P(LawsThroughABadNetwork, CountWhatTheNetworkDid) {
  ClosedLoop loop(sphere_through("delay 50ms 10ms loss 5% duplicate 2%", GetParam()));
  loop.run(10s);
  loop.close();
  const auto& up = loop.network().counters(netem::Direction::up);
  const auto& down = loop.network().counters(netem::Direction::down);
  const auto totals = loop.totals();
  // Hello, Welcome and Bye cross the network too: a few datagrams beside motions and forces.
  constexpr double kHandshakes = 60;
  EXPECT_NEAR(static_cast<double>(totals.lost_up), static_cast<double>(up.lost), kHandshakes);
  EXPECT_NEAR(static_cast<double>(totals.lost_down), static_cast<double>(down.lost), kHandshakes);
  EXPECT_NEAR(static_cast<double>(totals.duplicated), static_cast<double>(up.duplicated + down.duplicated),
              2 * kHandshakes);
  EXPECT_GT(totals.reordered, 100U) << "10 ms of jitter on datagrams 1 ms apart";
  EXPECT_EQ(totals.foreign_session, 0U);
}

INSTANTIATE_TEST_SUITE_P(Laws, LawsThroughABadNetwork, ::testing::Values("none", "fba-less", "fba-more"),
                         [](const auto& law) {
                           std::string name = law.param;
                           std::erase(name, '-');
                           return name;
                         });

//   omni, trace-sphere -- session ==( delay 50ms )== server, sphere
TEST(ClosedLoop, TakesNoMotionForLostThatIsOnItsWay) {
  ClosedLoop loop(sphere_through("delay 50ms", "fba-less"));
  loop.run(1s);
  const auto before = record::fates_of(loop.totals());
  EXPECT_NEAR(static_cast<double>(before.in_flight), 100, 2);
  EXPECT_EQ(before.answered + before.in_flight, before.sent) << record::words_of(before);
  loop.close();
  const auto after = record::fates_of(loop.totals());
  EXPECT_EQ(after.sent, before.sent);
  EXPECT_EQ(after.lost_up + after.lost_down + after.in_flight, 0U) << record::words_of(after);
}

//   without a law the device is thrown about; depth and stiffness are those at the ball itself
TEST(ClosedLoop, TellsTheDepthBelowTheTrueSurfaceAndNoStiffnessThatIsNotThere) {
  constexpr double kRadius_m = 0.02;
  const auto scene = server::load_scene("sphere");
  const double stiffness_N_per_m = scene->plan().effects().front().effect->facts().stiffness_N_per_m;
  for (const char* law : {"none", "fba-less", "fba-more", "fba-exact"}) {
    SCOPED_TRACE(law);
    ClosedLoop loop(sphere_through("delay 50ms 10ms loss 5%", law));
    loop.run(12s);
    const json summary = summary_of(loop);
    EXPECT_EQ(summary["run"]["surface"], "true");
    EXPECT_EQ(summary["surface_unknown_ticks"], 0);
    EXPECT_GT(summary["penetration_m"]["max"], 0);
    EXPECT_LE(summary["penetration_m"]["max"], kRadius_m) << "no depth exceeds the ball's radius";
    const json& shown = summary["displayed_stiffness_N_per_m"]["median"];
    if (law == std::string("none")) {
      EXPECT_TRUE(shown.is_null()) << "without a law the contact never rests";
      continue;
    }
    ASSERT_TRUE(shown.is_number());
    EXPECT_LT(shown.get<double>(), 1.05 * stiffness_N_per_m) << "no law shows more than the wall's stiffness";
  }
}

TEST(ClosedLoop, SameSettingsGiveTheSameRunByteForByte) {
  const auto once = [] {
    ClosedLoop loop(sphere_through("delay 20ms 15ms 25% loss gemodel 2% 20% duplicate 1%", "fba-less"));
    loop.run(5s);
    return loop.close().to_json();
  };
  EXPECT_EQ(once(), once());
}

TEST(ClosedLoop, AnotherSeedIsAnotherRun) {
  auto settings = sphere_through("delay 20ms 15ms loss 5%", "fba-less");
  ClosedLoop one(settings);
  settings.network.seed = 8;
  ClosedLoop other(settings);
  one.run(3s);
  other.run(3s);
  EXPECT_NE(one.close().to_json(), other.close().to_json());
}

//   server killed at 3 s in contact, back at 5 s
TEST(ClosedLoop, AServerThatRestartsCostsAFadingForceAndNothingElse) {
  Invariants invariants(3.3);
  ClosedLoop loop(sphere_through("delay 5ms", "fba-more"), {&invariants});
  loop.run(3s);
  ASSERT_GT(invariants.last.applied.norm(), 0.01) << "in contact";
  loop.kill_server();
  loop.run(600ms);
  EXPECT_EQ(invariants.last.policy, record::ForcePolicy::fading);
  loop.run(1400ms);
  EXPECT_EQ(invariants.last.applied.norm(), 0.0);
  EXPECT_EQ(loop.session().state(), client::SessionState::reconnecting);
  loop.start_server();
  loop.run(1s);
  EXPECT_EQ(loop.session().state(), client::SessionState::active) << "a new session within a second";
  EXPECT_EQ(invariants.last.policy, record::ForcePolicy::fresh);
  const json summary = summary_of(loop);
  EXPECT_EQ(summary["faults"]["reconnects"], 1);
  EXPECT_GE(summary["passivity"]["minimum_J"], -5e-3);
}

//   motion still goes up, no force comes down for a minute
TEST(ClosedLoop, ABlackoutInOneDirectionIsSaidToBeThatDirection) {
  Invariants invariants(3.3);
  ClosedLoop loop(sphere_through("delay 5ms", "fba-less"), {&invariants});
  loop.run(2s);
  loop.network().set_blackhole(netem::Direction::down, true);
  loop.run(60s);
  EXPECT_EQ(invariants.last.applied.norm(), 0.0);
  loop.network().set_blackhole(netem::Direction::down, false);
  loop.run(2s);
  EXPECT_EQ(loop.session().state(), client::SessionState::active);
  const json summary = summary_of(loop);
  EXPECT_LT(summary["lost_up"], 20);
  EXPECT_GT(summary["lost_down"], 59'000);
  EXPECT_EQ(summary["blackouts"]["count"], 1);
  EXPECT_NEAR(summary["blackouts"]["longest_s"].get<double>(), 60, 0.1);
}

//   every 50 ms the client is stopped for a while: within the hold time of 2 ms, or far beyond it
TEST_P(LawsThroughABadNetwork, StayPassiveThoughTheirTicksStall) {
  if (GetParam() == std::string("none")) GTEST_SKIP() << "no law, no guarantee";
  for (const auto stall : {500us, 900us, 2000us, 20'000us}) {
    SCOPED_TRACE(std::to_string(stall.count()) + " us");
    ClosedLoop loop(sphere_through("delay 5ms", GetParam()));
    for (int i = 0; i < 200; ++i) {
      loop.run(50ms);
      loop.stall(stall);
    }
    const json summary = summary_of(loop);
    EXPECT_EQ(summary["faults"]["released_by_device"] > 100, stall > 1ms);
    EXPECT_GE(summary["passivity"]["minimum_J"], -1e-6);
  }
}

//   one reading in ten is not new: device and client have clocks of their own
TEST(ClosedLoop, ADeviceThatHasNotANewReadingOnEachTickIsFeltAndPassive) {
  const auto pressed = [](double stale_readings) {
    ClosedLoop loop({.device = device::load_device("wall-1dof"),
                     .hand = "press",
                     .law = "fba-exact",
                     .scene = server::load_scene("wall"),
                     .flaws = {.stale_readings = stale_readings}});
    loop.run(4s);
    return summary_of(loop);
  };
  const json all_new = pressed(0);
  const json some_stale = pressed(0.1);
  EXPECT_EQ(all_new["faults"]["stale_readings"], 0);
  EXPECT_NEAR(some_stale["faults"]["stale_readings"], 400, 80);
  // The device holds a force for 2 ms: two of them in a row are too long.
  EXPECT_LT(some_stale["faults"]["refused_stale"], 0.02 * 4000);
  EXPECT_GE(some_stale["passivity"]["minimum_J"], -1e-9);
  EXPECT_GT(some_stale["force_N"]["mean"], 0.9 * all_new["force_N"]["mean"].get<double>());
}

struct RecordedRun {
  const char* scene;
  const char* trace;
  int duration_s;       ///< the whole trace
  double age_ms_least;  ///< the oldest force is older than this
  double blackout_s;    ///< the longest time without any force, at least
};

//   a recorded hand at the omni -- session ==( a recorded 5G network )== server
class RecordedHandOverARecordedNetwork : public ::testing::TestWithParam<RecordedRun> {};

TEST_P(RecordedHandOverARecordedNetwork, RunsToTheEndFiniteAndPassive) {
  const auto hand = recorded_data("motion/hand-guided-a.csv");
  const auto trace = recorded_data(std::string("network/") + GetParam().trace);
  if (!hand || !trace) GTEST_SKIP() << "no recorded data; FORCEBOUND_DATA names its folder";
  for (const char* law : {"fba-less", "fba-more"}) {
    SCOPED_TRACE(law);
    Invariants invariants(3.3);
    ClosedLoop loop({.device = device::load_device("omni"),
                     .hand = "replay:" + hand->string() + ",offset_x_m=0.01",  // as recorded it passes the ball by 2 mm
                     .law = law,
                     .scene = server::load_scene(GetParam().scene),
                     .network = {.up = {}, .down = {}, .trace = netem::load_trace(trace->string()), .seed = 1}},
                    {&invariants});
    loop.run(std::chrono::seconds{GetParam().duration_s});
    const json summary = summary_of(loop);
    EXPECT_TRUE(invariants.finite);
    EXPECT_TRUE(invariants.bounded);
    EXPECT_EQ(summary["ticks"], GetParam().duration_s * 1000);
    EXPECT_GE(summary["passivity"]["minimum_J"], -5e-3);
    EXPECT_GT(summary["contact_ticks"], 1000);
    EXPECT_GT(summary["force_age_ms"]["p50"], 5);
    EXPECT_GT(summary["force_age_ms"]["max"], GetParam().age_ms_least);
    EXPECT_GT(summary["blackouts"]["longest_s"], GetParam().blackout_s);
  }
}

INSTANTIATE_TEST_SUITE_P(Data, RecordedHandOverARecordedNetwork,
                         ::testing::Values(RecordedRun{"sphere", "5g-urban-n8.csv", 236, 1000, 14},
                                           RecordedRun{"plane", "5g-urban-n8.csv", 236, 1000, 14},
                                           RecordedRun{"sphere", "5g-rural-n8.csv", 127, 5000, 0.25},
                                           RecordedRun{"plane", "5g-rural-n8.csv", 127, 5000, 0.25}),
                         [](const auto& run) {
                           std::string name = std::string(run.param.scene) + "_" + run.param.trace;
                           for (char& c : name) {
                             if (c == '-' || c == '.') c = '_';
                           }
                           return name;
                         });

struct Picked {
  const char* netem;  ///< each way
  const char* level;
};

class AnAutoScene : public testing::TestWithParam<Picked> {};

TEST_P(AnAutoScene, IsPickedByTheMeasuredRoundTripAndSaidInTheSummary) {
  const auto parameters = netem::parse_netem(GetParam().netem);
  ClosedLoop loop({.device = device::load_device("wall-1dof"),
                   .hand = "press",
                   .law = "fba-exact",
                   .scene = test::auto_wall(),
                   .network = {.up = parameters, .down = parameters}});
  loop.run(4s);
  EXPECT_THAT(loop.totals().simulated, testing::HasSubstr(GetParam().level));
  EXPECT_EQ(loop.session().state(), client::SessionState::active);
}

INSTANTIATE_TEST_SUITE_P(RoundTrips, AnAutoScene,
                         testing::Values(Picked{"delay 0ms", "stiffness_N_per_m = 200 for a round trip of "},
                                         Picked{"delay 25ms loss 20%", "stiffness_N_per_m = 100 for a round trip of 5"},
                                         // Longer than the client's pause between Hellos.
                                         Picked{"delay 300ms", "stiffness_N_per_m = 100 for a round trip of 60"}));

}  // namespace
}  // namespace forcebound::sim
