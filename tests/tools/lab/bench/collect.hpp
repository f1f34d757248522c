#pragma once

#include <filesystem>

#include "tests/tools/lab/bench/results.hpp"

namespace forcebound::lab {

/// The results from the files that deploy/bench wrote to a folder:
///
///     machine.txt                            "key: value" lines
///     N-sockperf.txt  N-ours.json  N-client.json  N-cyclictest.txt   alternating runs, N = 1, 2, ...
///     N-capacity-echo.json  N-capacity-SCENE-RENDERING.json
///     *_benchmark.json                       Google Benchmark's
///
/// Figures are medians over the alternating runs.
///
/// @throws std::runtime_error naming the file or the benchmark that is missing or cannot be read
[[nodiscard]] BenchResults collect(const std::filesystem::path& folder);

}  // namespace forcebound::lab
