#include "forcebound/client/commands/doctor/doctor_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::client::commands {
namespace {

using Json = nlohmann::ordered_json;
using text::rounded;

constexpr std::size_t kFindingColumns = 16;

/// A line "  name          words", continued below the words.
std::string finding(const std::string& name, const std::string& words) {
  std::string line = "  " + name;
  line.resize(std::max(line.size() + 1, kFindingColumns), ' ');
  return text::wrapped(line + words, kFindingColumns) + '\n';
}

std::string words_of_delays(const Delays& delays) {
  if (delays.count == 0) return "not known";
  return rounded(delays.p50_ms) + " ms median, " + rounded(delays.p90_ms) + " p90, " + rounded(delays.p99_ms) +
         " p99, " + rounded(delays.p999_ms) + " p99.9, " + rounded(delays.max_ms) + " max";
}

std::string words_of_way(const WayFindings& way) {
  return std::to_string(way.sent) + " sent, " + std::to_string(way.lost) + " lost (" + rounded(100 * way.loss()) +
         " %), " + std::to_string(way.reordered) + " reordered, " + std::to_string(way.duplicated) +
         " duplicated; delays above the least " + rounded(way.above_least.p50_ms) + " ms median, " +
         rounded(way.above_least.p99_ms) + " p99, " + rounded(way.above_least.max_ms) + " max";
}

std::string words_of_handshake(const DoctorFindings& findings) {
  const Handshake& handshake = findings.handshake;
  std::string words =
      rounded(1e3 * time::to_seconds(handshake.took)) + " ms, " + text::counted(handshake.hellos, "Hello") +
      "; scene '" + handshake.scene + "' with " +
      text::counted(static_cast<std::uint64_t>(findings.degrees_of_freedom), "degree of freedom", "degrees of freedom");
  if (handshake.pieces_offered > 0) {
    words += "; handed over in " + text::counted(handshake.pieces_offered, "piece") + ", " +
             rounded(1e-3 * static_cast<double>(findings.piece_bytes)) + " kB received";
  }
  if (handshake.sessions > 1)
    words += "; the session was lost and renewed, " + text::counted(handshake.sessions, "session");
  return words;
}

std::string words_of_path(const PathFindings& path) {
  std::string words;
  if (!path.up_tried) {
    words = "up not tried";
  } else if (path.up_bytes == 0) {
    words = "up: no datagram that may not be taken apart arrived";
  } else {
    words = "up: packets of " + std::to_string(path.up_bytes + path.header_bytes) + " bytes arrive whole" +
            (path.up_bytes >= path.up_most_bytes ? ", the largest that the protocol sends" : ", larger ones do not");
  }
  if (path.down_bytes > 0) {
    words += "; down: the largest that came had " + std::to_string(path.down_bytes + path.header_bytes) + " bytes";
  }
  if (path.mtu) words += "; MTU " + std::to_string(*path.mtu) + " as this machine believes";
  return words;
}

std::string words_of_clocks(const DoctorFindings& findings) {
  if (!findings.clocks.known) return "not known";
  std::string words = "the server's is " + rounded(std::abs(findings.clocks.ahead_ms)) + " ms " +
                      (findings.clocks.ahead_ms < 0 ? "behind" : "ahead") + ", +- " +
                      rounded(findings.clocks.uncertain_ms);
  if (const auto& drift = findings.network.drift) {
    words += "; it drifts by " + rounded(drift->ppm) + " ppm, +- " + rounded(drift->uncertain_ppm);
  }
  return words;
}

std::string words_of_sleep(const MachineFindings& machine) {
  if (machine.sleep_states.empty()) return "the system tells of none";
  std::string words;
  for (const SleepState& state : machine.sleep_states) {
    words += (words.empty() ? "" : ", ") + state.name + " " + rounded(state.exit_latency_us) + " us" +
             (state.enabled ? "" : " (disabled)");
  }
  return words + "; " +
         (machine.grant.processors_awake ? "kept awake by this program"
          : machine.can_keep_awake       ? "/dev/cpu_dma_latency may be written"
                                         : "/dev/cpu_dma_latency may not be written");
}

std::string words_of_timer(const record::IdleTimer& timer) {
  if (timer.wake_ups == 0) return "not known";
  return rounded(timer.p50_us, 4) + " us median, " + rounded(timer.p99_us, 4) + " p99, " + rounded(timer.p999_us, 4) +
         " p99.9, " + rounded(timer.max_us, 4) + " max; " + std::to_string(timer.late) + " of " +
         std::to_string(timer.wake_ups) + " late";
}

std::string words_of_felt(const FeltHere& felt) {
  return rounded(100 * felt.at_client) + " % at the client, " + rounded(100 * felt.at_server) +
         " % at the server: " + felt.words;
}

Json json_of(const Delays& delays) {
  if (delays.count == 0) return nullptr;
  return {{"count", delays.count}, {"p50", delays.p50_ms},   {"p90", delays.p90_ms},
          {"p99", delays.p99_ms},  {"p999", delays.p999_ms}, {"max", delays.max_ms}};
}

Json json_of(const WayFindings& way) {
  return {{"sent", way.sent},
          {"lost", way.lost},
          {"loss", way.loss()},
          {"reordered", way.reordered},
          {"duplicated", way.duplicated},
          {"above_least_ms", json_of(way.above_least)}};
}

Json json_of(const record::IdleTimer& timer) {
  if (timer.wake_ups == 0) return nullptr;
  return {{"wake_ups", timer.wake_ups}, {"late", timer.late},    {"p50", timer.p50_us},
          {"p99", timer.p99_us},        {"p999", timer.p999_us}, {"max", timer.max_us}};
}

Json limit_json(std::uint64_t limit) { return limit == kUnlimited ? Json() : Json(limit); }

const char* name_of_parts(wire::ServerParts parts) {
  switch (parts) {
    case wire::ServerParts::none:
      return "none";
    case wire::ServerParts::modelled:
      return "modelled";
    case wire::ServerParts::held:
      break;
  }
  return "held";
}

Json handshake_json(const DoctorFindings& findings) {
  const Handshake& handshake = findings.handshake;
  return {{"took_ms", 1e3 * time::to_seconds(handshake.took)},
          {"hellos", handshake.hellos},
          {"sessions", handshake.sessions},
          {"degrees_of_freedom", findings.degrees_of_freedom},
          {"scene", handshake.scene},
          {"simulated", handshake.simulated},
          {"server_parts", name_of_parts(handshake.server_parts)},
          {"pieces_offered", handshake.pieces_offered},
          {"pieces_received", findings.pieces_received},
          {"piece_bytes", findings.piece_bytes}};
}

Json path_json(const PathFindings& path) {
  Json up = path.up_tried ? Json(path.up_bytes) : Json();
  return {{"up_payload_bytes", std::move(up)},
          {"up_tried_bytes", path.up_most_bytes},
          {"down_payload_bytes", path.down_bytes},
          {"header_bytes", path.header_bytes},
          {"mtu_bytes", path.mtu ? Json(*path.mtu) : Json()}};
}

Json clocks_json(const DoctorFindings& findings) {
  const auto& drift = findings.network.drift;
  const bool known = findings.clocks.known;
  return {{"server_ahead_ms", known ? Json(findings.clocks.ahead_ms) : Json()},
          {"server_ahead_off_ms", known ? Json(findings.clocks.uncertain_ms) : Json()},
          {"drift_ppm", drift ? Json(drift->ppm) : Json()},
          {"drift_off_ppm", drift ? Json(drift->uncertain_ppm) : Json()}};
}

Json machine_json(const MachineFindings& machine) {
  Json states = Json::array();
  for (const SleepState& state : machine.sleep_states) {
    states.push_back({{"name", state.name}, {"exit_latency_us", state.exit_latency_us}, {"enabled", state.enabled}});
  }
  return {{"sleep_states", std::move(states)},
          {"can_keep_awake", machine.can_keep_awake},
          {"priority_limit", limit_json(machine.priority_limit)},
          {"memory_limit_bytes", limit_json(machine.memory_limit)},
          {"first_in_first_out", machine.grant.first_in_first_out},
          {"memory_locked", machine.grant.memory_locked},
          {"processors_awake", machine.grant.processors_awake},
          {"granted", machine.grant.text},
          {"tick_us", json_of(machine.tick)},
          {"missed_ticks", machine.missed_ticks},
          {"idle_timer_us", json_of(machine.idle)}};
}

Json verdict_json(const DoctorVerdict& verdict) {
  Json felt = Json::array();
  for (const FeltHere& each : verdict.felt) {
    felt.push_back({{"class", each.name},
                    {"words", each.words},
                    {"displayed_at_client", each.at_client},
                    {"displayed_at_server", each.at_server}});
  }
  Json changes = Json::array();
  for (const Advice& advice : verdict.changes) {
    changes.push_back({{"where", name_of(advice.where)},
                       {"urgency", advice.urgency},
                       {"change", advice.change},
                       {"why", advice.why}});
  }
  return {{"network", name_of(verdict.network)},
          {"machine", name_of(verdict.machine)},
          {"summary", verdict.summary},
          {"scene", verdict.scene},
          {"felt", std::move(felt)},
          {"changes", std::move(changes)}};
}

}  // namespace

std::string doctor_text(const DoctorFindings& findings, const DoctorVerdict& verdict) {
  const NetworkFindings& network = findings.network;
  const MachineFindings& machine = findings.machine;
  std::string out =
      text::wrapped(
          "Server " + findings.server + ", " + rounded(findings.seconds) + " s, a motion on each tick of 1 ms", 2) +
      '\n';
  out += finding("handshake", words_of_handshake(findings));
  out += finding("round trip", words_of_delays(network.round_trip));
  out += finding("at the server", words_of_delays(network.at_server));
  out += finding("up", words_of_way(network.up));
  out += finding("down", words_of_way(network.down));
  out += finding("longest gap", rounded(network.longest_gap_ms) + " ms without a new force; " +
                                    text::counted(network.unanswered, "motion") + " answered by way of a newer one");
  out += finding("path", words_of_path(findings.path));
  out += finding("clocks", words_of_clocks(findings));
  out += finding("sleep states", words_of_sleep(machine));
  out += finding("real time", machine.grant.text);
  out += finding("tick", words_of_timer(machine.tick) + ", " + std::to_string(machine.missed_ticks) + " left out");
  out += finding("idle timer", words_of_timer(machine.idle));
  out += "\nWhat it will feel like, as displayed stiffness over that without a network\n";
  for (const FeltHere& each : verdict.felt) out += finding(each.name, words_of_felt(each));
  out += text::wrapped("  " + verdict.scene, 2) + '\n';
  out += '\n' + text::wrapped(verdict.summary, 0) + '\n';
  if (verdict.changes.empty()) return out + "Nothing needs to change.\n";
  out += "What to change first\n";
  int number = 0;
  for (const Advice& advice : verdict.changes) {
    out += text::wrapped("  " + std::to_string(++number) + ". " + advice.change + " Because " + advice.why + ".", 5) +
           '\n';
  }
  return out;
}

nlohmann::ordered_json doctor_json(const DoctorFindings& findings, const DoctorVerdict& verdict) {
  return {{"server", findings.server},
          {"seconds", findings.seconds},
          {"handshake", handshake_json(findings)},
          {"round_trip_ms", json_of(findings.network.round_trip)},
          {"at_server_ms", json_of(findings.network.at_server)},
          {"up", json_of(findings.network.up)},
          {"down", json_of(findings.network.down)},
          {"unanswered", findings.network.unanswered},
          {"longest_gap_ms", findings.network.longest_gap_ms},
          {"faults",
           {{"malformed", findings.malformed},
            {"datagrams_overflowed", findings.overflowed},
            {"port_unreachable", findings.unreachable}}},
          {"path", path_json(findings.path)},
          {"clocks", clocks_json(findings)},
          {"machine", machine_json(findings.machine)},
          {"verdict", verdict_json(verdict)}};
}

}  // namespace forcebound::client::commands
