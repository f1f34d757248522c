#include "forcebound/server/app/page_observer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "forcebound/time/heap_operations.hpp"

namespace forcebound::server {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class HandClock final : public time::Clock {
 public:
  [[nodiscard]] time::Nanoseconds now() const noexcept override { return time; }
  time::Nanoseconds time{0};
};

class Counting final : public ServerObserver {
 public:
  void on_opened(const SessionInfo&) override { ++opened; }
  void on_closed(const SessionInfo&, CloseReason, const wire::Bye&) override { ++closed; }
  void on_refused(const net::Address&, std::string_view) override { ++refused; }
  void on_motion(const wire::MotionSample&) noexcept override { ++motions; }
  void on_force(const wire::EnvironmentForce&) noexcept override { ++forces; }
  int opened = 0;
  int closed = 0;
  int refused = 0;
  int motions = 0;
  int forces = 0;
};

wire::EnvironmentForce force(std::uint64_t motion, std::uint64_t received) {
  wire::EnvironmentForce force;
  force.session = 12345678901234567890ULL;
  force.motion_sequence = motion;
  force.motions_received = received;
  force.compute_time = std::chrono::microseconds(20);
  return force;
}

class PageObserverTest : public testing::Test {
 protected:
  PageObserverTest() { observer.on_opened(info); }

  Json session() { return Json::parse(observer.snapshot().sessions_message({}))["sessions"].at(0); }

  HandClock clock;
  Counting next;
  PageObserver observer{next, clock};
  SessionInfo info{.session = 12345678901234567890ULL,
                   .address = {},
                   .device = "omni",
                   .degrees_of_freedom = 3,
                   .scene = "sphere",
                   .client = "lab \xff"};
};

TEST_F(PageObserverTest, ShowsSessionsWithoutTheirKey) {
  clock.time = std::chrono::seconds(5);
  const std::string message = observer.snapshot().sessions_message({.busy = 0.25, .places_used = 1, .places = 64});
  EXPECT_THAT(message, testing::Not(HasSubstr("12345678901234567890")));
  const Json parsed = Json::parse(message);
  EXPECT_EQ(parsed["load"]["processor_percent"], 25);
  EXPECT_EQ(parsed["load"]["places"], 64);
  EXPECT_EQ(session()["id"], 1);
  EXPECT_EQ(session()["scene"], "sphere");
  EXPECT_EQ(session()["since_s"], 5);
  EXPECT_EQ(session()["state"], "silent");
  EXPECT_TRUE(session()["compute_us"]["median"].is_null());
}

TEST_F(PageObserverTest, ShowsNothingOfASessionThatItNeverKnows) {
  observer.on_force(force(1, 1));
  const Json shown = session();
  for (const auto& [key, value] : shown.items()) EXPECT_FALSE(value.is_null()) << key;
}

TEST_F(PageObserverTest, CountsWhatIsLostOnTheWayUpAndHowLongAnswersTake) {
  observer.on_force(force(101, 1));
  observer.on_force(force(110, 8));  // two of ten are missing
  EXPECT_NEAR(session()["lost_up_percent"].get<double>(), 20, 1e-9);
  EXPECT_NEAR(session()["compute_us"]["median"].get<double>(), 20, 0.02);
  EXPECT_EQ(session()["state"], "active");
  observer.on_unsound_response(info);
  EXPECT_EQ(session()["faults"][0]["count"], 1);
}

TEST_F(PageObserverTest, FindsASessionByItsShownNumberUntilItEnds) {
  EXPECT_EQ(observer.session_of(1), info.session);
  EXPECT_EQ(observer.session_of(2), std::nullopt);
  observer.on_closed(info, CloseReason::client_said_bye, {});
  EXPECT_EQ(observer.session_of(1), std::nullopt);
  EXPECT_EQ(Json::parse(observer.snapshot().sessions_message({}))["sessions"].size(), 0);
}

TEST_F(PageObserverTest, TellsTheOtherObserverOfAll) {
  observer.on_motion({});
  observer.on_force(force(1, 1));
  observer.on_refused({}, "full");
  observer.on_closed(info, CloseReason::idle, {});
  EXPECT_EQ(next.opened, 1);
  EXPECT_EQ(next.closed, 1);
  EXPECT_EQ(next.refused, 1);
  EXPECT_EQ(next.motions, 1);
  EXPECT_EQ(next.forces, 1);
}

TEST_F(PageObserverTest, GivesMetricsInTheTextFormatOfPrometheus) {
  observer.on_force(force(1, 1));
  const std::string text = observer.snapshot().metrics({.busy = 0.5, .places_used = 1, .places = 64});
  EXPECT_THAT(text, HasSubstr("forcebound_server_sessions 1\n"));
  EXPECT_THAT(text, HasSubstr("forcebound_server_busy_ratio 0.5\n"));
  EXPECT_THAT(text, HasSubstr("forcebound_server_forces_sent{session=\"1\"} 1\n"));
}

TEST_F(PageObserverTest, KeepsAHistogramOfComputeTimeForEachSceneOverAllItsSessions) {
  observer.on_force(force(1, 1));
  SessionInfo second = info;
  second.session = 7;
  observer.on_opened(second);
  wire::EnvironmentForce slow = force(1, 1);
  slow.session = 7;
  slow.compute_time = std::chrono::milliseconds(3);
  observer.on_force(slow);
  observer.on_closed(second, CloseReason::client_said_bye, {});
  const std::string text = observer.snapshot().metrics({});
  const std::string name = "forcebound_server_scene_compute_seconds";
  EXPECT_THAT(text, HasSubstr("# TYPE " + name + " histogram\n"));
  EXPECT_THAT(text, HasSubstr(name + "_bucket{scene=\"sphere\",le=\"1e-05\"} 0\n"));
  EXPECT_THAT(text, HasSubstr(name + "_bucket{scene=\"sphere\",le=\"2.5e-05\"} 1\n"));
  EXPECT_THAT(text, HasSubstr(name + "_bucket{scene=\"sphere\",le=\"0.005\"} 2\n"));
  EXPECT_THAT(text, HasSubstr(name + "_bucket{scene=\"sphere\",le=\"+Inf\"} 2\n"));
  EXPECT_THAT(text, HasSubstr(name + "_sum{scene=\"sphere\"} 0.00302\n"));
  EXPECT_THAT(text, HasSubstr(name + "_count{scene=\"sphere\"} 2\n"));
}

TEST_F(PageObserverTest, DoesNotAllocateForAMotion) {
  if (!time::kCountsHeapOperations) GTEST_SKIP() << "the sanitizer's malloc does not count";
  const wire::EnvironmentForce answer = force(1, 1);
  const std::uint64_t before = time::heap_operations_of_this_thread();
  observer.on_force(answer);
  EXPECT_EQ(time::heap_operations_of_this_thread(), before);
}

}  // namespace
}  // namespace forcebound::server
