#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "forcebound/record/recording_writer.hpp"
#include "forcebound/record/summary.hpp"
#include "forcebound/text/file.hpp"
#include "tests/unit/record/sample_run.hpp"

// These run the program itself: its path comes from the build.
namespace forcebound::client::commands {
namespace {

using record::test::TemporaryFile;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Outcome {
  int code;
  std::string out;
};

/// stdout of forcebound, or its stderr.
Outcome forcebound(const std::string& arguments, bool errors = false) {
  const std::string command =
      std::string(FORCEBOUND_PROGRAM) + " " + arguments + (errors ? " 2>&1 >/dev/null" : " 2>/dev/null");
  FILE* pipe = ::popen(command.c_str(), "r");
  Outcome outcome{-1, {}};
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) outcome.out += static_cast<char>(c);
  outcome.code = WEXITSTATUS(::pclose(pipe));
  return outcome;
}

class RecordedReport : public ::testing::Test {
 protected:
  RecordedReport() : live_(record::test::sample_info()) {
    record::RecordingWriter writer(recording_.path(), record::test::sample_info());
    record::test::DirectSink sink(writer);
    record::test::play_sample_run(sink, 3000);
    writer.finish(record::test::sample_totals());
    record::test::play_sample_run(live_, 3000);
    live_.finish(record::test::sample_totals());
  }

  TemporaryFile recording_{"report.mcap"};
  record::Summary live_;
};

TEST_F(RecordedReport, PrintsTheLiveSummaryFromTheRecordingAlone) {
  const Outcome outcome = forcebound("report " + recording_.path().string());
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, StartsWith(live_.to_text() + "  recording     "));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr(" kB, "), HasSubstr(" MB without compression; no files within")));
  EXPECT_EQ(std::ranges::count(outcome.out, '\n'), std::ranges::count(live_.to_text(), '\n') + 1);
}

TEST_F(RecordedReport, WritesTheLiveSummaryAsJson) {
  EXPECT_EQ(forcebound("report --json - " + recording_.path().string()).out, live_.to_json());
  const TemporaryFile json("report.json");
  EXPECT_EQ(forcebound("report --json " + json.path().string() + " " + recording_.path().string()).code, 0);
  std::ifstream in(json.path());
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), live_.to_json());
}

TEST_F(RecordedReport, DrawsItsFigure) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed (gnuplot-nox)";
  const std::filesystem::path directory = recording_.path().string() + ".figures";
  EXPECT_EQ(forcebound("report --figures " + directory.string() + " " + recording_.path().string()).code, 0);
  EXPECT_GT(std::filesystem::file_size(directory / "run.png"), 10'000U);
  const std::string csv = text::read_file((directory / "run.csv").string());
  EXPECT_THAT(csv, StartsWith("time_s,x_mm,"));
  EXPECT_GT(std::ranges::count(csv, '\n'), 2000);
  std::filesystem::remove_all(directory);
}

TEST_F(RecordedReport, SaysOnOneLineWhatIsWrong) {
  const TemporaryFile text("text.mcap");
  std::ofstream(text.path()) << "not a recording at all";
  for (const auto& [arguments, code, what] :
       {std::tuple{"report " + text.path().string(), 1, "text.mcap: byte 0"},
        {std::string("report /nowhere.mcap"), 1, "No such file"},
        {"report --json /dev/full " + recording_.path().string(), 4, "No space left on device"},
        {"report --json " + recording_.path().string() + " " + recording_.path().string(), 2, "is read"},
        {"report --figures /dev/null " + recording_.path().string(), 1, "'/dev/null'"},
        {std::string("report"), 2, "RECORDING is required"},
        {std::string("report --nonsense x"), 2, "--nonsense"},
        {std::string("nonsense"), 2, "nonsense"},
        {std::string(), 2, "a command is required"}}) {
    SCOPED_TRACE(arguments);
    const Outcome outcome = forcebound(arguments, true);
    EXPECT_EQ(outcome.code, code);
    EXPECT_THAT(outcome.out, AllOf(StartsWith("forcebound: "), HasSubstr(what)));
    EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 1) << outcome.out;
  }
}

TEST_F(RecordedReport, AndATableSayThatARecordingIsIncomplete) {
  const std::string whole = text::read_file(recording_.path().string());
  const TemporaryFile part("part.mcap");
  text::write_file(part.path().string(), std::string_view(whole).substr(0, whole.size() - 100));
  for (const char* const command : {"report ", "table "}) {
    EXPECT_EQ(forcebound(command + recording_.path().string(), true).out, "");
    const Outcome outcome = forcebound(command + part.path().string(), true);
    EXPECT_EQ(outcome.code, 0);
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("part.mcap"), HasSubstr(": incomplete: it ends at byte "),
                                   HasSubstr("; shown is what is whole\n")));
  }
}

TEST_F(RecordedReport, NamesTheFilesWithinARecording) {
  const TemporaryFile file("files.mcap");
  record::RecordingWriter writer(file.path(), record::test::sample_info());
  writer.attach({.name = "device.toml", .media_type = "application/toml", .content = std::string(1234, 'x')}, {});
  writer.attach({.name = "law\x1b.toml", .media_type = "application/toml", .content = "[none]\n"}, {});
  writer.write(record::TickRecord{});
  writer.finish({});
  // The row is wrapped where it is too long for a terminal.
  EXPECT_THAT(forcebound("report " + file.path().string()).out,
              ::testing::ContainsRegex(R"(within: device\.toml \(1\.23\s+kB\),\s+law\?\.toml \(7 B\))"));
}

TEST_F(RecordedReport, RefusesTwoRecordingsOfOneSideOrWithoutACommonSession) {
  const TemporaryFile server("server.mcap");
  record::RecordingWriter writer(server.path(), {});
  writer.write(record::MotionRecord{});
  writer.finish({});
  const std::string client = recording_.path().string();
  EXPECT_THAT(forcebound("report " + client + " " + client, true).out, HasSubstr("both are of clients"));
  EXPECT_THAT(forcebound("report " + server.path().string() + " " + server.path().string(), true).out,
              HasSubstr("both are of servers"));
  const Outcome strange = forcebound("report " + client + " " + server.path().string(), true);
  EXPECT_EQ(strange.code, 1);
  EXPECT_THAT(strange.out, HasSubstr("no session in common"));
  EXPECT_EQ(forcebound("report " + client + " " + client + " " + client, true).code, 2);
}

TEST_F(RecordedReport, RefusesAServersRecordingSayingWhatItNeeds) {
  const TemporaryFile file("server.mcap");
  record::RecordingWriter writer(file.path(), {});
  writer.write(record::MotionRecord{});
  writer.finish({});
  const Outcome outcome = forcebound("report " + file.path().string(), true);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("/tick"), HasSubstr("client")));
}

}  // namespace
}  // namespace forcebound::client::commands
