#include "tests/tools/lab/trials/trials.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "forcebound/device/load_device.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/results/summary_cells.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/text/table.hpp"
#include "tests/tools/lab/trials/measures.hpp"
#include "tests/tools/lab/trials/task.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

constexpr time::Nanoseconds kChoosingTime = 15us;
constexpr time::Nanoseconds kBetweenProgress = 200ms;

/// The largest component of the applied force along the device's true velocity: pushing, not resisting.
class PushMeter final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    const control::Vector velocity = velocity_of();
    const double speed = velocity.norm();
    if (speed > kStill_m_per_s) push_N = std::max(push_N, tick.applied.dot(velocity) / speed);
  }

  std::function<control::Vector()> velocity_of;
  double push_N = 0;

 private:
  static constexpr double kStill_m_per_s = 1e-3;
};

/// The force applied in each tick.
class ForceTrace final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override { applied_N.push_back(tick.applied); }

  std::vector<control::Vector> applied_N;
};

/// Root mean square of the difference over that of the other, or nothing where the other is never felt.
std::optional<double> off_by(const std::vector<control::Vector>& forces, const std::vector<control::Vector>& without) {
  double difference = 0;
  double all = 0;
  for (std::size_t i = 0; i < std::min(forces.size(), without.size()); ++i) {
    difference += (forces[i] - without[i]).squaredNorm();
    all += without[i].squaredNorm();
  }
  if (all == 0) return std::nullopt;
  return std::sqrt(difference / all);
}

constexpr const char* kNoNetwork = "no network";

/// What is played beside what.
struct PlayedCase {
  std::string law;
  std::string rendering;
};

std::vector<PlayedCase> cases_of(const TrialsSettings& trials) {
  std::vector<PlayedCase> cases;
  for (const std::string& law : trials.laws) {
    if (trials.network != "none") cases.push_back({law, kNoNetwork});
    for (const std::string& rendering : trials.renderings) cases.push_back({law, rendering});
  }
  return cases;
}

/// The curves of each case, side by side by rendering, so that the laws of one are beside each other.
std::vector<record::TickSink*> curves_of(const TrialsSettings& trials, const std::vector<PlayedCase>& cases,
                                         results::LawsFigure* figure) {
  std::vector<record::TickSink*> curves(cases.size());
  if (figure == nullptr) return curves;
  std::vector<std::string> renderings{kNoNetwork};
  renderings.insert(renderings.end(), trials.renderings.begin(), trials.renderings.end());
  for (const std::string& rendering : renderings) {
    for (std::size_t i = 0; i < cases.size(); ++i) {
      if (cases[i].rendering != rendering) continue;
      curves[i] = rendering == kNoNetwork ? &figure->add_reference(cases[i].law)
                                          : &figure->add_run(cases[i].law, rendering + " rendering: " + cases[i].law);
    }
  }
  return curves;
}

sim::ClosedLoop::Settings settings_of(const TrialsSettings& trials, const PlayedCase& played,
                                      const std::shared_ptr<const scene::Scene>& scene, const NamedNetwork& network) {
  sim::ClosedLoop::Settings settings{.device = device::load_device(trials.device),
                                     .hand = trials.hand,
                                     .law = played.law,
                                     .scene = scene,
                                     .seed = trials.seed,
                                     .renders_locally = played.rendering == "local"};
  if (played.rendering != kNoNetwork) settings.network = network.settings;
  settings.network.seed = trials.seed;
  settings.timing = {.measured = true, .choosing_max = kChoosingTime};
  return settings;
}

}  // namespace

std::vector<PlayedTrial> play_trials(const TrialsSettings& settings, results::LawsFigure* figure,
                                     const std::function<void(double)>& progress) {
  const std::shared_ptr<const scene::Scene> scene = server::load_scene(settings.scene);
  const NamedNetwork network = network_of(settings.network);
  const auto laws = law_plugin::known_laws();
  const std::vector<PlayedCase> cases = cases_of(settings);
  const std::vector<record::TickSink*> curves = curves_of(settings, cases, figure);
  std::vector<PlayedTrial> trials;
  std::map<std::string, std::vector<control::Vector>> without_network;
  for (const PlayedCase& played : cases) {
    PlayedTrial trial{.law = played.law, .rendering = played.rendering};
    sim::ClosedLoop::Settings run = settings_of(settings, played, scene, network);
    trial.refused = laws.refusal(played.law, run.device.facts);
    if (trial.refused.empty() && run.renders_locally && laws.find(played.law).make_server_side) {
      trial.refused = "local rendering, as all forces go through its server-side law";
    }
    if (!trial.refused.empty()) {
      trials.push_back(std::move(trial));
      continue;
    }
    RingingMeter ringing;
    PushMeter push;
    ForceTrace trace;
    RotationalStiffness rotational;
    std::vector<record::TickSink*> sinks{&ringing, &push, &trace, &rotational};
    if (figure != nullptr) sinks.push_back(curves.at(trials.size()));
    sim::ClosedLoop loop(std::move(run), sinks);
    push.velocity_of = [&loop] { return loop.device().truth().velocity; };
    const time::Nanoseconds end = time::from_seconds(settings.duration_s);
    for (time::Nanoseconds done{0}; done < end; done += kBetweenProgress) {
      loop.run(std::min(kBetweenProgress, end - done));
      const double part = time::to_seconds(done) / settings.duration_s;
      progress((static_cast<double>(trials.size()) + part) / static_cast<double>(cases.size()));
    }
    trial.summary = Json::parse(loop.close().to_json());
    trial.ringing_s = ringing.ringing_s();
    trial.rotational_N_m_per_rad = rotational.stiffness_N_m_per_rad();
    trial.push_N = push.push_N;
    if (played.rendering == kNoNetwork) without_network[played.law] = trace.applied_N;
    if (const auto without = without_network.find(played.law); without != without_network.end())
      trial.off_by = off_by(trace.applied_N, without->second);
    trials.push_back(std::move(trial));
  }
  return trials;
}

std::string trials_table(const TrialsSettings& settings, const std::vector<PlayedTrial>& trials, text::Colour colour) {
  const bool turns = device::load_device(settings.device).facts.rotations > 0;
  std::vector<text::Table::Column> columns{
      {"law"}, {"rendering", "", text::Table::Align::left}, {"least P", "mJ"}, {"at rest", "%"}, {"displayed", "N/m"}};
  if (turns) columns.push_back({"turning", "N m/rad"});
  // Shorter beside one column more, for 80 in all.
  const std::string push = turns ? "push" : "worst push";
  columns.push_back({push, "N"});
  columns.push_back({"off by", "%"});
  text::Table table(std::move(columns));
  std::size_t untouched = 0;
  for (const PlayedTrial& trial : trials) {
    if (!trial.refused.empty()) {
      table.add_remark(trial.law, "refuses: " + trial.refused);
      continue;
    }
    const Json& s = trial.summary;
    untouched += results::never_touched(s) ? 1 : 0;
    const auto or_dash = [](const std::optional<double>& value, double factor, int digits) {
      return value ? text::fixed(factor * *value, digits) : "-";
    };
    std::vector<text::Table::Cell> row{trial.law, trial.rendering, results::least_P_cell(s),
                                       results::cell_at(s, "/at_rest/fraction", 100, 1),
                                       results::cell_at(s, "/displayed_stiffness_N_per_m/median", 1, 0)};
    if (turns) row.emplace_back(or_dash(trial.rotational_N_m_per_rad, 1, 3));
    row.emplace_back(text::fixed(trial.push_N, 2));
    row.emplace_back(or_dash(trial.off_by, 100, 1));
    table.add(std::move(row));
  }
  return "Each law and rendering in virtual time, the same figures on every machine:\n" +
         text::wrapped("scene " + settings.scene + ", device " + settings.device + ", hand " + settings.hand + ", " +
                           text::fixed(settings.duration_s, 0) + " s, network \"" + settings.network +
                           "\" each way, seed " + std::to_string(settings.seed),
                       2) +
         "\n\n" + table.to_text(colour) + results::untouched_in_words(untouched, trials.size()) +
         text::wrapped_below_descriptions(
             "\n  rendering   where forces are computed: remote, at the server; local, what can be at the client; no "
             "network: remote, with nothing late or lost\n"
             "  least P     least of the energy that the device dissipated less the energy that its motors returned; "
             "below zero: not passive\n"
             "  at rest     share of the contact in which the depth changes by < 5 mm/s; displayed stiffness (force "
             "over true depth) is the median there\n" +
                 std::string(turns
                                 ? "  turning     displayed rotational stiffness: torque by which the handle is turned "
                                   "back for each radian, least squares over the contact\n"
                                 : "") +
                 "  " + push + std::string(12 - push.size(), ' ') +
                 "largest force along the device's motion: pushing, not resisting\n"
                 "  off by      RMS force error relative to the run without a network\n",
             0);
}

std::string timing_table(const std::vector<Json>& summaries) {
  text::Table table({{"law"},
                     {"rendering", "", text::Table::Align::left},
                     {"period p99", "ms"},
                     {"late ticks", "%"},
                     {"force age", "ms"},
                     {"round trip", "ms"},
                     {"its p99", "ms"}});
  for (const Json& s : summaries) {
    table.add({results::law_of(s), results::rendering_of(s), results::cell_at(s, "/period_us/p99", 1e-3, 3),
               text::fixed(100 * results::number_at(s, "/late_ticks") / results::number_at(s, "/ticks"), 2),
               results::cell_at(s, "/force_age_ms/p50", 1, 1), results::cell_at(s, "/rtt_us/p50", 1e-3, 1),
               results::cell_at(s, "/rtt_us/p99", 1e-3, 1)});
  }
  return "Live on this machine, timing only; medians where nothing else is said:\n\n" + table.to_text();
}

}  // namespace forcebound::lab
