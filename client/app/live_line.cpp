#include "forcebound/client/app/live_line.hpp"

#include <fmt/format.h>

#include <array>

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
  const auto milliseconds = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-6; };
  const std::string age = has_force_ ? fmt::format("{:.0f} ms", milliseconds(age_ns_)) : "-";
  return fmt::format("{} {} ticks  {:.3f} N  age {}  RTT {:.1f} ms  E {:.3g} J  P {:.3g} J",
                     kStates[static_cast<std::size_t>(state_.load())], ticks_.load(), force_N_.load(), age,
                     milliseconds(round_trip_ns_), energy_J_.load(), audit_J_.load());
}

}  // namespace forcebound::client
