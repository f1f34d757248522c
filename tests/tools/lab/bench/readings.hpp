#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

/// Reads the output of deploy/bench's tools. Each throws std::runtime_error for what it cannot read.
namespace forcebound::lab {

/// Of sockperf's ping-pong with --full-rtt.
struct Sockperf {
  double p50_us = 0;
  double p99_us = 0;
};
[[nodiscard]] Sockperf read_sockperf(std::string_view text);

/// The latencies of `cyclictest --verbose --nsecs` of one thread, in their order [us].
[[nodiscard]] std::vector<double> read_cyclictest_us(std::string_view text);

/// The periods between wake-ups with these latencies: period + latency_n - latency_{n-1}.
[[nodiscard]] std::vector<double> periods_us(double period_us, const std::vector<double>& latencies_us);

/// Processor time per iteration [ns] by benchmark: the median where a benchmark was repeated. From Google Benchmark's
/// JSON.
using Benchmarks = std::map<std::string, double>;
[[nodiscard]] Benchmarks read_benchmarks(std::string_view json);

/// Those named "PREFIX/SIZE" or "PREFIX/name:SIZE", by size.
[[nodiscard]] std::map<double, double> by_size(const Benchmarks& benchmarks, const std::string& prefix);

/// The exponent e of cost = c size^e that fits best (least squares of the logarithms).
/// @throws std::runtime_error unless there are at least four sizes, and all numbers are positive
[[nodiscard]] double growth(const std::map<double, double>& cost_by_size);

}  // namespace forcebound::lab
