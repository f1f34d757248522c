#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "forcebound/client/commands/commands.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/record/recording_reader.hpp"
#include "forcebound/record/summary.hpp"
#include "forcebound/results/laws_figure.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/results/runs_table.hpp"

namespace forcebound::client::commands {
namespace {

using Json = nlohmann::ordered_json;

struct TableOptions {
  std::vector<std::string> runs;
  std::string figure;
  std::vector<std::string> formats;
};

/// Passes a recording to its summary and to the figure.
class RunReader final : public record::RecordingSink {
 public:
  RunReader(results::LawsFigure& figure, std::string file) : figure_(figure), file_(std::move(file)) {}

  void on_start(const record::RunInfo& info) override {
    summary_.emplace(info);
    const std::string title = "The laws compared" + (info.scene.empty() ? "" : " on " + info.scene);
    const std::string subtitle = info.device + ", " + info.operator_name;
    const bool first = figure_.title().empty();
    figure_.set_title(first || figure_.title() == title ? title : "The laws compared",
                      first || figure_.subtitle() == subtitle ? subtitle : "several devices or hands");
    curves_ = &figure_.add_run(info.law, info.law + ": " + file_);
  }
  void on_end(const record::RunTotals& totals) override { summary_->finish(totals); }
  void on_tick(const record::TickRecord& tick) noexcept override {
    any_tick_ = true;
    summary_->on_tick(tick);
    curves_->on_tick(tick);
  }
  void on_force(const record::ForceRecord& force) noexcept override { summary_->on_force(force); }

  [[nodiscard]] Json summary() const { return Json::parse(summary_->to_json()); }
  [[nodiscard]] bool any_tick() const { return any_tick_; }

 private:
  results::LawsFigure& figure_;
  std::string file_;
  record::TickSink* curves_ = nullptr;
  std::optional<record::Summary> summary_;
  bool any_tick_ = false;
};

Json read_run(const std::string& file, results::LawsFigure& figure) {
  RunReader run(figure, file);
  const record::mcap::Ending ending = record::read_recording(file, run);
  if (!run.any_tick()) {
    throw std::runtime_error(file + ": no message on topic /tick; a client's recording is needed");
  }
  if (!ending) std::cerr << record::incomplete_in_words(file, ending) << '\n';
  return run.summary();
}

void print_table(const TableOptions& options) {
  results::prepare({.inputs = options.runs, .figures = {options.figure}, .formats = options.formats});
  std::vector<results::NamedSummary> runs;
  results::LawsFigure figure;
  for (const std::string& file : options.runs) {
    runs.push_back({file, file.ends_with(".json") ? results::read_summary(file) : read_run(file, figure)});
  }
  std::cout << results::comparison_table(runs) << std::flush;
  if (options.figure.empty()) return;
  if (figure.title().empty()) {
    throw std::invalid_argument("--figure needs recordings (FILE.mcap): summaries have no curves");
  }
  figure.draw_to(options.figure, options.formats);
}

}  // namespace

void add_table(CLI::App& app) {
  auto options = std::make_shared<TableOptions>();
  CLI::App* command = app.add_subcommand("table", "Runs side by side");
  command->add_option("RUN", options->runs, "FILE.mcap that --record wrote, or FILE.json that --summary wrote")
      ->required();
  program::add_figure(*command, options->figure, options->formats, "draw force, depth and passivity of the recordings");
  command->footer("Example:\n  forcebound table less.mcap more.mcap --figure both.png");
  command->callback([options] { print_table(*options); });
}

}  // namespace forcebound::client::commands
