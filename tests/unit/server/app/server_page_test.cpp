#include "forcebound/server/app/server_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

namespace forcebound::server {
namespace {

using Json = nlohmann::json;

class StillClock final : public time::Clock {
 public:
  [[nodiscard]] time::Nanoseconds now() const noexcept override { return time::Nanoseconds{0}; }
};

class Sent final : public page::Viewers {
 public:
  void send(page::ViewerId, page::Text text, page::Worth) override { kinds.push_back(Json::parse(*text)["kind"]); }
  void send_binary(page::ViewerId, page::Text, page::Worth) override {}
  void send_to_all(page::Text text, page::Worth) override { kinds.push_back(Json::parse(*text)["kind"]); }
  [[nodiscard]] std::size_t count() const noexcept override { return viewers; }
  std::size_t viewers = 1;
  std::vector<std::string> kinds;
};

using Kinds = std::vector<std::string>;

TEST(ServerPage, ShowsTheSessionsOncePerChange) {
  const StillClock clock;
  ServerPage page(clock, {});
  Sent viewers;
  page.greet(1, viewers);
  page.show(R"({"kind":"sessions"})", "metric 1\n");
  page.report("info", "something");
  page.beat(viewers);
  page.beat(viewers);
  page.greet(2, viewers);
  EXPECT_EQ(viewers.kinds, (Kinds{"hello", "event", "sessions", "hello", "event", "sessions"}));
  EXPECT_EQ(page.metrics(), "metric 1\n");
}

TEST(ServerPage, TellsWhoeverComesLaterOfTheNewestEventsAndNobodyTwice) {
  const StillClock clock;
  ServerPage page(clock, {});
  for (std::size_t i = 0; i < ServerPage::kEventsKept + 7; ++i) page.report("info", "before");
  Sent viewers;
  page.greet(1, viewers);
  EXPECT_EQ(viewers.kinds, Kinds{"hello"}) << "what waits is sent to all";
  const auto events = [&viewers] { return std::ranges::count(viewers.kinds, "event"); };
  page.beat(viewers);
  EXPECT_EQ(events(), ServerPage::kEventsKept);
  page.beat(viewers);
  EXPECT_EQ(events(), ServerPage::kEventsKept);
  page.report("warning", "now");
  viewers.kinds.clear();
  page.greet(2, viewers);
  EXPECT_EQ(events(), ServerPage::kEventsKept - 1);
  page.beat(viewers);
  EXPECT_EQ(events(), ServerPage::kEventsKept);
}

TEST(ServerPage, ShowsItsRobotToWhoeverComesAndAsItMoves) {
  const StillClock clock;
  ServerPage page(clock, {});
  page.set_robot(view::describe({.name = "plug", .robot = R"({"name":"reach-7"})"}, {},
                                {{.names = {"tool"}}, {.names = {"lag_m"}, .values = true}}));
  Sent viewers;
  page.greet(1, viewers);
  const std::vector<float> place{0, 0, 1, 1, 0, 0, 0};
  page.move_robot(0, place);
  for (int beat = 0; beat < 4; ++beat) page.beat(viewers);
  EXPECT_EQ(viewers.kinds, (Kinds{"hello", "scene", "moved"})) << "nothing is told twice";
  page.greet(2, viewers);
  for (int beat = 0; beat < 2; ++beat) page.beat(viewers);
  EXPECT_EQ(viewers.kinds, (Kinds{"hello", "scene", "moved", "hello", "scene", "moved"}));
}

TEST(ServerPage, AsksForFiguresOnlyWhileSomebodyLooks) {
  const StillClock clock;
  ServerPage page(clock, {});
  Sent viewers;
  viewers.viewers = 0;
  page.beat(viewers);
  EXPECT_FALSE(page.watched());
  std::jthread serving([&page] {
    while (!page.awaited()) std::this_thread::yield();
    page.show(R"({"kind":"sessions"})", "metric 2\n");
  });
  EXPECT_EQ(page.metrics(), "metric 2\n");
  EXPECT_FALSE(page.awaited());
  viewers.viewers = 1;
  page.beat(viewers);
  EXPECT_TRUE(page.watched());
}

TEST(ServerPage, TakesKicksAndNothingElse) {
  const StillClock clock;
  ServerPage page(clock, {});
  Sent viewers;
  page.receive(1, R"({"kind":"kick","session":7})", viewers);
  EXPECT_EQ(page.take_kick(), 7U);
  EXPECT_EQ(page.take_kick(), std::nullopt);
  page.receive(1, R"({"kind":"choose","setting":"law","value":"none"})", viewers);
  page.receive(1, "garbage", viewers);
  EXPECT_EQ(viewers.kinds, (Kinds{"refused", "refused"}));
  for (std::size_t i = 0; i <= ServerPage::kKicksMost; ++i) page.receive(1, R"({"kind":"kick","session":7})", viewers);
  EXPECT_EQ(viewers.kinds.size(), 3);
}

}  // namespace
}  // namespace forcebound::server
