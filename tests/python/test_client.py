"""forcebound.client: the real client against the real server, from Python."""

import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest

from forcebound import laws, recordings
from forcebound.client import Client

SPHERE = {"scene": "sphere", "device": "cartesian-3dof", "hand": "trace-sphere"}


def wait_until(condition):
    """However long it takes: the test's own time limit ends what hangs."""
    while not condition():
        time.sleep(0.01)


def test_a_client_runs_beside_python_and_is_looked_at_meanwhile(server):
    with Client(server, **SPHERE) as running:
        wait_until(lambda: np.linalg.norm(running.ticks(-1)["applied_N"]) > 0)
        assert running.is_running()
        latest = running.ticks(-20)
        assert len(latest) == 20 and latest.dtype.names == tuple(recordings.TICK)
        assert np.all(np.diff(latest["tick"].astype(int)) == 1)
        with pytest.raises(RuntimeError, match="no summary before"):
            running.summary
    assert not running.is_running()
    assert running.summary["ticks"] == len(running.ticks()) + running.ticks_not_kept
    assert running.summary["scene"] == "sphere"
    assert running.why_no_session == ""
    with pytest.raises(RuntimeError, match="started once"):
        running.start()


def test_a_client_records_and_ends_by_itself(server, tmp_path):
    file = tmp_path / "run.mcap"
    client = Client(server, **SPHERE, duration_s=1, recording=file, law=laws.FbaMore, rendering="remote", seed=5)
    summary = client.run()
    recording = recordings.read(file)
    assert recording.info["law"] == summary["law"] == "fba-more"
    assert recording.info["program"].startswith("Python")
    assert len(recording.ticks) == summary["ticks"]
    np.testing.assert_array_equal(recording.ticks["applied_N"], client.ticks()["applied_N"])


def test_ticks_without_room_are_counted(server):
    client = Client(server, **SPHERE, duration_s=3, ticks_kept=100)
    summary = client.run()
    assert len(client.ticks()) == 100
    assert client.ticks_not_kept == summary["ticks"] - 100 > 0


def test_a_server_that_is_not_there_is_given_up():
    client = Client("127.0.0.1:9", **SPHERE, once=True)
    client.run()
    assert "127.0.0.1:9" in client.why_no_session


def test_what_is_refused_is_said_before_anything_runs():
    with pytest.raises(ValueError, match="is on another machine.* accepted are 'server_key' or .*, 'shared_key'"):
        Client("192.0.2.1:47800", **SPHERE)
    with pytest.raises(ValueError, match="unknown law"):
        Client("127.0.0.1:9", law="fba", **SPHERE)
    with pytest.raises(TypeError, match="no place in a tick of real time"):
        Client("127.0.0.1:9", law=laws.OwnLaw(), **SPHERE)
    with pytest.raises(ValueError, match="port"):
        Client("127.0.0.1:notaport", **SPHERE)
    with pytest.raises(ValueError, match="duration_s"):
        Client("127.0.0.1:9", duration_s=-1, **SPHERE)


def test_an_interpreter_that_ends_stops_its_clients(server):
    program = textwrap.dedent(f"""
        import time
        from forcebound.client import Client
        client = Client("{server}", scene="sphere", device="cartesian-3dof", hand="trace-sphere").start()
        while not len(client.ticks()):
            time.sleep(0.01)
        """)
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
