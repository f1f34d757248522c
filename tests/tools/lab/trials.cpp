#include "tests/tools/lab/trials.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/text/table.hpp"
#include "tests/tools/lab/comparison/task.hpp"
#include "tests/tools/lab/measures/measures.hpp"
#include "tests/tools/lab/measures/summary_cells.hpp"

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
  void on_force(const record::ForceRecord&) noexcept override {}

  std::function<control::Vector()> velocity_of;
  double push_N = 0;

 private:
  static constexpr double kStill_m_per_s = 1e-3;
};

sim::ClosedLoop::Settings settings_of(const TrialsSettings& trials, const std::string& law,
                                      const std::shared_ptr<const scene::Scene>& scene, const NamedNetwork& network) {
  sim::ClosedLoop::Settings settings{.device = device::load_device(trials.device),
                                     .hand = trials.hand,
                                     .law = law,
                                     .scene = scene,
                                     .network = network.settings,
                                     .seed = trials.seed};
  settings.network.seed = trials.seed;
  settings.timing = {.measured = true, .choosing_max = kChoosingTime};
  return settings;
}

}  // namespace

std::vector<Trial> play_trials(const TrialsSettings& settings, LawsFigure* figure,
                               const std::function<void(double)>& progress) {
  const std::shared_ptr<const scene::Scene> scene = server::load_scene(settings.scene);
  const NamedNetwork network = network_of(settings.network);
  const auto laws = baselines::shipped_laws();
  std::vector<Trial> trials;
  for (const std::string& law : settings.laws) {
    Trial trial{.law = law};
    sim::ClosedLoop::Settings run = settings_of(settings, law, scene, network);
    trial.refused = laws.refusal(law, run.device.facts);
    if (!trial.refused.empty()) {
      trials.push_back(std::move(trial));
      continue;
    }
    RingingMeter ringing;
    PushMeter push;
    std::vector<record::TickSink*> sinks{&ringing, &push};
    if (figure != nullptr) sinks.push_back(&figure->add_run(law));
    sim::ClosedLoop loop(std::move(run), sinks);
    push.velocity_of = [&loop] { return loop.device().truth().velocity; };
    const time::Nanoseconds end = time::from_seconds(settings.duration_s);
    for (time::Nanoseconds done{0}; done < end; done += kBetweenProgress) {
      loop.run(std::min(kBetweenProgress, end - done));
      const double part = time::to_seconds(done) / settings.duration_s;
      progress((static_cast<double>(trials.size()) + part) / static_cast<double>(settings.laws.size()));
    }
    trial.summary = Json::parse(loop.close().to_json());
    trial.ringing_s = ringing.ringing_s();
    trial.push_N = push.push_N;
    trials.push_back(std::move(trial));
  }
  return trials;
}

std::string trials_table(const TrialsSettings& settings, const std::vector<Trial>& trials, text::Colour colour) {
  text::Table table({{"law"},
                     {"least P", "mJ"},
                     {"at rest", "%"},
                     {"force at rest", "N"},
                     {"displayed", "N/m"},
                     {"worst push", "N"},
                     {"ringing", "s"}});
  for (const Trial& trial : trials) {
    if (!trial.refused.empty()) {
      table.add_remark(trial.law, "refuses: " + trial.refused);
      continue;
    }
    const Json& s = trial.summary;
    table.add({trial.law, least_P_cell(s), cell_at(s, "/at_rest/fraction", 100, 1),
               cell_at(s, "/at_rest/force_N", 1, 3), cell_at(s, "/displayed_stiffness_N_per_m/median", 1, 0),
               text::fixed(trial.push_N, 2), trial.ringing_s ? text::fixed(*trial.ringing_s, 2) : "-"});
  }
  return "Each law in virtual time, the same figures on every machine:\n" +
         text::wrapped("scene " + settings.scene + ", device " + settings.device + ", hand " + settings.hand + ", " +
                           text::fixed(settings.duration_s, 0) + " s, network \"" + settings.network +
                           "\" each way, seed " + std::to_string(settings.seed),
                       2) +
         "\n\n" + table.to_text(colour) +
         text::wrapped_below_descriptions(
             "\n  least P     least of the energy that the device dissipated less the energy that its motors returned; "
             "below zero: not passive\n"
             "  at rest     share of the contact in which the depth changes by < 5 mm/s; force and displayed stiffness "
             "(force over true depth) are medians there\n"
             "  worst push  largest force along the device's motion: pushing, not resisting\n"
             "  ringing     from the first contact until the force stays calm\n",
             0);
}

std::string timing_table(const std::vector<Json>& summaries) {
  text::Table table({{"law"},
                     {"period p99", "ms"},
                     {"late ticks", "%"},
                     {"median force age", "ms"},
                     {"median round trip", "ms"},
                     {"p99", "ms"}});
  for (const Json& s : summaries) {
    table.add({law_of(s), cell_at(s, "/period_us/p99", 1e-3, 3),
               text::fixed(100 * number_at(s, "/late_ticks") / number_at(s, "/ticks"), 2),
               cell_at(s, "/force_age_ms/p50", 1, 1), cell_at(s, "/rtt_us/p50", 1e-3, 1),
               cell_at(s, "/rtt_us/p99", 1e-3, 1)});
  }
  return "Live on this machine, timing only:\n\n" + table.to_text();
}

}  // namespace forcebound::lab
