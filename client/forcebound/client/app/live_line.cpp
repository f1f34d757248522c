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

void LiveLine::on_force(const record::ForceRecord& force) noexcept {
  round_trip_ns_ = force.round_trip.count();
  follower_ = force.force.answer.follower;
}

std::string LiveLine::text(std::size_t columns) const {
  const auto milliseconds = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-6; };
  const control::FollowerState follower = follower_;
  const std::array fields{
      fmt::format("{} {} ticks", kStates[static_cast<std::size_t>(state_.load())], ticks_.load()),
      follower == control::FollowerState::none ? std::string() : fmt::format("  robot {}", name_of(follower)),
      fmt::format("  {:.3f} N", force_N_.load()),
      has_force_ ? fmt::format("  age {:.0f} ms  RTT {:.2f} ms", milliseconds(age_ns_), milliseconds(round_trip_ns_))
                 : std::string("  no force yet"),
      fmt::format("  E {:.3g} mJ", 1e3 * energy_J_.load()),
      fmt::format("  P {:.3g} mJ", 1e3 * audit_J_.load()),
  };
  std::string line;
  for (const std::string& field : fields) {
    if (line.size() + field.size() > columns) break;
    line += field;
  }
  return line;
}

}  // namespace forcebound::client
