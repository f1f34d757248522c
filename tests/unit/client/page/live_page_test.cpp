#include "forcebound/client/page/live_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace forcebound::client {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class StoppedClock final : public time::Clock {
 public:
  [[nodiscard]] time::Nanoseconds now() const noexcept override { return time; }
  time::Nanoseconds time{0};
};

class Collected final : public page::Viewers {
 public:
  void send(page::ViewerId, page::Text text, page::Worth) override { messages.push_back(Json::parse(*text)); }
  void send_binary(page::ViewerId, page::Text content, page::Worth) override { binaries.push_back(*content); }
  void send_to_all(page::Text text, page::Worth) override { messages.push_back(Json::parse(*text)); }
  [[nodiscard]] std::size_t count() const noexcept override { return viewers; }

  /// The kinds that came since, and forgets them.
  std::vector<std::string> take_kinds() {
    std::vector<std::string> kinds;
    for (const Json& message : messages) kinds.push_back(message["kind"]);
    messages.clear();
    return kinds;
  }

  std::vector<Json> messages;
  std::vector<std::string> binaries;
  std::size_t viewers = 1;
};

class LivePageTest : public testing::Test {
 protected:
  void begin(int tracks) {
    std::vector<ShownTrack> shown;
    for (int i = 0; i < tracks; ++i) {
      taps.push_back(std::make_shared<TickTap>());
      pointers.push_back(std::make_shared<device::PointerTarget>());
      views.push_back(std::make_shared<ViewTap>());
      shown.push_back({.tap = taps.back(), .pointer = pointers.back(), .view = views.back()});
    }
    live.begin_run({}, shown);
  }

  static void tick(TickTap& tap) {
    record::TickRecord record;
    record.position = record.request = record.applied = control::Vector::Zero(3);
    tap.on_tick(record);
  }

  StoppedClock clock;
  LivePage live{clock};
  Collected viewers;
  std::vector<std::shared_ptr<TickTap>> taps;
  std::vector<std::shared_ptr<device::PointerTarget>> pointers;
  std::vector<std::shared_ptr<ViewTap>> views;
};

TEST_F(LivePageTest, ShowsTheTicksOfEachTrack) {
  begin(2);
  live.beat(viewers);
  EXPECT_EQ(viewers.take_kinds(), (std::vector<std::string>{"hello", "status", "status"}));
  tick(*taps[0]);
  tick(*taps[1]);
  live.beat(viewers);
  ASSERT_EQ(viewers.messages.size(), 2);
  EXPECT_EQ(viewers.messages[0]["track"], 0);
  EXPECT_EQ(viewers.messages[1]["track"], 1);
  EXPECT_EQ(viewers.messages[1]["time_s"].size(), 1);
}

TEST_F(LivePageTest, KeepsNoTicksWhileNobodyLooks) {
  begin(1);
  viewers.viewers = 0;
  for (int i = 0; i < 100; ++i) tick(*taps[0]);
  live.beat(viewers);
  viewers.messages.clear();
  viewers.viewers = 1;
  tick(*taps[0]);
  live.beat(viewers);
  ASSERT_FALSE(viewers.messages.empty());
  EXPECT_EQ(viewers.messages[0]["time_s"].size(), 1);
}

TEST_F(LivePageTest, TellsAViewerWhoComesLaterAllThatItNeeds) {
  begin(1);
  live.set_scene(0, {.name = "wall"});
  live.report(0, "info", "connected");
  live.beat(viewers);
  viewers.messages.clear();
  live.greet(2, viewers);
  EXPECT_EQ(viewers.take_kinds(), (std::vector<std::string>{"hello", "scene", "event"}));
}

TEST_F(LivePageTest, TellsAViewerWhoComesBeforeTheFirstRunOfItOnceItBegins) {
  live.greet(1, viewers);
  live.beat(viewers);
  EXPECT_TRUE(viewers.messages.empty());
  begin(1);
  live.beat(viewers);
  EXPECT_EQ(viewers.take_kinds().front(), "hello");
}

/// A call of the first service, /choose/law, by Foxglove's protocol.
std::string call_for_law(const std::string& request) {
  return std::string("\x02\x01\0\0\0\x09\0\0\0\x04\0\0\0json", 17) + request;
}

TEST_F(LivePageTest, AnswersACallOnceItsChoiceIsDealtWith) {
  begin(1);
  live.beat(viewers);
  page::Subject& foxglove = *live.foxglove().subject;
  foxglove.greet(5, viewers);
  viewers.messages.clear();
  foxglove.receive_binary(5, call_for_law(R"({"value":"none"})"), viewers);
  const auto choice = live.take_request();
  ASSERT_TRUE(choice);
  EXPECT_EQ(std::get<page::Choose>(*choice).setting, "law");
  EXPECT_EQ(std::get<page::Choose>(*choice).value, decltype(page::Choose::value)("none"));
  foxglove.beat(viewers);
  EXPECT_TRUE(viewers.binaries.empty()) << "nobody has dealt with it";
  EXPECT_FALSE(live.take_request());
  foxglove.beat(viewers);
  EXPECT_EQ(viewers.binaries.size(), 1);
  foxglove.receive_binary(5, call_for_law(R"({"value":"nothing"})"), viewers);
  ASSERT_TRUE(live.take_request());
  live.refuse("law", "unknown law");
  EXPECT_FALSE(live.take_request());
  foxglove.beat(viewers);
  EXPECT_EQ(viewers.binaries.size(), 1);
  ASSERT_EQ(viewers.messages.size(), 1);
  EXPECT_EQ(viewers.messages[0]["message"], "unknown law");
  for (std::size_t i = 0; i <= LivePage::kRequestsMost; ++i) {
    foxglove.receive_binary(5, call_for_law(R"({"value":"none"})"), viewers);
  }
  foxglove.beat(viewers);
  ASSERT_EQ(viewers.messages.size(), 2);
  EXPECT_THAT(viewers.messages[1]["message"].get<std::string>(), HasSubstr("too many changes at once"));
}

TEST_F(LivePageTest, ShowsFoxgloveTheFirstTrackAndItsSceneWhileSomebodyLooks) {
  begin(2);
  live.set_scene(0, {.name = "wall"});
  live.beat(viewers);
  page::Subject& foxglove = *live.foxglove().subject;
  tick(*taps[0]);
  foxglove.beat(viewers);
  foxglove.greet(5, viewers);
  foxglove.receive(5, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":3}]})", viewers);
  foxglove.beat(viewers);
  EXPECT_EQ(viewers.binaries.size(), 1) << "the scene alone, no tick of before";
  tick(*taps[0]);
  tick(*taps[1]);
  foxglove.beat(viewers);
  EXPECT_EQ(viewers.binaries.size(), 2);
}

TEST_F(LivePageTest, PointsTheHandsOfAllTracks) {
  begin(2);
  live.beat(viewers);
  live.receive(1, R"({"kind":"hand","point_m":[0.01,0.02,0.03]})", viewers);
  for (const auto& pointer : pointers) {
    EXPECT_TRUE(pointer->held());
    EXPECT_EQ(pointer->place_m(), (device::PointerTarget::Point{0.01, 0.02, 0.03}));
  }
  live.receive(1, R"({"kind":"button","index":0,"down":true})", viewers);
  live.receive(1, R"({"kind":"hand_free"})", viewers);
  EXPECT_FALSE(pointers[1]->held());
  EXPECT_EQ(pointers[1]->buttons(), 1U);
}

TEST_F(LivePageTest, HandsChoicesToTheProgramAndRefusesTooMany) {
  begin(1);
  for (std::size_t i = 0; i <= LivePage::kRequestsMost; ++i) {
    live.receive(1, R"({"kind":"choose","setting":"law","value":"none"})", viewers);
  }
  ASSERT_EQ(viewers.messages.size(), 1);
  EXPECT_EQ(viewers.messages[0]["about"], "law");
  std::size_t taken = 0;
  while (const auto request = live.take_request()) {
    EXPECT_EQ(std::get<page::Choose>(*request).setting, "law");
    ++taken;
  }
  EXPECT_EQ(taken, LivePage::kRequestsMost);
}

TEST_F(LivePageTest, AnswersGarbageAndWhatAClientHasNot) {
  begin(1);
  live.receive(1, "garbage", viewers);
  live.receive(1, R"({"kind":"kick","session":1})", viewers);
  live.receive(1, R"({"kind":"something new"})", viewers);
  EXPECT_EQ(viewers.take_kinds(), (std::vector<std::string>{"refused", "refused"}));
}

TEST_F(LivePageTest, BeginsTheFiguresOfARunFromZero) {
  begin(1);
  live.beat(viewers);
  tick(*taps[0]);
  live.beat(viewers);
  EXPECT_THAT(live.metrics(), HasSubstr("ticks_total{track=\"0\"} 1\n"));
  begin(1);
  live.beat(viewers);
  EXPECT_THAT(live.metrics(), HasSubstr("ticks_total{track=\"0\"} 0\n"));
}

TEST_F(LivePageTest, GreetsNobodyTwice) {
  begin(1);
  live.report(0, "info", "one");
  live.greet(1, viewers);
  live.beat(viewers);
  EXPECT_EQ(viewers.take_kinds(), (std::vector<std::string>{"hello", "event", "status"}));
  live.report(0, "info", "two");
  live.greet(2, viewers);
  EXPECT_EQ(viewers.take_kinds(), (std::vector<std::string>{"hello", "event"}));
  live.beat(viewers);
  EXPECT_EQ(viewers.take_kinds(), (std::vector<std::string>{"event"}));
}

TEST_F(LivePageTest, ShowsAGrowingSceneOnceASecond) {
  begin(1);
  live.beat(viewers);
  viewers.messages.clear();
  for (int i = 0; i < 50; ++i) {
    live.set_scene(0, {.name = std::to_string(i)});
    live.beat(viewers);
    clock.time += std::chrono::milliseconds{10};
  }
  const auto scenes = [this] {
    std::vector<std::string> names;
    for (const Json& message : viewers.messages) {
      if (message["kind"] == "scene") names.push_back(message["name"]);
    }
    return names;
  };
  EXPECT_EQ(scenes(), (std::vector<std::string>{"0"}));
  clock.time += std::chrono::seconds{1};
  live.beat(viewers);
  EXPECT_EQ(scenes(), (std::vector<std::string>{"0", "49"}));
}

TEST_F(LivePageTest, LetsGoForAViewerWhoLeavesWhileDragging) {
  begin(1);
  live.beat(viewers);
  live.receive(1, R"({"kind":"hand","point_m":[0,0,0]})", viewers);
  live.receive(1, R"({"kind":"button","index":3,"down":true})", viewers);
  live.leave(2);
  EXPECT_TRUE(pointers[0]->held());
  EXPECT_EQ(pointers[0]->buttons(), 8U);
  live.leave(1);
  EXPECT_FALSE(pointers[0]->held());
  EXPECT_EQ(pointers[0]->buttons(), 0U);
}

TEST_F(LivePageTest, ShowsWhatTheServerTellsBesideWhatIsHere) {
  begin(1);
  live.set_scene(0, {.name = "bench", .shapes = R"({"name":"table"})"});
  const std::vector<std::vector<scene::VisiblePart>> models{{{.name = "block", .kind = scene::VisiblePart::Kind::box}}};
  const view::Description description = view::describe({.name = "bench"}, models);
  wire::ViewPiece piece{.session = 1, .view = description.hash, .pieces = 1, .content = description.piece(0)};
  views[0]->on_view(piece);
  const std::vector<float> place{1, 2, 3, 1, 0, 0, 0};
  piece.pieces = 0;
  piece.content = std::as_bytes(std::span(place));
  views[0]->on_view(piece);
  live.beat(viewers);
  live.beat(viewers);
  Json scene;
  Json moved;
  for (const Json& message : viewers.messages) {
    if (message["kind"] == "scene") scene = message;
    if (message["kind"] == "moved") moved = message;
  }
  EXPECT_EQ(scene["shapes"].size(), 2);
  EXPECT_EQ(moved["bodies"].at(0)["name"], "block");
  viewers.messages.clear();
  live.greet(2, viewers);
  live.beat(viewers);
  live.beat(viewers);
  const auto kinds = viewers.take_kinds();
  EXPECT_NE(std::ranges::find(kinds, "moved"), kinds.end()) << "a viewer who comes later is told where it is";
}

TEST_F(LivePageTest, WaitsForASceneThatIsAllOnItsWayHere) {
  taps.push_back(std::make_shared<TickTap>());
  views.push_back(std::make_shared<ViewTap>());
  live.begin_run({}, {{.tap = taps.back(), .view = views.back(), .renders_locally = true}});
  const view::Description nothing = view::describe({.name = "ball"}, {});
  views[0]->on_view({.session = 1, .view = nothing.hash, .pieces = 1, .content = nothing.piece(0)});
  live.beat(viewers);
  EXPECT_EQ(viewers.take_kinds(), (std::vector<std::string>{"hello", "status"}));
  live.set_scene(0, {.name = "ball", .shapes = R"({"name":"ball"})"});
  live.beat(viewers);
  ASSERT_EQ(viewers.messages.size(), 1);
  EXPECT_EQ(viewers.messages[0]["shapes"].size(), 1);
}

}  // namespace
}  // namespace forcebound::client
