#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/program/output_options.hpp"
#include "forcebound/results/draw.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/text/file.hpp"
#include "tests/tools/lab/bench/collect.hpp"
#include "tests/tools/lab/bench/results.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/figures/figure_scripts.hpp"

namespace forcebound::lab {
namespace {

struct BenchOptions {
  std::string from;
  std::string csv;
  std::string figure;
  std::vector<std::string> formats;
  std::string readme;
};

void run(const BenchOptions& options) {
  results::prepare({.inputs = {options.from},
                    .files = {options.csv},
                    .page = options.readme,
                    .marks = kBenchMarks,
                    .figures = {options.figure},
                    .formats = options.formats});
  const BenchResults results = options.from.ends_with(".csv")
                                   ? parse_bench_csv(text::read_file(options.from), options.from)
                                   : collect(options.from);
  std::cout << to_table(results) << std::flush;
  if (!options.csv.empty()) text::write_file(options.csv, to_csv(results));
  if (!options.figure.empty())
    results::draw({.script = text::text_of(figure_scripts(), "ratios"), .csv = ratios_csv(results)}, options.figure,
                  options.formats);
  if (!options.readme.empty()) {
    text::write_file(options.readme, results::page_with(options.readme, kBenchMarks, to_markdown(results)));
  }
}

}  // namespace

void add_bench(CLI::App& app) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* command = app.add_subcommand("bench", "Print the table of ratios from deploy/bench's measurements");
  command->add_option("RESULTS", options->from, "the folder that its tools wrote to, or FILE.csv")->required();
  program::add_output(*command, "--csv", options->csv, "write the results to this file")->type_name("FILE.csv");
  program::add_figure(*command, options->figure, options->formats, "draw the ratios");
  program::add_output(*command, "--readme", options->readme, "put the results between the marks of this file")
      ->type_name("PAGE.md");
  command->footer("Example:\n  forcebound-lab bench deploy/bench-results.csv");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
