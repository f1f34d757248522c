"""A client of a live server: the programs' own client, with a simulated device and hand.

    with client.Client("127.0.0.1:47800", scene="sphere", device="omni", hand="trace-sphere", duration_s=10) as running:
        while running.is_running():
            latest = running.ticks(-1)          # look on while it runs
            ...
    running.summary["displayed_stiffness_N_per_m"]

Its tick is a thread of C++ at 1 kHz in which no Python ever runs: an interpreter that collects garbage or waits for
another thread would make it late. Laws and environments in Python are for `simulation`; a real device, whose hand one
must not experiment on from an interpreter, is for forcebound-client.
"""

from __future__ import annotations

import atexit
import json
import os
import secrets
import threading
from collections.abc import Mapping
from typing import Any

import numpy as np

from forcebound import _native
from forcebound.devices import Device, device_from
from forcebound.laws import Law, OwnLaw

__all__ = ["Client"]


class Client:
    """Connects when it is made, and ticks between `start` and its end; `with` starts and stops it.

    server       "HOST:PORT"
    scene        asked for; empty: the server's own
    device       name, TOML file or Device; simulated
    hand         the simulated hand, as `devices.hands()` explains
    law          name, library of forcebound_law.h or class of `laws`; `memory` and `law_parameters` as in `simulation`
    rendering    "local": what can be, at the client; "remote", and with a law that has a server-side law always: forces
                 are computed at the server
    duration_s   until it ends by itself; 0: when stopped
    once         gives up if the server does not answer for 5 s, or refuses another session
    ticks_kept   most ticks kept for `ticks`; None: all of duration_s up to ten minutes, or one minute without one
    recording    MCAP file for every tick and force
    key, server_key, known_servers, shared_key, trust_new, insecure    as forcebound-client's options --key,
                 --server-key, --known-servers, --psk, --trust-new, --insecure

    ValueError for what is refused of device, hand, law or server.
    """

    def __init__(
        self,
        server: str,
        *,
        scene: str = "",
        device: str | os.PathLike | Device = "wall-1dof",
        hand: str = "press",
        law: str | os.PathLike | type[Law] = "fba-exact",
        memory: str = "capped",
        law_parameters: Mapping[str, float] | None = None,
        rendering: str = "local",
        duration_s: float = 0,
        once: bool = False,
        ticks_kept: int | None = None,
        recording: str | os.PathLike = "",
        seed: int | None = None,
        key: str | os.PathLike = "",
        server_key: str | os.PathLike = "",
        known_servers: str | os.PathLike = "",
        shared_key: str | os.PathLike = "",
        trust_new: bool = False,
        insecure: bool = False,
    ) -> None:
        if isinstance(law, OwnLaw):
            raise TypeError("law: an OwnLaw is in Python, which has no place in a tick of real time; use simulation")
        if isinstance(law, type) and issubclass(law, Law):
            law = law.info.name
        if rendering not in ("remote", "local"):
            raise ValueError(f"rendering must be 'remote' or 'local', got {rendering!r}")
        if not 0 <= duration_s < 1e6:
            raise ValueError(f"duration_s must be 0 to 1e6 s, got {duration_s}")
        device = device_from(device)
        if ticks_kept is None:
            ticks_kept = int(min(duration_s or 60, 600) / device.facts.period_s) + 10
        self._client = _native.LiveClient(
            server=server,
            scene=scene,
            device=device,
            hand=hand,
            law=os.fspath(law),
            memory=memory,
            parameters=dict(law_parameters or {}),
            renders_locally=rendering == "local",
            duration_s=float(duration_s),
            once=once,
            ticks_kept=ticks_kept,
            recording=os.fspath(recording),
            seed=secrets.randbits(63) | 1 if seed is None else seed,
            key=os.fspath(key),
            server_key=os.fspath(server_key),
            known_servers=os.fspath(known_servers),
            shared_key=os.fspath(shared_key),
            trust_new=trust_new,
            insecure=insecure,
        )
        self._thread: threading.Thread | None = None
        self._error: BaseException | None = None

    def start(self) -> "Client":
        """Starts to tick, in a thread of its own. Once: a client that has ended is not started again."""
        if self._thread is not None:
            raise RuntimeError("a client is started once: make another")
        # A client may have no end: the interpreter's end is one. A daemon, as that would be waited for first otherwise.
        atexit.register(self.stop)
        self._thread = threading.Thread(target=self._run, name="forcebound-client", daemon=True)
        self._thread.start()
        return self

    def is_running(self) -> bool:
        return self._thread is not None and self._thread.is_alive()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Until it has ended, or for that time; whether it has ended. Raises what ended it early."""
        if self._thread is None:
            raise RuntimeError("the client was not started")
        self._thread.join(timeout_s)
        if self._thread.is_alive():
            return False
        if self._error is not None:
            error, self._error = self._error, None
            raise error
        return True

    def stop(self) -> None:
        """Ends with zero force, and waits for that; at most 3 s where the server does not answer."""
        self._client.stop()
        if self._thread is not None:
            self.wait()

    def run(self) -> dict[str, Any]:
        """Starts, waits for the end and gives the summary. Ctrl-C stops the client and is raised."""
        self.start()
        try:
            while not self.wait(0.1):
                pass
        except KeyboardInterrupt:
            self.stop()
            raise
        return self.summary

    def ticks(self, first: int = 0) -> np.ndarray:
        """A copy of the ticks kept so far from number `first` on, below zero from the end; columns of recordings.TICK."""
        if first < 0:
            first = max(0, self._client.ticks_kept + first)
        return self._client.ticks(first)

    @property
    def ticks_not_kept(self) -> int:
        """Ticks for which there was no room; a recording has them."""
        return self._client.ticks_not_kept

    @property
    def problems(self) -> list[str]:
        """What went wrong with keys, handshakes or the recording so far, a line each."""
        return self._client.problems

    @property
    def summary(self) -> dict[str, Any]:
        """As forcebound-client's; RuntimeError before the end."""
        return json.loads(self._client.summary())

    @property
    def why_no_session(self) -> str:
        """Why it gave up; empty: it did not. RuntimeError before the end."""
        return self._client.why_no_session()

    def __enter__(self) -> "Client":
        return self.start()

    def __exit__(self, *_: object) -> None:
        self.stop()

    def _run(self) -> None:
        try:
            self._client.run()
        except BaseException as error:  # noqa: BLE001 - raised again by wait
            self._error = error
        finally:
            atexit.unregister(self.stop)
