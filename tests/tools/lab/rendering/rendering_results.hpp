#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "forcebound/results/draw.hpp"
#include "forcebound/text/marks.hpp"
#include "tests/tools/lab/rendering/rendering_study.hpp"

namespace forcebound::lab {

inline constexpr text::Marks kRenderingMarks{"<!-- rendering: made by deploy/rendering -->\n", "<!-- /rendering -->\n"};

/// Each figure of each scene and network, without a network, remote and local: [median, least, most] over the seeds.
/// What is infinite or not a number is null in a file: a contact that was never felt, for example.
[[nodiscard]] nlohmann::ordered_json rendering_json(const RenderingStudySettings& settings,
                                                    const std::vector<RenderingRow>& rows);

/// What follows takes what `rendering_json` made, or a file of it. @throws nlohmann::json::exception for anything else

/// As a file: a line for each scene and network.
[[nodiscard]] std::string rendering_file(const nlohmann::ordered_json& study);

/// For a terminal: a line for each scene and network, what the columns mean, and each class beside its goal.
[[nodiscard]] std::string rendering_text(const nlohmann::ordered_json& study);

/// For a terminal: each scene with E_dev, share of the true force, largest change of force and least P, remote beside
/// local; a table for each kind of networks.
[[nodiscard]] std::string rendering_side_by_side(const nlohmann::ordered_json& study);

/// Each class beside its goal, for a page: the worst of its scenes, of medians over the seeds.
[[nodiscard]] std::string rendering_markdown(const nlohmann::ordered_json& study);

/// A row for each scene, network, rendering and quantity.
[[nodiscard]] std::string rendering_csv(const nlohmann::ordered_json& study);

/// Displayed stiffness and E_dev of each class behind each network, remote and local (rendering.gnuplot): the worst of
/// its scenes, of medians over the seeds.
[[nodiscard]] results::Figure rendering_figure(const nlohmann::ordered_json& study);

}  // namespace forcebound::lab
