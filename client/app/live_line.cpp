#include "forcebound/client/app/live_line.hpp"

#include <array>
#include <cstdio>

namespace forcebound::client {
namespace {

constexpr std::array kStates{"connecting", "active", "stale", "reconnecting"};

}  // namespace

void LiveLine::on_tick(const record::TickRecord& tick) noexcept {
  ticks_ = tick.tick;
  state_ = tick.state;
  has_force_ = tick.force_sequence != 0;
  age_ns_ = tick.force_age.count();
  force_N_ = tick.applied.norm();
  energy_J_ = tick.energy_J;
  audit_J_ = tick.audit_J;
}

void LiveLine::on_force(const record::ForceRecord& force) noexcept { round_trip_ns_ = force.round_trip.count(); }

std::string LiveLine::text() const {
  std::array<char, 32> age{"-"};
  std::array<char, 200> line{};
  if (has_force_) std::snprintf(age.data(), age.size(), "%.0f ms", static_cast<double>(age_ns_) * 1e-6);
  std::snprintf(line.data(), line.size(),
                "%-12s ticks %-8llu force age %-9s force %6.3f N  energy %9.3g J  P %9.3g J  RTT %.1f ms",
                kStates[static_cast<std::size_t>(state_.load())], static_cast<unsigned long long>(ticks_), age.data(),
                force_N_.load(), energy_J_.load(), audit_J_.load(), static_cast<double>(round_trip_ns_) * 1e-6);
  return line.data();
}

}  // namespace forcebound::client
