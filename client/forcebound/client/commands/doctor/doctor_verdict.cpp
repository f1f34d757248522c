#include "forcebound/client/commands/doctor/doctor_verdict.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "forcebound/client/commands/doctor/felt_stiffness.hpp"
#include "forcebound/client/runtime/priority.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::client::commands {
namespace {

using Where = Advice::Where;

// More urgent than any ratio: a client's Hello does not get through.
constexpr double kUrgencyMost = 1000;
// What did no harm in this run, but will under load.
constexpr double kUrgencyPermission = 0.5;
// From here on a grade is poor.
constexpr double kPoor = 4;

std::string ms_text(double time_ms) { return text::rounded(time_ms) + " ms"; }

std::string share_text(double share) { return text::rounded(100 * share) + " %"; }

/// What is felt beside a scene that runs at the client.
double limit_of_round_trip_ms(wire::ServerParts parts, const DoctorLimits& limits) {
  return parts == wire::ServerParts::held ? limits.held_ms : limits.round_trip_ms;
}

void advise_on_loss(const DoctorFindings& findings, const DoctorLimits& limits, std::vector<Advice>& changes) {
  const NetworkFindings& network = findings.network;
  const bool up = network.up.loss() >= network.down.loss();
  const WayFindings& worse = up ? network.up : network.down;
  if (worse.loss() <= limits.loss) return;
  const std::string way = up ? "to the server" : "from the server";
  changes.push_back(
      {.where = Where::network,
       .urgency = worse.loss() / limits.loss,
       .change = "Find where datagrams " + way + " are lost: a wireless link, a queue that is full, a limit of rate.",
       .why = share_text(worse.loss()) + " are lost on the way " + way + "; up to " + share_text(limits.loss) +
              " nothing is felt of it"});
}

void advise_on_delay(const DoctorFindings& findings, const DoctorLimits& limits, std::vector<Advice>& changes) {
  const NetworkFindings& network = findings.network;
  const wire::ServerParts parts = findings.handshake.server_parts;
  const double limit_ms = limit_of_round_trip_ms(parts, limits);
  if (network.round_trip.p50_ms > limit_ms) {
    const bool held = parts == wire::ServerParts::held;
    changes.push_back(
        {.where = Where::network,
         .urgency = network.round_trip.p50_ms / limit_ms,
         .change = held ? "Use a nearer server, or a scene without forces that are held: forcebound-server --explain "
                          "says which are."
                        : "Use a nearer server, or a way to it with fewer hops.",
         .why = "the round trip is " + ms_text(network.round_trip.p50_ms) + ", and " +
                (held ? "some of this scene's forces are held meanwhile" : "local rendering was measured up to ") +
                (held ? "" : ms_text(limit_ms))});
  }
  const double jitter_ms = network.round_trip.p99_ms - network.round_trip.p50_ms;
  if (jitter_ms > limits.jitter_ms) {
    const bool up = network.up.above_least.p99_ms >= network.down.above_least.p99_ms;
    changes.push_back({.where = Where::network,
                       .urgency = jitter_ms / limits.jitter_ms,
                       .change = "Keep other traffic off the way " + std::string(up ? "to" : "from") +
                                 " the server, or give these datagrams precedence; use a cable in place of a wireless "
                                 "link.",
                       .why = "one round trip in a hundred takes " + ms_text(jitter_ms) +
                              " longer than the median, most of it " + (up ? "up" : "down")});
  }
  if (network.longest_gap_ms > limits.gap_ms) {
    changes.push_back({.where = Where::network,
                       .urgency = network.longest_gap_ms / limits.gap_ms,
                       .change = "Find what interrupts the network: a roaming or sleeping wireless link, a failing "
                                 "route, a server that stalls.",
                       .why = "no new force came for " + ms_text(network.longest_gap_ms) +
                              "; the server's forces fade after " + ms_text(limits.gap_ms)});
  }
}

void advise_on_path(const DoctorFindings& findings, std::vector<Advice>& changes) {
  const PathFindings& path = findings.path;
  if (!path.up_tried || path.up_bytes >= path.up_most_bytes) return;
  changes.push_back(
      {.where = Where::network,
       .urgency = kUrgencyMost,
       .change =
           "Let packets of " + std::to_string(path.up_most_bytes + path.header_bytes) +
           " bytes through: raise the MTU of the tunnel or link that is too narrow, and let it report so by ICMP.",
       .why = (path.up_bytes == 0 ? "none that may not be taken apart reached the server"
                                  : "whole, only packets up to " + std::to_string(path.up_bytes + path.header_bytes) +
                                        " bytes reach the server") +
              std::string("; a client asks for a session in one of that size")});
}

void advise_on_server(const DoctorFindings& findings, const DoctorLimits& limits, std::vector<Advice>& changes) {
  const NetworkFindings& network = findings.network;
  if (network.at_server.p99_ms > limits.at_server_ms) {
    changes.push_back({.where = Where::server,
                       .urgency = network.at_server.p99_ms / limits.at_server_ms,
                       .change = "Give the scene a coarser model (accuracy = \"auto\" picks it by the round trip), or "
                                 "the server a faster or less loaded machine.",
                       .why = "one answer in a hundred stays at the server for " + ms_text(network.at_server.p99_ms) +
                              ", longer than a tick"});
  }
  if (findings.network.drift) {
    const ClockDrift& drift = *findings.network.drift;
    const double surely_ppm = std::abs(drift.ppm) - drift.uncertain_ppm;
    if (surely_ppm > limits.drift_ppm) {
      changes.push_back({.where = Where::server,
                         .urgency = surely_ppm / limits.drift_ppm,
                         .change = "Let a service such as chrony discipline the clock of the machine that drifts.",
                         .why = "the two clocks drift apart by " + text::rounded(std::abs(drift.ppm)) +
                                " ppm, and local models allow for " + text::rounded(limits.drift_ppm)});
    }
  }
}

/// What the tick's thread lacks, the cheapest first.
void advise_on_ticks(const DoctorFindings& findings, const DoctorLimits& limits, std::vector<Advice>& changes) {
  const MachineFindings& machine = findings.machine;
  const double late = machine.late_share() / limits.late_share;
  const double idle_late = machine.idle_late_share() / limits.late_share;
  const std::string late_words = share_text(machine.late_share()) + " of the ticks came late";
  if (!machine.grant.first_in_first_out) {
    changes.push_back(
        {.where = Where::machine,
         .urgency = std::max(late, kUrgencyPermission),
         .change = "Permit real-time priority: a file in /etc/security/limits.d with 'USER - rtprio " +
                   std::to_string(client::kTickPriority) + "' and 'USER - memlock unlimited', then log in again.",
         .why = "the tick's thread does not get SCHED_FIFO, so that any other work may delay it; " + late_words});
  } else if (late > 1) {
    const bool machine_itself = idle_late > 1;
    changes.push_back({.where = Where::machine,
                       .urgency = late,
                       .change = machine_itself
                                     ? "Use a machine of its own in place of a virtual or shared one, or a kernel with "
                                       "PREEMPT_RT, and turn its power saving off."
                                     : "Leave a processor to the client: other work at real-time priority delays it.",
                       .why = late_words + " in spite of SCHED_FIFO" +
                              (machine_itself ? ", and so did those of a thread that only sleeps"
                                              : ", and those of a thread that only sleeps did not")});
  }
}

void advise_on_sleep(const DoctorFindings& findings, const DoctorLimits& limits, std::vector<Advice>& changes) {
  const MachineFindings& machine = findings.machine;
  const double latency_us = longest_exit_latency_us(machine.sleep_states);
  if (latency_us > limits.exit_latency_us && !machine.grant.processors_awake) {
    // Measured late ticks say more than what a state may take.
    const double urgency = machine.late_share() > limits.late_share ? 1 : kUrgencyPermission;
    changes.push_back(
        {.where = Where::machine,
         .urgency = urgency,
         .change = machine.can_keep_awake
                       ? "Permit real-time priority: the client then keeps the processors awake by itself."
                       : "Let the client write /dev/cpu_dma_latency (a udev rule with GROUP and "
                         "MODE=\"0660\"), so that it keeps the processors awake.",
         .why = "processors may sleep so deep that waking up takes " + text::rounded(latency_us) + " us"});
  }
  if (machine.grant.first_in_first_out && !machine.grant.memory_locked) {
    changes.push_back({.where = Where::machine,
                       .urgency = kUrgencyPermission,
                       .change = "Permit locked memory: 'USER - memlock unlimited' in /etc/security/limits.d.",
                       .why = "memory may be moved to disk, and the tick waits until it is back"});
  }
}

DoctorVerdict::Grade grade_of(const std::vector<Advice>& changes, bool of_machine) {
  double most = 0;
  for (const Advice& advice : changes) {
    if ((advice.where == Where::machine) == of_machine) most = std::max(most, advice.urgency);
  }
  if (most > kPoor) return DoctorVerdict::Grade::poor;
  return most > 1 ? DoctorVerdict::Grade::fair : DoctorVerdict::Grade::good;
}

std::string scene_words(const Handshake& handshake) {
  const std::string name = "Scene '" + handshake.scene + "': ";
  switch (handshake.server_parts) {
    case wire::ServerParts::none:
      return name + "all of it runs at the client, so it feels as it does without a network.";
    case wire::ServerParts::modelled:
      return name + "what moves comes with local models, and all else runs at the client: as at the client above.";
    case wire::ServerParts::held:
      break;
  }
  return name +
         (handshake.pieces_offered > 0 ? "some of it runs at the client, and some of its forces are held"
                                       : "its forces are held") +
         " until the next answer: as at the server above.";
}

std::string summary_words(const DoctorFindings& findings, const DoctorVerdict& verdict) {
  return std::string("The network is ") + name_of(verdict.network) + " (round trip " +
         ms_text(findings.network.round_trip.p50_ms) + ", " + ms_text(findings.network.round_trip.p99_ms) +
         " p99; lost " + share_text(findings.network.up.loss()) + " up, " + share_text(findings.network.down.loss()) +
         " down), the machine " + name_of(verdict.machine) + " (" + share_text(findings.machine.late_share()) +
         " of the ticks late).";
}

}  // namespace

const char* name_of(DoctorVerdict::Grade grade) noexcept {
  switch (grade) {
    case DoctorVerdict::Grade::good:
      return "good";
    case DoctorVerdict::Grade::fair:
      return "fair";
    case DoctorVerdict::Grade::poor:
      break;
  }
  return "poor";
}

const char* name_of(Advice::Where where) noexcept {
  switch (where) {
    case Where::network:
      return "network";
    case Where::machine:
      return "machine";
    case Where::server:
      break;
  }
  return "server";
}

DoctorVerdict doctor_verdict(const DoctorFindings& findings, const DoctorLimits& limits) {
  DoctorVerdict verdict;
  advise_on_path(findings, verdict.changes);
  advise_on_loss(findings, limits, verdict.changes);
  advise_on_delay(findings, limits, verdict.changes);
  advise_on_server(findings, limits, verdict.changes);
  advise_on_ticks(findings, limits, verdict.changes);
  advise_on_sleep(findings, limits, verdict.changes);
  std::stable_sort(verdict.changes.begin(), verdict.changes.end(),
                   [](const Advice& a, const Advice& b) { return a.urgency > b.urgency; });
  verdict.network = grade_of(verdict.changes, false);
  verdict.machine = grade_of(verdict.changes, true);

  const auto part_of = [&](const auto& shares) {
    return std::clamp(felt_share(shares, findings.network.round_trip.p50_ms), 0.0, 1.0);
  };
  verdict.felt.reserve(felt_classes().size());
  for (const FeltClass& each : felt_classes()) {
    verdict.felt.push_back({.name = each.name,
                            .words = each.words,
                            .at_client = part_of(each.at_client),
                            .at_server = part_of(each.at_server)});
  }
  verdict.scene = scene_words(findings.handshake);
  verdict.summary = summary_words(findings, verdict);
  return verdict;
}

}  // namespace forcebound::client::commands
