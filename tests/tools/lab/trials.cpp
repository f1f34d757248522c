#include "tests/tools/lab/trials.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/tools/lab/comparison/task.hpp"
#include "tests/tools/lab/measures.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

constexpr time::Nanoseconds kChoosing = 15us;
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
  settings.timing = {.measured = true, .choosing_max = kChoosing};
  return settings;
}

/// The number at a path like "/force_N/max" with so many decimals, or "-".
std::string fixed(const Json& json, const char* path, double scale, int decimals) {
  const Json::json_pointer pointer(path);
  if (!json.contains(pointer) || !json.at(pointer).is_number()) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, json.at(pointer).get<double>() * scale);
  // Avoids "-0".
  const bool zero = std::strpbrk(text, "123456789") == nullptr;
  return zero && text[0] == '-' ? text + 1 : text;
}

std::string fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string right(const std::string& words, std::size_t columns) {
  return std::string(columns - std::min(columns, words.size()), ' ') + words;
}

std::string row(const std::string& name, const std::vector<std::string>& cells,
                const std::vector<std::size_t>& widths) {
  std::string line = name;
  line.resize(std::max<std::size_t>(12, name.size()), ' ');
  for (std::size_t i = 0; i < cells.size(); ++i) line += right(cells[i], widths[i]);
  return line + '\n';
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
    if (figure != nullptr) sinks.push_back(&figure->add_law(law));
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
  const std::vector<std::size_t> widths{10, 10, 14, 12, 12, 10};
  std::string table = "Each law in virtual time, the same figures on every machine:\n" +
                      text::wrapped("scene " + settings.scene + ", device " + settings.device + ", hand " +
                                        settings.hand + ", " + fixed(settings.duration_s, 0) + " s, network \"" +
                                        settings.network + "\" each way, seed " + std::to_string(settings.seed),
                                    2) +
                      "\n\n" +
                      row("", {"least P", "at rest", "force at rest", "displayed", "worst push", "ringing"}, widths) +
                      row("law", {"[J]", "[%]", "[N]", "[N/m]", "[N]", "[s]"}, widths);
  for (const Trial& trial : trials) {
    if (!trial.refused.empty()) {
      table += text::wrapped(trial.law + ": refuses: " + trial.refused, 2) + "\n";
      continue;
    }
    const Json& s = trial.summary;
    std::string line = row(trial.law,
                           {fixed(s, "/passivity/minimum_J", 1, 4), fixed(s, "/at_rest/fraction", 100, 1),
                            fixed(s, "/at_rest/force_N", 1, 3), fixed(s, "/displayed_stiffness_N_per_m/median", 1, 0),
                            fixed(trial.push_N, 2), trial.ringing_s ? fixed(*trial.ringing_s, 2) : "-"},
                           widths);
    if (s.at("verdict") == "not passive") {
      const std::string cell = right(fixed(s, "/passivity/minimum_J", 1, 4), widths[0]);
      line.replace(std::max<std::size_t>(12, trial.law.size()), widths[0], text::red(cell, colour));
    }
    table += line;
  }
  return table +
         "\n  least P     least of the energy the device dissipated less the energy its\n"
         "              motors returned; below zero: not passive\n"
         "  at rest     share of the contact in which the depth changes by < 5 mm/s; force\n"
         "              and displayed stiffness (force over true depth) are medians there\n"
         "  worst push  largest force along the device's own motion: pushing, not resisting\n"
         "  ringing     from the first contact until the force stays calm\n";
}

std::string timing_table(const std::vector<Json>& summaries) {
  const std::vector<std::size_t> widths{13, 13, 13, 19, 10};
  std::string table = "Live on this machine, timing only:\n\n" +
                      row("", {"period p99", "late ticks", "force age", "round trip", "p99"}, widths) +
                      row("law", {"[ms]", "[%]", "median [ms]", "median [ms]", "[ms]"}, widths);
  for (const Json& s : summaries) {
    const bool counted = s.contains("ticks") && s["ticks"].is_number() && s["ticks"].get<double>() > 0 &&
                         s.contains("late_ticks") && s["late_ticks"].is_number();
    const bool named = s.contains("law") && s["law"].is_string();
    table +=
        row(named ? s["law"].get<std::string>() : "-",
            {fixed(s, "/period_us/p99", 1e-3, 3),
             counted ? fixed(100 * s["late_ticks"].get<double>() / s["ticks"].get<double>(), 2) : "-",
             fixed(s, "/force_age_ms/p50", 1, 1), fixed(s, "/rtt_us/p50", 1e-3, 1), fixed(s, "/rtt_us/p99", 1e-3, 1)},
            widths);
  }
  return table;
}

}  // namespace forcebound::lab
