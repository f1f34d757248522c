#pragma once

#include "forcebound/client/commands/doctor/findings.hpp"

namespace forcebound::client::commands {

/// An examination that found nothing to complain of: a near server, a scene that all runs at the client, a quiet
/// machine.
inline DoctorFindings sound_findings() {
  DoctorFindings found{.server = "127.0.0.1:47800", .seconds = 5, .degrees_of_freedom = 3};
  found.handshake = {.hellos = 1,
                     .took = time::Nanoseconds{310'000},
                     .sessions = 1,
                     .scene = "sphere",
                     .simulated = "ball (sphere): surface stiffness_N_per_m 10000, damping_N_s_per_m 0",
                     .pieces_offered = 2,
                     .server_parts = wire::ServerParts::none};
  found.pieces_received = 2;
  found.piece_bytes = 380;
  const Delays near{.count = 5000, .p50_ms = 0.3, .p90_ms = 0.4, .p99_ms = 0.6, .p999_ms = 0.9, .max_ms = 1.7};
  const Delays none{.count = 5000};
  found.network = {.round_trip = near,
                   .at_server = {.count = 5000, .p50_ms = 0.01, .p90_ms = 0.02, .p99_ms = 0.03, .p999_ms = 0.1},
                   .up = {.sent = 5000, .above_least = none},
                   .down = {.sent = 5000, .above_least = none},
                   .longest_gap_ms = 2,
                   .drift = ClockDrift{.ppm = 3, .uncertain_ppm = 1}};
  found.clocks = {.known = true, .ahead_ms = -1234.5, .uncertain_ms = 0.15};
  found.path = {
      .up_bytes = 1200, .up_tried = true, .up_most_bytes = 1200, .down_bytes = 400, .header_bytes = 28, .mtu = 1500};
  const record::IdleTimer quiet{
      .wake_ups = 5000, .late = 0, .p50_us = 1000, .p99_us = 1010, .p999_us = 1040, .max_us = 1100};
  found.machine.sleep_states = {{.name = "POLL", .exit_latency_us = 0, .enabled = true},
                                {.name = "C6", .exit_latency_us = 133, .enabled = true}};
  found.machine.can_keep_awake = true;
  found.machine.priority_limit = 95;
  found.machine.memory_limit = kUnlimited;
  found.machine.grant = {.first_in_first_out = true,
                         .memory_locked = true,
                         .processors_awake = true,
                         .text = "SCHED_FIFO 80, memory locked, processors kept awake"};
  found.machine.tick = quiet;
  found.machine.idle = quiet;
  return found;
}

}  // namespace forcebound::client::commands
