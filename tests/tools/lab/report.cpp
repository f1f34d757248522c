#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>

#include "forcebound/record/recording_reader.hpp"
#include "forcebound/record/summary.hpp"
#include "forcebound/text/file.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/figures/run_figure.hpp"
#include "tests/tools/lab/option_checks.hpp"
#include "tests/tools/lab/outputs.hpp"

namespace forcebound::lab {
namespace {

constexpr const char* kRunPicture = "run.png";

struct ReportOptions {
  std::string recording;
  std::string figures;
  std::string json;
};

/// Reads a recording into its summary and its figure in one pass.
class Report final : public record::RecordingSink {
 public:
  void on_start(const record::RunInfo& info) override {
    summary_.emplace(info);
    figure_.emplace(info);
  }
  void on_end(const record::RunTotals& totals) override { summary_->finish(totals); }
  void on_tick(const record::TickRecord& tick) noexcept override {
    summary_->on_tick(tick);
    figure_->on_tick(tick);
    any_tick_ = true;
  }
  void on_force(const record::ForceRecord& force) noexcept override {
    summary_->on_force(force);
    figure_->on_force(force);
  }

  [[nodiscard]] const record::Summary& summary() const { return *summary_; }
  [[nodiscard]] const RunFigure& figure() const { return *figure_; }
  [[nodiscard]] bool any_tick() const { return any_tick_; }

 private:
  std::optional<record::Summary> summary_;
  std::optional<RunFigure> figure_;
  bool any_tick_ = false;
};

void run(const ReportOptions& options) {
  const bool to_stdout = options.json == "-";
  prepare({.inputs = {options.recording},
           .files = {to_stdout ? std::string() : options.json},
           .folder = options.figures,
           .figures = pictures_in(options.figures, {kRunPicture})});
  auto report = std::make_unique<Report>();
  const record::mcap::Ending ending = record::read_recording(options.recording, *report);
  if (!report->any_tick()) {
    throw std::runtime_error(options.recording + ": no message on topic /tick; a client's recording is needed");
  }
  if (!ending) std::cerr << record::incomplete_in_words(options.recording, ending) << '\n';
  if (!to_stdout) std::cout << report->summary().to_text(text::colour_for(STDOUT_FILENO)) << std::flush;
  if (to_stdout) {
    std::cout << report->summary().to_json();
  } else if (!options.json.empty()) {
    text::write_file(options.json, report->summary().to_json());
  }
  if (options.figures.empty()) return;
  const auto drawn = report->figure().draw_to(std::filesystem::path(options.figures) / kRunPicture);
  (to_stdout ? std::cerr : std::cout) << "figure " << drawn.string() << '\n';
}

}  // namespace

void add_report(CLI::App& app) {
  auto options = std::make_shared<ReportOptions>();
  CLI::App* report = app.add_subcommand("report", "Print the summary of a recorded run again, and draw it");
  report->add_option("RECORDING", options->recording, "FILE.mcap that a client's --record wrote")->required();
  add_figures(*report, options->figures, "draw motion, force, energy and timing, as run.png,");
  add_output(*report, "--json", options->json, "write the summary to this file; -: to stdout, instead of the text")
      ->type_name("FILE.json");
  report->footer("Example:\n  forcebound-lab report run.mcap --figures out");
  report->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
