#pragma once

#include <cstdint>

/// What may go wrong in a run without ending it, each with a counter: COUNT(NAME, ONE, MANY), in the order in which a
/// summary lists them. NAME is that of the member below, of the recording's field and of the summary's; ONE and MANY
/// say what one count or several mean. A new counter is a new row, and a line that counts.
#define FORCEBOUND_FAULT_COUNTS(COUNT)                                                                                 \
  COUNT(foreign_session, "datagram of another session or sender", "datagrams of another session or sender")            \
  COUNT(non_finite_requests, "force asked for that was not finite, shown as zero",                                     \
        "forces asked for that were not finite, shown as zero")                                                        \
  COUNT(readings_too_far, "reading further away than the device can be, shown as zero force",                          \
        "readings further away than the device can be, shown as zero force")                                           \
  COUNT(failed_writes, "command that may not have reached the motors",                                                 \
        "commands that may not have reached the motors")                                                               \
  COUNT(effects_outside_facts,                                                                                         \
        "force that the device reports in effect when its file does not allow it: the worst case is charged",          \
        "forces that the device reports in effect when its file does not allow it: the worst case is charged")         \
  COUNT(releases_outside_facts,                                                                                        \
        "release that the device reports when its file does not allow it: the worst case is charged",                  \
        "releases that the device reports when its file does not allow them: the worst case is charged")               \
  COUNT(withdrawn_forces, "force commanded too long after the reading, and made zero",                                 \
        "forces commanded too long after the reading, and made zero")                                                  \
  COUNT(law_faults, "force that the law failed to give, or gave as no finite number: made zero",                       \
        "forces that the law failed to give, or gave as no finite number: made zero")                                  \
  COUNT(impossible_intervals, "tick whose clock stood still or ran back: nothing credited",                            \
        "ticks whose clock stood still or ran back: nothing credited")                                                 \
  COUNT(held_too_long, "tick beyond the hold time of a device that cannot let go: not passive",                        \
        "ticks beyond the hold time of a device that cannot let go: not passive")                                      \
  COUNT(released_by_device, "tick so late that the device let go of the force",                                        \
        "ticks so late that the device let go of the force")                                                           \
  COUNT(stale_readings, "tick without a new reading of the device, whose force was held on",                           \
        "ticks without a new reading of the device, whose forces were held on")                                        \
  COUNT(reconnects, "time the session was lost and requested again", "times the session was lost and requested again") \
  COUNT(refusals, "request for a session that the server refused", "requests for a session that the server refused")   \
  COUNT(scenes_refused, "scene of the server refused: its forces were held instead",                                   \
        "scenes of the server refused: their forces were held instead")                                                \
  COUNT(parts_quarantined, "part of the scene at the client whose force was not finite, left out from then on",        \
        "parts of the scene at the client whose forces were not finite, left out from then on")                        \
  COUNT(searches_exhausted,                                                                                            \
        "tick on which the scene at the client had too much of a mesh to search: its force was held instead",          \
        "ticks on which the scene at the client had too much of a mesh to search: its forces were held instead")       \
  COUNT(models_refused, "local model of the server refused: its force was held instead",                               \
        "local models of the server refused: their forces were held instead")                                          \
  COUNT(slew_bounded, "tick on which --force-slew limited the change of the requested force",                          \
        "ticks on which --force-slew limited the change of the requested force")                                       \
  COUNT(torque_slew_bounded, "tick on which --torque-slew limited the change of the requested torque",                 \
        "ticks on which --torque-slew limited the change of the requested torque")                                     \
  COUNT(trips_of_speed, "time the hand was faster than the device's limit: no force meanwhile",                        \
        "times the hand was faster than the device's limit: no force meanwhile")                                       \
  COUNT(trips_of_turn, "time the hand turned faster than the device's limit: no force meanwhile",                      \
        "times the hand turned faster than the device's limit: no force meanwhile")                                    \
  COUNT(trips_of_workspace, "time the hand left the device's workspace: the force faded",                              \
        "times the hand left the device's workspace: the force faded")                                                 \
  COUNT(trips_of_heat, "time the motors' load was above the device's limit: the force was bounded",                    \
        "times the motors' load was above the device's limit: the force was bounded")                                  \
  COUNT(trips_of_dead_man, "time the dead-man button was not pressed: no force meanwhile",                             \
        "times the dead-man button was not pressed: no force meanwhile")                                               \
  COUNT(trips_of_frozen_readings,                                                                                      \
        "time readings of the device did not change, though the force on it had: no force meanwhile",                  \
        "times readings of the device did not change, though the force on it had: no force meanwhile")                 \
  COUNT(watchdog_stops, "time the device was stopped because the tick did not run",                                    \
        "times the device was stopped because the tick did not run")                                                   \
  COUNT(send_failures, "datagram the system did not take", "datagrams the system did not take")                        \
  COUNT(missed_ticks, "tick left out: the loop woke too late for it",                                                  \
        "ticks left out: the loop woke too late for them")                                                             \
  COUNT(device_gaps_cut, "pause so long that the simulated device stood still in it",                                  \
        "pauses so long that the simulated device stood still in them")                                                \
  COUNT(device_frozen_joints, "time the simulation of a joint's friction failed for 1 ms",                             \
        "times the simulation of a joint's friction failed for 1 ms")                                                  \
  COUNT(device_faulty_commands, "command not finite at the device, shown as zero",                                     \
        "commands not finite at the device, shown as zero")                                                            \
  COUNT(device_handle_refused, "orientation or gripper opening of the device that cannot be true, taken for absent",   \
        "orientations or gripper openings of the device that cannot be true, taken for absent")                        \
  COUNT(datagrams_overflowed, "datagram lost here: the socket was full", "datagrams lost here: the socket was full")   \
  COUNT(port_unreachable, "datagram refused by the server's machine: port unreachable (ICMP)",                         \
        "datagrams refused by the server's machine: port unreachable (ICMP)")                                          \
  COUNT(events_dropped, "log line missing: the queue was full", "log lines missing: their queue was full")             \
  COUNT(tick_allocations, "heap allocation inside the tick", "heap allocations inside the tick")                       \
  COUNT(recording_dropped, "record missing: the recorder's queue was full",                                            \
        "records missing: the recorder's queue was full")                                                              \
  COUNT(recording_unwritten, "record missing: it could not be written", "records missing: they could not be written")

namespace forcebound::record {

/// Of each fault, how often it was.
struct FaultCounts {
#define FORCEBOUND_MEMBER(name, one, many) std::uint64_t name = 0;
  FORCEBOUND_FAULT_COUNTS(FORCEBOUND_MEMBER)
#undef FORCEBOUND_MEMBER
};

/// Calls visit(NAME, count, ONE, MANY) for each.
template <class Counts, class Visit>
void each_fault(Counts& counts, Visit&& visit) {
#define FORCEBOUND_VISIT(name, one, many) visit(#name, counts.name, one, many);
  FORCEBOUND_FAULT_COUNTS(FORCEBOUND_VISIT)
#undef FORCEBOUND_VISIT
}

}  // namespace forcebound::record
