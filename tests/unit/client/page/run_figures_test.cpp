#include "forcebound/client/page/run_figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

namespace forcebound::client {
namespace {

using Json = nlohmann::json;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::HasSubstr;

TickSample tick(int number) {
  TickSample sample;
  sample.time = milliseconds(1000 + number);
  sample.interval = milliseconds(1);
  sample.motion_sequence = static_cast<std::uint64_t>(number);
  sample.position_m = {0.01F, 0, 0};
  sample.usable = true;
  sample.state = record::SessionState::active;
  return sample;
}

ForceSample force(std::uint64_t sequence, std::uint64_t motion, std::uint64_t received_there) {
  ForceSample sample;
  sample.session = 7;
  sample.sequence = sequence;
  sample.motion_sequence = motion;
  sample.motions_received = received_there;
  sample.received = milliseconds(1010);
  sample.round_trip = milliseconds(8);
  sample.at_server = milliseconds(2);
  return sample;
}

RunFigures::Options options(int dof = 2, bool audited = true) {
  return {.degrees_of_freedom = dof, .epoch = milliseconds(1000), .audited = audited};
}

TEST(RunFigures, GiveTicksInColumnsOfOneLength) {
  RunFigures figures(options());
  EXPECT_EQ(figures.take_ticks(0, {}), "");
  figures.add(tick(1));
  TickSample second = tick(2);
  second.force_sequence = 1;
  second.age = milliseconds(5);
  second.place_m = {0.25F, 0, 0};
  second.has_place = true;
  second.audit_J = 1e-3;
  second.contact = true;
  figures.add(second);
  const Json message = Json::parse(figures.take_ticks(1, std::array{0.5, 0.25, 0.0}));
  EXPECT_EQ(message["kind"], "ticks");
  EXPECT_EQ(message["track"], 1);
  EXPECT_EQ(message["time_s"], Json({0.001, 0.002}));
  EXPECT_EQ(message["position_m"], Json({{0.01, 0}, {0.01, 0}}));
  EXPECT_EQ(message["place_m"], Json({nullptr, {0.25, 0}}));
  EXPECT_EQ(message["age_ms"], Json({nullptr, 5}));
  EXPECT_EQ(message["passivity_mJ"], Json({0, 1}));
  EXPECT_EQ(message["contact"], Json({0, 1}));
  EXPECT_EQ(message["hand_m"], Json({0.5, 0.25}));
  EXPECT_TRUE(message["plane"].is_null());
  for (const char* const key : {"asked_N", "applied_N", "ledger_mJ"}) EXPECT_EQ(message[key].size(), 2) << key;
  EXPECT_EQ(figures.take_ticks(1, {}), "");  // they were taken
}

TEST(RunFigures, GiveNullForWhatIsNotKnown) {
  RunFigures figures(options(1, false));
  TickSample gone = tick(1);
  gone.usable = false;
  gone.ledger_J = std::numeric_limits<double>::infinity();
  figures.add(gone);
  const Json message = Json::parse(figures.take_ticks(0, {}));
  EXPECT_EQ(message["position_m"], Json::array({nullptr}));
  EXPECT_EQ(message["passivity_mJ"], Json::array({nullptr}));
  EXPECT_EQ(message["ledger_mJ"], Json::array({nullptr}));
  EXPECT_TRUE(message["hand_m"].is_null());
  const Json status = Json::parse(figures.status(0, 0, false));
  EXPECT_TRUE(status["passive"].is_null());
  EXPECT_TRUE(status["network"]["round_trip_ms"].is_null());
}

TEST(RunFigures, CountTheNetworkFromBothEnds) {
  RunFigures figures(options());
  for (int i = 1; i <= 10; ++i) figures.add(tick(i));
  figures.add(force(1, 2, 2));
  figures.add(force(5, 8, 6));  // two of eight motions lost on the way up, three of five forces on the way down
  const Json status = Json::parse(figures.status(0, 3, false));
  const Json& network = status["network"];
  EXPECT_EQ(network["sent"], 10);
  EXPECT_EQ(network["received"], 2);
  EXPECT_EQ(network["lost_up"], 2);
  EXPECT_EQ(network["lost_down"], 3);
  EXPECT_EQ(network["in_flight_up"].get<int>() + network["in_flight_down"].get<int>(), 2);
  EXPECT_NEAR(network["round_trip_ms"]["median"].get<double>(), 8, 0.01);
  EXPECT_EQ(status["tick"]["dropped_for_page"], 3);
  EXPECT_EQ(status["state"], "connected");
}

TEST(RunFigures, SplitTheLatencyByStage) {
  RunFigures figures(options());
  figures.add(force(1, 4, 4));
  TickSample first_use = tick(12);  // at 1012 ms, 2 ms after it came
  first_use.force_sequence = 4;
  figures.add(first_use);
  TickSample second_use = tick(13);
  second_use.force_sequence = 4;
  figures.add(second_use);
  const Json stages = Json::parse(figures.status(0, 0, false))["stages_ms"];
  const auto bin_of = [](const Json& stage, double ms) {
    for (std::size_t i = 0; i < stage["counts"].size(); ++i) {
      if (stage["edges"][i].get<double>() <= ms && ms < stage["edges"][i + 1].get<double>()) {
        return stage["counts"][i].get<int>();
      }
    }
    return -1;
  };
  for (const auto& [name, ms] : {std::pair{"network", 6.0}, {"server", 2.0}, {"waiting", 2.0}, {"total", 10.0}}) {
    EXPECT_EQ(stages[name]["edges"].size(), stages[name]["counts"].size() + 1) << name;
    EXPECT_EQ(bin_of(stages[name], ms), 1) << name;
  }
}

/// The milliseconds of what happened at random, of which the newest forces overtake older ones.
struct Drawn {
  std::vector<double> network_ms;
  std::vector<double> total_ms;
};

Drawn draw_overtaking(RunFigures& figures) {
  std::mt19937_64 random(7);
  const auto microseconds_up_to = [&random](int most) {
    return microseconds(std::uniform_int_distribution<int>(0, most)(random));
  };
  Drawn drawn;
  for (std::uint64_t motion = 1; motion <= 4000; ++motion) {
    ForceSample answer = force(motion, motion, motion);
    answer.at_server = microseconds_up_to(40);
    answer.round_trip = milliseconds(80) + microseconds_up_to(60'000) + answer.at_server;
    figures.add(answer);
    if (answer.round_trip > milliseconds(100)) continue;  // overtaken
    TickSample use = tick(static_cast<int>(motion));
    use.time = answer.received + microseconds_up_to(1000);
    use.force_sequence = motion;
    figures.add(use);
    drawn.network_ms.push_back(time::to_seconds(answer.round_trip - answer.at_server) * 1e3);
    drawn.total_ms.push_back(time::to_seconds(answer.round_trip + use.time - answer.received) * 1e3);
  }
  return drawn;
}

double nearest_rank(std::vector<double> values, double fraction) {
  std::ranges::sort(values);
  return values.at(static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(values.size()))) - 1);
}

TEST(RunFigures, HaveNoPercentileOfTheTotalBelowOneOfItsPartsAndEachWithinTheErrorThatIsStated) {
  RunFigures figures(options());
  const Drawn drawn = draw_overtaking(figures);
  const Json stages = Json::parse(figures.status(0, 0, false))["stages_ms"];
  for (const char* const percentile : {"median", "p99"}) {
    for (const char* const part : {"network", "server", "waiting"}) {
      EXPECT_LE(stages[part][percentile].get<double>(), stages["total"][percentile].get<double>()) << part;
    }
  }
  const auto expect_near = [&](const char* stage, const char* percentile, double exact_ms) {
    // And the six digits of a number on a page.
    EXPECT_NEAR(stages[stage][percentile].get<double>(), exact_ms, 5.1e-4 * exact_ms) << stage << ' ' << percentile;
  };
  expect_near("network", "p99", nearest_rank(drawn.network_ms, 0.99));
  expect_near("total", "p99", nearest_rank(drawn.total_ms, 0.99));
  expect_near("total", "median", nearest_rank(drawn.total_ms, 0.5));
}

TEST(RunFigures, SayWhetherAForceWasAskedForSoFar) {
  RunFigures figures(options());
  const auto touched = [&figures] { return Json::parse(figures.status(0, 0, false))["touched"].get<bool>(); };
  EXPECT_FALSE(touched());
  figures.add(tick(1));
  EXPECT_FALSE(touched());
  TickSample asked = tick(2);
  asked.asked_N = {0, 0.1F, 0};
  figures.add(asked);
  figures.add(tick(3));
  EXPECT_TRUE(touched()) << "it stays so";
}

TEST(RunFigures, TellHowAHandleIsTurnedAndItsTorqueWhereItTellsThat) {
  RunFigures figures(options(3));
  figures.add(tick(1));
  EXPECT_FALSE(Json::parse(figures.take_ticks(0, {})).contains("orientation"));
  TickSample turned = tick(2);
  turned.has_orientation = true;
  turned.orientation = {0.5, 0.5, -0.5, 0.5};
  turned.applied_torque_N_m = {0, 0.25F, 0};
  figures.add(turned);
  const Json message = Json::parse(figures.take_ticks(0, {}));
  EXPECT_EQ(message["orientation"], Json({0.5, 0.5, -0.5, 0.5}));
  EXPECT_EQ(message["torque_N_m"], Json({0, 0.25, 0}));
}

TEST(RunFigures, TellWhetherTheDeviceWasPassiveSinceTheStart) {
  RunFigures figures(options());
  figures.add(tick(1));
  EXPECT_EQ(Json::parse(figures.status(0, 0, false))["passive"], true);
  TickSample active = tick(2);
  active.audit_minimum_J = -2e-3;
  figures.add(active);
  const Json status = Json::parse(figures.status(0, 0, true));
  EXPECT_EQ(status["passive"], false);
  EXPECT_EQ(status["least_passivity_mJ"], -2);
  EXPECT_EQ(status["state"], "closing");
}

TEST(RunFigures, CountTicksThatWereLate) {
  RunFigures figures(options());
  figures.add(tick(1));
  TickSample late = tick(2);
  late.interval = microseconds(1600);
  figures.add(late);
  EXPECT_EQ(Json::parse(figures.status(0, 0, false))["tick"]["late"], 1);
}

TEST(RunFigures, AreMetricsInTheTextFormatOfPrometheus) {
  RunFigures figures(options());
  figures.add(tick(1));
  std::string text;
  figures.add_metrics(text, 1, 4);
  EXPECT_THAT(text, HasSubstr("forcebound_client_ticks_total{track=\"1\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("forcebound_client_page_dropped_total{track=\"1\"} 4\n"));
  EXPECT_THAT(text, HasSubstr("forcebound_client_least_passivity_joules{track=\"1\"} 0\n"));
}

TEST(RunFigures, KeepHistogramsOfRoundTripAgeAndTimeAtTheServerForTheScene) {
  RunFigures::Options of_scene = options();
  of_scene.scene = "a \"ball\"";
  RunFigures figures(of_scene);
  figures.add(force(1, 1, 1));
  TickSample used = tick(2);
  used.force_sequence = 1;
  used.age = milliseconds(30);
  figures.add(used);
  figures.add(tick(3));
  std::string text;
  figures.add_metrics(text, 0, 0);
  const auto has = [&](const std::string& name, const std::string& edge, int count) {
    EXPECT_THAT(text,
                HasSubstr("forcebound_client_scene_" + name + "_bucket{track=\"0\",scene=\"a \\\"ball\\\"\",le=\"" +
                          edge + "\"} " + std::to_string(count) + "\n"));
  };
  has("round_trip_seconds", "0.005", 0);
  has("round_trip_seconds", "0.01", 1);
  has("at_server_seconds", "0.001", 0);
  has("at_server_seconds", "0.0025", 1);
  has("age_seconds", "0.025", 0);
  has("age_seconds", "+Inf", 1);
  EXPECT_THAT(text, HasSubstr("# TYPE forcebound_client_scene_age_seconds histogram\n"));
}

}  // namespace
}  // namespace forcebound::client
