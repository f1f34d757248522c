#include "tests/tools/lab/rendering/live_runs.hpp"

#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include "forcebound/record/recording_reader.hpp"
#include "forcebound/record/summary.hpp"
#include "forcebound/results/summary_cells.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

struct LiveReader final : record::RecordingSink {
  void on_start(const record::RunInfo& info) override {
    scene = info.scene;
    summary.emplace(info);
  }
  void on_end(const record::RunTotals& totals) override {
    if (!totals.scene.empty()) scene = totals.scene;
    summary->finish(totals);
  }
  void on_tick(const record::TickRecord& tick) noexcept override {
    ticks.push_back(tick);
    summary->on_tick(tick);
  }
  void on_force(const record::ForceRecord& force) noexcept override { summary->on_force(force); }

  std::string scene;
  std::optional<record::Summary> summary;
  std::vector<record::TickRecord> ticks;
};

double round_trip_us(const LiveRun& run) { return results::number_at(run.summary, "/rtt_us/p50"); }

/// The scene's run that is compared with; null if there is none.
const LiveRun* without_delay(const std::vector<LiveRun>& runs, const std::string& scene) {
  const LiveRun* nearest = nullptr;
  for (const LiveRun& run : runs) {
    if (run.scene != scene || results::rendering_of(run.summary) != "remote") continue;
    if (nearest == nullptr || round_trip_us(run) < round_trip_us(*nearest)) nearest = &run;
  }
  return nearest;
}

}  // namespace

LiveRun read_live_run(const std::string& file) {
  LiveReader recording;
  (void)record::read_recording(file, recording);
  if (recording.ticks.empty()) {
    throw std::runtime_error(file + ": no message on topic /tick; a client's recording is needed");
  }
  const auto rows = static_cast<std::uint32_t>(recording.ticks.front().position.rows());
  const std::shared_ptr<const scene::Scene> scene = server::load_scene(recording.scene);
  if (!scene->accepts(rows)) throw std::runtime_error(file + ": not of the scene '" + recording.scene + "' that ships");
  TrueForceMeter meter(scene, rows);
  const record::TickRecord* now = nullptr;
  meter.place_of = [&now] { return now->position; };
  for (const record::TickRecord& tick : recording.ticks) {
    now = &tick;
    meter.on_tick(tick);
  }
  return {.scene = recording.scene, .summary = Json::parse(recording.summary->to_json()), .figures = meter.figures()};
}

std::string live_runs_table(const std::vector<LiveRun>& runs, text::Colour colour) {
  text::Table table({{"rendering"},
                     {"round trip", "ms"},
                     {"displayed"},
                     {"at client", "%"},
                     {"least P", "mJ"},
                     {"ready", "s"},
                     {"late", "%"},
                     {"period", "ms"}});
  std::string scene;
  for (const LiveRun& run : runs) {
    if (run.scene != scene) table.add_heading(run.scene);
    scene = run.scene;
    const LiveRun* const beside = without_delay(runs, run.scene);
    const double displayed = beside == nullptr ? std::nan("") : displayed_over(run.figures, beside->figures);
    const double late = results::number_at(run.summary, "/late_ticks") / results::number_at(run.summary, "/ticks");
    table.add({results::rendering_of(run.summary), results::cell_at(run.summary, "/rtt_us/p50", 1e-3, 1),
               text::fixed(displayed, 3), text::fixed(100 * run.figures.at_client, 1),
               results::least_P_cell(run.summary), text::fixed(run.figures.ready_s, 2), text::fixed(100 * late, 2),
               results::cell_at(run.summary, "/period_us/p99", 1e-3, 3)});
  }
  return "Live on this machine:\n\n" + table.to_text(colour) +
         "\n"
         "  displayed  stiffness over that of the scene's run with remote rendering and the\n"
         "             least round trip: least squares of the force out of the surface\n"
         "             over the true depth; where nothing is pressed in, the share of the\n"
         "             true force that is applied\n"
         "  at client  share of the ticks since the first contact that are rendered there\n"
         "  ready      from the start to the first tick rendered there; -: never\n"
         "  late       share of the ticks more than 0.5 ms over the period; period: 99 %\n"
         "             of the ticks are shorter\n";
}

}  // namespace forcebound::lab
