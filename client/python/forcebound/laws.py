"""The laws: what becomes of the force that an environment asks for.

There is a class for each law of the registry, such as FbaExact, FbaLess, FbaMore and NoLaw; `all_laws()` lists them and
`help(laws.FbaExact)` explains one.

    law = laws.FbaExact(facts)
    for x, f in zip(positions, requests_N):     # one tick each
        applied_N = law.step(x, f)
        law.energy_J                            # the ledger: what may be spent now

    steps = laws.FbaExact(facts).run(positions, requests_N)     # the same, 100 times as fast
    steps.force_N, steps.energy_J, steps.xi
"""

from __future__ import annotations

import inspect
from typing import Any, NamedTuple

import numpy as np

from forcebound import _native
from forcebound._native import DeviceFacts, Motion, ServerSideLaw

__all__ = ["Law", "LawInfo", "LawParameter", "Motion", "OwnLaw", "ServerSideLaw", "Steps", "all_laws", "by_name"]


class LawParameter(NamedTuple):
    """A number that can be chosen about a law."""

    name: str
    purpose: str
    accepted: str


class LawInfo(NamedTuple):
    """What the registry says of a law."""

    name: str
    summary: str
    reference: str  # who, when; empty: ours
    guarantee: str  # what it promises of P; empty: nothing
    shortens: bool  # its force is the request, made shorter at most
    has_server_side: bool  # needs a part that runs at the server
    parameters: tuple[LawParameter, ...]


class Steps(NamedTuple):
    """What a law made of n ticks."""

    force_N: np.ndarray  # (n, dof): for the device
    energy_J: np.ndarray  # (n,): what the law may spend after each tick
    xi: np.ndarray  # (n,): share of the coming interval's dissipation that it will credit


class Law:
    """A law at work on one device. Made through its subclasses, one for each law, or `by_name`.

    Between the request and the device are, as in the client: saturation at `facts.force_N_max`, the law, and rounding
    to the actuator's steps. What is not finite becomes zero force and is counted. A law has a state and one owner: use
    another one for each device and each run.
    """

    info: LawInfo

    def __init__(self, facts: DeviceFacts, *, memory: str = "capped", **parameters: float) -> None:
        if type(self) is Law:
            raise TypeError("Law is the base of the laws: use one of them, such as FbaExact, or by_name")
        self._law = _native.RunningLaw(facts, self.info.name, memory, parameters)

    def step(
        self,
        position,
        request_N,
        interval_s=None,
        joint=None,
        jacobian=None,
        latency_s=None,
        latency_s_max=None,
        effect_s=None,
        held_s=None,
        write_failed=False,
    ) -> np.ndarray:
        """One tick: notes the motion since the last one, and gives the force for the device, (dof,) [N].

        position      (dof,) of the tip [m]
        request_N     (dof,), the force asked for [N]; None: there is no answer of the environment, the force is zero
        interval_s    measured time since the last reading; None: the nominal period, 0 at the first tick
        joint         (joints,) readings, and
        jacobian      (dof, joints), d position / d joint: both needed unless the device is Cartesian, else not read
        latency_s     from the previous reading to the effect of the force chosen on it; None: the facts' latency
        latency_s_max longest time from this reading to the effect of the force now to be chosen; None: the facts'
        effect_s      latency_s as the device reports it; None: it does not
        held_s        from latency_s until the device let go of that force; None: it did not
        write_failed  whether that force was ever in effect is unknown

        ValueError for a wrong shape, with both shapes; TypeError for a dtype that float64 does not hold. The law is as
        before then.
        """
        return self._law.step(
            position, request_N, interval_s, joint, jacobian, latency_s, latency_s_max, effect_s, held_s, write_failed
        )

    def run(
        self, positions, requests_N, intervals_s=None, joints=None, jacobians=None, latencies_s=None
    ) -> Steps:
        """Many ticks in one call, for recorded sequences: the same numbers as `step` for each row.

        positions, requests_N    (n, dof); arrays of float64 are read where they lie, also columns of a recording
        intervals_s, latencies_s (n,), or one number for all intervals; None: as in `step`
        joints, jacobians        (n, joints), (n, dof, joints): needed unless the device is Cartesian

        Where latencies are given, each also bounds the force that is chosen one row before. Other threads of Python run
        meanwhile. Errors as in `step`, before the first tick.
        """
        return Steps(*self._law.run(positions, requests_N, intervals_s, joints, jacobians, latencies_s))

    def confirm(self, force_N, latency_s: float) -> np.ndarray:
        """The force that `step` gave, or zero if it takes effect so long after the reading that it is not allowed."""
        return self._law.confirm(force_N, latency_s)

    def hear(self, numbers) -> None:
        """What the server-side law said, (k,), ahead of the tick that uses its force."""
        self._law.hear(numbers)

    def outgoing(self) -> np.ndarray:
        """For the server-side law, (k,), as of the tick before."""
        return self._law.outgoing()

    def server_side(self) -> ServerSideLaw:
        """The part of this law that runs at the server; ValueError if it has none."""
        return ServerSideLaw(self.info.name, self.facts.degrees_of_freedom)

    def begin_server_side(self) -> None:
        """From now on another server answers, or the same one after a restart."""
        self._law.begin_server_side()

    @property
    def facts(self) -> DeviceFacts:
        return self._law.facts

    @property
    def energy_J(self) -> float:
        """The ledger: energy that the law may spend now [J]."""
        return self._law.energy_J

    @property
    def xi(self) -> float:
        """Share, 0 to 1, of the coming interval's dissipation that the law will credit."""
        return self._law.xi

    @property
    def counts(self) -> dict[str, int]:
        """What was wrong with readings, requests and forces so far."""
        return self._law.counts

    @property
    def memory(self) -> str:
        """"capped" or "full": how much of the energy it may keep for later."""
        return self._law.memory

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters: as given, or what is standard for this device."""
        return self._law.parameters

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.facts.name!r}, energy_J={self.energy_J:.4g})"


class OwnLaw:
    """A law of one's own for the simulated loop: derive from it, and override what it needs.

        class Halve(laws.OwnLaw):
            name = "halve"
            def bound(self, request_N):
                return request_N / 2

    A tick calls `credit`, then `bound`, then `commit`. An exception in any of them ends the run with that exception.
    It is for `simulation` alone: in a real tick of 1 ms Python has no place.
    """

    name = "own"

    #: Energy that the law may spend now [J]: what the tables show.
    energy_J = 0.0
    #: Share of the coming interval's dissipation that it will credit.
    xi = 1.0

    def begin(self, facts: DeviceFacts) -> None:
        """A run begins: forget the one before."""

    def credit(self, motion: Motion) -> None:
        """Notes the motion under the force committed last."""

    def lose(self, motion: Motion) -> None:
        """The reading was lost: of the motion only the times may be used."""

    def bound(self, request_N: np.ndarray) -> np.ndarray:
        """The force (dof,) [N] that the law makes of the request (dof,) [N]."""
        raise NotImplementedError(f"{type(self).__name__} has no bound(request_N)")

    def commit(self, force_N: np.ndarray) -> None:
        """What the device was told after rounding (dof,) [N], and holds until the next tick."""


def _info(name: str) -> LawInfo:
    words = _native.law_description(name)
    parameters = tuple(LawParameter(**parameter) for parameter in words["parameters"])
    return LawInfo(parameters=parameters, **{key: words[key] for key in LawInfo._fields if key != "parameters"})


def _class_name(law: str) -> str:
    return "NoLaw" if law == "none" else "".join(part.capitalize() for part in law.split("-"))


def _class_of(name: str) -> type[Law]:
    info = _info(name)
    chosen = [inspect.Parameter("self", inspect.Parameter.POSITIONAL_OR_KEYWORD)]
    chosen += [inspect.Parameter("facts", inspect.Parameter.POSITIONAL_OR_KEYWORD)]
    chosen += [inspect.Parameter("memory", inspect.Parameter.KEYWORD_ONLY, default="capped")]
    chosen += [inspect.Parameter(p.name, inspect.Parameter.KEYWORD_ONLY, default=None) for p in info.parameters]

    def __init__(self: Law, facts: DeviceFacts, *, memory: str = "capped", **parameters: Any) -> None:
        Law.__init__(self, facts, memory=memory, **{k: v for k, v in parameters.items() if v is not None})

    __init__.__signature__ = inspect.Signature(chosen)  # type: ignore[attr-defined]
    doc = _native.law_description(name)["help"] + "\nParameters that are None are what is standard for the device."
    return type(
        _class_name(name), (Law,), {"__doc__": doc, "__module__": __name__, "__init__": __init__, "info": info}
    )


_LAWS = {name: _class_of(name) for name in _native.law_names()}
for _law in _LAWS.values():
    globals()[_law.__name__] = _law
    __all__.append(_law.__name__)
del _law


def all_laws() -> list[type[Law]]:
    """A class for each law there is."""
    return list(_LAWS.values())


def by_name(name: str) -> type[Law]:
    """The class of the law that programs call so, such as "fba-exact"; ValueError naming those there are."""
    _native.law_description(name)
    return _LAWS[name]
