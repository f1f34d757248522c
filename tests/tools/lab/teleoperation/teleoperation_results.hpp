#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "forcebound/results/draw.hpp"
#include "forcebound/text/table.hpp"
#include "tests/tools/lab/teleoperation/teleoperation_study.hpp"

namespace forcebound::lab {

/// All seeds of one task, architecture, law and network: medians, the least P and the largest lurch of all.
struct TeleoperationGroup {
  std::string task;
  std::string architecture;
  std::string law;
  std::string network;
  std::size_t runs = 0;
  std::size_t succeeded = 0;
  TeleoperationMeasures median{};  ///< of what is known; the minima are the least, lurch the largest
  bool on_front = false;           ///< of all passive ones with its task and network, none is better in every respect
};

/// In the order of the rows. The front: least tracking error, force error and peak force, most successes.
[[nodiscard]] std::vector<TeleoperationGroup> groups_of(const std::vector<TeleoperationRow>& rows);

[[nodiscard]] text::Table teleoperation_table(const std::vector<TeleoperationGroup>& groups);

/// What the columns mean, and over all groups of a law: least P of both sides, runs and successes.
[[nodiscard]] std::string teleoperation_words(const std::vector<TeleoperationGroup>& groups);

/// A row for each run: task, architecture, law, network, seed, `passivity: {leader_minimum_J, follower_minimum_J}`, and
/// the measures; null for what is not known. `on_pareto_front`: TeleoperationGroup::on_front of the runs that the row
/// is of.
[[nodiscard]] nlohmann::ordered_json teleoperation_json(const std::vector<TeleoperationRow>& rows);

/// Force error and tracking error, a row for each network and architecture (teleoperation.gnuplot).
[[nodiscard]] results::Figure teleoperation_figure(const std::vector<TeleoperationGroup>& groups);

}  // namespace forcebound::lab
