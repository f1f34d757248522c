#include "forcebound/program/log.hpp"

#include <gmock/gmock.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <string>

namespace forcebound::program {
namespace {

TEST(Log, ShowsWordsOfOthersInOneLineWithoutControlCharacters) {
  testing::internal::CaptureStderr();
  log_to_stderr("example");
  spdlog::info("device '{}'", "\x1b[2J\nexample info: forged");
  spdlog::default_logger()->flush();
  const std::string line = testing::internal::GetCapturedStderr();
  EXPECT_THAT(line, testing::EndsWith("example info: device '?[2J?example info: forged'\n"));
  EXPECT_THAT(line, testing::MatchesRegex("[0-9]+:[0-9]+:[0-9]+\\.[0-9]+ [^\n]*\n"));
}

/// What a logger of that name writes as JSON for one warning.
std::string json_of_warning(const std::string& program, const std::string& text) {
  testing::internal::CaptureStderr();
  set_logs_json(true);
  log_to_stderr(program);
  spdlog::warn("{}", text);
  spdlog::default_logger()->flush();
  set_logs_json(false);
  return testing::internal::GetCapturedStderr();
}

TEST(Log, IsALineOfJsonForEachEventIfAskedFor) {
  const std::string output = json_of_warning("json-example", "a \"word\" of \xff\n\x1b others");
  EXPECT_EQ(output.find('\n'), output.size() - 1);
  const auto line = nlohmann::json::parse(output);
  EXPECT_EQ(line["level"], "warning");
  EXPECT_EQ(line["program"], "json-example");
  EXPECT_EQ(line["version"], FORCEBOUND_VERSION);
  EXPECT_EQ(line["pid"], getpid());
  EXPECT_THAT(line["text"].get<std::string>(), testing::StartsWith("a \"word\" of "));
  EXPECT_THAT(line["text"].get<std::string>(), testing::EndsWith("?? others"));
  EXPECT_THAT(line["time"].get<std::string>(),
              testing::MatchesRegex("20[0-9][0-9]-[0-9]+-[0-9]+T[0-9]+:[0-9]+:[0-9]+\\.[0-9]+Z"));
  EXPECT_EQ(line.size(), 6U);
}

TEST(Log, TellsAListenerEachLineWhileItIsThere) {
  using Line = std::pair<std::string, std::string>;
  std::vector<Line> heard;
  testing::internal::CaptureStderr();
  log_to_stderr("listened");
  {
    const LogListener listener(
        [&heard](const std::string& level, const std::string& text) { heard.emplace_back(level, text); });
    spdlog::info("one\ntwo");
    spdlog::error("three");
  }
  spdlog::warn("nobody listens");
  spdlog::default_logger()->flush();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), testing::HasSubstr("nobody listens"));
  EXPECT_THAT(heard, testing::ElementsAre(Line("info", "one?two"), Line("error", "three")));
}

TEST(Log, WritesItsTimeInUtc) {
  const auto line = nlohmann::json::parse(json_line("example", "info", "text", 1'795'514'052'000'007));
  EXPECT_EQ(line["time"], "2026-11-24T09:54:12.000007Z");
}

}  // namespace
}  // namespace forcebound::program
