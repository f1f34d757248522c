#include "forcebound/program/log.hpp"

#include <gmock/gmock.h>
#include <spdlog/spdlog.h>

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

}  // namespace
}  // namespace forcebound::program
