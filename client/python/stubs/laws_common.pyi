# What is the same for all laws; write_law_stubs.py adds a class for each.
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcebound._native import DeviceFacts, Motion, ServerSideLaw

class LawParameter(NamedTuple):
    name: str
    purpose: str
    accepted: str

class LawInfo(NamedTuple):
    name: str
    summary: str
    reference: str
    guarantee: str
    shortens: bool
    has_server_side: bool
    parameters: tuple[LawParameter, ...]

class Steps(NamedTuple):
    force_N: NDArray[np.float64]
    energy_J: NDArray[np.float64]
    xi: NDArray[np.float64]

class Law:
    info: LawInfo
    def __init__(self, facts: DeviceFacts, *, memory: str = "capped", **parameters: float) -> None: ...
    def step(
        self,
        position: ArrayLike,
        request_N: ArrayLike | None,
        interval_s: float | None = None,
        joint: ArrayLike | None = None,
        jacobian: ArrayLike | None = None,
        latency_s: float | None = None,
        latency_s_max: float | None = None,
        effect_s: float | None = None,
        held_s: float | None = None,
        write_failed: bool = False,
    ) -> NDArray[np.float64]: ...
    def run(
        self,
        positions: ArrayLike,
        requests_N: ArrayLike,
        intervals_s: ArrayLike | None = None,
        joints: ArrayLike | None = None,
        jacobians: ArrayLike | None = None,
        latencies_s: ArrayLike | None = None,
    ) -> Steps: ...
    def confirm(self, force_N: ArrayLike, latency_s: float) -> NDArray[np.float64]: ...
    def hear(self, numbers: ArrayLike) -> None: ...
    def outgoing(self) -> NDArray[np.float64]: ...
    def server_side(self) -> ServerSideLaw: ...
    def begin_server_side(self) -> None: ...
    @property
    def facts(self) -> DeviceFacts: ...
    @property
    def energy_J(self) -> float: ...
    @property
    def xi(self) -> float: ...
    @property
    def counts(self) -> dict[str, int]: ...
    @property
    def memory(self) -> str: ...
    @property
    def parameters(self) -> dict[str, float]: ...

class OwnLaw:
    name: str
    energy_J: float
    xi: float
    def begin(self, facts: DeviceFacts) -> None: ...
    def credit(self, motion: Motion) -> None: ...
    def lose(self, motion: Motion) -> None: ...
    def bound(self, request_N: NDArray[np.float64]) -> ArrayLike: ...
    def commit(self, force_N: NDArray[np.float64]) -> None: ...

def all_laws() -> list[type[Law]]: ...
def by_name(name: str) -> type[Law]: ...
