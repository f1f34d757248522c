#include "forcebound/client/commands/view/recording_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/client/commands/view/recorded.hpp"
#include "forcebound/client/commands/view/shipped_appearance.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/unit/record/sample_run.hpp"

namespace forcebound::client::commands {
namespace {

using Json = nlohmann::ordered_json;
using record::test::TemporaryFile;
using testing::HasSubstr;

/// A run of so many milliseconds, in file order.
void record_sample(const std::filesystem::path& file, std::uint64_t ticks) {
  record::RecordingWriter writer(file, record::test::sample_info());
  record::test::DirectSink sink(writer);
  record::test::play_sample_run(sink, ticks);
  writer.finish(record::test::sample_totals());
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Collected final : public page::Viewers {
 public:
  void send(page::ViewerId, page::Text text, page::Worth) override { messages.push_back(Json::parse(*text)); }
  void send_binary(page::ViewerId, page::Text, page::Worth) override {}
  void send_to_all(page::Text text, page::Worth) override { messages.push_back(Json::parse(*text)); }
  [[nodiscard]] std::size_t count() const noexcept override { return viewers; }

  [[nodiscard]] std::vector<Json> of(const std::string& kind) const {
    std::vector<Json> some;
    for (const Json& message : messages) {
      if (message["kind"] == kind) some.push_back(message);
    }
    return some;
  }

  /// The times of all ticks that came.
  [[nodiscard]] std::vector<double> times() const {
    std::vector<double> all;
    for (const Json& message : of("ticks")) {
      for (const Json& time : message["time_s"]) all.push_back(time);
    }
    return all;
  }

  std::vector<Json> messages;
  std::size_t viewers = 1;
};

/// A recording of 60 s with one viewer.
class RecordingPageTest : public testing::Test {
 protected:
  static constexpr std::uint64_t kTicks = 60'000;

  RecordingPageTest() { record_sample(file.path(), kTicks); }

  void open() {
    shown.emplace(read_recorded(file.path()), "run.mcap", R"({"kind":"scene"})", clock);
    shown->greet(1, viewers);
  }

  /// Beats for so long.
  void go_on(double seconds) {
    for (int i = 0; i < static_cast<int>(60 * seconds); ++i) {
      clock.time += time::from_seconds(1.0 / 60);
      shown->beat(viewers);
    }
  }

  void say(const Json& message) { shown->receive(1, message.dump(), viewers); }

  TemporaryFile file{"view.mcap"};
  test::FakeClock clock;
  Collected viewers;
  std::optional<RecordingPage> shown;
};

TEST_F(RecordingPageTest, PlaysTheRunInItsOwnTime) {
  open();
  const Json hello = viewers.of("hello").at(0);
  EXPECT_EQ(hello["program"], "view");
  EXPECT_EQ(hello["settings"]["law"], "fba-more");
  EXPECT_EQ(hello["recording"], "run.mcap");
  EXPECT_NEAR(hello["duration_s"].get<double>(), 59.999, 0.01);
  EXPECT_EQ(hello["dof"], 3);
  EXPECT_FALSE(hello["may_change"]);
  EXPECT_EQ(viewers.of("scene").size(), 1);
  EXPECT_FALSE(viewers.of("event").empty());
  go_on(2);
  const std::vector<double> times = viewers.times();
  ASSERT_FALSE(times.empty());
  EXPECT_NEAR(times.back(), 2, 0.15);
  EXPECT_TRUE(std::ranges::is_sorted(times));
  EXPECT_EQ(times.front(), 0);
  EXPECT_NEAR(static_cast<double>(times.size()), 1000 * times.back(), 3) << "each tick once";
  EXPECT_EQ(viewers.of("status").back()["state"], "connected");
  EXPECT_GT(viewers.of("status").back()["network"]["received"], 500);
}

TEST_F(RecordingPageTest, SeeksWithTheLastTenSecondsAndTheFiguresOfThatTime) {
  open();
  go_on(1);
  viewers.messages.clear();
  say({{"kind", "seek"}, {"time_s", 50}});
  say({{"kind", "play"}, {"on", false}});
  go_on(1);
  std::vector<double> times = viewers.times();
  ASSERT_FALSE(times.empty());
  EXPECT_NEAR(times.front(), 40, 0.01);
  EXPECT_NEAR(times.back(), 50, 0.01);
  const Json later = viewers.of("status").back()["network"];
  viewers.messages.clear();
  say({{"kind", "seek"}, {"time_s", 3}});
  go_on(1);
  times = viewers.times();
  EXPECT_EQ(times.front(), 0);
  EXPECT_NEAR(times.back(), 3, 0.01);
  EXPECT_LT(viewers.of("status").back()["network"]["sent"], later["sent"]) << "as they were then";
  say({{"kind", "seek"}, {"time_s", 50}});
  go_on(1);
  EXPECT_EQ(viewers.of("status").back()["network"], later) << "the same place, the same figures";
}

TEST_F(RecordingPageTest, PlaysFasterAndStopsAtTheEndAndBeginsAnewFromThere) {
  open();
  go_on(0.5);
  say({{"kind", "seek"}, {"time_s", 58}});
  say({{"kind", "play"}, {"on", true}, {"speed", 5}});
  go_on(2);
  EXPECT_FALSE(viewers.of("hello").back()["playing"]);
  EXPECT_NEAR(viewers.times().back(), 59.999, 0.01);
  viewers.messages.clear();
  go_on(1);
  EXPECT_TRUE(viewers.times().empty());
  say({{"kind", "play"}, {"on", true}});
  go_on(1);
  EXPECT_EQ(viewers.times().front(), 0);
  EXPECT_TRUE(viewers.of("hello").back()["playing"]);
}

TEST_F(RecordingPageTest, WaitsWhileNobodyLooks) {
  open();
  viewers.viewers = 0;
  go_on(5);
  EXPECT_TRUE(viewers.times().empty());
  viewers.viewers = 1;
  go_on(1);
  EXPECT_LT(viewers.times().back(), 1.1);
}

TEST_F(RecordingPageTest, RefusesWhatCannotBeDoneToWhatHasHappened) {
  open();
  say({{"kind", "choose"}, {"setting", "law"}, {"value", "none"}});
  say({{"kind", "kick"}, {"session", 1}});
  shown->receive(1, "garbage", viewers);
  EXPECT_EQ(viewers.of("refused").size(), 3);
  EXPECT_THAT(shown->metrics(), HasSubstr("ticks_total"));
}

TEST_F(RecordingPageTest, ShowsWhatCanBeReadOfATruncatedOrDamagedRecording) {
  std::string content = content_of(file.path());
  std::ofstream(file.path(), std::ios::binary) << content.substr(0, content.size() / 2);
  const Recorded cut = read_recorded(file.path());
  EXPECT_THAT(cut.flaw, HasSubstr("incomplete"));
  EXPECT_GT(cut.ticks.size(), 1000U);
  EXPECT_LT(cut.ticks.size(), kTicks);
  content[2 * content.size() / 3] ^= 0x55;
  std::ofstream(file.path(), std::ios::binary) << content;
  const Recorded damaged = read_recorded(file.path());
  EXPECT_THAT(damaged.flaw, HasSubstr("incomplete: 1 damaged record, with "));
  EXPECT_THAT(damaged.flaw, HasSubstr("chunk is damaged"));
  EXPECT_GE(damaged.ticks.size() + 1010, kTicks);  // a second is lost, not what follows
  EXPECT_LT(damaged.ticks.size(), kTicks);
  EXPECT_NEAR(damaged.duration_s(), 1e-3 * kTicks, 0.01);
  open();
  EXPECT_THAT(viewers.of("event").at(0)["text"].get<std::string>(), HasSubstr("shown is what is whole"));
}

TEST_F(RecordingPageTest, RefusesWhatIsNoRecordingOfAClient) {
  std::ofstream(file.path()) << "no recording";
  EXPECT_THROW((void)read_recorded(file.path()), std::runtime_error);
  EXPECT_THROW((void)read_recorded("/does/not/exist.mcap"), std::runtime_error);
  record_sample(file.path(), 0);
  EXPECT_THAT([this] { (void)read_recorded(file.path()); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("no message on topic /tick")));
}

TEST(ShippedLook, IsThatOfTheSceneOfTheRecordedNameOrSaysWhyThereIsNone) {
  Recorded recorded;
  recorded.info.scene = "sphere";
  const Json sphere = Json::parse(scene_message_of(recorded, ""));
  EXPECT_EQ(sphere["shapes"].at(0)["kind"], "sphere");
  recorded.info.scene = "of my own";
  EXPECT_THAT(Json::parse(scene_message_of(recorded, ""))["more"].get<std::string>(), HasSubstr("--scene"));
  recorded.forces.push_back({.follower = control::FollowerState::waiting});
  EXPECT_THAT(Json::parse(scene_message_of(recorded, ""))["more"].get<std::string>(), HasSubstr("work of a robot"));
  recorded.info.scene = "circle";  // of two axes
  EXPECT_THAT(Json::parse(scene_message_of(recorded, ""))["more"].get<std::string>(), HasSubstr("degrees of freedom"));
}

}  // namespace
}  // namespace forcebound::client::commands
