"""forcebound.server: a simulator in Python, served live, and felt by a live client."""

import ctypes
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest

import forcebound
from forcebound.client import Client
from forcebound.server import Server, Touch

# Held 3 mm below the floor, by a spring of 1000 N/m that the hand is.
PRESSING = {"device": "firm-3dof", "hand": "press:axis=2,from_m=0.003,to_m=-0.003,stiffness_N_per_m=1000"}
FLOOR = {"place_m": [0, 0, 0], "normal": [0, 0, 1]}


@pytest.fixture
def serving():
    with Server("floor", listen="127.0.0.1:0") as server:
        yield server


def step_until(serving, condition, touches=(Touch(**FLOOR),)):
    """Asks and reports; the test's own time limit ends what hangs. `condition` of what was asked for."""
    while True:
        probes = serving.ask()
        for probe in probes:
            serving.report(probe.client, touches)
        if condition(probes):
            return probes
        time.sleep(1 / 60)


def asked(serving):
    """The first probe that comes."""
    return step_until(serving, bool)[0]


def test_a_simulator_is_felt_between_its_steps_and_is_told_how_it_was_pushed(serving):
    with Client(serving.address, **PRESSING) as feeling:
        pushed_N = 0

        def pushes(probes):
            nonlocal pushed_N
            for probe in probes:
                if probe.interval_s > 0:
                    pushed_N = sum(push.impulse_Ns[2] for push in probe.pushes if push.body == 7) / probe.interval_s
            return pushed_N < -0.5 and feeling.ticks(-1)["applied_N"][0, 2] > 0.5

        # Only once it is below the floor are there pushes.
        (probe,) = step_until(serving, lambda probes: probes and probes[0].pushes, [Touch(**FLOOR, body=7)])
        assert {push.body for push in probe.pushes} == {7}
        for numbers in (probe.place_m, probe.velocity_m_per_s, probe.device_m, probe.pushes[0].impulse_Ns):
            assert numbers.shape == (3,) and numbers.dtype == np.float64
        step_until(serving, pushes, [Touch(**FLOOR, body=7)])
        step_until(serving, lambda _: serving.summary["clients"] == 1)
    step_until(serving, lambda probes: not probes)
    counts = serving.summary
    assert counts["environment"] == counts["simulated"] == "floor" and counts["encryption"] == "none"
    assert counts["reports"] > 0 and counts["reports_refused"] == 0
    assert counts["counts"]["motions_received"] > 0


class Plate:
    """Of 20 g on a spring of 200 N/m, along z; a step is one of implicit Euler."""

    mass_kg, spring_N_per_m, damper_N_s_per_m, step_s = 0.02, 200, 2, 1 / 60

    def __init__(self):
        self.z_m = self.speed_m_per_s = 0.0

    def step(self, impulse_Ns):
        h, k, c = self.step_s, self.spring_N_per_m, self.damper_N_s_per_m
        gained_Ns = impulse_Ns - h * (k * (self.z_m + h * self.speed_m_per_s) + c * self.speed_m_per_s)
        self.speed_m_per_s += gained_Ns / (self.mass_kg + h * c + h * h * k)
        self.z_m += h * self.speed_m_per_s

    def touch(self):
        return Touch([0, 0, self.z_m], [0, 0, 1], velocity_m_per_s=[0, 0, self.speed_m_per_s],
                     mobility_per_kg=np.diag([0, 0, 1 / self.mass_kg]), others_N=[0, 0, -self.spring_N_per_m * self.z_m],
                     spring_N_per_m=self.spring_N_per_m, damper_N_s_per_m=self.damper_N_s_per_m)


def test_what_gives_way_is_felt_as_soft_as_it_is(serving):
    """Held 3 mm deep by 1000 N/m, through a coupling of 2000 N/m, on 200 N/m: 0.46 N, less what the device's friction
    takes; on what stands: 2 N."""
    plate = Plate()
    with Client(serving.address, **PRESSING) as feeling:
        def felt_N():
            latest = feeling.ticks(-300)["applied_N"][:, 2]
            return np.median(latest) if len(latest) else 0

        while not (0.3 < felt_N() < 0.6 and -0.003 < plate.z_m < -0.0015):
            probes = serving.ask()
            plate.step(sum(push.impulse_Ns[2] for probe in probes for push in probe.pushes))
            for probe in probes:
                serving.report(probe.client, [plate.touch()])
            time.sleep(plate.step_s)
        step_until(serving, lambda _: felt_N() > 1.5)


def test_silence_is_counted(serving):
    with Client(serving.address, **PRESSING):
        asked(serving)
        while serving.summary["silences"] == 0:
            time.sleep(0.01)


@pytest.mark.parametrize("touch, kind, why", [
    ({"place_m": [0, np.nan, 0]}, ValueError, r"touches\[0\]\.place_m must be finite, within 100 m of .*, got 0 nan 0"),
    ({"normal": [0, 0, 2]}, ValueError, r"touches\[0\]\.normal must be of length 1, got 0 0 2"),
    ({"normal": [0, 1]}, ValueError, r"touches\[0\]\.normal: expected shape \(3,\), got \(2,\)"),
    ({"normal": "up"}, TypeError, r"touches\[0\]\.normal: expected numbers that float64 holds, got dtype"),
    ({"mobility_per_kg": -1}, ValueError, r"touches\[0\]\.mobility_per_kg must be .*, without an eigenvalue below"),
    ({"mobility_per_kg": np.eye(2)}, ValueError, r"touches\[0\]\.mobility_per_kg: expected shape \(3, 3\), got .*"),
    ({"friction": -0.1}, ValueError, r"touches\[0\]\.friction must be 0 to 10, got -0\.1"),
    ({"friction": "much"}, TypeError, r"touches\[0\]\.friction: expected a number, got <class 'str'>"),
    ({"spring_N_per_m": 200}, ValueError, r"touches\[0\]\.spring_N_per_m must be 0 where mobility_per_kg is 0"),
    ({"spring_N_per_m": np.inf}, ValueError, r"touches\[0\]\.spring_N_per_m must be 0 to 1e6 N/m, got inf"),
    ({"radius_m": 0}, ValueError, r"touches\[0\]\.radius_m must be above 0 m, got 0"),
    ({"body": -1}, ValueError, r"touches\[0\]\.body must be 0 to 4294967295, got -1"),
    ({"body": 0.5}, TypeError, r"touches\[0\]\.body: expected a whole number, got <class 'float'>"),
])
def test_a_touch_that_cannot_be_is_refused_in_one_line(serving, touch, kind, why):
    with Client(serving.address, **PRESSING):
        probe = asked(serving)
        with pytest.raises(kind, match=f"^{why}[^\n]*$"):
            serving.report(probe.client, [Touch(**{**FLOOR, **touch})])
        assert serving.summary["reports_refused"] == 1


def test_a_report_that_cannot_be_is_refused_in_one_line(serving):
    with Client(serving.address, **PRESSING):
        probe = asked(serving)
        with pytest.raises(ValueError, match="^touches must be at most 3 of a probe, got 4$"):
            serving.report(probe.client, 4 * [Touch(**FLOOR)])
        with pytest.raises(TypeError, match=r"^touches\[1\]: expected a Touch, got <class 'int'>$"):
            serving.report(probe.client, [Touch(**FLOOR), 3])
        with pytest.raises(ValueError, match="^client 99 is not there: accepted are those that were asked for last$"):
            serving.report(99, [])
        with pytest.raises(ValueError, match="^client must be 1 to 9223372036854775807, got -1$"):
            serving.report(-1, [])
        with pytest.raises(TypeError, match="^client: expected a whole number, got <class 'str'>$"):
            serving.report("first", [])
        assert serving.summary["reports_refused"] == 5
        serving.report(probe.client, [])


def test_a_server_that_does_not_run_says_so(serving):
    with pytest.raises(RuntimeError, match="^a server runs once: make another$"):
        serving.start()
    serving.stop()
    serving.stop()
    assert not serving.is_running()
    not_running = "^the server does not run: start it, or make another if it was stopped$"
    with pytest.raises(RuntimeError, match=not_running):
        serving.ask()
    with pytest.raises(RuntimeError, match=not_running):
        serving.report(1, [])
    with pytest.raises(RuntimeError, match=not_running):
        Server(listen="127.0.0.1:0").ask()


def test_what_is_refused_of_a_server_is_said_before_anything_runs(serving, tmp_path):
    def refused(kind, why, name="floor", **settings):
        with pytest.raises(kind, match=f"^[^\n]*{why}[^\n]*$"):
            Server(name, **{"listen": "127.0.0.1:0", **settings})

    refused(RuntimeError, "in use", listen=serving.address)
    refused(ValueError, "'listen': .* accepted are 'key' with 'clients', or 'shared_key'", listen="0.0.0.0:0")
    refused(ValueError, "'key': .* accepted is 'key' with 'clients'", key="server.key")
    refused(ValueError, "port", listen="127.0.0.1:notaport")
    refused(ValueError, str(tmp_path), key=tmp_path / "no.key", clients=tmp_path / "clients.toml")
    refused(ValueError, "name must be a name", name="")
    refused(TypeError, "name: expected text, got <class 'int'>", name=3)
    refused(ValueError, "clients_max must be 1 to 64, got 0", clients_max=0)
    refused(ValueError, "clients_per_address must be 0 to 64, got 65", clients_per_address=65)
    refused(ValueError, "idle_s must be 1 to 1e6 s, got 0", idle_s=0)
    refused(ValueError, "idle_s must be 0 to 1e6 s, got nan", idle_s=np.nan)
    refused(ValueError, "probe_mass_kg must be 0.001 to 100 kg, got 0", probe_mass_kg=0)
    refused(ValueError, "probe_radius_m must be 0 to 1 m, got nan", probe_radius_m=np.nan)
    refused(TypeError, "probe_radius_m: expected a number, got <class 'str'>", probe_radius_m="a point")
    with pytest.raises(TypeError, match="missing 2 required"):
        Touch()


def test_no_more_clients_are_let_in_than_have_room():
    with Server("floor", listen="127.0.0.1:0", clients_max=1) as serving, Client(serving.address, **PRESSING):
        asked(serving)
        other = Client(serving.address, **PRESSING, once=True)
        other.run()
        assert other.why_no_session


def test_forces_are_sent_while_the_interpreter_is_held(serving):
    """The counts may be 0.1 s old, or about 100 forces."""
    with Client(serving.address, **PRESSING):
        asked(serving)
        sent = 0
        while sent < 300:
            before = serving.summary["counts"]["forces_sent"]
            ctypes.PyDLL(None).usleep(900_000)
            sent = serving.summary["counts"]["forces_sent"] - before


def test_an_interpreter_that_ends_stops_its_servers():
    program = textwrap.dedent("""
        import forcebound
        forcebound.Server(listen="127.0.0.1:0").start()
        forcebound.Server(listen="127.0.0.1:0")
        """)
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
    assert forcebound.Server is Server and forcebound.Touch is Touch
