"""A live server of a simulator of one's own, which steps at its own rate: 20 Hz and more.

    with Server("wall") as serving:
        while True:
            for probe in serving.ask():                     # each hand that is there
                touch = Touch(place_m=[*probe.place_m[:2], 0], normal=[0, 0, 1])
                serving.report(probe.client, [touch])       # what it meets: a wall at z = 0
            time.sleep(1 / 60)

Each device touches the simulator with a probe: a ball on a virtual coupling, which the server moves at the device's rate,
on a thread of C++ in which no Python ever runs. Before a step the simulator asks where the probes are and what they pushed
since it asked last; after it, it reports what each probe meets. Until the next report the probe goes on against that, at
the server and at a client that renders locally. Without a report for 0.25 s its force fades, to zero after 1 s.
"""

from __future__ import annotations

import atexit
import json
import os
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcebound import _native

__all__ = ["Probe", "Push", "Server", "Touch"]


class Push(NamedTuple):
    """What a probe gave a place that was reported, since it was asked for before. All pushes of a body add up; a step of h
    seconds applies impulse_Ns / h, whatever time that was given in.

    body        as it was reported
    place_m     (3,), likewise
    impulse_Ns  (3,)
    """

    body: int
    place_m: NDArray[np.float64]
    impulse_Ns: NDArray[np.float64]


class Probe(NamedTuple):
    """A client's probe as it was asked for.

    client            a number that no other client has, before or after
    interval_s        since it was asked for before, by the client's motions; 0: the first time, or none came
    place_m           (3,), of its centre
    velocity_m_per_s  (3,)
    device_m          (3,), where the device is: the coupling pulls the probe there
    buttons           bit k: button k is pressed
    pushes            on what the newest report told of and on what the one before did; up to 6, which add up
    """

    client: int
    interval_s: float
    place_m: NDArray[np.float64]
    velocity_m_per_s: NDArray[np.float64]
    device_m: NDArray[np.float64]
    buttons: int
    pushes: list[Push]


@dataclass
class Touch:
    """A place that a probe touches, or may before the next report. Pushed by f it goes on, by z from there:

        z'' = W (f + others - k z - c z' + dry friction)

    body              0 to 2**32 - 1: as the simulator calls it
    place_m           of the surface, nearest to the probe's centre; within 100 m of the origin
    normal            unit, out of the surface
    velocity_m_per_s  of the surface there; up to 100 m/s
    mobility_per_kg   W, (3, 3), symmetric: J M^-1 J' there; or a number for all directions; up to 1e4; 0: it stands
    others_N          on it there now, of all but the probe and c: gravity, its own springs; up to 1e5 N
    spring_N_per_m    k, 0 to 1e6; 0 where W is
    damper_N_s_per_m  c, 0 to 1e5
    dry_friction_N    of what it slides on, 0 to 1e5
    friction          of the probe along the surface, 0 to 10
    radius_m          the surface goes on so far along its plane from place_m; above 0
    """

    place_m: ArrayLike
    normal: ArrayLike
    body: int = 0
    velocity_m_per_s: ArrayLike = (0, 0, 0)
    mobility_per_kg: ArrayLike = 0
    others_N: ArrayLike = (0, 0, 0)
    spring_N_per_m: float = 0
    damper_N_s_per_m: float = 0
    dry_friction_N: float = 0
    friction: float = 0
    radius_m: float = float("inf")


class Server:
    """Takes its address when it is made, and serves between `start` and `stop`; `with` starts and stops it.

    name         by which clients may ask for it, as for a scene
    simulated    what it is, in one line for people; empty: its name
    listen       "HOST:PORT"; port 0: a free one, see `address`
    key, clients, shared_key, insecure    as forcebound-server's options --key, --clients, --psk, --insecure
    clients_max  at once, 1 to 64; clients_per_address: of them of one IP address; 0: as many
    idle_s       a client ends that sends no motion for so long; 1 to 1e6 s
    probe_radius_m             0: a point; up to 1
    probe_mass_kg              0.001 to 100
    probe_stiffness_N_per_m    of the coupling, up to 1e5: no wall feels harder
    probe_damping_N_s_per_m    up to 1e4

    ValueError for what is refused of these, RuntimeError for an address that cannot be had. Not thread-safe: one thread
    asks and reports.
    """

    def __init__(
        self,
        name: str = "simulator",
        *,
        simulated: str = "",
        listen: str = "127.0.0.1:47800",
        key: str | os.PathLike = "",
        clients: str | os.PathLike = "",
        shared_key: str | os.PathLike = "",
        insecure: bool = False,
        clients_max: int = 64,
        clients_per_address: int = 0,
        idle_s: float = 60,
        probe_radius_m: float = 0,
        probe_mass_kg: float = 0.03,
        probe_stiffness_N_per_m: float = 2000,
        probe_damping_N_s_per_m: float = 8,
    ) -> None:
        self._server = _native.LiveServer(
            name=name,
            simulated=simulated,
            listen=listen,
            key=os.fspath(key),
            clients=os.fspath(clients),
            shared_key=os.fspath(shared_key),
            insecure=insecure,
            clients_max=clients_max,
            clients_per_address=clients_per_address,
            idle_s=idle_s,
            probe_radius_m=probe_radius_m,
            probe_mass_kg=probe_mass_kg,
            probe_stiffness_N_per_m=probe_stiffness_N_per_m,
            probe_damping_N_s_per_m=probe_damping_N_s_per_m,
        )

    def start(self) -> "Server":
        """Starts to serve, in a thread of its own. Once: a server that was stopped is not started again."""
        self._server.start()
        atexit.register(self.stop)  # so that clients are told
        return self

    def stop(self) -> None:
        """Says good-bye to all clients, and waits for the thread. RuntimeError: why that had ended by itself."""
        atexit.unregister(self.stop)
        self._server.stop()

    def ask(self) -> list[Probe]:
        """What the probes did since they were asked for before. Waits for nobody. RuntimeError unless it runs."""
        return [Probe(*fields, [Push(*push) for push in pushes]) for *fields, pushes in self._server.ask()]

    def report(self, client: int, touches: Iterable[Touch]) -> None:
        """What a client's probe meets after the step that began when it was asked for last: up to 3 touches; none: nothing.

        ValueError or TypeError for a client that was not there then and for a touch that is not what it has to be: counted,
        and what was reported before holds. RuntimeError unless it runs. Waits for nobody.
        """
        self._server.report(client, list(touches))

    def is_running(self) -> bool:
        return self._server.is_running()

    @property
    def address(self) -> str:
        """"127.0.0.1:47800"."""
        return self._server.address

    @property
    def summary(self) -> dict[str, Any]:
        """As of 0.1 s ago at most: "clients" now, "busy", "reports", "reports_refused", "silences" (times that a probe had
        no report for 0.25 s), and in "counts" every count that forcebound-server prints at its end."""
        return json.loads(self._server.summary())

    def __enter__(self) -> "Server":
        return self.start()

    def __exit__(self, *_: object) -> None:
        self.stop()
