#include <unistd.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "forcebound/client/session/motion_schedule.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/draw.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/rendering/live_runs.hpp"
#include "tests/tools/lab/rendering/rendering_results.hpp"
#include "tests/tools/lab/rendering/rendering_study.hpp"
#include "tests/tools/lab/rendering/two_people.hpp"
#include "tests/tools/lab/trials/option_checks.hpp"
#include "tests/tools/lab/trials/task.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kRenderingPicture = "rendering.png";

struct RenderingOptions {
  RenderingStudySettings settings;
  std::string only;
  bool two_people = false;
  bool side_by_side = false;
  std::vector<std::string> live;
  std::string from;
  std::string csv;
  std::string json;
  std::string readme;
  std::string figures;
  std::vector<std::string> formats;
};

Json figures_json(const HandleFigures& figures) {
  return {{"force_N", figures.force_N},
          {"error", figures.error},
          {"minimum_J", figures.minimum_J},
          {"deviation_m", figures.deviation_m}};
}

void run_two_people(const RenderingOptions& options) {
  const TwoPeopleSettings settings{.law = options.settings.law, .seeds = options.settings.seeds};
  const std::vector<TwoPeopleRow> rows = study_two_people(settings);
  std::fputs(two_people_table(settings, rows).c_str(), stdout);
  if (options.json.empty()) return;
  Json all = Json::array();
  for (const TwoPeopleRow& row : rows) {
    all.push_back({{"rendering", row.local ? "local" : "remote"},
                   {"at_10_ms", figures_json(row.people[0])},
                   {"at_80_ms", figures_json(row.people[1])},
                   {"impulse", row.impulse}});
  }
  text::write_file(options.json, all.dump(2) + '\n');
}

void run_live(const RenderingOptions& options) {
  std::vector<LiveRun> runs;
  runs.reserve(options.live.size());
  {
    program::Progress progress;
    for (const std::string& file : options.live) {
      progress.report(static_cast<double>(runs.size()) / static_cast<double>(options.live.size()), "reading the runs");
      runs.push_back(read_live_run(file));
    }
  }
  std::fputs(live_runs_table(runs, text::colour_for(STDOUT_FILENO)).c_str(), stdout);
}

std::vector<RenderingRow> carried_out_rendering(const std::vector<RenderingTask>& tasks,
                                                const RenderingStudySettings& settings) {
  report_left_out(standard_networks().absent);
  program::Progress progress;
  return study_rendering(tasks, settings, [&](double share) { progress.report(share, "rendering"); });
}

Json read_rendering(const std::string& file) {
  Json study = Json::parse(text::read_file(file), nullptr, false);
  if (!study.is_object() || !study.contains("rows") || !study.contains("settings")) {
    throw std::runtime_error(file + ": not a study of rendering; expected the output of --json");
  }
  return study;
}

/// Of a study and of each class; none of what is not run.
std::vector<std::string> pictures_drawn(const std::vector<RenderingTask>& tasks) {
  std::vector<std::string> pictures{kRenderingPicture};
  for (const RenderingTask& task : tasks) {
    const std::string picture = course_picture(task.group);
    if (pictures.back() != picture) pictures.push_back(picture);
  }
  return pictures;
}

void draw_figures(const RenderingOptions& options, const Json& study, const std::vector<RenderingTask>& tasks,
                  const std::vector<RenderingRow>& rows) {
  const std::filesystem::path folder = options.figures;
  const auto drawn = results::draw(rendering_figure(study), folder / kRenderingPicture, options.formats);
  std::printf("\nFigure: %s\n", drawn.c_str());
  for (const WorstRendering& worst : worst_renderings(rows)) {
    const auto course = rendering_course(tasks, worst, options.settings)
                            .draw_to(folder / course_picture(worst.row->group), options.formats);
    std::printf("Figure: %s\n", course.c_str());
  }
}

void run_rendering(const RenderingOptions& options) {
  if (!options.live.empty()) {
    run_live(options);
    return;
  }
  const bool is_run = options.from.empty() && !options.two_people;
  const std::vector<RenderingTask> tasks = is_run ? rendering_tasks_with(options.only) : std::vector<RenderingTask>{};
  results::prepare({.inputs = {options.from},
                    .files = {options.csv, options.json},
                    .page = options.readme,
                    .marks = kRenderingMarks,
                    .folder = options.figures,
                    .figures = results::pictures_in(options.figures, pictures_drawn(tasks)),
                    .formats = options.formats});
  if (options.two_people) {
    run_two_people(options);
    return;
  }
  const std::vector<RenderingRow> rows =
      is_run ? carried_out_rendering(tasks, options.settings) : std::vector<RenderingRow>{};
  const Json study = is_run ? rendering_json(options.settings, rows) : read_rendering(options.from);
  const std::string told = options.side_by_side ? rendering_side_by_side(study) : rendering_text(study);
  std::fputs(text::printable_lines(told).c_str(), stdout);
  if (!options.csv.empty()) text::write_file(options.csv, rendering_csv(study));
  if (!options.json.empty()) text::write_file(options.json, rendering_file(study));
  if (!options.readme.empty()) {
    text::write_file(options.readme, results::page_with(options.readme, kRenderingMarks, rendering_markdown(study)));
  }
  if (!options.figures.empty()) draw_figures(options, study, tasks, rows);
}

/// What is printed or drawn in place of a study.
struct OtherSources {
  CLI::Option* from;
  CLI::Option* two_people;
  CLI::Option* live;
};

void add_outputs(CLI::App& command, RenderingOptions& options, const OtherSources& others) {
  program::add_output(command, "--json", options.json, "write all figures to this file")
      ->excludes(others.from)
      ->excludes(others.live)
      ->type_name("FILE.json");
  program::add_output(command, "--csv", options.csv, "write a row for each figure to this file")
      ->excludes(others.two_people)
      ->excludes(others.live)
      ->type_name("FILE.csv");
  program::add_output(command, "--readme", options.readme, "put a table between the marks of this file")
      ->excludes(others.two_people)
      ->excludes(others.live)
      ->type_name("PAGE.md");
  program::add_figures(command, options.figures, options.formats,
                       "draw stiffness and error of each class, and the course of its worst run")
      ->excludes(others.two_people)
      ->excludes(others.live);
}

}  // namespace

void add_rendering(CLI::App& app) {
  auto options = std::make_shared<RenderingOptions>();
  CLI::App* command = app.add_subcommand(
      "rendering", "Displayed stiffness and error of scenes, rendered at the server and at the client");
  command->add_option("--law", options->settings.law, "law that bounds the force")
      ->transform(known_law())
      ->type_name("LAW|FILE.so")
      ->capture_default_str();
  command->add_option("--seeds", options->settings.seeds, "runs for each scene and condition")
      ->check(program::whole_within(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  CLI::Option* only =
      command->add_option("--only", options->only, "run only the scenes whose name or class contains this word")
          ->type_name("WORD");
  command
      ->add_option_function<std::string>(
          "--send-rate",
          [options](const std::string& typed) { options->settings.send_rate = client::parse_send_rate(typed); },
          "motions per second where rendering is local, as the client's; default: on each tick")
      ->check(program::accepted_by([](const std::string& typed) { (void)client::parse_send_rate(typed); }))
      ->type_name("HZ|auto");
  CLI::Option* const from =
      command->add_option("--from", options->from, "print and draw what --json wrote, without any run")
          ->excludes(only)
          ->type_name("FILE.json");
  CLI::Option* const side_by_side =
      command->add_flag("--side-by-side", options->side_by_side,
                        "print only E_dev, share of the true force, largest change of force and least P of each scene, "
                        "remote beside local");
  CLI::Option* const two_people =
      command
          ->add_flag("--two-people", options->two_people,
                     "two people who move one block, behind 10 and 80 ms, in place of the scenes")
          ->excludes(only)
          ->excludes(from)
          ->excludes(side_by_side);
  CLI::Option* const live =
      command
          ->add_option("--live", options->live,
                       "recordings of clients, whose figures are printed side by side in place of any run")
          ->excludes(only)
          ->excludes(from)
          ->excludes(side_by_side)
          ->excludes(two_people)
          ->type_name("RUN.mcap");
  add_outputs(*command, *options, {.from = from, .two_people = two_people, .live = live});
  command->footer(
      "Round trips of 0, 20, 100 and 200 ms, the recorded networks of FORCEBOUND_DATA, and blackouts of 1 and 3 s; "
      "each beside the same scene, device, hand and law without a network. Client and server are those of the "
      "programs; the "
      "clock and the network are simulated. Ends with each class of scenes beside its goal.\n"
      "\n"
      "Examples:\n"
      "  forcebound-lab rendering --only mesh --seeds 1\n"
      "  forcebound-lab rendering --only body --seeds 1 --side-by-side\n"
      "  forcebound-lab rendering --json all.json --csv all.csv --figures figures\n"
      "  forcebound-lab rendering --live remote.mcap local.mcap");
  command->callback([options] { run_rendering(*options); });
}

}  // namespace forcebound::lab
