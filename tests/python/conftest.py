"""What the tests of the Python package share.

FORCEBOUND_BIN (environment) is the folder of the programs, else they are looked for in PATH; tests that need one are
skipped without it. FORCEBOUND_EXAMPLES is the folder of the examples.
"""

import os
import re
import shutil
import subprocess
import time

import matplotlib
import numpy as np
import pytest

from forcebound import devices

matplotlib.use("Agg")  # no screen


def program(name: str) -> str:
    found = shutil.which(name, path=os.environ.get("FORCEBOUND_BIN", os.environ["PATH"]))
    if not found:
        pytest.skip(f"{name} is not there: build it, or install the package forcebound")
    return found


@pytest.fixture
def lab() -> str:
    return program("forcebound-lab")


@pytest.fixture
def server(tmp_path):
    """A server of the scene sphere on a free port of the loopback; its address."""
    log = tmp_path / "server.log"
    with log.open("w") as output:
        serving = subprocess.Popen([program("forcebound-server"), "--scene", "sphere", "--listen", "127.0.0.1:0"],
                                   stdout=output, stderr=subprocess.STDOUT)
    try:
        limit = time.monotonic() + 60
        while not (listening := re.search(r"listening on (\S+:\d+),", log.read_text())):
            assert serving.poll() is None and time.monotonic() < limit, log.read_text()
            time.sleep(0.02)
        yield listening[1]
    finally:
        serving.terminate()
        status = serving.wait(60)
    assert status == 0, log.read_text()


@pytest.fixture
def wall_facts():
    return devices.load("wall-1dof").facts


def random_ticks(facts, count, seed=1):
    """Positions and requests (count, dof) of a restless hand in a stiff and noisy environment."""
    random = np.random.default_rng(seed)
    positions = np.cumsum(random.normal(0, 2e-4, (count, facts.degrees_of_freedom)), axis=0)
    requests_N = -3000 * positions + random.normal(0, 1, positions.shape)
    return positions, requests_N
