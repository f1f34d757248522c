#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "forcebound/client/commands/commands.hpp"
#include "forcebound/client/commands/report/both_ends.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/record/recording_reader.hpp"
#include "forcebound/record/summary.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/results/run_figure.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::client::commands {
namespace {

constexpr const char* kRunPicture = "run.png";

struct ReportOptions {
  std::vector<std::string> recordings;
  std::string figures;
  std::vector<std::string> formats;
  std::string json;
};

/// Reads a recording in one pass: into its summary and its figure, and what joins it with the other end's.
class Report final : public record::RecordingSink {
 public:
  /// @param both null: there is one recording alone
  explicit Report(BothEnds* both) : both_(both) {}

  void on_start(const record::RunInfo& info) override {
    info_ = info;
    summary_.emplace(info);
    figure_.emplace(info, file_);
  }
  void on_end(const record::RunTotals& totals) override {
    summary_->finish(totals);
    if (both_ != nullptr && any_tick_) both_->add_client(totals);
  }
  void on_tick(const record::TickRecord& tick) noexcept override {
    summary_->on_tick(tick);
    figure_->on_tick(tick);
    any_tick_ = true;
    if (both_ != nullptr) both_->add(tick);
  }
  void on_force(const record::ForceRecord& force) noexcept override {
    summary_->on_force(force);
    figure_->on_force(force);
    if (both_ != nullptr) both_->add(force);
  }
  void on_motion(const record::MotionRecord& motion) override {
    any_motion_ = true;
    if (both_ != nullptr) both_->add(motion);
  }
  void on_sent(const record::SentForceRecord& force) override {
    if (both_ != nullptr) both_->add(force);
  }
  void on_file(const record::RecordedFile& file) override {
    files_ +=
        (files_.empty() ? "" : ", ") + text::printable(file.name) + " (" + bytes_in_words(file.content.size()) + ")";
  }

  /// Tells about its size and files on one line, and what is missing.
  void read(const std::string& file) {
    file_ = std::filesystem::path(file).filename().string();
    const record::mcap::Ending ending = record::read_recording(file, *this);
    if (!ending) std::cerr << record::incomplete_in_words(file, ending) << '\n';
    recording_ = bytes_in_words(ending.size);
    if (ending.stored < ending.uncompressed) {
      recording_ += ", " + bytes_in_words(ending.size - ending.stored + ending.uncompressed) + " without compression";
    }
    recording_ += "; " + (files_.empty() ? "no files within" : "within: " + files_);
  }

  [[nodiscard]] const record::Summary& summary() const { return *summary_; }
  [[nodiscard]] const record::RunInfo& info() const { return info_; }
  [[nodiscard]] const results::RunFigure& figure() const { return *figure_; }
  [[nodiscard]] const std::string& recording() const { return recording_; }
  [[nodiscard]] bool is_clients() const { return any_tick_; }
  [[nodiscard]] bool is_servers() const { return any_motion_ && !any_tick_; }

 private:
  static std::string bytes_in_words(std::uint64_t bytes) {
    constexpr double kKilo = 1e3;
    const auto number = static_cast<double>(bytes);
    if (number < kKilo) return std::to_string(bytes) + " B";
    if (number < kKilo * kKilo) return text::rounded(number / kKilo) + " kB";
    return text::rounded(number / kKilo / kKilo) + " MB";
  }

  BothEnds* both_;
  record::RunInfo info_;
  std::optional<record::Summary> summary_;
  std::optional<results::RunFigure> figure_;
  std::string file_;   ///< its name
  std::string files_;  ///< within it
  std::string recording_;
  bool any_tick_ = false;
  bool any_motion_ = false;
};

/// @param report of the client
void print(const ReportOptions& options, const Report& report, const std::string& rest, const std::string& json) {
  const bool to_stdout = options.json == "-";
  if (!to_stdout) std::cout << report.summary().to_text(text::colour_for(STDOUT_FILENO)) << rest << std::flush;
  if (to_stdout) {
    std::cout << json;
  } else if (!options.json.empty()) {
    text::write_file(options.json, json);
  }
  if (options.figures.empty()) return;
  const auto drawn = report.figure().draw_to(std::filesystem::path(options.figures) / kRunPicture, options.formats);
  (to_stdout ? std::cerr : std::cout) << "figure " << drawn.string() << '\n';
}

void report_one(const ReportOptions& options) {
  const std::string& file = options.recordings.front();
  auto report = std::make_unique<Report>(nullptr);
  report->read(file);
  if (!report->is_clients()) {
    throw std::runtime_error(file + ": no message on topic /tick; a client's recording is needed");
  }
  print(options, *report, text::wrapped("  recording     " + report->recording(), 16) + '\n',
        report->summary().to_json());
}

void report_both(const ReportOptions& options) {
  BothEnds both;
  auto first = std::make_unique<Report>(&both);
  auto second = std::make_unique<Report>(&both);
  first->read(options.recordings[0]);
  second->read(options.recordings[1]);
  const bool client_first = first->is_clients();
  const Report& client = client_first ? *first : *second;
  const Report& server = client_first ? *second : *first;
  if (!client.is_clients() || !server.is_servers()) {
    const char* const of = client.is_clients() ? "clients" : "servers";
    throw std::runtime_error(options.recordings[0] + ", " + options.recordings[1] + ": both are of " + of +
                             ", or one is empty; one of a client and one of its server are needed");
  }
  both.add_client(client.info());
  both.add_server(server.info());
  auto json = nlohmann::ordered_json::parse(client.summary().to_json());
  json["both_ends"] = both.results();
  const std::string rest = text::wrapped("  recording     " + client.recording(), 16) + '\n' + both.to_text() +
                           text::wrapped("  recording     " + server.recording(), 16) + '\n';
  print(options, client, rest, json.dump(2) + "\n");
}

void run(const ReportOptions& options) {
  const bool to_stdout = options.json == "-";
  results::prepare({.inputs = options.recordings,
                    .files = {to_stdout ? std::string() : options.json},
                    .folder = options.figures,
                    .figures = results::pictures_in(options.figures, {kRunPicture}),
                    .formats = options.formats});
  if (options.recordings.size() == 1) {
    report_one(options);
  } else {
    report_both(options);
  }
}

}  // namespace

void add_report(CLI::App& app) {
  auto options = std::make_shared<ReportOptions>();
  CLI::App* report = app.add_subcommand("report", "Summary and figures of a recorded run");
  report
      ->add_option(
          "RECORDING", options->recordings,
          "FILE.mcap that a client's --record wrote; with the one of its server's --record, also what both show "
          "only together: times up and down, and what was lost on which way")
      ->required()
      ->expected(1, 2);
  program::add_figures(*report, options->figures, options->formats,
                       "draw motion, force, energy and timing, as run.png,");
  program::add_output(*report, "--json", options->json,
                      "write the summary to this file; -: to stdout, instead of the text")
      ->type_name("FILE.json");
  report->footer("Examples:\n  forcebound report run.mcap --figures out\n  forcebound report run.mcap server.mcap");
  report->callback([options] { run(*options); });
}

}  // namespace forcebound::client::commands
