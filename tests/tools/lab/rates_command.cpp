#include <unistd.h>
#include <CLI/CLI.hpp>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/device/tick_rate.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/draw.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/results/summary_cells.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/comparison/rate_study.hpp"
#include "tests/tools/lab/figures/figure_scripts.hpp"
#include "tests/tools/lab/trials/option_checks.hpp"

namespace forcebound::lab {
namespace {

struct RatesOptions {
  RateSettings settings{.devices = {"wall-1dof", "cartesian-3dof"},
                        .laws = {"none", "fba-less", "fba-exact"},
                        .rates_Hz = {500, 1000, 2000, 4000}};
  bool markdown = false;
  std::string csv;
  std::string figure;
  std::vector<std::string> formats;
};

std::string shown(const ShownWall& wall) {
  return wall.shown_N_per_m > 0 ? results::newtons_per_mm(wall.shown_N_per_m) : "-";
}

std::string stable_up_to(const StableStiffness& stable) {
  return (stable.no_limit ? ">= " : "") + results::newtons_per_mm(stable.N_per_m);
}

text::Table table_of(const std::vector<AtRate>& results) {
  text::Table table({{"device"},
                     {"law", "", text::Table::Align::left},
                     {"rate", "Hz"},
                     {"2b/T", "N/mm"},
                     {"late", "N/mm"},
                     {"stable to", "N/mm"},
                     {"ideal", "N/mm"},
                     {"own", "N/mm"},
                     {"least P", "mJ"}});
  for (const AtRate& at : results) {
    const double least_P_J = std::min(at.ideal.least_P_J, at.own.least_P_J);
    table.add({at.device, at.law, text::rounded(at.rate_Hz), results::newtons_per_mm(at.passive_N_per_m),
               results::newtons_per_mm(at.late_N_per_m), stable_up_to(at.stable), shown(at.ideal), shown(at.own),
               results::millijoules(least_P_J)});
  }
  return table;
}

constexpr const char* kWords =
    "\n  late       b/(T/2 + 0.1 ms): as 2b/T, behind the latency of 'own'\n"
    "  stable to  stiffest wall that comes to rest under the hand 'press', of all up\n"
    "             to 1000 N/mm, on an ideal device: exact encoder, no latency\n"
    "  ideal      stiffest wall displayed at rest on that device; -: never at rest\n"
    "  own        the same with its own encoder and 0.1 ms of latency\n"
    "  least P    least of dissipated less returned energy over all walls tried\n";

void run(const RatesOptions& options) {
  results::prepare({.files = {options.csv}, .figures = {options.figure}, .formats = options.formats});
  program::Progress progress;
  const auto results = run_rate_study(options.settings, [&](std::size_t done, std::size_t all) {
    progress.report(static_cast<double>(done) / static_cast<double>(all),
                    std::to_string(done) + " of " + std::to_string(all) + " searches");
  });
  progress.clear();
  const text::Table table = table_of(results);
  if (options.markdown) {
    std::cout << table.to_markdown();
  } else {
    std::cout << table.to_text(text::colour_for(STDOUT_FILENO)) << kWords;
  }
  if (!options.csv.empty()) text::write_file(options.csv, rate_csv(results));
  if (!options.figure.empty())
    results::draw({.script = text::text_of(figure_scripts(), "rates"), .csv = rate_csv(results)}, options.figure,
                  options.formats);
}

}  // namespace

void add_rates(CLI::App& app) {
  auto options = std::make_shared<RatesOptions>();
  CLI::App* command = app.add_subcommand(
      "rates",
      "The stiffest wall that each law displays over the ticks per second of the device's loop, beside theory");
  command->add_option("--devices", options->settings.devices, "Cartesian ones, or files of such")
      ->check(known_device())
      ->type_name("DEVICES")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--laws", options->settings.laws, "laws to compare")
      ->transform(known_law())
      ->type_name("LAWS")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--rates", options->settings.rates_Hz, "ticks per second")
      ->check(program::number_within(device::kTickRateLeast_Hz, device::kTickRateMost_Hz))
      ->type_name("HZ")
      ->delimiter(',')
      ->capture_default_str();
  command->add_flag("--markdown", options->markdown, "as a Markdown table");
  program::add_output(*command, "--csv", options->csv, "write the table to this file")->type_name("FILE.csv");
  program::add_figure(*command, options->figure, options->formats, "draw stiffness over rate");
  command->footer("Example:\n  forcebound-lab rates --devices wall-1dof --laws none,fba-exact --figure rates.png");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
