#include "forcebound/page/request.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <string>

namespace forcebound::page {
namespace {

using testing::HasSubstr;

std::string refusal(const std::string& text) {
  try {
    (void)read_request(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Request, IsReadByItsKind) {
  EXPECT_EQ(std::get<HandAt>(*read_request(R"({"kind":"hand","point_m":[0.01,-0.02]})")).point_m,
            (std::array{0.01, -0.02, 0.0}));
  EXPECT_TRUE(std::holds_alternative<HandFree>(*read_request(R"({"kind":"hand_free"})")));
  const auto button = std::get<Button>(*read_request(R"({"kind":"button","index":2,"down":true})"));
  EXPECT_EQ(button.index, 2);
  EXPECT_TRUE(button.down);
  const auto law = std::get<Choose>(*read_request(R"({"kind":"choose","setting":"law","value":"none"})"));
  EXPECT_EQ(law.setting, "law");
  EXPECT_EQ(std::get<std::string>(law.value), "none");
  const auto nothing = std::get<Choose>(*read_request(R"({"kind":"choose","setting":"law_beside","value":null})"));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(nothing.value));
  const auto network = std::get<Choose>(*read_request(
      R"({"kind":"choose","setting":"network","value":{"delay_ms":50,"jitter_ms":10,"loss_percent":5}})"));
  EXPECT_EQ(std::get<Network>(network.value), (Network{.delay_ms = 50, .jitter_ms = 10, .loss_percent = 5}));
  EXPECT_TRUE(std::get<Record>(*read_request(R"({"kind":"record","on":true})")).on);
  EXPECT_EQ(std::get<Kick>(*read_request(R"({"kind":"kick","session":18446744073709551615})")).session,
            18446744073709551615ULL);
  EXPECT_EQ(std::get<Seek>(*read_request(R"({"kind":"seek","time_s":3.5})")).time_s, 3.5);
  EXPECT_EQ(std::get<Play>(*read_request(R"({"kind":"play","on":true})")).speed, 1);
}

TEST(Request, OfAnUnknownKindIsPassedOver) { EXPECT_FALSE(read_request(R"({"kind":"dance"})").has_value()); }

TEST(Request, IsRefusedWithTheValueAndWhatWouldBeAccepted) {
  EXPECT_THAT(refusal("hand"), HasSubstr("JSON object"));
  EXPECT_THAT(refusal("[]"), HasSubstr("JSON object"));
  EXPECT_THAT(refusal(R"({"kind":7})"), HasSubstr("kind is 7"));
  EXPECT_THAT(refusal(R"({"kind":"hand","point_m":[1,2,3,4]})"), HasSubstr("1 to 3 numbers"));
  EXPECT_THAT(refusal(R"({"kind":"hand","point_m":["a"]})"), HasSubstr("from -10 to 10"));
  EXPECT_THAT(refusal(R"({"kind":"hand","point_m":[1e300]})"), HasSubstr("from -10 to 10"));
  EXPECT_THAT(refusal(R"({"kind":"button","index":32,"down":true})"), HasSubstr("index is 32"));
  EXPECT_THAT(refusal(R"({"kind":"kick","session":-1})"), HasSubstr("session is -1"));
  EXPECT_THAT(refusal(R"({"kind":"choose","setting":"network","value":{"delay_ms":-1}})"), HasSubstr("delay_ms is -1"));
  EXPECT_THAT(refusal(R"({"kind":"choose","setting":"law","value":[1]})"), HasSubstr("value is [1]"));
  EXPECT_THAT(refusal(R"({"kind":"record","on":"yes"})"), HasSubstr("true or false"));
}

TEST(Request, OfGarbageIsRefusedOrPassedOver) {
  std::mt19937 random(1);
  const std::string valid =
      R"({"kind":"choose","setting":"network","value":{"delay_ms":50,"jitter_ms":1,"loss_percent":5}})";
  for (int i = 0; i < 20000; ++i) {
    std::string text = valid;
    for (int change = 0; change < 3; ++change) text[random() % text.size()] = static_cast<char>(random());
    try {
      (void)read_request(text);
    } catch (const std::invalid_argument&) {
      // As it should be; anything else would end the test.
    }
  }
  EXPECT_THAT(refusal(std::string(4096, '[')), HasSubstr("JSON object"));
}

}  // namespace
}  // namespace forcebound::page
