#include "forcebound/net/trace.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string_view>

namespace forcebound::net {
namespace {

constexpr std::string_view kCsvHeader = "send_time_ms,rtt_ms";
constexpr double kLongest_ms = 1e11;  // three years, so that no sum of times overflows

std::string_view trimmed(std::string_view line) {
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
  return line;
}

/// The lines of a trace, and errors that say which one.
class Lines {
 public:
  Lines(std::istream& text, const std::string& name) : text_(text), name_(name) {}

  bool next() {
    if (!std::getline(text_, line_)) return false;
    ++number_;
    return true;
  }
  [[nodiscard]] std::string_view line() const { return trimmed(line_); }
  [[nodiscard]] std::size_t number() const { return number_; }

  [[noreturn]] void refuse(const std::string& what) const {
    throw std::runtime_error(name_ + ":" + std::to_string(number_) + ": " + what);
  }

 private:
  std::istream& text_;
  const std::string& name_;
  std::string line_;
  std::size_t number_ = 0;
};

std::optional<Nanoseconds> milliseconds(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stopped != end || !(value >= 0 && value <= kLongest_ms)) return std::nullopt;
  return Nanoseconds{std::llround(value * 1e6)};
}

RttTrace read_csv(Lines& lines) {
  std::vector<RttTrace::Sample> samples;
  while (lines.next()) {
    const std::string_view line = lines.line();
    if (line.empty()) continue;
    const std::size_t comma = line.find(',');
    const auto send_time = milliseconds(line.substr(0, comma));
    const auto round_trip = comma == std::string_view::npos ? std::nullopt : milliseconds(line.substr(comma + 1));
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

DeliveryTrace read_mahimahi(Lines& lines) {
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
    lines.refuse("the trace ends at 0 ms: expected a last line above 0, since that is when it starts over");
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
  Lines lines(text, name);
  if (!lines.next())
    throw std::runtime_error(name + ":1: the file is empty: expected '" + std::string(kCsvHeader) +
                             "' and rows (CSV), or one whole millisecond per line (mahimahi)");
  if (lines.line() == kCsvHeader) return read_csv(lines);
  return read_mahimahi(lines);
}

NetworkTrace load_trace(const std::filesystem::path& file) {
  std::ifstream text(file);
  // A directory opens, but cannot be read.
  if (!text || std::filesystem::is_directory(file))
    throw std::runtime_error(file.string() +
                             ": cannot read this trace: " + (text ? "it is a directory" : std::strerror(errno)));
  return read_trace(text, file.string());
}

}  // namespace forcebound::net
