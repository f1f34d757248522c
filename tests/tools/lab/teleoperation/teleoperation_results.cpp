#include "tests/tools/lab/teleoperation/teleoperation_results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "forcebound/results/summary_cells.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/time/percentile.hpp"
#include "tests/tools/lab/figures/figure_scripts.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

/// Of what is a number; not a number if nothing is.
double median_of(const std::vector<const TeleoperationRow*>& rows, double TeleoperationMeasures::*which) {
  std::vector<double> values;
  for (const TeleoperationRow* row : rows) {
    const double value = row->measures.*which;
    if (std::isfinite(value)) values.push_back(value);
  }
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : time::percentile_of(values, 0.5);
}

double most_of(const std::vector<const TeleoperationRow*>& rows, double TeleoperationMeasures::*which) {
  double most = 0;
  for (const TeleoperationRow* row : rows) most = std::max(most, row->measures.*which);
  return most;
}

double least_of(const std::vector<const TeleoperationRow*>& rows, double TeleoperationMeasures::*which) {
  double least = 0;
  for (const TeleoperationRow* row : rows) least = std::min(least, row->measures.*which);
  return least;
}

TeleoperationGroup group_of(const std::vector<const TeleoperationRow*>& rows) {
  using M = TeleoperationMeasures;
  const TeleoperationRow& first = *rows.front();
  TeleoperationGroup group{.task = first.task,
                           .architecture = first.architecture,
                           .law = first.law,
                           .network = first.network,
                           .runs = rows.size()};
  group.succeeded = static_cast<std::size_t>(
      std::ranges::count_if(rows, [](const TeleoperationRow* row) { return row->measures.succeeded; }));
  for (double M::*which : {&M::given_J, &M::received_J, &M::tracking_rms_m, &M::force_error_rms_N, &M::stiffness_ratio,
                           &M::peak_N, &M::completed_s, &M::measure, &M::goal, &M::bounded_share, &M::lag_m_max}) {
    group.median.*which = median_of(rows, which);
  }
  for (double M::*which : {&M::leader_minimum_J, &M::leader_kept_minimum_J, &M::follower_minimum_J}) {
    group.median.*which = least_of(rows, which);
  }
  group.median.lurch_m_per_s = most_of(rows, &M::lurch_m_per_s);
  for (const TeleoperationRow* row : rows) group.median.stops += row->measures.stops;
  return group;
}

bool passive(const TeleoperationGroup& group) {
  constexpr double kRounding_J = -1e-9;
  return group.median.leader_minimum_J >= kRounding_J && group.median.follower_minimum_J >= kRounding_J;
}

/// In no respect worse, and in one better. What is not known is the worst.
bool dominates(const TeleoperationGroup& a, const TeleoperationGroup& b) {
  const auto known = [](double value) { return std::isfinite(value) ? value : std::numeric_limits<double>::max(); };
  const auto respects = [&](const TeleoperationGroup& group) {
    return std::array{known(group.median.tracking_rms_m), known(group.median.force_error_rms_N),
                      known(group.median.peak_N), -static_cast<double>(group.succeeded)};
  };
  const auto of_a = respects(a);
  const auto of_b = respects(b);
  return std::equal(of_a.begin(), of_a.end(), of_b.begin(), std::less_equal{}) && of_a != of_b;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

text::Table::Cell energy(double least_J) {
  constexpr double kRounding_J = -1e-9;
  return {results::millijoules(least_J), least_J < kRounding_J ? text::Table::Mark::alarm : text::Table::Mark::none};
}

}  // namespace

std::vector<TeleoperationGroup> groups_of(const std::vector<TeleoperationRow>& rows) {
  std::vector<std::vector<const TeleoperationRow*>> gathered;
  std::map<std::string, std::size_t> places;
  for (const TeleoperationRow& row : rows) {
    const std::string key = row.task + '\n' + row.network + '\n' + row.architecture + '\n' + row.law;
    const auto [place, is_new] = places.try_emplace(key, gathered.size());
    if (is_new) gathered.emplace_back();
    gathered[place->second].push_back(&row);
  }
  std::vector<TeleoperationGroup> groups;
  groups.reserve(gathered.size());
  for (const auto& of_one : gathered) groups.push_back(group_of(of_one));
  for (TeleoperationGroup& group : groups) {
    group.on_front = passive(group) && std::ranges::none_of(groups, [&](const TeleoperationGroup& other) {
                       return other.task == group.task && other.network == group.network && passive(other) &&
                              dominates(other, group);
                     });
  }
  return groups;
}

text::Table teleoperation_table(const std::vector<TeleoperationGroup>& groups) {
  using Align = text::Table::Align;
  text::Table table({{"architecture"},
                     {"law", "", Align::left},
                     {"hand", "mJ"},
                     {"robot", "mJ"},
                     {"track", "mm"},
                     {"err", "N"},
                     {"peak", "N"},
                     {"lurch", "mm/s"},
                     {"done", "", Align::left}});
  std::string heading;
  for (const TeleoperationGroup& group : groups) {
    const TeleoperationMeasures& m = group.median;
    if (const std::string now = group.task + ", " + results::network_in_words(group.network); now != heading)
      table.add_heading(heading = now);
    table.add({group.architecture, group.law, energy(m.leader_minimum_J), energy(m.follower_minimum_J),
               text::fixed(1e3 * m.tracking_rms_m, 1), text::fixed(m.force_error_rms_N, 1), text::fixed(m.peak_N, 0),
               text::fixed(1e3 * m.lurch_m_per_s, 0),
               std::to_string(group.succeeded) + "/" + std::to_string(group.runs) + (group.on_front ? " *" : "")});
  }
  return table;
}

std::string teleoperation_words(const std::vector<TeleoperationGroup>& groups) {
  std::string words =
      "\n  hand    least P at the hand's device, of all seeds: below 0 it gave energy away\n"
      "  robot   likewise of the robot: dissipated and received less given, README of\n"
      "          server/forcebound/server/follower\n"
      "  track   from where the hand is, in the robot's world, to the tool, RMS\n"
      "  err     from the true contact force to the one on the hand, RMS in contact\n"
      "  peak    largest contact force\n"
      "  lurch   most speed of a tool that catches up, after its law withheld torque, beyond\n"
      "          its leader's: over twice that plus 20 mm/s, or the fastest meanwhile\n"
      "  done    runs that reached the task's goal\n"
      "          *: passive, and none that is passive is better in every respect\n"
      "  Numbers are medians of the seeds but for the least P and the largest lurch.\n\n";
  std::vector<std::string> laws;
  for (const TeleoperationGroup& group : groups) {
    if (std::ranges::find(laws, group.law) == laws.end()) laws.push_back(group.law);
  }
  for (const std::string& law : laws) {
    double hand_J = 0;
    double robot_J = 0;
    std::size_t runs = 0;
    std::size_t done = 0;
    for (const TeleoperationGroup& group : groups) {
      if (group.law != law) continue;
      hand_J = std::min(hand_J, group.median.leader_minimum_J);
      robot_J = std::min(robot_J, group.median.follower_minimum_J);
      runs += group.runs;
      done += group.succeeded;
    }
    words += "  " + law + ": " + std::to_string(runs) + " runs, " + std::to_string(done) +
             " done; least P at the hand " + results::millijoules(hand_J) + " mJ, at the robot " +
             results::millijoules(robot_J) + " mJ\n";
  }
  return words;
}

nlohmann::ordered_json teleoperation_json(const std::vector<TeleoperationRow>& rows) {
  Json all = Json::array();
  const std::vector<TeleoperationGroup> groups = groups_of(rows);
  for (const TeleoperationRow& row : rows) {
    const TeleoperationMeasures& m = row.measures;
    const bool on_front = std::ranges::any_of(groups, [&row](const TeleoperationGroup& group) {
      return group.on_front && group.task == row.task && group.architecture == row.architecture &&
             group.law == row.law && group.network == row.network;
    });
    all.push_back({{"task", row.task},
                   {"architecture", row.architecture},
                   {"law", row.law},
                   {"network", row.network},
                   {"seed", row.seed},
                   {"passivity",
                    {{"leader_minimum_J", m.leader_minimum_J},
                     {"leader_less_given_minimum_J", m.leader_kept_minimum_J},
                     {"follower_minimum_J", m.follower_minimum_J}}},
                   {"given_J", m.given_J},
                   {"received_J", m.received_J},
                   {"tracking_rms_m", number(m.tracking_rms_m)},
                   {"force_error_rms_N", number(m.force_error_rms_N)},
                   {"displayed_over_true_stiffness", number(m.stiffness_ratio)},
                   {"contact_N_max", m.peak_N},
                   {"succeeded", m.succeeded},
                   {"completed_s", number(m.completed_s)},
                   {"measure", m.measure},
                   {"goal", m.goal},
                   {"stops", m.stops},
                   {"why_stopped", m.why_stopped},
                   {"bounded_share", m.bounded_share},
                   {"lag_m_max", m.lag_m_max},
                   {"lurch_m_per_s", m.lurch_m_per_s},
                   {"on_pareto_front", on_front}});
  }
  return all;
}

results::Figure teleoperation_figure(const std::vector<TeleoperationGroup>& groups) {
  std::string csv = "network,task,architecture,law,tracking_mm,force_N\n";
  for (const TeleoperationGroup& group : groups) {
    csv += group.network + ',' + group.task + ',' + group.architecture + ',' + group.law + ',' +
           results::figure_number(1e3 * group.median.tracking_rms_m) + ',' +
           results::figure_number(group.median.force_error_rms_N) + '\n';
  }
  return {.script = text::text_of(figure_scripts(), "teleoperation"), .csv = results::readable_by_gnuplot(csv)};
}

}  // namespace forcebound::lab
