#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/rendering/true_force_meter.hpp"

namespace forcebound::lab {

/// A run of the programs, as a client recorded it.
struct LiveRun {
  std::string scene;
  nlohmann::ordered_json summary{};  ///< as the client's --summary writes it
  RenderingFigures figures{};        ///< by the true scene at the places that the device read
};

/// @throws std::runtime_error `FILE: ...` if it cannot be read or is no client's, SceneError if its scene is unknown
/// here
[[nodiscard]] LiveRun read_live_run(const std::string& file);

/// A line for each run, below the name of its scene. Displayed stiffness is over that of the scene's run with remote
/// rendering that had the least round trip.
[[nodiscard]] std::string live_runs_table(const std::vector<LiveRun>& runs, text::Colour colour);

}  // namespace forcebound::lab
