#include "tests/tools/lab/identification/study.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "forcebound/client/commands/identify/identification.hpp"
#include "forcebound/control/classic_text.hpp"
#include "forcebound/results/summary_cells.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "tests/tools/lab/identification/hidden_device.hpp"
#include "tests/tools/lab/identification/run_guide.hpp"
#include "tests/tools/sim/closed_loop.hpp"
#include "tests/tools/sim/draw.hpp"
#include "tests/tools/sim/restless_hand.hpp"

namespace forcebound::lab::identification {
namespace {

using client::commands::identify::Findings;
using client::commands::identify::Guide;
using client::commands::identify::GuideSettings;
using client::commands::identify::JointFindings;
using client::commands::identify::LowerBound;
using client::commands::identify::TimeBounds;

constexpr double kGuarantee_J = 1e-9;
constexpr double kLatencyMost_s = 100e-6;
constexpr double kHostile_s = 2;
constexpr double kWall_s = 2.5;

sim::ClosedLoop::Settings loop_settings(const HiddenDevice& hidden, const control::DeviceFacts& told) {
  sim::ClosedLoop::Settings settings;
  settings.device = hidden.description;
  settings.flaws = hidden.flaws;
  settings.told = told;
  settings.law = "fba-exact";
  return settings;
}

/// The least energy balance against one of the hostile environments, and a restless hand.
double least_P_J(const HiddenDevice& hidden, const control::DeviceFacts& told, std::uint64_t seed) {
  sim::Draw draw(seed);
  std::vector<std::string> hostile = sim::environment_names();
  std::erase_if(hostile, [](const std::string& name) { return name == "honest" || name == "replayed"; });
  sim::ClosedLoop::Settings settings = loop_settings(hidden, told);
  settings.seed = draw.seed();
  settings.timing = {.late_share = 0.1, .late_max = time::from_seconds(told.period_s)};
  settings.make_hand = [hand_seed = draw.seed(), dof = told.degrees_of_freedom()] {
    return std::make_unique<sim::RestlessHand>(
        sim::RestlessHand::Settings{.seed = hand_seed,
                                    .degrees_of_freedom = dof,
                                    .hand = {.mass_kg = 0.05, .stiffness_N_per_m = 200, .damping_N_s_per_m = 1},
                                    .reach_m = 0.015,
                                    .duration_s = kHostile_s});
  };
  settings.scene = server::parse_scene(
      "scene = { name = 'nothing', description = 'free space', degrees_of_freedom = 'any' }\n", "study");
  settings.environment = sim::EnvironmentSetting{
      .name = hostile[draw.index(hostile.size())], .seed = draw.seed(), .force_N_max = told.force_N_max};
  sim::ClosedLoop loop(settings);
  loop.run(time::from_seconds(kHostile_s));
  return loop.device().audit()->minimum_J;
}

double displayed_N_per_m(const HiddenDevice& hidden, const control::DeviceFacts& told) {
  sim::ClosedLoop::Settings settings = loop_settings(hidden, told);
  settings.hand = "press";
  settings.settle_s = 1;
  settings.scene = server::parse_scene(
      "scene = { name = 'wall', description = 'a wall at x = 0', degrees_of_freedom = 'any' }\n"
      "[[object]]\nname = 'wall'\nshape = { kind = 'half_space', through_m = [0], normal = [-1] }\n"
      "effects = ['surface']\n[object.surface]\nstiffness_N_per_m = 20000\ndamping_N_s_per_m = 0\n",
      "study");
  sim::ClosedLoop loop(settings);
  loop.run(time::from_seconds(kWall_s));
  const auto summary = nlohmann::ordered_json::parse(loop.close().to_json());
  return results::number_at(summary, "/displayed_stiffness_N_per_m/median");
}

/// The facts that say the most: the range of the motors' true gains is all that facts can tell of several.
control::DeviceFacts true_facts(const HiddenDevice& hidden, const control::Vector& gain) {
  control::DeviceFacts facts = hidden.description.facts;
  facts.uncertainty.torque_gain_share = {gain.minCoeff() - 1, gain.maxCoeff() - 1};
  return facts;
}

/// @param gain of the motors: damping and friction are found in units of their commands
void compare_joints(StudyDevice& study, const Findings& findings, const control::DeviceFacts& truth,
                    const control::Vector& gain) {
  const auto compare = [&](const LowerBound& bound, double unit, double true_value, std::vector<double>& shares) {
    const double least = unit * bound.least();
    study.bounds += bound.refused.empty();
    study.above += least > true_value;
    if (true_value > 0) shares.push_back(least / true_value);
  };
  for (std::size_t i = 0; i < findings.joints.size(); ++i) {
    const JointFindings& joint = findings.joints[i];
    const auto row = static_cast<Eigen::Index>(i);
    compare(joint.balance.damping, gain[row], truth.damping(row, row), study.damping_share);
    compare(joint.balance.friction, gain[row], truth.friction[row], study.friction_share);
    constexpr double kSame = 1e-9;
    const double step = truth.encoder_step[row];
    study.wrong_step |= joint.encoder_refused.empty() && std::abs(joint.encoder_step - step) > kSame * step;
    if (!joint.balance.damping.refused.empty()) continue;
    study.wrong_gain |= gain[row] < 1 + joint.gain_share.least || gain[row] > 1 + joint.gain_share.most;
    study.gain_doubt.push_back(0.5 * (joint.gain_share.most - joint.gain_share.least));
  }
}

double median(std::vector<double> values, double share = 0.5) {
  if (values.empty()) return std::nan("");
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

/// The sums of a row of the tables.
struct Group {
  int devices = 0;
  int complete = 0;
  int bounds = 0;
  int above = 0;
  int wrong_steps = 0;
  int wrong_gains = 0;
  int outside = 0;
  int far = 0;
  int latencies = 0;
  double least_P_J = 0;
  int played = 0;
  std::vector<double> gain_doubt{};
  std::vector<double> damping{};
  std::vector<double> friction{};
  std::vector<double> latency_s{};
  std::vector<double> hold_s{};
  std::vector<double> stiffness{};
  std::vector<double> seconds{};

  void add(const StudyDevice& device) {
    ++devices;
    complete += device.complete;
    bounds += device.bounds;
    above += device.above;
    wrong_steps += device.wrong_step;
    wrong_gains += device.wrong_gain;
    gain_doubt.insert(gain_doubt.end(), device.gain_doubt.begin(), device.gain_doubt.end());
    outside += device.time_outside;
    damping.insert(damping.end(), device.damping_share.begin(), device.damping_share.end());
    friction.insert(friction.end(), device.friction_share.begin(), device.friction_share.end());
    if (device.latency_excess_s) {
      latency_s.push_back(*device.latency_excess_s);
      far += *device.latency_excess_s > kLatencyMost_s;
    }
    if (device.hold_excess_s) hold_s.push_back(*device.hold_excess_s);
    if (device.least_P_J) {
      least_P_J = std::min(least_P_J, *device.least_P_J);
      ++played;
    }
    if (device.stiffness_share) stiffness.push_back(*device.stiffness_share);
    seconds.push_back(device.seconds);
  }
};

text::Table::Cell count_cell(int wrong, int of) {
  return {std::to_string(wrong) + " of " + std::to_string(of),
          wrong > 0 ? text::Table::Mark::alarm : text::Table::Mark::none};
}

std::string percent(double share) { return text::fixed(100 * share, 1); }

std::map<std::string, Group> groups_of(const std::vector<StudyDevice>& devices) {
  std::map<std::string, Group> groups;
  for (const StudyDevice& device : devices) {
    groups[device.kind].add(device);
    groups["all"].add(device);
  }
  return groups;
}

/// "damping of axis 2: it is lost ..." counts as what and why, without the joint and numbers.
std::string kind_of(const std::string& refusal) {
  const auto end = refusal.find(" of ");
  const auto colon = refusal.find(':');
  return refusal.substr(0, std::min(end, colon));
}

}  // namespace

StudyDevice study_device(std::uint64_t seed, const StudySettings& settings) {
  const HiddenDevice hidden = draw_hidden_device(seed);
  const auto device = without_hand(hidden.description, hidden.flaws);
  const control::DeviceFacts truth = true_facts(hidden, device->motor_gain());
  const control::DeviceFacts declared = declared_facts(hidden);
  GuideSettings guide_settings = settings.guide;
  guide_settings.seed = seed;
  Guide guide(declared, guide_settings);
  constexpr double kLongest_s = 1200;
  run_in_virtual_time(guide, *device, declared.period_s, seed, kLongest_s);
  const Findings findings = evaluate(guide, declared, settings.confidence, known_mass(hidden));

  StudyDevice study;
  study.seed = seed;
  study.kind = hidden.kind;
  study.complete = findings.complete();
  study.refusals = findings.refusals(declared.cartesian);
  study.seconds = static_cast<double>(findings.readings.ticks) * declared.period_s;
  compare_joints(study, findings, truth, device->motor_gain());
  const auto outside = [](const TimeBounds& bounds, double true_s) {
    return bounds.refused.empty() && (bounds.most_s < true_s || bounds.least_s > true_s);
  };
  study.time_outside = outside(findings.latency, truth.latency_s) || findings.releases != truth.releases ||
                       (truth.releases && outside(findings.hold, truth.hold_s_max));
  if (findings.latency.refused.empty()) study.latency_excess_s = findings.latency.most_s - truth.latency_s;
  if (truth.releases && findings.hold.refused.empty()) study.hold_excess_s = findings.hold.most_s - truth.hold_s_max;
  if (settings.law && study.complete) {
    const control::DeviceFacts told = facts_of(findings, declared);
    study.least_P_J = least_P_J(hidden, told, seed);
    const double with_truth = displayed_N_per_m(hidden, truth);
    const double with_reported = displayed_N_per_m(hidden, told);
    if (with_truth > 0 && with_reported > 0) study.stiffness_share = with_reported / with_truth;
  }
  return study;
}

std::vector<StudyDevice> study_devices(const StudySettings& settings,
                                       const std::function<void(std::uint64_t done)>& progress) {
  std::vector<StudyDevice> devices;
  sim::Draw draw(settings.seed);
  for (std::uint64_t i = 0; i < settings.devices; ++i) {
    progress(i);
    devices.push_back(study_device(draw.seed(), settings));
  }
  return devices;
}

bool any_wrong(const std::vector<StudyDevice>& devices) noexcept {
  return std::ranges::any_of(devices, [](const StudyDevice& device) {
    return device.above > 0 || device.any_outside() || device.least_P_J.value_or(0) < -kGuarantee_J;
  });
}

std::string study_text(const std::vector<StudyDevice>& devices, text::Colour colour) {
  text::Table bounds({{"devices"},
                      {"number"},
                      {"all facts"},
                      {"bounds above truth"},
                      {"damping, median", "%"},
                      {"worst tenth", "%"},
                      {"friction, median", "%"},
                      {"worst tenth", "%"},
                      {"gain known to, median", "%"},
                      {"most", "%"}});
  text::Table times({{"devices"},
                     {"outside bounds"},
                     {"latency above truth, median", "us"},
                     {"most", "us"},
                     {"beyond 100 us"},
                     {"hold above truth, median", "us"},
                     {"takes, median", "s"}});
  text::Table laws({{"devices"}, {"runs"}, {"least P", "mJ"}, {"shown stiffness, median", "%"}, {"worst tenth", "%"}});
  constexpr double kTenth = 0.1;
  for (const auto& [kind, g] : groups_of(devices)) {
    const bool whole = g.complete == g.devices;
    bounds.add({kind, std::to_string(g.devices), whole ? "all" : std::to_string(g.complete),
                count_cell(g.above, g.bounds), percent(median(g.damping)), percent(median(g.damping, kTenth)),
                percent(median(g.friction)), percent(median(g.friction, kTenth)), percent(median(g.gain_doubt)),
                percent(median(g.gain_doubt, 1))});
    times.add({kind, count_cell(g.outside + g.wrong_steps + g.wrong_gains, g.devices),
               text::fixed(1e6 * median(g.latency_s), 1), text::fixed(1e6 * median(g.latency_s, 1), 1),
               count_cell(g.far, static_cast<int>(g.latency_s.size())), text::fixed(1e6 * median(g.hold_s), 1),
               text::fixed(median(g.seconds), 0)});
    const std::string leak = results::millijoules(g.least_P_J);
    laws.add({kind,
              std::to_string(g.played),
              {leak, g.least_P_J < -kGuarantee_J ? text::Table::Mark::alarm : text::Table::Mark::none},
              percent(median(g.stiffness)),
              percent(median(g.stiffness, kTenth))});
  }
  std::map<std::string, int> refusals;
  for (const StudyDevice& device : devices) {
    for (const std::string& refusal : device.refusals) ++refusals[kind_of(refusal)];
  }
  control::ClassicText out;
  out << "Lower bounds as a share of the hidden truth; a refused one counts as 0 %.\n\n"
      << bounds.to_text(colour) << "\nLatency and hold time: how far the upper bound is above the truth. Outside: a\n"
      << "time or a motor's gain not within its bounds, or a wrong encoder step.\n\n"
      << times.to_text(colour);
  if (std::ranges::any_of(devices, [](const StudyDevice& d) { return d.least_P_J.has_value(); })) {
    out << "\nfba-exact with the identified facts on the same devices: least P of 2 s against\n"
        << "a hostile environment, and the stiffness that a wall shows, as a share of that\nwith the true facts.\n\n"
        << laws.to_text(colour);
  }
  out << "\nRefused:";
  if (refusals.empty()) out << " nothing";
  for (const auto& [what, times_refused] : refusals) out << "\n  " << what << ": " << times_refused;
  out << '\n';
  return out.str();
}

std::string study_csv(const std::vector<StudyDevice>& devices) {
  text::Table table({{"seed"},
                     {"kind"},
                     {"complete"},
                     {"bounds"},
                     {"above"},
                     {"least_damping_share"},
                     {"least_friction_share"},
                     {"latency_excess_s"},
                     {"hold_excess_s"},
                     {"outside"},
                     {"least_P_J"},
                     {"stiffness_share"},
                     {"refused"}});
  const auto number = [](const std::optional<double>& value) { return value ? text::rounded(*value, 6) : ""; };
  for (const StudyDevice& d : devices) {
    std::string refused;
    for (const std::string& refusal : d.refusals) refused += (refused.empty() ? "" : "; ") + refusal;
    table.add({std::to_string(d.seed), d.kind, d.complete ? "1" : "0", std::to_string(d.bounds),
               std::to_string(d.above), text::rounded(median(d.damping_share, 0), 6),
               d.friction_share.empty() ? "" : text::rounded(median(d.friction_share, 0), 6),
               number(d.latency_excess_s), number(d.hold_excess_s), d.any_outside() ? "1" : "0", number(d.least_P_J),
               number(d.stiffness_share), refused});
  }
  return table.to_csv();
}

}  // namespace forcebound::lab::identification
