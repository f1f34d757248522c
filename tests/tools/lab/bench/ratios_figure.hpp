#pragma once

#include <filesystem>

#include "tests/tools/lab/bench/results.hpp"

namespace forcebound::lab {

/// Draws the ratios as bars from 1, the reference, on a logarithmic axis, with the required bounds.
/// @throws std::runtime_error as `draw` does
void draw_ratios(const BenchResults& results, const std::filesystem::path& png);

}  // namespace forcebound::lab
