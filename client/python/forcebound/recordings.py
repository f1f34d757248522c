"""Recordings (MCAP) of client, server and simulated loop as numpy's structured arrays.

    recording = recordings.read("run.mcap")
    ticks = recording.ticks                     # one row for each tick
    plt.plot(ticks["time_s"], ticks["applied_N"][:, 0])

Columns have the names of the C++ records, with units; `recordings.TICK` and the like say what each is. A vector is a
column of (n, dof), or of (n, joints) for joints; in one that is absent all numbers are nan.
"""

from __future__ import annotations

import enum
import json
import os
from dataclasses import dataclass
from typing import Any

import numpy as np

from forcebound import _native

__all__ = [
    "FORCE",
    "ForceOrigin",
    "ForcePolicy",
    "MOTION",
    "Recording",
    "SessionState",
    "TICK",
    "TruncatedRecordingError",
    "read",
]

SessionState = enum.IntEnum("SessionState", _native.session_states, start=0)
SessionState.__doc__ = "The column `state` of ticks."
ForcePolicy = enum.IntEnum("ForcePolicy", _native.force_policies, start=0)
ForcePolicy.__doc__ = "The column `policy` of ticks: what became of the newest force by its age."
ForceOrigin = enum.IntEnum("ForceOrigin", _native.force_origins, start=0)
ForceOrigin.__doc__ = "The column `rendering` of ticks: where the force asked for came from."

TICK = {
    "tick": "1, 2, 3, ...",
    "time_s": "of the reading, client's clock",
    "interval_s": "since the previous reading",
    "latency_s": "from the reading to the command",
    "state": "of the session: SessionState",
    "policy": "what the late-force policy did: ForcePolicy",
    "rendering": "where the force asked for came from: ForceOrigin",
    "contact": "the device touches a surface",
    "motion_sequence": "of the motion sent on this tick; 0: none",
    "force_sequence": "of the motion that the force used answers; 0: none",
    "force_age_s": "since that motion's reading",
    "position": "reading of the tip [m]",
    "joint": "readings of the joints [m] or [rad]",
    "request_N": "force asked for, after the late-force policy",
    "applied_N": "force commanded",
    "remote_N": "what the newest answer alone would request",
    "local_N": "of the scene at the client",
    "model_N": "of the server's local models at the device's own place",
    "model_deviation_m": "how far the newest answer moved a mass at the client",
    "model_trust": "the share of the models that counts, by how they foretold the answers; nan: there is none",
    "penetration_m": "below the surface; <= 0: no contact; nan: not known",
    "displayed_N": "component of the applied force out of that surface",
    "energy_J": "that the law may spend now: the ledger",
    "xi": "share of the coming interval's dissipation that the law will credit",
    "audit_J": "the ground-truth energy balance P at the command, of a simulated device",
    "audit_minimum_J": "the least P so far, between ticks too: never below 0 if the device was passive",
    "buttons": "bit k: button k is pressed",
    "gripper": "0: closed, 1: open; nan: there is none",
    "orientation": "of the handle, quaternion w, x, y, z; nan: not known",
}
FORCE = {
    "receive_time_s": "of arrival, client's clock (client alone)",
    "round_trip_s": "since the reading of the motion it answers (client alone)",
    "sequence": "of this force: 1, 2, 3, ...",
    "motion_sequence": "of the motion it answers",
    "motion_device_time_s": "of that motion's reading, client's clock",
    "force_N": "of the environment",
    "position": "where it was computed [m]",
    "contact": "a surface is touched there",
    "contact_normal": "unit, out of that surface; nan: no contact",
    "penetration_m": "below that surface",
    "server_receive_time_s": "of the motion, server's clock",
    "server_send_time_s": "server's clock",
    "compute_time_s": "spent on the scene",
    "server_parts_N": "of the force, that of parts which are not handed over; nan: none",
}
MOTION = {
    "receive_time_s": "of arrival, server's clock",
    "session": "its number",
    "sequence": "1, 2, 3, ... for each client",
    "device_time_s": "of the reading, client's clock",
    "position": "of the tip [m]",
    "buttons": "bit k: button k is pressed",
    "gripper": "0: closed, 1: open; nan: there is none",
    "orientation": "of the handle, quaternion w, x, y, z; nan: not known",
}


@dataclass(frozen=True)
class Recording:
    """What a recording has. A client's has ticks and forces, a server's motions and sent forces."""

    file: str
    complete: bool  # it ends as it should and nothing is damaged; that of a killed process does not end so
    flaw: str  # what is missing, and which bytes are damaged; empty: nothing
    info: dict[str, str]  # the run's settings, as text
    totals: dict[str, str] | None  # what the session counted, as text; None: its end is missing
    summary: dict[str, Any] | None  # as the client prints and writes it; None: there are no ticks
    ticks: np.ndarray  # (n,) with the columns of TICK
    forces: np.ndarray  # (n,) with the columns of FORCE
    motions: np.ndarray  # (n,) with the columns of MOTION
    sent: np.ndarray  # (n,) with the columns of FORCE, but for the client's


class TruncatedRecordingError(EOFError):
    """A recording ends in the middle, as that of a killed process does, or part of it is damaged. `recording` has all
    that is whole."""

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        counted = {
            "ticks": recording.ticks,
            "forces": recording.forces,
            "motions": recording.motions,
            "sent forces": recording.sent,
        }
        read_so_far = ", ".join(f"{len(rows)} {name}" for name, rows in counted.items() if len(rows)) or "no records"
        super().__init__(
            f"{recording.file}: incomplete: {recording.flaw}; read: {read_so_far} (partial=True accepts that)"
        )


def read(file: str | os.PathLike, *, partial: bool = False) -> Recording:
    """Reads a recording.

    OSError if the file cannot be read; ValueError if it is no recording; TruncatedRecordingError, an EOFError that
    carries what was read, where it ends too early or part of it is damaged, unless `partial` accepts that.
    """
    path = os.fspath(file)
    with open(path, "rb"):
        pass
    read_ = _native.read_recording(path)
    summary = read_.pop("summary")
    recording = Recording(file=path, summary=json.loads(summary) if summary else None, **read_)
    if not recording.complete and not partial:
        raise TruncatedRecordingError(recording)
    return recording
