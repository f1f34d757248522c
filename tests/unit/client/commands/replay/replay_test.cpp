#include "forcebound/client/commands/replay/replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>
#include <streambuf>

#include "forcebound/client/commands/replay/csv_reader.hpp"
#include "tests/support/random_ticks.hpp"

namespace forcebound::client::commands {
namespace {

using test::ReferenceAnswer;
using test::ReferenceTick;
using testing::HasSubstr;
using testing::StartsWith;
using testing::StrEq;
using testing::ThrowsMessage;

ReplayOptions wall_options() {
  ReplayOptions options;
  options.law = "fba-less";
  options.damping_N_s_per_m = {30};
  return options;
}

/// B = b/T = 2^10 N/m, exactly: 2^-10 m saves 2^-10 J, of which sqrt(4 E B) = 2 N can be spent.
ReplayOptions exact_options() {
  ReplayOptions options = wall_options();
  options.damping_N_s_per_m = {16};
  options.period_s = 0.015625;
  return options;
}

std::string answers(const ReplayOptions& options, const std::string& rows) {
  std::istringstream input(rows);
  std::ostringstream output;
  replay(options, {input, "rows.csv"}, output);
  return output.str();
}

std::string refusal(const ReplayOptions& options, const std::string& rows) {
  try {
    answers(options, rows);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

class NoServerSideLaw final : public control::ServerSideLaw {
 public:
  control::Vector place(const Received& received) noexcept override { return received.position; }
  Reply answer(const control::Vector& force_N) noexcept override { return {force_N, {}}; }
};

TEST(Replay, RefusesALawThatHasAServerSideLaw) {
  ReplayOptions options = wall_options();
  options.law = "split";
  options.laws.add({.name = "split",
                    .summary = "needs a server",
                    .make = options.laws.find("none").make,
                    .make_server_side = [](int) { return std::make_unique<NoServerSideLaw>(); }});
  EXPECT_EQ(refusal(options, "time_s,x0_m,fe0_N\n0,0,0\n"),
            "--law: law 'split' has a server-side law, and rows have no server: it cannot be replayed");
}

TEST(Replay, HandsParametersToTheLaw) {
  ReplayOptions options = wall_options();
  options.law = "sfa";
  options.law_options.parameters = {{"feedback_share", 0.5}};
  EXPECT_THAT(answers(options, "time_s,x0_m,fe0_N\n0,0,0\n0.001,0.0001,-15\n"), HasSubstr("\n0.001,-1.5000"));
}

std::string number(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.17g", value);
  return text.data();
}

std::string as_csv(const std::vector<ReferenceTick>& ticks) {
  const std::size_t axes = ticks.front().position_m.size();
  std::string text = "time_s";
  for (std::size_t i = 0; i < axes; ++i) text += ",x" + std::to_string(i) + "_m";
  for (std::size_t i = 0; i < axes; ++i) text += ",fe" + std::to_string(i) + "_N";
  for (std::size_t n = 0; n < ticks.size(); ++n) {
    text += "\n" + number(static_cast<double>(n) * 1e-3);
    for (const double x : ticks[n].position_m) text += "," + number(x);
    for (const double f : ticks[n].request_N) text += "," + number(f);
  }
  return text + "\n";
}

std::vector<std::vector<double>> numbers_of(const std::string& csv) {
  std::istringstream text(csv);
  CsvReader reader(text, "answers");
  const auto columns = reader.header();
  std::vector<std::vector<double>> rows;
  for (auto row = reader.row(columns); !row.empty(); row = reader.row(columns)) rows.push_back(row);
  return rows;
}

void expect_relative(double actual, double expected) {
  ASSERT_LE(std::abs(actual - expected), 1e-9 * std::abs(expected)) << actual << ", not " << expected;
}

class ReplayOfRandomRuns : public testing::TestWithParam<int> {};

TEST_P(ReplayOfRandomRuns, AgreesWithTheReferenceThroughText) {
  const auto ticks =
      test::random_ticks({.seed = 21, .degrees_of_freedom = GetParam(), .ticks = 1500, .motion_m = 1e-4});
  ReplayOptions options;
  options.damping_matrix = ticks.front().damping_N_s_per_m;
  options.force_N_max = 15;
  for (const bool more : {false, true}) {
    options.law = more ? "fba-more" : "fba-less";
    SCOPED_TRACE(options.law);
    const std::vector<ReferenceAnswer> expected =
        more ? more_conservative_reference(ticks, {1e-3, 15}) : less_conservative_reference(ticks, {1e-3, 15});
    const auto rows = numbers_of(answers(options, as_csv(ticks)));
    ASSERT_EQ(rows.size(), ticks.size());
    for (std::size_t n = 0; n < rows.size(); ++n) {
      SCOPED_TRACE(testing::Message() << "row " << n);
      const std::size_t axes = ticks.front().position_m.size();
      ASSERT_EQ(rows[n].size(), axes + 3);
      ASSERT_EQ(rows[n][0], static_cast<double>(n) * 1e-3);
      for (std::size_t i = 0; i < axes; ++i) expect_relative(rows[n][1 + i], expected[n].force_N[i]);
      expect_relative(rows[n][axes + 1], expected[n].energy_J);
      expect_relative(rows[n][axes + 2], expected[n].xi);
      if (HasFatalFailure()) return;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(DegreesOfFreedom, ReplayOfRandomRuns, testing::Values(1, 2, 3, 4, 5, 6));

TEST(Replay, AnswersWithAHeaderAndSeventeenDigits) {
  EXPECT_EQ(answers(exact_options(), "time_s,x0_m,fe0_N\n0,0,-9\n0.1,9.765625e-4,-9\n"),
            "time_s,f0_N,energy_J,xi\n"
            "0,0,0,1\n"
            "0.10000000000000001,-2,0.0009765625,1\n");
}

TEST(Replay, NamesAColumnForEachAxis) {
  ReplayOptions options = wall_options();
  EXPECT_EQ(answers(options, "time_s,x0_m,x1_m,x2_m,fe0_N,fe1_N,fe2_N\n"), "time_s,f0_N,f1_N,f2_N,energy_J,xi\n");
}

TEST(Replay, UsesOneDampingForAllAxesOrOneForEach) {
  const std::string rows = "time_s,x0_m,x1_m,fe0_N,fe1_N\n0,0,0,0,0\n0.001,1e-4,2e-4,0,0\n";
  ReplayOptions options = wall_options();
  const double both_J = numbers_of(answers(options, rows))[1][3];
  options.damping_N_s_per_m = {30, 30};
  EXPECT_EQ(numbers_of(answers(options, rows))[1][3], both_J);
  options.damping_N_s_per_m = {30, 60};
  EXPECT_NEAR(numbers_of(answers(options, rows))[1][3], 30e3 * 1e-8 + 60e3 * 4e-8, 1e-15);
  options.damping_matrix = {{30, 10}, {10, 60}};
  EXPECT_NEAR(numbers_of(answers(options, rows))[1][3], 30e3 * 1e-8 + 60e3 * 4e-8 + 2 * 10e3 * 2e-8, 1e-15);
}

TEST(Replay, SaturatesAlongTheRequestBeforeTheLaw) {
  ReplayOptions options = wall_options();
  options.law = "none";
  options.force_N_max = 5;
  EXPECT_EQ(answers(options, "time_s,x0_m,x1_m,fe0_N,fe1_N\n0,0,0,6,-8\n"),
            "time_s,f0_N,f1_N,energy_J,xi\n0,3,-4,0,1\n");
}

TEST(Replay, IgnoresOptionsThatALawHasNoUseFor) {
  const auto ticks = test::random_ticks({.seed = 5, .degrees_of_freedom = 2, .ticks = 300});
  ReplayOptions plain = wall_options();
  ReplayOptions full = plain;
  full.encoder_step_m = {15e-6, 55e-6};
  full.friction_N = {0.1};
  full.hold_s = 5e-3;
  full.latency_s = 1e-4;
  full.law_options.memory = control::EnergyMemory::full;
  for (const char* law : {"none", "fba-less", "fba-more"}) {
    plain.law = full.law = law;
    EXPECT_EQ(answers(plain, as_csv(ticks)), answers(full, as_csv(ticks))) << law;
  }
}

TEST(Replay, OfTheExactLawIsTheLessConservativeOneOnAnIdealDevice) {
  const auto ticks = test::random_ticks({.seed = 8, .degrees_of_freedom = 3, .ticks = 500, .motion_m = 1e-4});
  ReplayOptions options = wall_options();
  options.law_options.memory = control::EnergyMemory::full;
  options.law = "fba-less";
  const auto expected = numbers_of(answers(options, as_csv(ticks)));
  options.law = "fba-exact";
  const auto rows = numbers_of(answers(options, as_csv(ticks)));
  ASSERT_EQ(rows.size(), expected.size());
  for (std::size_t n = 0; n < rows.size(); ++n) {
    for (std::size_t k = 1; k < rows[n].size(); ++k) ASSERT_NEAR(rows[n][k], expected[n][k], 1e-9) << "row " << n;
  }
}

TEST(Replay, OfTheExactLawKnowsFrictionAndEncoder) {
  ReplayOptions options = wall_options();
  options.law = "fba-exact";
  options.friction_N = {0.75};
  options.encoder_step_m = {15e-6};
  // One count back and forth is no motion, and friction holds exactly that much.
  const auto rows = numbers_of(answers(options, "time_s,x0_m,fe0_N\n0,0,-9\n1e-3,15e-6,-9\n2e-3,0,-9\n3e-3,15e-6,9\n"));
  for (const auto& row : rows) {
    EXPECT_EQ(std::abs(row[1]), 0.75);
    EXPECT_LE(row[2], 1e-15);
  }
}

TEST(Replay, OfTheExactLawLetsGoAfterTheHoldTimeThatIsGiven) {
  const std::string rows = "time_s,x0_m,fe0_N\n0,0,0\n1e-3,1e-3,-2\n4e-3,1e-3,0\n";
  ReplayOptions options = wall_options();
  options.law = "fba-exact";
  const double earned_J = 30 / 1e-3 * 1e-6;
  EXPECT_NEAR(numbers_of(answers(options, rows))[2][2], earned_J, 1e-12) << "held to the end, at rest on the whole";
  options.hold_s = 2e-3;
  // With the force for 2 ms and back in 1 ms: z = f/(2 b (1/2 ms + 1/1 ms)).
  const double taken_J = 4 / (4 * 30 * (1 / 2e-3 + 1 / 1e-3));
  EXPECT_NEAR(numbers_of(answers(options, rows))[2][2], earned_J - taken_J, 1e-12);
}

TEST(Replay, AcceptsWindowsLineEndsAndBlankLinesAtTheEnd) {
  const std::string unix_rows = "time_s,x0_m,fe0_N\n0,0,-9\n1.0E-3,1e-4,-9\n";
  const std::string windows_rows = "time_s, x0_m, fe0_N\r\n0,0,-9\r\n1.0E-3, 1e-4, -9\r\n\r\n\r\n";
  EXPECT_EQ(answers(wall_options(), windows_rows), answers(wall_options(), unix_rows));
}

/// Hands out one row at a time and notes how much had been answered, and flushed, when each was asked for.
class RowByRow : public std::streambuf {
 public:
  RowByRow(std::vector<std::string> rows, const std::string& flushed) : rows_(std::move(rows)), flushed_(flushed) {}

  [[nodiscard]] const std::vector<std::string>& answered_before() const { return answered_before_; }

 protected:
  int_type underflow() override {
    answered_before_.push_back(flushed_);
    if (next_ == rows_.size()) return traits_type::eof();
    std::string& row = rows_[next_++];
    setg(row.data(), row.data(), row.data() + row.size());
    return traits_type::to_int_type(row.front());
  }

 private:
  std::vector<std::string> rows_;
  std::size_t next_ = 0;
  const std::string& flushed_;
  std::vector<std::string> answered_before_;
};

/// The text that its reader has received: only what was flushed.
class FlushedText : public std::stringbuf {
 public:
  [[nodiscard]] const std::string& text() const { return text_; }

 protected:
  int sync() override {
    text_ = str();
    return 0;
  }

 private:
  std::string text_;
};

TEST(Replay, AnswersEachRowBeforeItAsksForTheNext) {
  FlushedText flushed;
  RowByRow rows({"time_s,x0_m,fe0_N\n", "0,0,-9\n", "0.5,9.765625e-4,-9\n"}, flushed.text());
  std::istream input(&rows);
  std::ostream output(&flushed);
  replay(exact_options(), {input, "<stdin>"}, output);
  const std::string header = "time_s,f0_N,energy_J,xi\n";
  EXPECT_THAT(rows.answered_before(),
              testing::ElementsAre("", header, header + "0,0,0,1\n", header + "0,0,0,1\n0.5,-2,0.0009765625,1\n"));
}

TEST(Replay, TakesARequestThatIsNotFiniteForNoForceAndCountsIt) {
  std::istringstream input("time_s,x0_m,fe0_N\n0,0,0\n0.001,1e-3,nan\n0.002,2e-3,-inf\n0.003,2e-3,1\n");
  std::ostringstream output;
  const ReplayCounts counts = replay(wall_options(), {input, "rows.csv"}, output);
  EXPECT_EQ(counts.rows, 4U);
  EXPECT_EQ(counts.requests_not_finite, 2U);
  EXPECT_EQ(counts.readings_not_finite, 0U);
  const auto rows = numbers_of(output.str());
  EXPECT_EQ(rows[1][1], 0.0);
  EXPECT_EQ(rows[2][1], 0.0);
  EXPECT_EQ(rows[3][1], 1.0);
}

TEST(Replay, TakesAPositionThatIsNotFiniteForALostReadingAndCountsIt) {
  std::istringstream input("time_s,x0_m,fe0_N\n0,0,0\n0.001,1e-3,20\n0.002,nan,20\n0.003,2e-3,20\n");
  std::ostringstream output;
  const ReplayCounts counts = replay(wall_options(), {input, "rows.csv"}, output);
  EXPECT_EQ(counts.readings_not_finite, 1U);
  const auto rows = numbers_of(output.str());
  EXPECT_EQ(rows[1][1], 20.0);
  EXPECT_EQ(rows[2][1], 0.0);
  EXPECT_NEAR(rows[2][2], 0.03 - 400 / 120e3, 1e-15);
  EXPECT_EQ(rows[3][1], 20.0);
}

TEST(Replay, CreditsNothingForARowAtTheTimeOfTheOneBeforeAndCountsIt) {
  for (const char* law : {"none", "fba-less", "fba-more", "fba-exact"}) {
    SCOPED_TRACE(law);
    std::istringstream input("time_s,x0_m,fe0_N\n0,0,0\n0.001,1e-3,0\n0.001,5,0\n1e308,9,0\n");
    std::ostringstream output;
    ReplayOptions options = wall_options();
    options.law = law;
    const ReplayCounts counts = replay(options, {input, "rows.csv"}, output);
    EXPECT_EQ(counts.intervals_impossible, 2U);
    const auto rows = numbers_of(output.str());
    EXPECT_NEAR(rows[1][2], 0.03, 1e-12);
    EXPECT_LE(rows[2][2], rows[1][2]);
    EXPECT_LE(rows[3][2], rows[2][2]);
  }
}

TEST(Replay, RefusesAHeaderItDoesNotKnow) {
  for (const char* header :
       {"time,x0_m,fe0_N", "time_s,x0_m", "time_s,x0_m,x1_m,fe0_N", "time_s,x1_m,fe1_N", "time_s,fe0_N,x0_m", "0,0,0",
        "time_s,x0_m,fe0_N,", "time_s,x0_m,x1_m,x2_m,x3_m,x4_m,x5_m,x6_m,fe0_N,fe1_N,fe2_N,fe3_N,fe4_N,fe5_N,fe6_N"}) {
    EXPECT_THAT(refusal(wall_options(), std::string(header) + "\n0,0,0\n"),
                HasSubstr("rows.csv:1: expected the header time_s,x0_m[,x1_m..],fe0_N[,fe1_N..]"))
        << header;
  }
}

TEST(Replay, ShowsAnEmptyFirstColumnOfTheHeaderAndWhatMakesIt) {
  EXPECT_THAT(refusal(wall_options(), ",time_s,x0_m,fe0_N\n0,0,0,0\n"),
              HasSubstr("got ',time_s,x0_m,fe0_N', whose first column has no name (pandas: to_csv(index=False))"));
}

TEST(Replay, KnowsThePaceOfItsRowsSoThatOtherUnitsAreSaid) {
  const auto doubt = [](const char* rows) {
    std::istringstream input(std::string("time_s,x0_m,fe0_N\n") + rows);
    std::ostringstream output;
    ReplayOptions options = wall_options();
    options.period_s = 1e-3;
    return replay(options, {input, "rows.csv"}, output).pace.doubt_of_units();
  };
  EXPECT_EQ(doubt("0,0,0\n0.001,1e-3,0\n0.002,2e-3,0\n"), "");
  EXPECT_EQ(doubt("0,0,0\n0.001,4e-3,0\n0.002,5e-3,0\n"), "moves at up to 4 m/s: are its positions in mm?");
  EXPECT_EQ(doubt("0,0,0\n1,1e-3,0\n2,2e-3,0\n"),
            "has rows 1 s apart, 1000 times the period of 0.001 s: are its times in ms?");
  EXPECT_EQ(doubt("0,0,0\n1e-6,0,0\n2e-6,0,0\n"),
            "has rows 1e-06 s apart, 0.001 times the period of 0.001 s: are its times in 1000 s, or is the period in "
            "ms?");
  EXPECT_EQ(doubt("0,0,0\n"), "");
  EXPECT_EQ(doubt("0,0,0\n0.001,0,0\n0.002,0,0\n600,0,0\n"), "") << "one long pause";
}

TEST(Replay, RefusesAMalformedRowByFileAndLine) {
  const std::string good = "time_s,x0_m,fe0_N\n0,0,0\n";
  EXPECT_THAT(refusal(wall_options(), good + "0.001,1,\n"), HasSubstr("rows.csv:3: fe0_N: '' is not a number"));
  EXPECT_THAT(refusal(wall_options(), good + "0.001,1x,0\n"), HasSubstr("rows.csv:3: x0_m: '1x' is not a number"));
  EXPECT_THAT(refusal(wall_options(), good + "0.001,1\n"), HasSubstr("rows.csv:3: expected 3 numbers, got 2"));
  EXPECT_THAT(refusal(wall_options(), good + "0.001,1,2,3\n"), HasSubstr("rows.csv:3: expected 3 numbers, got 4"));
  EXPECT_THAT(refusal(wall_options(), good + "nan,1,2\n"), HasSubstr("rows.csv:3: time_s must be finite"));
}

TEST(Replay, RefusesTimeThatRunsBackwards) {
  const std::string rows = "time_s,x0_m,fe0_N\n0.5,0,0\n0.5,0,0\n0.25,0,0\n";
  EXPECT_EQ(refusal(wall_options(), rows), "rows.csv:4: time_s runs backwards: 0.25 after 0.5; it must stay or grow");
}

TEST(Replay, RefusesInvalidOptions) {
  const std::string rows = "time_s,x0_m,x1_m,fe0_N,fe1_N\n";
  const auto with = [&](const auto& change) {
    ReplayOptions options = wall_options();
    change(options);
    EXPECT_THROW(answers(options, rows), std::invalid_argument) << "not an error of use";
    return refusal(options, rows);
  };
  EXPECT_THAT(with([](auto& o) { o.law = "fba-exactly"; }),
              StartsWith("--law: unknown law 'fba-exactly' (known: none, fba-less, fba-more, fba-exact"));
  EXPECT_EQ(with([](auto& o) { o.damping_N_s_per_m = {}; }), "--damping or --damping-matrix must be given");
  EXPECT_EQ(with([](auto& o) {
              o.damping_N_s_per_m = {1, 2, 3};
            }),
            "--damping has 3 values, but the input has 2 axes: give one for all or one for each");
  EXPECT_THAT(with([](auto& o) { o.damping_N_s_per_m = {0}; }), HasSubstr("--damping: damping must be symmetric"));
  EXPECT_THAT(with([](auto& o) {
                o.damping_matrix = {{1, 2}, {2, 1}};
              }),
              HasSubstr("--damping-matrix: damping must be symmetric, positive definite"));
  EXPECT_EQ(with([](auto& o) { o.damping_matrix.emplace(1, std::vector<double>{1.0}); }),
            "--damping-matrix has 1 rows, but the input has 2 axes");
  EXPECT_EQ(with([](auto& o) {
              o.damping_matrix = {{1, 0}, {0}};
            }),
            "--damping-matrix: row 2 must have 2 numbers, got 1");
  EXPECT_EQ(with([](auto& o) { o.period_s = 0; }), "--period must be > 0 s, got 0");
  EXPECT_EQ(with([](auto& o) { o.hold_s = -1; }), "--hold must be > 0 s, got -1");
  EXPECT_EQ(with([](auto& o) { o.latency_s = -1; }), "--latency must be >= 0 s, got -1");
  EXPECT_EQ(with([](auto& o) { o.force_N_max = -1; }), "--force-max must be >= 0 N, got -1");
  EXPECT_EQ(with([](auto& o) { o.encoder_step_m = {-1}; }), "--encoder must be >= 0 m, got -1");
  EXPECT_EQ(with([](auto& o) { o.friction_N = {0, std::nan("")}; }), "--friction must be >= 0 N, got nan");
  EXPECT_EQ(with([](auto& o) {
              o.friction_N = {0, 0, 0};
            }),
            "--friction has 3 values, but the input has 2 axes: give one for all or one for each");
}

TEST(Replay, SaysSoWhenTheAnswerCannotBeWritten) {
  std::istringstream input("time_s,x0_m,fe0_N\n0,0,0\n");
  std::ostream nowhere(nullptr);
  EXPECT_THAT(
      [&] {
        replay(wall_options(), {input, "rows.csv"}, nowhere);
      },
      ThrowsMessage<std::runtime_error>(StrEq("the answer cannot be written")));
}

}  // namespace
}  // namespace forcebound::client::commands
