#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "forcebound/record/recording_reader.hpp"
#include "forcebound/record/summary.hpp"
#include "tests/lab/commands.hpp"
#include "tests/lab/comparison.hpp"
#include "tests/lab/figure.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::vector<std::string> runs;
  std::string figure;
};

/// A run as it is compared: its summary, and its curves if there is a recording.
class ComparedRun final : public record::RecordingSink {
 public:
  void on_start(const record::RunInfo& info) override { summary_.emplace(info); }
  void on_end(const record::RunTotals& totals) override { summary_->finish(totals); }
  void on_tick(const record::TickRecord& tick) noexcept override {
    if (!start_) start_ = tick.time;
    summary_->on_tick(tick);
    const double t = time::to_seconds(tick.time - *start_);
    depth_mm_.add(t, 1e3 * std::max(tick.penetration_m, 0.0));
    force_N_.add(t, tick.applied.norm());
    audit_mJ_.add(t, 1e3 * tick.audit_J);
  }
  void on_force(const record::ForceRecord& force) noexcept override { summary_->on_force(force); }

  [[nodiscard]] Json summary() const { return Json::parse(summary_->to_json()); }
  [[nodiscard]] const record::RunInfo& info() const { return summary_->info(); }
  [[nodiscard]] bool any_tick() const { return start_.has_value(); }

  void add_to(Figure& figure) const {
    const Envelope* curves[] = {&depth_mm_, &force_N_, &audit_mJ_};
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
      figure.panels[i].series.push_back(curves[i]->series(info().law, colour::of_law(info().law)));
    }
  }

 private:
  std::optional<record::Summary> summary_;
  std::optional<record::Nanoseconds> start_;
  Envelope depth_mm_, force_N_, audit_mJ_;
};

Json read_summary(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read '" + file + "'");
  Json summary = Json::parse(in, nullptr, false);
  if (!summary.is_object())
    throw std::runtime_error(file + ": not a summary; what a client's --summary wrote is needed");
  return summary;
}

std::unique_ptr<ComparedRun> read_run(const std::string& file) {
  auto run = std::make_unique<ComparedRun>();
  record::read_recording(file, *run);
  if (!run->any_tick()) {
    throw std::runtime_error(file + ": no message on topic /tick; a client's recording is needed");
  }
  return run;
}

void print_table(const Options& options) {
  std::vector<Json> summaries;
  Figure figure;
  figure.panels = {
      {"Depth below the surface", "depth [mm]", {}, {}, 0.0, {}},
      {"Force on the device", "magnitude [N]", {}, {}, 0.0, {}},
      {"Passivity: energy the device dissipated less energy its motors returned", "P [mJ]", {}, {}, {}, {}}};
  figure.panels.back().references = {{0, "passive above"}};
  for (const std::string& file : options.runs) {
    if (file.ends_with(".json")) {
      summaries.push_back(read_summary(file));
      continue;
    }
    const auto run = read_run(file);
    summaries.push_back(run->summary());
    run->add_to(figure);
    figure.title = "The laws compared on " + run->info().scene;
    figure.subtitle = run->info().device + ", " + run->info().operator_name;
  }
  std::cout << comparison_table(summaries) << std::flush;
  if (options.figure.empty()) return;
  if (figure.title.empty()) throw std::runtime_error("--figure needs recordings (FILE.mcap): summaries have no curves");
  draw(figure, options.figure);
}

}  // namespace

void add_table(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("table", "Print runs side by side, and draw them over each other");
  command->add_option("runs", options->runs, "recordings, or summaries that --summary wrote")
      ->required()
      ->type_name("FILE.mcap|FILE.json");
  command->add_option("--figure", options->figure, "draw depth, force and passivity of the recordings here")
      ->type_name("FILE.png");
  command->callback([options] { print_table(*options); });
}

}  // namespace forcebound::lab
