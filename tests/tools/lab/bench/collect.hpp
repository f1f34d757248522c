#pragma once

#include <filesystem>

#include "tests/tools/lab/bench/results.hpp"

namespace forcebound::lab {

/// The results from the files that deploy/bench wrote to a folder:
///
///     machine.txt                            "key: value" lines
///     N-STATE-sockperf.txt  N-STATE-ours.json  N-STATE-encrypted.json   alternating runs, N = 1, 2, ...; processors
///                                                                       "awake" or "asleep"
///     N-cyclictest.txt  N-client.json  N-client-encrypted.json
///     N-capacity-echo.json  N-capacity-SCENE-RENDERING.json  N-capacity-sphere-encrypted.json
///     *_benchmark.json                       Google Benchmark's
///
/// Figures are medians over the alternating runs.
///
/// @throws std::runtime_error naming the file or the benchmark that is missing or cannot be read
[[nodiscard]] BenchResults collect(const std::filesystem::path& folder);

}  // namespace forcebound::lab
