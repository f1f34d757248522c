#pragma once

#include <nlohmann/json.hpp>

#include "forcebound/record/summary.hpp"
#include "tests/unit/record/sample_run.hpp"

namespace forcebound::record {

using nlohmann::json;
using record::test::vector_of;

inline json json_of(const Summary& summary) { return json::parse(summary.to_json()); }

/// One axis; tick n at n ms.
inline TickRecord tick_at(std::uint64_t n) {
  TickRecord tick;
  tick.tick = n;
  tick.time = Nanoseconds{static_cast<std::int64_t>(n) * 1'000'000};
  tick.interval = Nanoseconds{1'000'000};
  tick.position = tick.joint = tick.request = tick.applied = vector_of({0});
  return tick;
}

inline TickRecord contact_at(std::uint64_t n, double force_N, double penetration_m) {
  TickRecord tick = tick_at(n);
  tick.request = tick.applied = vector_of({-force_N});
  tick.displayed_N = force_N;
  tick.penetration_m = penetration_m;
  tick.contact = !(penetration_m <= 0);
  return tick;
}

inline ForceRecord force_at(std::uint64_t n, std::uint64_t answers) {
  ForceRecord force;
  force.receive_time = Nanoseconds{static_cast<std::int64_t>(n) * 1'000'000};
  force.force.sequence = force.force.motion_sequence = answers;
  return force;
}

inline RunInfo audited() {
  RunInfo info;
  info.audited = true;
  return info;
}

inline TickRecord connected(TickRecord tick) {
  tick.state = SessionState::active;
  return tick;
}

}  // namespace forcebound::record
