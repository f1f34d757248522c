#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "forcebound/results/draw.hpp"
#include "forcebound/results/figure_scripts.hpp"
#include "forcebound/results/laws_figure.hpp"
#include "forcebound/results/run_figure.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/lines.hpp"
#include "tests/support/source_folder.hpp"
#include "tests/tools/lab/accuracy/study_figure.hpp"
#include "tests/tools/lab/bench/results.hpp"
#include "tests/tools/lab/comparison/comparison_figure.hpp"
#include "tests/tools/lab/figures/figure_scripts.hpp"
#include "tests/tools/lab/passivity.hpp"
#include "tests/tools/lab/rendering/rendering_results.hpp"
#include "tests/tools/temporary_folder.hpp"
#include "tests/unit/record/sample_run.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;
using test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

bool has_gnuplot() { return std::system("gnuplot --version > /dev/null 2>&1") == 0; }

Json committed(const std::string& file) {
  return Json::parse(text::read_file((test::source_folder() / "deploy" / file).string()));
}

results::LawsFigure two_laws(const std::string& title) {
  results::LawsFigure figure(title, "K_1 {x}^2 %s \\ 'quoted'");
  for (const char* const law : {"none", "fba-exact"}) {
    record::test::play_sample_run(figure.add_reference(law), 500);
    record::test::play_sample_run(figure.add_run(law, std::string("remote rendering: ") + law), 500);
  }
  return figure;
}

std::size_t lines_with(const std::string& csv, std::string_view part) {
  std::size_t count = 0;
  for (const auto line : text::split(csv, '\n')) count += line.find(part) != std::string_view::npos ? 1U : 0U;
  return count;
}

struct Png {
  int width;
  int height;
};

Png size_of(const std::filesystem::path& file) {
  const std::string bytes = text::read_file(file.string());
  EXPECT_THAT(bytes, StartsWith("\x89PNG\r\n\x1a\n"));
  if (bytes.size() < 24) return {};
  const auto number = [&](std::size_t at) {
    return static_cast<unsigned char>(bytes[at]) * 256 + static_cast<unsigned char>(bytes[at + 1]);
  };
  return {number(18), number(22)};
}

// Each figure that is committed or that a command draws, from real data where there are any.
std::vector<results::Figure> every_figure() {
  const Json comparison = committed("comparison-results.json");
  const std::string bench_file = (test::source_folder() / "deploy/bench-results.csv").string();
  const BenchResults bench = parse_bench_csv(text::read_file(bench_file), bench_file);
  std::vector<PassivityResult> leaks;
  for (const PassivityCondition& condition : passivity_conditions()) {
    leaks.push_back({.condition = condition, .least_P_J = -1e-4 * condition.latency_s});
  }
  results::RunFigure run(record::test::sample_info(), "run.mcap");
  record::test::play_sample_run(run, 5000);
  const std::string long_words = "a hand with more settings than fit on a line of a picture, ";
  return {{.script = text::text_of(figure_scripts(), "comparison"), .csv = comparison_csv(comparison)},
          {.script = text::text_of(figure_scripts(), "limits"), .csv = limits_csv(comparison)},
          study_figure(committed("accuracy-results.json")),
          {.script = text::text_of(figure_scripts(), "ratios"), .csv = ratios_csv(bench)},
          {.script = text::text_of(figure_scripts(), "leaks"), .csv = passivity_csv(leaks)},
          rendering_figure(committed("rendering-results.json")),
          {.script = text::text_of(results::figure_scripts(), "laws"),
           .csv = two_laws("").to_csv(),
           .title = "two laws compared on /a/path/to/a/file/of/some/length/with/a/name/like/scene.toml",
           .subtitle = long_words + long_words + long_words + std::string(100, 'x')},
          {.script = text::text_of(results::figure_scripts(), "run"),
           .csv = run.to_csv(),
           .title = run.title(),
           .subtitle = long_words + long_words + long_words},
          {.script = text::text_of(figure_scripts(), "fleet"),
           .csv = "time_s,sessions,waiting,in_use,ready,starting\n0,0,0,0,40,0\n1,49,0,1,39,0\n"
                  "2,98,70,1,38,1\n3,120,0,2,39,1\n4,121,0,2,40,0\n"},
          {.script = text::text_of(results::figure_scripts(), "slides"),
           .csv = "joint,direction,speed,force,damping,friction,speed_unit,force_unit\n"
                  "0,1,0.1,3,20,0.9,m/s,N\n0,-1,0.1,3.2,20,0.9,m/s,N\n0,1,0.2,5.2,20,0.9,m/s,N\n"},
          {.script = text::text_of(figure_scripts(), "rates"),
           .csv = "device,law,rate_Hz,passive_N_per_mm,late_N_per_mm,ideal_N_per_mm,own_N_per_mm\n"
                  "wall-1dof,none,500,30,28,31,20\nwall-1dof,none,1000,60,52,61,33\n"},
          {.script = text::text_of(figure_scripts(), "teleoperation"),
           .csv = "network,task,architecture,law,tracking_mm,force_N\n"
                  "none,plug,position-position,fba-exact,2,3\n"
                  "none,plug,position-position,none,1.5,2\n"
                  "delay 10ms,plug,position-position,fba-exact,nan,nan\n"}};
}

/// Whether any point of the picture's outermost four is not white, as a text is that goes beyond it. gnuplot reads it.
bool touches_its_edge(const std::filesystem::path& png) {
  const Png size = size_of(png);
  const auto edges = png.string() + ".edges";
  const auto part = [&](int left, int top, int right, int bottom) {
    return "'" + png.string() + "' binary filetype=png every 1:1:" + std::to_string(left) + ":" + std::to_string(top) +
           ":" + std::to_string(right) + ":" + std::to_string(bottom) + " using 1:2:3 with rgbimage";
  };
  const int width = size.width;
  const int height = size.height;
  text::write_file(png.string() + ".edges.gnuplot", "set table '" + edges + "'\nplot " + part(0, 0, width - 1, 3) +
                                                        ", " + part(0, height - 4, width - 1, height - 1) + ", " +
                                                        part(0, 0, 3, height - 1) + ", " +
                                                        part(width - 4, 0, width - 1, height - 1) + "\n");
  EXPECT_EQ(std::system(("gnuplot '" + png.string() + ".edges.gnuplot'").c_str()), 0);
  const std::string read = text::read_file(edges);
  std::size_t white = 0;
  std::size_t all = 0;
  for (const auto line : text::split(read, '\n')) {
    if (!line.ends_with("i")) continue;  // a comment
    ++all;
    if (line.find("  255  255  255 ") != std::string_view::npos) ++white;
  }
  EXPECT_EQ(all, static_cast<std::size_t>(8 * (width + height)));
  return white < all;
}

TEST(Figures, AreDrawnWithoutAWarningAndWithinTheCanvas) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (gnuplot-nox)";
  for (const results::Figure& figure : every_figure()) {
    SCOPED_TRACE(figure.csv.substr(0, figure.csv.find('\n')));
    const TemporaryFolder folder;
    const auto png = folder.path() / "figure.png";
    testing::internal::CaptureStderr();
    EXPECT_EQ(results::draw(figure, png), png);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    const Png size = size_of(png);
    EXPECT_GE(size.width, 740);
    EXPECT_GE(size.height, 300);
    EXPECT_FALSE(touches_its_edge(png));
  }
}

TEST(Figures, AreDrawnAsPdfAndSvgToo) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (gnuplot-nox)";
  const TemporaryFolder folder;
  const auto png = folder.path() / "two laws.png";
  testing::internal::CaptureStderr();
  EXPECT_EQ(two_laws("title").draw_to(png, {"pdf", "svg"}), png);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(size_of(png).width, 0);
  EXPECT_THAT(text::read_file((folder.path() / "two laws.pdf").string()), StartsWith("%PDF-"));
  EXPECT_THAT(text::read_file((folder.path() / "two laws.svg").string()),
              AllOf(HasSubstr("<svg"), HasSubstr("remote rendering: none"), HasSubstr("felt without a network")));
}

TEST(Figures, LeaveDataAndAScriptThatDrawsThemAgain) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (gnuplot-nox)";
  const TemporaryFolder folder;
  const auto png = folder.path() / "two laws.png";
  results::draw(
      {.script = text::text_of(results::figure_scripts(), "laws"), .csv = two_laws("").to_csv(), .title = "title"},
      png);
  const std::string drawn = text::read_file(png.string());
  std::filesystem::remove(png);
  ASSERT_TRUE(std::filesystem::exists(folder.path() / "two laws.csv"));
  const std::string again = "cd '" + folder.path().string() + "' && gnuplot 'two laws.gnuplot'";
  EXPECT_EQ(std::system(again.c_str()), 0);
  EXPECT_EQ(text::read_file(png.string()), drawn);
}

TEST(Figures, MayHaveAnyNameAndTitle) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (gnuplot-nox)";
  const TemporaryFolder folder;
  const auto odd = folder.path() / "it's $HOME; \"quoted\"";
  std::filesystem::create_directory(odd);
  EXPECT_EQ(size_of(two_laws("it's \"applied\" $x\n%s").draw_to(odd / "-'a' $b.png")).width, 1000);
}

TEST(Figures, ThatCannotBeWrittenAreRefusedByName) {
  EXPECT_THAT([] { two_laws("").draw_to("/nowhere/figure.png"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("/nowhere/figure.")));
}

TEST(Figures, SayWhatGnuplotCannotRead) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (gnuplot-nox)";
  const TemporaryFolder folder;
  EXPECT_THAT(
      [&] {
        results::draw({.script = text::text_of(figure_scripts(), "ratios"), .csv = "what,ever\n"},
                      folder.path() / "bad.png");
      },
      ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("bad.png"), HasSubstr("gnuplot"))));
}

TEST(Figures, WithoutGnuplotLeaveDataAndScriptAndNameThePackageToInstall) {
  const TemporaryFolder folder;
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nowhere", 1);
  testing::internal::CaptureStderr();
  const auto left = two_laws("").draw_to(folder.path() / "laws.png");
  const std::string output = testing::internal::GetCapturedStderr();
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(left, folder.path() / "laws.gnuplot");
  EXPECT_THAT(output, AllOf(HasSubstr("not installed"), HasSubstr("gnuplot-nox"), HasSubstr(left.string())));
  EXPECT_TRUE(std::filesystem::exists(left));
  EXPECT_GT(std::filesystem::file_size(folder.path() / "laws.csv"), 1000U);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "laws.png"));
}

TEST(ComparisonFigure, HasEveryLawBehindEveryNetwork) {
  const Json all = committed("comparison-results.json");
  const std::string csv = comparison_csv(all);
  for (const Json& law : all.at("laws")) {
    const std::string name = law.at("law");
    EXPECT_EQ(lines_with(csv, "," + name + ","), all.at("networks").size()) << name;
  }
}

TEST(ComparisonFigure, ShowsEveryLawThatPlayedAndCallsUnbeatenWhatRestsAndIsPassiveAlone) {
  const auto behind = [](double ripple, double shown, double calm, double least_P_J) {
    return Json::array({{{"ripple", ripple}, {"shown", shown}, {"calm", calm}, {"least_P_J", least_P_J}}});
  };
  const Json standings{{"networks", {"none"}},
                       {"laws",
                        {{{"law", "best"}, {"behind", behind(0.1, 0.9, 1, 0)}},
                         {{"law", "worse"}, {"behind", behind(0.2, 0.8, 1, 0)}},
                         {{"law", "leaks"}, {"behind", behind(0.01, 1, 1, -0.1)}},
                         {{"law", "rings"}, {"behind", behind(0.01, 1, 0.4, 0)}},
                         {{"law", "never touched"}, {"behind", behind(NAN, 0, 1, 0)}},
                         {{"law", "never rested"}, {"behind", behind(0.5, NAN, 1, 0)}},
                         {{"law", "refused"}, {"behind", behind(NAN, NAN, 0, 0)}}}}};
  EXPECT_EQ(comparison_csv(standings),
            "network,law,displayed_over_requested,restlessness,rests_and_passive,unbeaten\n"
            "none,best,0.9,0.1,1,1\n"
            "none,worse,0.8,0.2,1,0\n"
            "none,leaks,1,0.01,0,0\n"
            "none,rings,1,0.01,0,0\n"
            "none,never touched,0,nan,0,0\n"
            "none,never rested,nan,0.5,0,0\n");
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (gnuplot-nox)";
  const TemporaryFolder folder;
  testing::internal::CaptureStderr();
  results::draw({.script = text::text_of(figure_scripts(), "comparison"), .csv = comparison_csv(standings)},
                folder.file("comparison.png"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(LimitsFigure, HasEveryLawAndTheoryUnderEachHandAtEachDelay) {
  const Json all = committed("comparison-results.json");
  const std::string csv = limits_csv(all);
  const std::size_t places = all.at("hands").size() * all.at("limits").size();
  for (const Json& law : all.at("laws")) {
    const std::string name = law.at("law");
    EXPECT_EQ(lines_with(csv, "," + name + ","), places) << name;
  }
  EXPECT_EQ(lines_with(csv, ",2b/T,60"), places);
  EXPECT_THAT(csv, HasSubstr("light,1,b/(T/2 + 2t),12\n"));
}

TEST(AccuracyFigure, HasEverySettingBehindEachNetworkAndMarksTheLeastErrorOnce) {
  const Json study = committed("accuracy-results.json");
  const results::Figure figure = study_figure(study);
  const std::size_t networks = study.at("settings").at(0).at("behind").size();
  EXPECT_EQ(lines_with(figure.csv, "\"[9, 9, 3]\","), networks);
  EXPECT_THAT(figure.subtitle, HasSubstr("tissue.pad.shape.cells"));
  // By round trip: all errors, and those that are marked.
  std::map<std::string, std::vector<double>> errors;
  std::map<std::string, std::vector<double>> marked;
  const std::string csv = results::readable_by_gnuplot(figure.csv);
  for (const auto line : text::split(csv, '\n')) {
    const auto cells = text::split(line, ',');
    if (cells.size() < 10 || cells[0] == "setting") continue;
    const double error = std::stod(std::string(cells[3]));
    errors[std::string(cells[2])].push_back(error);
    if (cells[9] == "1") marked[std::string(cells[2])].push_back(error);
  }
  EXPECT_EQ(errors.size(), networks);
  for (const auto& [round_trip_ms, all] : errors) {
    EXPECT_THAT(marked[round_trip_ms], testing::ElementsAre(std::ranges::min(all))) << round_trip_ms << " ms";
  }
}

TEST(RatiosFigure, HasEachRatioWithItsBoundAndNoGrowth) {
  BenchResults results;
  results.rows = {ratio_row("round trip", "us", 30, "sockperf", 25, "<= 1.25"),
                  ratio_row("most clients", "clients", 400, "echo", 800, ">= 0.7"),
                  ratio_row("law", "us", 0.1, "no law", 0.1), growth_row("law", "degrees of freedom", 0.7)};
  EXPECT_EQ(ratios_csv(results),
            "what,yardstick,conditions,ratio,bound,missed\n"
            "round trip,sockperf,-,1.2,1.25,0\n"
            "most clients,echo,-,0.5,0.7,1\n"
            "law,no law,-,1,0,0\n");
}

TEST(LawsFigure, HasAllTicksOfAShortRun) {
  const std::string csv = two_laws("").to_csv();
  EXPECT_THAT(csv, StartsWith("run,law,time_s,force_N,penetration_mm,P_mJ\n,none,0,"));
  for (const char* const law : {"none", "fba-exact"}) {
    EXPECT_EQ(lines_with(csv, std::string("remote rendering: ") + law + "," + law + ","), 500U);
    EXPECT_EQ(lines_with(csv, std::string(",") + law + ","), 1000U) << "with the reference";
  }
}

TEST(RunFigure, SaysInItsTitleWhichRunItIs) {
  record::RunInfo info = record::test::sample_info();
  info.law = "fba-exact";
  info.rendering = "local";
  info.scene = "";
  info.simulated = "dome (lathe): surface stiffness_N_per_m 10000";
  EXPECT_EQ(results::RunFigure(info, "fba-exact-local.mcap").title(),
            "fba-exact-local.mcap: fba-exact on dome (lathe), local rendering");
  info.scene = "sphere";
  EXPECT_EQ(results::RunFigure(info, "a.mcap").title(), "a.mcap: fba-exact on sphere, local rendering");
}

TEST(Draw, RefusesToReplaceAFileOfTheCommand) {
  const TemporaryFolder folder;
  const std::string csv = folder.file("../") + folder.path().filename().string() + "/a.csv";
  EXPECT_THAT(
      [&] {
        results::expect_drawable(folder.file("a.png"), {"", "b.csv", csv});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("would replace " + csv)));
  EXPECT_NO_THROW(results::expect_drawable(folder.file("a.png"), {"", folder.file("b.csv"), "a.csv"}));
  const std::string pdf = folder.file("a.pdf");
  EXPECT_NO_THROW(results::expect_drawable(folder.file("a.png"), {pdf}));
  EXPECT_THAT([&] { results::expect_drawable(folder.file("a.png"), {pdf}, {"pdf"}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("would replace " + pdf)));
}

TEST(Draw, ReplacesDataAndScriptOfAnEarlierFigureAlone) {
  const TemporaryFolder folder;
  const std::string png = folder.file("run.png");
  const auto is_none_of_ours = [&](const std::string& file) {
    EXPECT_THAT([&] { results::expect_drawable(png, {}); },
                ThrowsMessage<std::runtime_error>(AllOf(StartsWith(file), HasSubstr("not of an earlier one"))));
  };
  text::write_file(folder.file("run.csv"), "time_s,x_m\n");
  is_none_of_ours(folder.file("run.csv"));
  text::write_file(folder.file("run.gnuplot"), "plot sin(x)\n");
  is_none_of_ours(folder.file("run.gnuplot"));
  std::filesystem::remove(folder.file("run.gnuplot"));
  std::filesystem::remove(folder.file("run.csv"));
  two_laws("").draw_to(png);  // data and script at least: gnuplot may be missing
  EXPECT_NO_THROW(results::expect_drawable(png, {}));
}

TEST(Draw, WritesNoFieldThatGnuplotWouldTakeForTwo) {
  EXPECT_EQ(results::readable_by_gnuplot("a,b\n1,2\n"), "a,b\n1,2\n");
  EXPECT_EQ(results::readable_by_gnuplot("run,x\n\"[ 9, 9, 3 ]\",1\n\"none a,b.mcap\",2\n"),
            "run,x\n[ 9 9 3 ],1\nnone a b.mcap,2\n");
  EXPECT_EQ(results::readable_by_gnuplot("\"the \"\"best\"\"\ntoday\",\"\",1\n"), "the 'best' today,,1\n");
}

TEST(Draw, LeavesTheOldPictureWhereItFails) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const TemporaryFolder folder;
  const std::string png = folder.file("a.png");
  text::write_file(png, "old");
  EXPECT_THROW(results::draw({.script = text::text_of(figure_scripts(), "ratios"), .csv = "no such columns\n1\n"}, png),
               std::runtime_error);
  EXPECT_EQ(text::read_file(png), "old");
}

}  // namespace
}  // namespace forcebound::lab
