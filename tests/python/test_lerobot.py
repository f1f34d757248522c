"""forcebound.lerobot, with a simulated arm.

FORCEBOUND_LEROBOT (environment) is a checkout of huggingface/lerobot, whose Teleoperator is then the base; without it that
test is skipped.
"""

import abc
import ast
import inspect
import math
import os
import sys
import types
from pathlib import Path

import numpy as np
import pytest

from forcebound.leader import SO101, ForceBoundedLeader, Servo, SimulatedArm
from forcebound.lerobot import ForceBoundedTeleoperator
from forcebound.simulation import OwnHand

NAMES = [servo.name for servo in SO101]


class Arm:
    """A simulated SO-101 behind LeRobot's calls, with a clock of its own."""

    def __init__(self):
        self.time_s = 0.0
        self.is_connected = self.is_calibrated = False
        self.fails = ""
        self.written, self.done = [], []
        facts = ForceBoundedLeader(latency_s_max=4e-3, read_s_max=2e-3, hold_s_max=0.1)
        hand = OwnHand(lambda t: np.full(6, 0.3 * math.sin(4 * t)), 0.003, 3, 0.1)
        self.simulated = SimulatedArm(facts, hand=hand)

    def clock(self):
        return self.time_s

    def connect(self):
        self.is_connected = True

    def calibrate(self):
        self.is_calibrated = True
        self.done.append("calibrate")

    def configure(self):
        self.done.append("configure")

    def read(self):
        if self.fails == "read":
            raise OSError("no answer from motor 3")
        return self.simulated.read(self.time_s)

    def write(self, torques):
        if self.fails == "write":
            raise OSError("the bus is gone")
        if self.fails == "late":
            self.time_s += 0.01
        self.simulated.write(self.time_s, torques)
        self.written.append(np.array(torques))

    def disconnect(self):
        self.is_connected = False


def connected(cls=ForceBoundedTeleoperator, **settings):
    arm = Arm()
    teleop = cls(arm, clock=arm.clock, **{"stiffness_N_m_per_rad": 5, **settings})
    teleop.connect()
    return teleop, arm


def led(teleop, arm, seconds=3.0):
    """LeRobot's loop at 60 Hz; the follower is where the leader was a quarter of a second ago."""
    past = []
    for _ in range(round(60 * seconds)):
        past.append(teleop.get_action())
        sent = teleop.send_feedback({**past[max(0, len(past) - 16)], "camera": np.zeros((2, 2))})
        arm.time_s += 1 / 60
    return sent


def test_the_arm_is_led_and_no_energy_comes_back():
    teleop, arm = connected()
    assert arm.done == ["calibrate", "configure"]
    assert list(teleop.action_features) == list(teleop.feedback_features) == [f"{name}.pos" for name in NAMES]
    sent = led(teleop, arm)
    assert list(sent) == [f"{name}.torque" for name in NAMES]
    assert np.abs(arm.written).max() > 0.1
    assert arm.simulated.least_P_J >= -1e-9
    assert teleop.leader.counts["late"] == 0
    teleop.disconnect()
    assert not teleop.is_connected
    assert arm.written[-1].tolist() == [0] * 6


def test_actions_are_degrees_and_of_a_gripper_percent():
    teleop, arm = connected(percent={"gripper": (0.1, 1.1)})
    action = teleop.get_action()
    positions = arm.simulated.read(arm.time_s)
    assert action["elbow_flex.pos"] == pytest.approx(math.degrees(positions[2]))
    assert action["gripper.pos"] == pytest.approx(100 * (positions[5] - 0.1))
    with pytest.raises(ValueError, match="expected joints of .* got 'gripp'"):
        connected(percent={"gripp": (0, 1)})


def test_feedback_may_be_torques_and_what_is_missing_is_zero():
    teleop, arm = connected(stiffness_N_m_per_rad=None)
    for _ in range(60):
        teleop.send_feedback({"elbow_flex.torque": 0.2, "wrist_flex.torque": math.nan})
        arm.time_s += 1 / 60
    torques = np.abs(arm.written).max(axis=0)
    assert torques[2] == pytest.approx(0.2, abs=2e-3)
    assert np.all(np.delete(torques, 2) == 0)


@pytest.mark.parametrize("feedback", [{}, {"elbow.pos": 1}, None, {f"{NAMES[0]}.pos": "far"}])
def test_feedback_that_is_none_is_refused_after_zero_torques(feedback):
    teleop, arm = connected()
    led(teleop, arm, 1)
    energy_J = teleop.leader.energy_J
    with pytest.raises(ValueError, match="feedback: expected .*shoulder_pan.pos"):
        teleop.send_feedback(feedback)
    assert arm.written[-1].tolist() == [0] * 6
    assert np.all(teleop.leader.energy_J > 0.5 * energy_J)


def test_what_needs_a_connection_is_refused_without_one():
    arm = Arm()
    teleop = ForceBoundedTeleoperator(arm, stiffness_N_m_per_rad=5, clock=arm.clock)
    for use in (teleop.get_action, lambda: teleop.send_feedback({}), teleop.disconnect, teleop.configure, teleop.calibrate):
        with pytest.raises(ConnectionError, match="not connected"):
            use()
    teleop.connect(calibrate=False)
    assert not teleop.is_calibrated
    with pytest.raises(ConnectionError, match="already"):
        teleop.connect()


def test_a_bus_that_fails_leaves_zero_torques_or_is_told_the_law():
    teleop, arm = connected()
    led(teleop, arm, 1)
    arm.fails = "read"
    with pytest.raises(OSError, match="motor 3"):
        teleop.send_feedback({"elbow_flex.pos": 0})
    assert arm.written[-1].tolist() == [0] * 6
    assert teleop.leader.counts["readings_lost"] == 6
    arm.fails = "write"
    arm.time_s += 1 / 60
    with pytest.raises(OSError, match="bus is gone"):
        teleop.send_feedback({"elbow_flex.pos": 0})
    arm.fails = "late"
    arm.time_s += 1 / 60
    teleop.send_feedback({"elbow_flex.pos": 0})
    assert teleop.leader.counts["writes_failed"] == 2
    arm.fails = ""
    arm.time_s += 1 / 60
    led(teleop, arm)
    assert arm.simulated.least_P_J >= -1e-9


def test_settings_are_refused():
    with pytest.raises(ValueError, match="stiffness_N_m_per_rad must be > 0, or None"):
        ForceBoundedTeleoperator(Arm(), stiffness_N_m_per_rad=-1)
    soft = Servo("one", 0.15, 0.03, 1e-3, 1, goal_stiffness_N_m_per_rad=0.1)
    with pytest.raises(ValueError, match="must be 0, as an Arm takes torques"):
        ForceBoundedTeleoperator(Arm(), (soft,))


class Anything:
    """Stands for what LeRobot's file imports and its base class does not use."""

    def __getattr__(self, name):
        return Anything()

    def __call__(self, *args, **kwargs):
        return Anything()

    def __getitem__(self, key):
        return Anything()

    def __or__(self, other):
        return Anything()

    __ror__ = __or__


def lerobots_teleoperator(checkout, monkeypatch):
    """The class of LeRobot's own source, without the packages that it imports."""
    file = checkout / "src/lerobot/teleoperators/teleoperator.py"
    if not file.exists():
        pytest.fail(f"FORCEBOUND_LEROBOT: expected a checkout of huggingface/lerobot, there is no {file}")
    source = file.read_text()
    package = "lerobots_source.teleoperators"
    for node in ast.walk(ast.parse(source)):
        names = [(alias.name, ()) for alias in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom):
            names = [(f"{package}.{node.module}" if node.level else node.module, [alias.name for alias in node.names])]
        for name, members in names:
            if name.split(".")[0] in sys.stdlib_module_names:
                continue
            for end in range(1, name.count(".") + 2):
                parent = ".".join(name.split(".")[:end])
                if parent not in sys.modules:
                    monkeypatch.setitem(sys.modules, parent, types.ModuleType(parent))
            for member in members:
                setattr(sys.modules[name], member, Anything())
    space = {"__name__": f"{package}.teleoperator", "__package__": package}
    exec(compile(source, file, "exec"), space)
    return space["Teleoperator"]


def test_it_is_a_teleoperator_by_lerobots_own_source(monkeypatch, tmp_path):
    if "FORCEBOUND_LEROBOT" not in os.environ:
        pytest.skip("FORCEBOUND_LEROBOT is not set to a checkout of huggingface/lerobot")
    base = lerobots_teleoperator(Path(os.environ["FORCEBOUND_LEROBOT"]), monkeypatch)
    assert issubclass(type(base), abc.ABCMeta)
    assert {"get_action", "send_feedback", "feedback_features"} <= base.__abstractmethods__
    for name in base.__abstractmethods__:
        theirs, ours = inspect.getattr_static(base, name), inspect.getattr_static(ForceBoundedTeleoperator, name)
        assert isinstance(ours, property) == isinstance(theirs, property), name
        if not isinstance(theirs, property):
            assert list(inspect.signature(ours).parameters) == list(inspect.signature(theirs).parameters), name

    class Bounded(ForceBoundedTeleoperator, base):
        config_class, name = object, "bounded"

        def __init__(self, arm, **settings):
            base.__init__(self, types.SimpleNamespace(id="mine", calibration_dir=tmp_path / "calibration"))
            ForceBoundedTeleoperator.__init__(self, arm, **settings)

    teleop, arm = connected(Bounded)
    assert str(teleop) == "mine Bounded"
    led(teleop, arm, 1)
    assert arm.simulated.least_P_J >= -1e-9
    teleop.disconnect()
    if hasattr(base, "__enter__"):
        with teleop:
            assert teleop.is_connected
        assert not teleop.is_connected
