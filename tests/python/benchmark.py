#!/usr/bin/python3
"""Times the Python package: a law's tick, a law's sequence beside C++, and a closed loop in virtual time.

    PYTHONPATH=build/release/python tests/python/benchmark.py [LAW_ROWS]

LAW_ROWS is the program law_rows of the same build, which times the same law over the same rows in C++; build/release/bin
unless said. Python and C++ take turns, and each figure is the median of its turns, with the least and the most. Times are
of the processor, so that what others do on the machine counts less. Asserts nothing about times, but that both sides come to
the same forces.
"""

import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import numpy as np

from forcebound import devices, laws, simulation

ROWS = 20_000
TURNS = 15
TICKS = 20_000


def recorded(device: str, hand: str) -> tuple[np.ndarray, np.ndarray]:
    """A hand in contact, from a closed loop: positions and requests (n, dof)."""
    scene = "wall" if device == "wall-1dof" else "sphere"
    ticks = simulation.simulate(ROWS / 1000, scene=scene, device=device, hand=hand, law="none",
                                network="delay 2ms").ticks
    return np.ascontiguousarray(ticks["position"]), np.ascontiguousarray(ticks["request_N"])


def figure(times: list[float]) -> str:
    return f"{median(times):8.4g}  ({min(times):.4g} to {max(times):.4g})"


def tick_us(law: laws.Law, positions: np.ndarray, requests_N: np.ndarray) -> float:
    pairs = list(zip(positions[:TICKS], requests_N[:TICKS]))
    step = law.step
    begin = time.process_time()
    for position, request_N in pairs:
        step(position, request_N)
    return (time.process_time() - begin) / len(pairs) * 1e6


def sequence_ns(law: laws.Law, positions: np.ndarray, requests_N: np.ndarray) -> tuple[float, float]:
    begin = time.process_time()
    steps = law.run(positions, requests_N)
    return (time.process_time() - begin) / len(positions) * 1e9, steps.force_N.sum()


def of_laws(law_rows: Path, device: str, hand: str) -> None:
    facts = devices.load(device).facts
    positions, requests_N = recorded(device, hand)
    print(f"\n{device}, {len(positions)} rows of {hand}\n")
    print("  law        tick through Python [us]        sequence in Python [ns/tick]    the same in C++ [ns/tick]       ratio")
    with tempfile.NamedTemporaryFile() as file:
        np.hstack([positions, requests_N]).tofile(file.name)
        for kind in (laws.NoLaw, laws.FbaLess, laws.FbaMore, laws.FbaExact):
            ticks, python, cpp = [], [], []
            for _ in range(TURNS):
                ticks.append(tick_us(kind(facts), positions, requests_N))
                ns, sum_N = sequence_ns(kind(facts), positions, requests_N)
                python.append(ns)
                # The last of three: in Python all is warm too.
                *_, ns, cpp_sum_N = subprocess.run([law_rows, device, kind.info.name, file.name, "3"], check=True,
                                                   capture_output=True, text=True).stdout.split()
                cpp.append(float(ns))
                if not np.isclose(sum_N, float(cpp_sum_N), rtol=1e-9, atol=1e-9):
                    sys.exit(f"benchmark: {kind.info.name}: forces differ: {sum_N} in Python, {cpp_sum_N} in C++")
            print(f"  {kind.info.name:<9}  {figure(ticks):<30}  {figure(python):<30}  {figure(cpp):<30}  "
                  f"{median(python) / median(cpp):.2f}")


def of_loops() -> None:
    print("\n10 s of a closed loop in virtual time [s]\n")
    settings = dict(scene="sphere", device="omni", hand="trace-sphere", network="delay 50ms 10ms loss 5%")

    class Halve(laws.OwnLaw):
        def bound(self, request_N):
            return request_N / 2

    def well(position, time_s):
        return -100 * position

    cases = {"law and scene in C++": {}, "law in Python": {"law": Halve()},
             "environment in Python": {"scene": None, "environment": well}}
    for name, changed in cases.items():
        took = []
        for _ in range(5):
            begin = time.process_time()
            simulation.simulate(10, **{**settings, **changed})
            took.append(time.process_time() - begin)
        print(f"  {name:<22}  {figure(took)}")


if __name__ == "__main__":
    program = Path(sys.argv[1] if len(sys.argv) > 1 else "build/release/bin/law_rows")
    processor = next((line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                      if line.startswith("model name")), platform.machine())
    print(f"Python {platform.python_version()}, numpy {np.__version__}, {processor}")
    of_laws(program, "wall-1dof", "press")
    of_laws(program, "cartesian-3dof", "trace-sphere")
    of_loops()
