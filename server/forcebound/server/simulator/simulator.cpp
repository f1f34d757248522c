#include "forcebound/server/simulator/simulator.hpp"

#include <algorithm>

namespace forcebound::server {

Simulator::Simulator(const ProbeFacts& probe, int seats) : probe_(probe) {
  expect_sound(probe);
  for (int i = 0; i < seats; ++i) seats_.push_back(std::make_unique<Seat>());
}

void Simulator::add_pushes(const Seat& seat, const Sample& before, Probe& probe) noexcept {
  for (const Pushed& pushed : seat.now.pushed) {
    const Report& report = seat.reports_told.at(pushed.report % seat.reports_told.size());
    if (pushed.report == 0 || report.number != pushed.report) continue;
    const auto same = std::ranges::find(before.pushed, pushed.report, &Pushed::report);
    for (std::size_t i = 0; i < report.count; ++i) {
      const Point given_Ns = same == before.pushed.end() ? Point(Point::Zero()) : same->impulse_Ns.at(i);
      const Touch& touch = report.touches.at(i);
      probe.pushes.at(probe.push_count++) = {
          .body = touch.body, .place_m = touch.place_m, .impulse_Ns = pushed.impulse_Ns.at(i) - given_Ns};
    }
  }
}

std::size_t Simulator::probes(std::span<Probe> to) noexcept {
  std::size_t count = 0;
  for (const auto& seat : seats_) {
    const Sample before = seat->now;
    if (const Sample* const newest = seat->samples.take()) seat->now = *newest;
    const Sample& now = seat->now;
    const bool same = now.client == before.client;
    if (!same) seat->reports_told = {};
    if (now.client == 0 || count == to.size()) continue;
    Probe& probe = to[count++];
    probe = {.client = now.client,
             .interval_s = same ? time::to_seconds(now.moment - before.moment) : 0,
             .place_m = now.place_m,
             .velocity_m_per_s = now.velocity_m_per_s,
             .device_m = now.device_m,
             .buttons = now.buttons};
    if (same) add_pushes(*seat, before, probe);
  }
  return count;
}

bool Simulator::report(std::uint64_t client, std::span<const Touch> touches) {
  try {
    expect_sound(touches);
  } catch (...) {
    count_refused();
    throw;
  }
  const bool stored = store(client, touches);
  (stored ? reports_ : reports_refused_).fetch_add(1, std::memory_order_relaxed);
  return stored;
}

bool Simulator::store(std::uint64_t client, std::span<const Touch> touches) noexcept {
  const auto found =
      std::ranges::find_if(seats_, [&](const auto& one) { return client != 0 && one->now.client == client; });
  if (found == seats_.end()) return false;
  Seat& seat = **found;
  Report& report = seat.reports_told.at(++seat.told % seat.reports_told.size());
  report = {.number = seat.told,
            .client = client,
            .moment = seat.now.moment,
            .place_m = seat.now.place_m,
            .velocity_m_per_s = seat.now.velocity_m_per_s,
            .count = touches.size()};
  std::ranges::copy(touches, report.touches.begin());
  seat.reports.store(report);
  return true;
}

Simulator::Counts Simulator::counts() const noexcept {
  return {.reports = reports_.load(std::memory_order_relaxed),
          .reports_refused = reports_refused_.load(std::memory_order_relaxed),
          .silences = silences_.load(std::memory_order_relaxed)};
}

}  // namespace forcebound::server
