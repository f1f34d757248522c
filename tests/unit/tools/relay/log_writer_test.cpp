#include "tests/tools/relay/log_writer.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <stdexcept>

namespace forcebound::relay {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

std::string content(const std::filesystem::path& file) {
  std::ifstream text(file);
  return {std::istreambuf_iterator<char>(text), {}};
}

TEST(LogWriter, WritesEveryRowByItsEnd) {
  const auto file = std::filesystem::path(testing::TempDir()) / "forcebound-log-writer-test.csv";
  constexpr std::uint64_t kPackets = 10'000;
  LogWriter writer(file.string(), 0s);
  for (std::uint64_t number = 1; number <= kPackets; ++number) {
    const netem::Verdict verdict{.number = number, .arrival = 1ms, .delay = 2ms};
    writer.on_verdict(Direction::up, verdict);
    writer.on_departure(Direction::up, verdict);
  }
  const LogResult result = writer.finish();
  EXPECT_EQ(result.written, kPackets);
  EXPECT_EQ(result.missing, 0U);
  EXPECT_EQ(result.problem, "");
  const std::string text = content(file);
  EXPECT_THAT(text, StartsWith("direction,number,time_ms,verdict,delay_ms\nup,1,1.000000,forwarded,2.000000\n"));
  EXPECT_EQ(static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n')), kPackets + 1);
  std::filesystem::remove(file);
}

TEST(LogWriter, SaysWhatIsMissingWhenTheDiskIsFull) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  LogWriter writer("/dev/full", 0s);
  for (std::uint64_t number = 1; number <= 100; ++number)
    writer.on_verdict(Direction::up, {.number = number, .fate = netem::Fate::lost});
  const LogResult result = writer.finish();
  EXPECT_EQ(result.written, 0U);
  EXPECT_EQ(result.missing, 100U);
  EXPECT_THAT(result.problem, HasSubstr("No space left"));
}

TEST(LogWriter, RefusesAFileItCannotCreate) {
  EXPECT_THAT([] { LogWriter("/nonexistent/log.csv", 0s); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr("/nonexistent/log.csv: cannot write the log"), HasSubstr("No such file"))));
}

TEST(LogWriter, InAFloodEveryRowIsWrittenOrCountedAsMissing) {
  const auto file = std::filesystem::path(testing::TempDir()) / "forcebound-log-writer-full-test.csv";
  LogWriter writer(file.string(), 0s);
  constexpr std::uint64_t kFlood = 2'000'000;
  for (std::uint64_t number = 1; number <= kFlood; ++number)
    writer.on_verdict(Direction::up, {.number = number, .fate = netem::Fate::lost});
  const LogResult result = writer.finish();
  EXPECT_EQ(result.written + result.missing, kFlood);
  EXPECT_EQ(result.problem, result.missing == 0 ? "" : "the disk was slower than the network");
  std::filesystem::remove(file);
}

TEST(LogWriter, TellsOfAFullDiskAtOnce) {
  std::promise<std::string> told;
  LogWriter writer("/dev/full", 0s, [&](const std::string& why) { told.set_value(why); });
  std::future<std::string> why = told.get_future();
  writer.on_verdict(Direction::up, {.number = 1, .arrival = 1ms, .delay = 2ms});
  ASSERT_EQ(why.wait_for(20s), std::future_status::ready) << "its end would be too late";
  EXPECT_EQ(why.get(), "No space left on device");
  EXPECT_EQ(writer.finish().missing, 1U);
}

}  // namespace
}  // namespace forcebound::relay
