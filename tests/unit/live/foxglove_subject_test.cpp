#include "forcebound/live/foxglove_subject.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/live/record_tap.hpp"
#include "tests/support/allocation_guard.hpp"

namespace forcebound::live {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

/// A viewer that takes all, or leaves at its first binary message.
class Sent final : public page::Viewers {
 public:
  void send(page::ViewerId, page::Text text, page::Worth) override { texts.push_back(Json::parse(*text)); }
  void send_binary(page::ViewerId viewer, page::Text content, page::Worth worth) override {
    binaries.push_back({viewer, *content, worth});
    if (on_binary) on_binary(viewer);
  }
  void send_to_all(page::Text, page::Worth) override { FAIL(); }
  [[nodiscard]] std::size_t count() const noexcept override { return 1; }

  /// The only text since the last call.
  Json take_text() {
    EXPECT_EQ(texts.size(), 1);
    Json text = texts.empty() ? Json() : texts.front();
    texts.clear();
    return text;
  }

  struct Binary {
    page::ViewerId viewer;
    std::string content;
    page::Worth worth;
  };
  std::vector<Json> texts;
  std::vector<Binary> binaries;
  std::function<void(page::ViewerId)> on_binary;
};

class FoxgloveSubjectTest : public testing::Test, protected FoxgloveSubject::Source {
 protected:
  void write_new(record::TopicEncoder& to, bool wanted) override {
    tap.drain(to, wanted);
    if (scene) to.write_scene(*scene, time::Nanoseconds{5});
    scene.reset();
  }
  void call(std::uint64_t number, const Service& service, const std::string& value) override {
    calls.push_back({number, service.name + " " + value});
  }

  void begin() {
    subject.greet(1, sent);
    sent.texts.clear();
  }

  /// What a message is answered with, in a status.
  std::string refusal(const std::string& message) {
    subject.receive(1, message, sent);
    return status_of(sent.take_text());
  }
  std::string binary_refusal(const std::string& message) {
    subject.receive_binary(1, message, sent);
    return status_of(sent.take_text());
  }
  static std::string status_of(const Json& status) {
    EXPECT_EQ(status["op"], "status");
    EXPECT_EQ(status["level"], 2);
    return status["message"];
  }

  void subscribe(int id, int channel) {
    subject.receive(1, Json{{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}}.dump(),
                    sent);
  }

  static std::string call_of(unsigned char service, const std::string& encoding, const std::string& request) {
    const auto number = [](unsigned char value) { return std::string{static_cast<char>(value), 0, 0, 0}; };
    return "\x02" + number(service) + number(9) + number(static_cast<unsigned char>(encoding.size())) + encoding +
           request;
  }

  RecordTap tap;
  std::optional<std::vector<record::ScenePart>> scene;
  struct Called {
    std::uint64_t number;
    std::string words;
  };
  std::vector<Called> calls;
  Sent sent;
  FoxgloveSubject subject{{.name = "a program",
                           .epoch = time::Nanoseconds{1'000},
                           .topics = {record::Topic::tick, record::Topic::scene},
                           .services = {{.name = "/choose/law", .schema = R"({"type":"string"})"}}},
                          *this};
};

TEST_F(FoxgloveSubjectTest, SaysWhatThereIsWithTheSchemasOfRecordings) {
  subject.greet(1, sent);
  ASSERT_EQ(sent.texts.size(), 3);
  EXPECT_EQ(sent.texts[0]["op"], "serverInfo");
  EXPECT_EQ(sent.texts[0]["capabilities"], Json::array({"services"}));
  EXPECT_EQ(sent.texts[0]["supportedEncodings"], Json::array({"json"}));
  const Json& tick = sent.texts[1]["channels"][0];
  EXPECT_EQ(tick["topic"], "/tick");
  EXPECT_EQ(tick["schemaName"], "forcebound.v1.TickRecord");
  EXPECT_EQ(tick["encoding"], "protobuf");
  EXPECT_GT(tick["schema"].get<std::string>().size(), 1000);
  EXPECT_EQ(sent.texts[1]["channels"][1]["schemaName"], "foxglove.SceneUpdate");
  const Json& service = sent.texts[2]["services"][0];
  EXPECT_EQ(service["name"], "/choose/law");
  EXPECT_EQ(Json::parse(service["request"]["schema"].get<std::string>())["properties"]["value"]["type"], "string");
}

TEST_F(FoxgloveSubjectTest, SendsTheTicksOfWhoSubscribesUntilHeDoesNot) {
  begin();
  subscribe(7, 1);
  subject.beat(sent);  // from now on they are wanted
  record::TickRecord tick;
  tick.time = time::Nanoseconds{2};
  tap.on_tick(tick);
  subject.beat(sent);
  ASSERT_EQ(sent.binaries.size(), 1);
  EXPECT_EQ(sent.binaries[0].worth, page::Worth::stream);
  const std::string head("\x01\x07\0\0\0\xea\x03\0\0\0\0\0\0", 13);  // 1002 ns
  EXPECT_EQ(sent.binaries[0].content.substr(0, head.size()), head);
  subject.receive(1, R"({"op":"unsubscribe","subscriptionIds":[7]})", sent);
  tap.on_tick(tick);
  subject.beat(sent);
  EXPECT_EQ(sent.binaries.size(), 1);
  EXPECT_TRUE(sent.texts.empty());
}

TEST_F(FoxgloveSubjectTest, WantsNoRecordsWhileNobodyLooks) {
  tap.on_tick({});
  subject.beat(sent);
  EXPECT_FALSE(tap.wanted());
  begin();
  subject.beat(sent);
  EXPECT_TRUE(tap.wanted());
  subject.leave(1);
  subject.beat(sent);
  EXPECT_FALSE(tap.wanted());
  EXPECT_EQ(tap.dropped(), 0);
}

TEST_F(FoxgloveSubjectTest, SendsTheSceneToWhoSubscribesLater) {
  begin();
  scene.emplace();
  subject.beat(sent);
  EXPECT_TRUE(sent.binaries.empty());
  subscribe(3, 2);
  ASSERT_EQ(sent.binaries.size(), 1);
  EXPECT_EQ(sent.binaries[0].worth, page::Worth::needed);
}

TEST_F(FoxgloveSubjectTest, GoesOnWhereAViewerLeavesWhileItIsSentSomething) {
  begin();
  subject.greet(2, sent);
  subscribe(3, 2);
  subject.receive(2, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2}]})", sent);
  sent.on_binary = [&](page::ViewerId viewer) { subject.leave(viewer); };
  scene.emplace();
  subject.beat(sent);
  EXPECT_EQ(sent.binaries.size(), 2);
  scene.emplace();
  subject.beat(sent);
  EXPECT_EQ(sent.binaries.size(), 2);
  subject.greet(3, sent);
  subject.receive(3, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2},{"id":2,"channelId":1}]})", sent);
  EXPECT_EQ(sent.binaries.size(), 3);
  subject.beat(sent);
  EXPECT_FALSE(tap.wanted()) << "the last has left while the scene was sent to it";
}

TEST_F(FoxgloveSubjectTest, RefusesWhatIsWrongInOneLine) {
  begin();
  EXPECT_EQ(refusal("garbage"), "a message must be a JSON object");
  EXPECT_THAT(refusal("{}"), StartsWith("op is null; accepted are"));
  EXPECT_THAT(refusal(R"({"op":"subscribe","subscriptions":[7]})"), HasSubstr("must have id and channelId"));
  EXPECT_THAT(refusal(R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})"), StartsWith("id is 1.5"));
  EXPECT_THAT(refusal(R"({"op":"subscribe","subscriptions":[{"id":1}]})"), StartsWith("channelId is null"));
  EXPECT_THAT(refusal(R"({"op":"unsubscribe","subscriptionIds":[4294967296]})"), HasSubstr("of 32 bits"));
  subscribe(1, 3);
  EXPECT_EQ(status_of(sent.take_text()), "there is no channel 3; accepted are 1 to 2");
  subscribe(1, 1);
  subscribe(1, 2);
  EXPECT_EQ(status_of(sent.take_text()), "subscription 1 is there already; accepted is another id");
  EXPECT_THAT(binary_refusal(""), HasSubstr("opcode 2"));
  for (std::size_t size = 1; size < 17; ++size) {
    EXPECT_EQ(binary_refusal(call_of(1, "json", "").substr(0, size)), "a binary message ends too early") << size;
  }
  EXPECT_TRUE(calls.empty());
}

TEST_F(FoxgloveSubjectTest, AnswersCallsOnceTheyAreDone) {
  begin();
  subject.receive_binary(1, call_of(1, "json", R"({"value":"none"})"), sent);
  subject.receive_binary(1, call_of(1, "json", "x"), sent);
  ASSERT_EQ(calls.size(), 2);
  EXPECT_EQ(calls[0].words, R"(/choose/law {"value":"none"})");
  subject.beat(sent);
  EXPECT_TRUE(sent.binaries.empty());
  subject.answer(calls[0].number, "");
  subject.answer(calls[1].number, "no such law");
  subject.answer(calls[1].number, "again");
  subject.beat(sent);
  ASSERT_EQ(sent.binaries.size(), 1);
  EXPECT_EQ(sent.binaries[0].content, std::string("\x03\x01\0\0\0\x09\0\0\0\x04\0\0\0json{}", 19));
  const Json failure = sent.take_text();
  EXPECT_EQ(failure["op"], "serviceCallFailure");
  EXPECT_EQ(failure["callId"], 9);
  EXPECT_EQ(failure["message"], "no such law");
  subject.receive_binary(1, call_of(2, "json", ""), sent);
  EXPECT_EQ(sent.take_text()["message"], "there is no service 2; accepted are 1 to 1");
  subject.receive_binary(1, call_of(1, "cdr", ""), sent);
  EXPECT_EQ(sent.take_text()["message"], "encoding is 'cdr'; accepted is json");
}

TEST_F(FoxgloveSubjectTest, CountsWhatFindsItsQueueFull) {
  begin();
  subscribe(7, 1);
  subject.beat(sent);
  for (std::size_t i = 0; i < RecordTap::kCapacity + 5; ++i) tap.on_tick({});
  EXPECT_EQ(tap.dropped(), 5);
  subject.beat(sent);
  EXPECT_EQ(sent.binaries.size(), RecordTap::kCapacity);
}

TEST_F(FoxgloveSubjectTest, TakesRecordsFromTheTickWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  begin();
  subject.beat(sent);
  const record::TickRecord tick;
  const record::ForceRecord force;
  const test::AllocationGuard guard;
  tap.on_tick(tick);
  tap.on_force(force);
  EXPECT_EQ(guard.heap_operations(), 0);
}

}  // namespace
}  // namespace forcebound::live
