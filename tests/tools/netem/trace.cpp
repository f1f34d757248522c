#include "tests/tools/netem/trace.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "forcebound/text/file.hpp"
#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::netem {
namespace {

constexpr std::string_view kCsvHeader = "send_time_ms,rtt_ms";
constexpr double kLongest_ms = 1e11;  // three years, so that no sum of times overflows

std::optional<Nanoseconds> milliseconds(std::string_view text) {
  const auto value = text::finite_number(text);
  if (!value || *value < 0 || *value > kLongest_ms) return std::nullopt;
  return Nanoseconds{std::llround(*value * 1e6)};
}

RttTrace read_csv(text::LineReader& lines) {
  std::vector<RttTrace::Sample> samples;
  while (lines.next()) {
    const std::string_view line = lines.line();
    if (line.empty()) continue;
    const std::vector<std::string_view> fields = text::split(line, ',');
    const auto send_time = milliseconds(fields.front());
    const auto round_trip = fields.size() == 2 ? milliseconds(fields.back()) : std::nullopt;
    if (!send_time || !round_trip)
      lines.refuse("'" + std::string(line) + "': expected two numbers >= 0, send_time_ms,rtt_ms, such as 55,21");
    if (!samples.empty() && *send_time < samples.back().send_time)
      lines.refuse("'" + std::string(line) +
                   "' was sent before the row above: expected send_time_ms never to decrease");
    samples.push_back({*send_time, *round_trip});
  }
  if (samples.empty()) lines.refuse("the trace has no rows: expected at least one such as 55,21");
  return RttTrace(std::move(samples));
}

DeliveryTrace read_mahimahi(text::LineReader& lines) {
  std::vector<Nanoseconds> opportunities;
  do {
    const std::string_view line = lines.line();
    if (line.empty()) continue;
    const auto time =
        line.find_first_not_of("0123456789") == std::string_view::npos ? milliseconds(line) : std::nullopt;
    if (!time)
      lines.refuse("'" + std::string(line) +
                   "': expected one whole number of milliseconds such as 17 (mahimahi), or '" +
                   std::string(kCsvHeader) + "' as the first line (CSV)");
    if (!opportunities.empty() && *time < opportunities.back())
      lines.refuse("'" + std::string(line) + "' is before the line above: expected milliseconds never to decrease");
    opportunities.push_back(*time);
  } while (lines.next());
  if (opportunities.empty() || opportunities.back().count() == 0)
    lines.refuse("the trace ends at 0 ms: expected a last line above 0, since the trace repeats from there");
  return DeliveryTrace(std::move(opportunities));
}

}  // namespace

RttTrace::RttTrace(std::vector<Sample> samples) : samples_(std::move(samples)) {
  if (samples_.empty()) throw std::invalid_argument("a trace of round trips needs at least one sample");
  const auto earlier = [](const Sample& a, const Sample& b) { return a.send_time < b.send_time; };
  if (!std::is_sorted(samples_.begin(), samples_.end(), earlier))
    throw std::invalid_argument("a trace's times of sending must never decrease");
  if (std::any_of(samples_.begin(), samples_.end(), [](const Sample& s) { return s.round_trip.count() < 0; }))
    throw std::invalid_argument("a trace's round trips must be >= 0");
}

Nanoseconds RttTrace::duration() const noexcept { return samples_.back().send_time - samples_.front().send_time; }

std::optional<Nanoseconds> RttTrace::one_way_delay(Nanoseconds elapsed) const noexcept {
  if (duration().count() == 0) return samples_.back().round_trip / 2;
  const Nanoseconds time = samples_.front().send_time + std::max(elapsed, Nanoseconds{0}) % duration();
  const auto after = std::upper_bound(samples_.begin(), samples_.end(), time,
                                      [](Nanoseconds t, const Sample& sample) { return t < sample.send_time; });
  // The last row is where the first one takes over again, so `time` is always before it.
  const Sample& b = *after;
  const Sample& a = *(after - 1);
  if (time == a.send_time) return a.round_trip / 2;
  const Nanoseconds hole = b.send_time - a.send_time;
  if (hole > kBlackoutHole) return std::nullopt;
  // Whole numbers, so that every machine rounds alike: at most 1e9 ns between rows, split to stay within 64 bits.
  const std::int64_t rise = (b.round_trip - a.round_trip).count();
  const std::int64_t part = (time - a.send_time).count();
  const std::int64_t interpolated = rise / hole.count() * part + rise % hole.count() * part / hole.count();
  return (a.round_trip + Nanoseconds{interpolated}) / 2;
}

DeliveryTrace::DeliveryTrace(std::vector<Nanoseconds> opportunities) : opportunities_(std::move(opportunities)) {
  if (opportunities_.empty() || !std::is_sorted(opportunities_.begin(), opportunities_.end()) ||
      opportunities_.front().count() < 0 || opportunities_.back().count() <= 0)
    throw std::invalid_argument("delivery opportunities must be >= 0, never decrease, and end after 0");
}

NetworkTrace read_trace(std::istream& text, const std::string& name) {
  text::LineReader lines(text, name);
  if (!lines.next())
    lines.refuse("the file is empty: expected '" + std::string(kCsvHeader) +
                 "' and rows (CSV), or one whole millisecond per line (mahimahi)");
  if (lines.line() == kCsvHeader) return read_csv(lines);
  return read_mahimahi(lines);
}

NetworkTrace load_trace(const std::filesystem::path& file) {
  std::istringstream text(text::read_file(file.string()));
  return read_trace(text, file.string());
}

}  // namespace forcebound::netem
