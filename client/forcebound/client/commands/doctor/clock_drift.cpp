#include "forcebound/client/commands/doctor/clock_drift.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <vector>

#include "forcebound/time/clock.hpp"

namespace forcebound::client::commands {
namespace {

using client::ClockOffset;

constexpr std::size_t kDriftWindows = 10;
constexpr std::size_t kDriftWindowsLeast = 3;
constexpr double kDriftSpan_s_min = 0.1;

/// The offset of the clocks at one time, less that of the first exchange.
struct OffsetPoint {
  double at_s = 0;
  double offset_s = 0;
  double delay_s = std::numeric_limits<double>::infinity();  ///< of both ways together
};

/// Differences to the first exchange: times of two machines are too large for a double's rounding.
OffsetPoint offset_point(const ClockOffset::Exchange& exchange, const ClockOffset::Exchange& first) {
  const double read_s = time::to_seconds(exchange.read - first.read);
  const double received_s = time::to_seconds(exchange.received - first.received);
  const double answered_s = time::to_seconds(exchange.answered - first.received);
  const double arrived_s = time::to_seconds(exchange.arrived - first.read);
  return {.at_s = 0.5 * (read_s + arrived_s),
          .offset_s = 0.5 * ((received_s - read_s) + (answered_s - arrived_s)),
          .delay_s = (arrived_s - read_s) - (answered_s - received_s)};
}

/// Of each window with exchanges, the one with the least delay.
std::vector<OffsetPoint> shortest_of_windows(std::span<const ClockOffset::Exchange> exchanges) {
  const double begin_s = time::to_seconds(exchanges.front().arrived - exchanges.front().read);
  const double end_s = time::to_seconds(exchanges.back().arrived - exchanges.front().read);
  if (!(end_s - begin_s >= kDriftSpan_s_min)) return {};
  std::array<OffsetPoint, kDriftWindows> shortest{};
  for (const ClockOffset::Exchange& exchange : exchanges) {
    const double share = (time::to_seconds(exchange.arrived - exchanges.front().read) - begin_s) / (end_s - begin_s);
    const auto window = std::min(kDriftWindows - 1,
                                 static_cast<std::size_t>(std::max(0.0, share * static_cast<double>(kDriftWindows))));
    const OffsetPoint point = offset_point(exchange, exchanges.front());
    if (point.delay_s < shortest[window].delay_s) shortest[window] = point;
  }
  std::vector<OffsetPoint> points;
  points.reserve(shortest.size());
  std::copy_if(shortest.begin(), shortest.end(), std::back_inserter(points),
               [](const OffsetPoint& point) { return std::isfinite(point.delay_s); });
  return points;
}

}  // namespace

std::optional<ClockDrift> clock_drift(std::span<const ClockOffset::Exchange> exchanges) {
  if (exchanges.size() < kDriftWindowsLeast) return std::nullopt;
  const std::vector<OffsetPoint> points = shortest_of_windows(exchanges);
  if (points.size() < kDriftWindowsLeast) return std::nullopt;

  const auto count = static_cast<double>(points.size());
  double mean_at_s = 0;
  double mean_offset_s = 0;
  double least_delay_s = std::numeric_limits<double>::infinity();
  for (const OffsetPoint& point : points) {
    mean_at_s += point.at_s / count;
    mean_offset_s += point.offset_s / count;
    least_delay_s = std::min(least_delay_s, point.delay_s);
  }
  double squares = 0;
  double products = 0;
  for (const OffsetPoint& point : points) {
    squares += (point.at_s - mean_at_s) * (point.at_s - mean_at_s);
    products += (point.at_s - mean_at_s) * (point.offset_s - mean_offset_s);
  }
  if (!(squares > 0)) return std::nullopt;
  const double slope = products / squares;

  double one_sided = 0;
  double scatter = 0;
  for (const OffsetPoint& point : points) {
    one_sided += std::abs(point.at_s - mean_at_s) / squares * 0.5 * (point.delay_s - least_delay_s);
    const double off = point.offset_s - mean_offset_s - slope * (point.at_s - mean_at_s);
    scatter += off * off;
  }
  const double error = std::sqrt(scatter / (count - 2) / squares);
  constexpr double kPpm = 1e6;
  return ClockDrift{.ppm = kPpm * slope, .uncertain_ppm = kPpm * (one_sided + 2 * error)};
}

}  // namespace forcebound::client::commands
