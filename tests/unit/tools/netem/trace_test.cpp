#include "tests/tools/netem/trace.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::netem {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

NetworkTrace read(const std::string& text) {
  std::istringstream stream(text);
  return read_trace(stream, "t.csv");
}

RttTrace read_rtt(const std::string& text) { return std::get<RttTrace>(read(text)); }

TEST(RttTrace, HalfOfTheRoundTripAppliesEachWay) {
  EXPECT_EQ(read_rtt("send_time_ms,rtt_ms\n0,53\n55,21\n").one_way_delay(0ms), 26500us);
}

TEST(RttTrace, IsInterpolatedBetweenRows) {
  const RttTrace trace = read_rtt("send_time_ms,rtt_ms\n0,50\n100,20\n200,40\n");
  EXPECT_EQ(trace.one_way_delay(50ms), 17500us);
  EXPECT_EQ(trace.one_way_delay(100ms), 10ms);
  EXPECT_EQ(trace.one_way_delay(150ms), 15ms);
}

TEST(RttTrace, HoleOfMoreThanASecondIsABlackout) {
  const RttTrace trace = read_rtt("send_time_ms,rtt_ms\n0,20\n1001,20\n2001,40\n");
  EXPECT_EQ(trace.one_way_delay(0ms), 10ms);
  EXPECT_EQ(trace.one_way_delay(1ns), std::nullopt);
  EXPECT_EQ(trace.one_way_delay(1001ms - 1ns), std::nullopt);
  EXPECT_EQ(trace.one_way_delay(1001ms), 10ms);
  EXPECT_EQ(trace.one_way_delay(1501ms), 15ms);  // a hole of exactly one second is none
}

TEST(RttTrace, StartsOverAfterItsLastRow) {
  const RttTrace trace = read_rtt("send_time_ms,rtt_ms\n1000,20\n1100,40\n1200,60\n");
  EXPECT_EQ(trace.duration(), 200ms);
  EXPECT_EQ(trace.one_way_delay(200ms), 10ms);
  EXPECT_EQ(trace.one_way_delay(200ms * 1'000'000 + 50ms), 15ms);
}

TEST(RttTrace, OneRowIsAConstant) { EXPECT_EQ(read_rtt("send_time_ms,rtt_ms\n7,20\n").one_way_delay(12345s), 10ms); }

TEST(RttTrace, RefusesSamplesThatMakeNoTrace) {
  EXPECT_THROW(RttTrace({}), std::invalid_argument);
  EXPECT_THROW(RttTrace({{1s, 1ms}, {0s, 1ms}}), std::invalid_argument);
  EXPECT_THROW(RttTrace({{1s, -1ms}}), std::invalid_argument);
}

TEST(DeliveryTrace, RefusesOpportunitiesThatMakeNoSchedule) {
  EXPECT_THROW(DeliveryTrace({}), std::invalid_argument);
  EXPECT_THROW(DeliveryTrace({0ms}), std::invalid_argument);
  EXPECT_THROW(DeliveryTrace({2ms, 1ms}), std::invalid_argument);
  EXPECT_THROW(DeliveryTrace({-1ms, 1ms}), std::invalid_argument);
}

TEST(TraceFile, ReadsWindowsLineEndsBlankLinesAndFractions) {
  const RttTrace trace = read_rtt("send_time_ms,rtt_ms\r\n0,20.5\r\n\r\n0.5,20.5\r\n");
  EXPECT_EQ(trace.one_way_delay(0ms), 10250us);
  EXPECT_EQ(trace.duration(), 500us);
}

TEST(TraceFile, ReadsMahimahi) {
  const auto trace = std::get<DeliveryTrace>(read("0\n5\n5\n12\n"));
  EXPECT_THAT(trace.opportunities(), ElementsAre(0ms, 5ms, 5ms, 12ms));
  EXPECT_EQ(trace.period(), 12ms);
}

struct Malformed {
  const char* text;
  const char* where;
  const char* what;
};
void PrintTo(const Malformed& malformed, std::ostream* out) { *out << malformed.what; }

class TraceFileRefuses : public testing::TestWithParam<Malformed> {};

TEST_P(TraceFileRefuses, NamingFileAndLineAndWhatWouldBeAccepted) {
  EXPECT_THAT([] { read(GetParam().text); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(StartsWith(GetParam().where), HasSubstr(GetParam().what), HasSubstr("expected"))));
}

INSTANTIATE_TEST_SUITE_P(Csv, TraceFileRefuses,
                         testing::Values(Malformed{"send_time_ms,rtt_ms\n0,20\n55\n", "t.csv:3: ", "'55'"},
                                         Malformed{"send_time_ms,rtt_ms\n0,20,3\n", "t.csv:2: ", "'0,20,3'"},
                                         Malformed{"send_time_ms,rtt_ms\n0,-20\n", "t.csv:2: ", "'0,-20'"},
                                         Malformed{"send_time_ms,rtt_ms\n0,nan\n", "t.csv:2: ", "'0,nan'"},
                                         Malformed{"send_time_ms,rtt_ms\n0,1e300\n", "t.csv:2: ", "'0,1e300'"},
                                         Malformed{"send_time_ms,rtt_ms\n,\n", "t.csv:2: ", "','"},
                                         Malformed{"send_time_ms,rtt_ms\n10,20\n9,20\n",
                                                   "t.csv:3: ", "'9,20' was sent before"},
                                         Malformed{"send_time_ms,rtt_ms\n", "t.csv:1: ", "no rows"}));

INSTANTIATE_TEST_SUITE_P(
    Mahimahi, TraceFileRefuses,
    testing::Values(Malformed{"", "t.csv:1: ", "empty"}, Malformed{"1\ntwo\n", "t.csv:2: ", "'two'"},
                    Malformed{"time,rtt\n1,2\n", "t.csv:1: ", "send_time_ms,rtt_ms"},
                    Malformed{"1.5\n", "t.csv:1: ", "'1.5'"}, Malformed{"-1\n", "t.csv:1: ", "'-1'"},
                    Malformed{"5\n4\n", "t.csv:2: ", "'4' is before"}, Malformed{"0\n0\n", "t.csv:2: ", "ends at 0"},
                    Malformed{"\n\n", "t.csv:2: ", "ends at 0"}));

TEST(TraceFile, SaysWhichFileCannotBeRead) {
  EXPECT_THAT(
      [] { load_trace("/nonexistent/trace.csv"); },
      ThrowsMessage<std::runtime_error>(AllOf(StartsWith("/nonexistent/trace.csv: "), HasSubstr("No such file"))));
  EXPECT_THAT([] { load_trace("/"); }, ThrowsMessage<std::runtime_error>(HasSubstr("it is a directory")));
}

Nanoseconds longest_delay(const RttTrace& trace) {
  Nanoseconds longest{0};
  for (Nanoseconds t{0}; t < trace.duration(); t += 1ms)
    longest = std::max(longest, trace.one_way_delay(t).value_or(0ns));
  return longest;
}

TEST(TraceFile, RuralTraceReachesTwelveSeconds) {
  const auto file = recorded_data("network/5g-rural-n8.csv");
  if (!file) GTEST_SKIP() << "no trace 5g-rural-n8.csv; set FORCEBOUND_DATA";
  const auto trace = std::get<RttTrace>(load_trace(*file));
  EXPECT_EQ(trace.one_way_delay(0ms), 26500us);
  EXPECT_EQ(longest_delay(trace), 6033ms);
}

TEST(TraceFile, UrbanTraceHasItsBlackouts) {
  const auto file = recorded_data("network/5g-urban-n8.csv");
  if (!file) GTEST_SKIP() << "no trace 5g-urban-n8.csv; set FORCEBOUND_DATA";
  const auto trace = std::get<RttTrace>(load_trace(*file));
  EXPECT_EQ(trace.one_way_delay(81651ms).has_value(), true);
  EXPECT_EQ(trace.one_way_delay(81652ms), std::nullopt);
  EXPECT_EQ(trace.one_way_delay(104095ms), std::nullopt);
  EXPECT_EQ(trace.one_way_delay(104096ms).has_value(), true);
  EXPECT_LT(longest_delay(trace), 1s);
}

}  // namespace
}  // namespace forcebound::netem
