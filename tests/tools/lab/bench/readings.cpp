#include "tests/tools/lab/bench/readings.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>

namespace forcebound::lab {
namespace {

constexpr std::size_t kSizesLeast = 4;

std::optional<double> number(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return std::nullopt;
  return value;
}

/// The number behind `key` and an equals sign.
double number_behind(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(key);
  const std::size_t sign = at == std::string_view::npos ? at : text.find('=', at);
  const auto value = sign == std::string_view::npos ? std::nullopt : number(text.substr(sign + 1));
  if (!value) throw std::runtime_error("no '" + std::string(key) + "' in sockperf's output");
  return *value;
}

/// Google Benchmark writes NaN as a bare word, which is not JSON.
std::string without_bare_words(std::string_view json) {
  constexpr std::array<std::string_view, 2> kWords{"NaN", "Infinity"};
  std::string out;
  out.reserve(json.size());
  for (bool in_string = false; !json.empty();) {
    const bool escaped = in_string && json.front() == '\\' && json.size() > 1;
    if (json.front() == '"') in_string = !in_string;
    const auto word = std::ranges::find_if(kWords, [&](std::string_view each) { return json.starts_with(each); });
    if (!in_string && word != kWords.end()) {
      if (out.ends_with('-')) out.pop_back();
      out += "null";
      json.remove_prefix(word->size());
      continue;
    }
    const std::size_t taken = escaped ? 2 : 1;
    out += json.substr(0, taken);
    json.remove_prefix(taken);
  }
  return out;
}

double in_ns(const nlohmann::json& run) {
  const std::string unit = run.at("time_unit");
  const double scale = unit == "s" ? 1e9 : unit == "ms" ? 1e6 : unit == "us" ? 1e3 : 1;
  const nlohmann::json& time = run.at("cpu_time");
  if (!time.is_number()) throw std::runtime_error(run.at("name").get<std::string>() + " has no time");
  return scale * time.get<double>();
}

}  // namespace

Sockperf read_sockperf(std::string_view text) {
  return {.p50_us = number_behind(text, "percentile 50.000"), .p99_us = number_behind(text, "percentile 99.000")};
}

std::vector<double> read_cyclictest_us(std::string_view text) {
  std::vector<double> all;
  std::istringstream lines{std::string(text)};
  std::string line;
  while (std::getline(lines, line)) {
    // "  0:  CYCLE:  NANOSECONDS"
    const std::size_t first = line.find(':');
    const std::size_t second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos || number(line) != 0) continue;
    const auto latency_ns = number(std::string_view(line).substr(second + 1));
    if (latency_ns) all.push_back(1e-3 * *latency_ns);
  }
  if (all.size() < 2) throw std::runtime_error("no latencies in cyclictest's output");
  return all;
}

std::vector<double> periods_us(double period_us, const std::vector<double>& latencies_us) {
  std::vector<double> periods;
  for (std::size_t i = 1; i < latencies_us.size(); ++i) {
    periods.push_back(period_us + latencies_us[i] - latencies_us[i - 1]);
  }
  return periods;
}

Benchmarks read_benchmarks(std::string_view text) {
  const nlohmann::json json = nlohmann::json::parse(without_bare_words(text), nullptr, false);
  if (!json.is_object() || !json.contains("benchmarks")) throw std::runtime_error("not the output of Google Benchmark");
  Benchmarks all;
  for (const auto& run : json["benchmarks"]) {
    const bool aggregate = run.value("run_type", "") == "aggregate";
    if (aggregate && run.value("aggregate_name", "") != "median") continue;
    std::string name = run.value("run_name", run.at("name").get<std::string>());
    // A suffix for fixed iterations is not part of the name.
    name = name.substr(0, name.find("/iterations:"));
    name = name.substr(0, name.find("/repeats:"));
    if (aggregate || !all.contains(name)) all[name] = in_ns(run);
  }
  return all;
}

std::map<double, double> by_size(const Benchmarks& benchmarks, const std::string& prefix) {
  std::map<double, double> sizes;
  for (const auto& [name, time_ns] : benchmarks) {
    if (!name.starts_with(prefix + "/")) continue;
    const std::string_view argument = std::string_view(name).substr(prefix.size() + 1);
    const std::size_t colon = argument.find(':');
    const auto size = number(colon == std::string_view::npos ? argument : argument.substr(colon + 1));
    if (size) sizes[*size] = time_ns;
  }
  return sizes;
}

double growth(const std::map<double, double>& cost_by_size) {
  if (cost_by_size.size() < kSizesLeast) {
    throw std::runtime_error("growth needs at least " + std::to_string(kSizesLeast) + " sizes, got " +
                             std::to_string(cost_by_size.size()));
  }
  const auto n = static_cast<double>(cost_by_size.size());
  double mean_x = 0;
  double mean_y = 0;
  for (const auto& [size, cost] : cost_by_size) {
    if (!(size > 0) || !(cost > 0)) throw std::runtime_error("growth needs positive sizes and costs");
    mean_x += std::log(size) / n;
    mean_y += std::log(cost) / n;
  }
  double xx = 0;
  double xy = 0;
  for (const auto& [size, cost] : cost_by_size) {
    const double x = std::log(size) - mean_x;
    xx += x * x;
    xy += x * (std::log(cost) - mean_y);
  }
  return xy / xx;
}

}  // namespace forcebound::lab
