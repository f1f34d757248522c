#include "forcebound/client/commands/doctor/network_findings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "forcebound/time/percentile.hpp"

namespace forcebound::client::commands {
namespace {

double in_milliseconds(Nanoseconds time) { return 1e3 * time::to_seconds(time); }

/// The delays of one way above the least of them.
std::vector<double> above_least_ms(std::vector<double> delays_ms) {
  if (delays_ms.empty()) return delays_ms;
  const double least_ms = *std::min_element(delays_ms.begin(), delays_ms.end());
  for (double& each_ms : delays_ms) each_ms -= least_ms;
  return delays_ms;
}

}  // namespace

Delays delays_of(std::vector<double> values_ms) {
  if (values_ms.empty()) return {};
  return {.count = values_ms.size(),
          .p50_ms = time::percentile_of(values_ms, 0.5),
          .p90_ms = time::percentile_of(values_ms, 0.9),
          .p99_ms = time::percentile_of(values_ms, 0.99),
          .p999_ms = time::percentile_of(values_ms, 0.999),
          .max_ms = *std::max_element(values_ms.begin(), values_ms.end())};
}

NetworkFindings network_findings(std::span<const AnsweredMotion> answers, const client::ForceStream::Counts& counts,
                                 Nanoseconds longest_gap) {
  NetworkFindings found;
  std::vector<client::ClockOffset::Exchange> exchanges;
  exchanges.reserve(answers.size());
  for (const AnsweredMotion& answer : answers) exchanges.push_back(answer.times);
  found.drift = clock_drift(exchanges);
  const bool drifts = found.drift && std::abs(found.drift->ppm) > found.drift->uncertain_ppm;
  const double drift = drifts ? 1e-6 * found.drift->ppm : 0;

  std::vector<double> round_trips_ms;
  std::vector<double> at_server_ms;
  std::vector<double> up_ms;
  std::vector<double> down_ms;
  for (std::vector<double>* const list : {&round_trips_ms, &at_server_ms, &up_ms, &down_ms})
    list->reserve(answers.size());
  for (const client::ClockOffset::Exchange& times : exchanges) {
    // Against the first exchange, or a double would round times of two machines to more than a delay may be.
    const client::ClockOffset::Exchange& first = exchanges.front();
    const double drifted_ms = drift * in_milliseconds(times.read - first.read);
    round_trips_ms.push_back(in_milliseconds(times.arrived - times.read));
    at_server_ms.push_back(in_milliseconds(times.answered - times.received));
    up_ms.push_back(in_milliseconds((times.received - first.received) - (times.read - first.read)) - drifted_ms);
    down_ms.push_back(in_milliseconds((times.arrived - first.arrived) - (times.answered - first.answered)) +
                      drifted_ms);
  }
  // What is on its way counts as lost up.
  const std::uint64_t in_flight = std::min(counts.in_flight, counts.lost_up);
  found.round_trip = delays_of(std::move(round_trips_ms));
  found.at_server = delays_of(std::move(at_server_ms));
  found.up = {.sent = counts.sent - std::min(in_flight, counts.sent),
              .lost = counts.lost_up - in_flight,
              .reordered = counts.motions_reordered,
              .duplicated = counts.motions_duplicated,
              .above_least = delays_of(above_least_ms(std::move(up_ms)))};
  found.down = {.sent = counts.received + counts.lost_down,
                .lost = counts.lost_down,
                .reordered = counts.reordered,
                .duplicated = counts.duplicated,
                .above_least = delays_of(above_least_ms(std::move(down_ms)))};
  found.unanswered = counts.unanswered;
  found.longest_gap_ms = in_milliseconds(longest_gap);
  return found;
}

}  // namespace forcebound::client::commands
