#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

/// What the tools of deploy/bench wrote, as numbers. Each refuses what it cannot read by a std::runtime_error.
namespace forcebound::lab {

/// Of sockperf's ping-pong with --full-rtt.
struct Sockperf {
  double p50_us = 0;
  double p99_us = 0;
};
[[nodiscard]] Sockperf read_sockperf(std::string_view text);

/// The latencies of `cyclictest --verbose --nsecs` of one thread, in their order [us].
[[nodiscard]] std::vector<double> read_cyclictest_us(std::string_view text);

/// The periods between wake-ups that are late by so much: period + latency_n - latency_{n-1}.
[[nodiscard]] std::vector<double> periods_us(double period_us, const std::vector<double>& latencies_us);

/// Processor time per iteration [ns] by benchmark: the median where a benchmark was repeated. From Google Benchmark's
/// JSON.
using Benchmarks = std::map<std::string, double>;
[[nodiscard]] Benchmarks read_benchmarks(std::string_view json);

/// Those called "PREFIX/SIZE" or "PREFIX/name:SIZE", by their size.
[[nodiscard]] std::map<double, double> by_size(const Benchmarks& benchmarks, const std::string& prefix);

/// The exponent e of cost = c size^e that fits best (least squares of the logarithms).
/// @throws std::runtime_error unless there are at least four sizes, and all numbers are positive
[[nodiscard]] double growth(const std::map<double, double>& cost_by_size);

}  // namespace forcebound::lab
