"""Client, network and server in virtual time: the very code of the programs, and as fast as the processor allows.

    run = simulation.simulate(10, scene="sphere", device="omni", hand="trace-sphere", law="fba-exact",
                              network="delay 50ms 10ms loss 5%")
    run.ticks["applied_N"], run.summary["passivity"]["minimum_J"]

The same settings give the same run, on every machine.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from forcebound import _native
from forcebound.devices import Device, DeviceFacts, device_from
from forcebound.laws import Law, OwnLaw
from forcebound.scenes import Scene, parse, scene_from

__all__ = ["ClosedLoop", "OwnHand", "Run", "hostile_environments", "network_words", "simulate"]

#: position (dof,) [m], time_s -> force (dof,) [N], or (force, unit normal out of the surface (dof,), depth_m).
Environment = Callable[[np.ndarray, float], Any]

#: time_s -> position (dof,) [m] in the scene's frame, or (position, velocity (dof,) [m/s]).
HandTarget = Callable[[float], Any]


class OwnHand(NamedTuple):
    """A simulated hand whose target is a function: a mass at the tip, and a spring and a damper to the target.

    The device takes a sample of the target each millisecond. A position alone moves in a straight line to the next
    sample. An exception ends the run with it.
    """

    target: HandTarget
    mass_kg: float = 0.1
    stiffness_N_per_m: float = 200
    damping_N_s_per_m: float = 1


class Run(NamedTuple):
    """A simulated run."""

    ticks: np.ndarray  # (n,) with the columns of recordings.TICK
    forces: np.ndarray  # (m,) with the columns of recordings.FORCE
    summary: dict[str, Any]  # as the client's


def hostile_environments() -> list[str]:
    """Environments that try to make the device return energy, for ClosedLoop's `environment`; "honest" is the scene."""
    return _native.environment_names()


def network_words() -> str:
    """What `network`, `up` and `down` may say, in words: the grammar of `tc ... netem`."""
    return _native.netem_help()


class ClosedLoop:
    """One client and one server over an emulated network, in virtual time.

    scene        name, TOML file or Scene; with `environment` a function it may be None
    environment  None: the scene; a function (position (dof,) [m], time_s) -> force (dof,) [N], or (force, normal,
                 depth_m); or the name of a hostile one
    device       name, TOML file or Device
    hand         the simulated hand, as `devices.hands()` explains: "press:to_m=0.01"; an OwnHand, or the target of one
    law          name, library of forcebound_law.h, class of `laws`, or an OwnLaw
    memory, law_parameters    of a law that is not an OwnLaw: "capped" or "full"; numbers by name
    network      both ways, as forcebound-lab has it: netem's words, "none", or "trace:FILE" for recorded round trips;
                 `up` and `down` are netem's words for one way
    rendering    "remote": forces are computed at the server; "local": what can be, at the client; not with a law that
                 has a server-side law
    seed         of everything that is drawn
    settle_s     the summary's contact statistics begin so long after the first contact
    hold_s, drop_s            a force older than hold_s fades, to zero at drop_s
    late_share, late_s_max    share of the ticks that are late, and by up to how much
    measured_timing           in addition, all are late as measured on a shared virtual machine
    choosing_s_max            longest time from a reading to its command
    told         DeviceFacts that the law is told in place of the true ones
    recording    MCAP file to be written
    """

    def __init__(
        self,
        *,
        scene: str | os.PathLike | Scene | None = None,
        environment: Environment | str | None = None,
        device: str | os.PathLike | Device = "wall-1dof",
        hand: str | OwnHand | HandTarget = "press",
        law: str | os.PathLike | type[Law] | OwnLaw = "fba-exact",
        memory: str = "capped",
        law_parameters: Mapping[str, float] | None = None,
        network: str = "",
        up: str | None = None,
        down: str | None = None,
        rendering: str = "remote",
        seed: int = 1,
        settle_s: float = 0,
        hold_s: float = 0.25,
        drop_s: float = 1,
        late_share: float = 0,
        late_s_max: float = 0,
        measured_timing: bool = False,
        choosing_s_max: float = 0,
        told: DeviceFacts | None = None,
        recording: str | os.PathLike | None = None,
    ) -> None:
        if rendering not in ("remote", "local"):
            raise ValueError(f"rendering must be 'remote' or 'local', got {rendering!r}")
        words, trace = _network_words(network)
        settings: dict[str, Any] = {
            "scene": _scene_of(scene, environment),
            "device": device_from(device),
            "up": words if up is None else up,
            "down": words if down is None else down,
            "renders_locally": rendering == "local",
            "seed": seed,
            "settle_s": settle_s,
            "hold_s": hold_s,
            "drop_s": drop_s,
            "late_share": late_share,
            "late_s_max": late_s_max,
            "measured_timing": measured_timing,
            "choosing_s_max": choosing_s_max,
            **_hand_settings(hand),
            **_law_settings(law, memory, law_parameters),
        }
        if callable(environment):
            settings["own_environment"] = environment
        elif environment is not None:
            settings["hostile_environment"] = environment
        if told is not None:
            settings["told"] = told
        if trace:
            settings["trace"] = trace
        if recording is not None:
            settings["recording"] = os.fspath(recording)
        self._loop = _native.ClosedLoop(**settings)
        self._summary: dict[str, Any] | None = None

    def run(self, duration_s: float) -> tuple[np.ndarray, np.ndarray]:
        """Goes on for that time [s]: the ticks and forces of it, structured arrays as in `recordings`.

        Other threads of Python run meanwhile, unless law, environment or hand are in Python. An exception of these ends the
        run with it.
        """
        self._loop.run(duration_s)
        return self._loop.take()

    def close(self) -> dict[str, Any]:
        """Ends the session, and the recording; the summary. No `run` afterwards."""
        if self._summary is None:
            self._summary = json.loads(self._loop.close())
        return self._summary

    @property
    def time_s(self) -> float:
        """How far it has run [s]."""
        return self._loop.time_s

    @property
    def truth(self) -> dict[str, np.ndarray]:
        """The device's exact state now: joint, joint_velocity (joints,); position, velocity (dof,) of the tip,
        and where that turns its turning (3,) [rad/s], else (0,)."""
        return self._loop.truth


def simulate(duration_s: float, **settings: Any) -> Run:
    """A whole run of that length [s]; the settings are those of ClosedLoop."""
    loop = ClosedLoop(**settings)
    loop._loop.run(duration_s)
    summary = loop.close()  # forces come until then
    return Run(*loop._loop.take(), summary)


def _scene_of(scene: str | os.PathLike | Scene | None, environment: Environment | str | None) -> Scene:
    if scene is not None:
        return scene_from(scene)
    if not callable(environment):
        raise TypeError("scene: a loop needs a scene, or an environment that is a function")
    return parse("scene = { name = 'python', description = 'nothing', degrees_of_freedom = 'any' }", "python")


def _network_words(network: str) -> tuple[str, str]:
    """Netem's words of a network, and the file of a recorded one."""
    if network.startswith("trace:"):
        return "", network.removeprefix("trace:")
    return ("" if network == "none" else network), ""


def _hand_settings(hand: Any) -> dict[str, Any]:
    if isinstance(hand, str):
        return {"hand": hand}
    if isinstance(hand, OwnHand):
        if not callable(hand.target):
            raise TypeError(f"target: expected a function of time_s, got {type(hand.target).__name__}")
        return {"own_hand": hand}
    if callable(hand):
        return {"own_hand": OwnHand(hand)}
    raise TypeError(f"hand: expected its words, an OwnHand or a function of time_s, got {type(hand).__name__}")


def _law_settings(law: Any, memory: str, parameters: Mapping[str, float] | None) -> dict[str, Any]:
    if isinstance(law, OwnLaw):
        if parameters or memory != "capped":
            raise TypeError("law_parameters and memory are for laws of the registry, not for an OwnLaw")
        return {"law": law.name, "own_law": law}
    if isinstance(law, type) and issubclass(law, Law):
        law = law.info.name
    if isinstance(law, os.PathLike):
        law = os.fspath(law)
    if not isinstance(law, str):
        raise TypeError(f"law: expected a name, a class of forcebound.laws or an OwnLaw, got {type(law).__name__}")
    return {"law": law, "memory": memory, "parameters": dict(parameters or {})}
