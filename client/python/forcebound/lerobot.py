"""A leader arm with bounded force feedback, in the form of LeRobot's `Teleoperator` (as of 0.6).

LeRobot need not be installed. As a plug-in of it (a package named lerobot_teleoperator_...):

    @TeleoperatorConfig.register_subclass("bounded_arm")
    @dataclass
    class BoundedArmConfig(TeleoperatorConfig):
        port: str = "/dev/ttyACM0"

    class BoundedArm(ForceBoundedTeleoperator, Teleoperator):
        config_class, name = BoundedArmConfig, "bounded_arm"

        def __init__(self, config):
            Teleoperator.__init__(self, config)
            ForceBoundedTeleoperator.__init__(self, MyArm(config.port), stiffness_N_m_per_rad=5)

LeRobot 0.6's own teleoperation loop sends feedback to one robot's teleoperator alone, so write the loop:

    while True:
        teleop.send_feedback(robot.get_observation())   # reads the arm, bounds, writes torques
        robot.send_action(teleop.get_action())

No arm was tried: which servo modes make a torque, and what is promised, is in `forcebound.leader`.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from forcebound.leader import SO101, ForceBoundedLeader, Servo

__all__ = ["Arm", "ForceBoundedTeleoperator"]


class Arm(Protocol):
    """What talks to the servos. An exception of any method leaves the teleoperator, after zero torques where that is
    possible; nothing of the account is lost.
    """

    is_connected: bool
    is_calibrated: bool

    def connect(self) -> None:
        """Opens the bus; torques are zero."""

    def calibrate(self) -> None:
        """Finds its zero angles."""

    def configure(self) -> None:
        """Puts the servos into the mode in which they take torques."""

    def read(self) -> Sequence[float]:
        """Angles, (joints,) [rad], unwrapped; one that was not read is not a number."""

    def write(self, torques: np.ndarray) -> None:
        """Commands torques, (joints,) [N m]."""

    def disconnect(self) -> None:
        """Closes the bus; the servos go limp."""


class ForceBoundedTeleoperator:
    """An Arm and its ForceBoundedLeader. Actions are NAME.pos in degrees, as of LeRobot's motors with use_degrees.

    stiffness_N_m_per_rad  feedback is NAME.pos of the follower, and pulls there so hard; None: it is NAME.torque [N m]
    percent                joints whose .pos is 0 to 100, such as a gripper's, with the angles of both: (closed, open) [rad]
    clock                  only goes on [s]
    loop                   the times of ForceBoundedLeader; unless said, steps may be up to 0.1 s apart, torques act within
                           4 ms of the stamp of their reading, and positions are latched in half of that

    Feedback of a joint that is missing or not finite is zero torque. Methods other than `connect` and the properties raise
    ConnectionError while not connected.
    """

    def __init__(
        self,
        arm: Arm,
        servos: Sequence[Servo] = SO101,
        *,
        stiffness_N_m_per_rad: float | None = None,
        percent: Mapping[str, tuple[float, float]] | None = None,
        clock: Callable[[], float] = time.monotonic,
        **loop: Any,
    ) -> None:
        if stiffness_N_m_per_rad is not None and not 0 < stiffness_N_m_per_rad < math.inf:
            raise ValueError(f"stiffness_N_m_per_rad must be > 0, or None for torques, got {stiffness_N_m_per_rad}")
        if any(servo.goal_stiffness_N_m_per_rad for servo in servos):
            raise ValueError("servos: goal_stiffness_N_m_per_rad must be 0, as an Arm takes torques")
        names = [servo.name for servo in servos]
        for name, (closed_rad, open_rad) in (percent or {}).items():
            if name not in names or closed_rad == open_rad:
                raise ValueError(f"percent: expected joints of {names} with two angles, got {name!r}: {closed_rad, open_rad}")
        times = {"period_s": 1 / 60, "latency_s_max": 4e-3, "read_s_max": 2e-3, "hold_s_max": 0.1}
        self.leader = ForceBoundedLeader(servos, **{**times, **loop})
        self._arm, self._clock, self._names = arm, clock, names
        self._stiffness_N_m_per_rad = stiffness_N_m_per_rad
        self._zeros_rad = np.array([(percent or {}).get(name, (0, 0))[0] for name in names])
        self._units_rad = np.array(
            [(percent[name][1] - percent[name][0]) / 100 if percent and name in percent else math.pi / 180 for name in names]
        )

    @property
    def action_features(self) -> dict[str, type]:
        return {f"{name}.pos": float for name in self._names}

    @property
    def feedback_features(self) -> dict[str, type]:
        kind = "torque" if self._stiffness_N_m_per_rad is None else "pos"
        return {f"{name}.{kind}": float for name in self._names}

    @property
    def is_connected(self) -> bool:
        return bool(self._arm.is_connected)

    @property
    def is_calibrated(self) -> bool:
        return bool(self._arm.is_calibrated)

    def connect(self, calibrate: bool = True) -> None:
        """Ready to use, with zero torques. ConnectionError if it is connected already."""
        if self.is_connected:
            raise ConnectionError("the leader arm is connected already")
        self._arm.connect()
        if calibrate and not self.is_calibrated:
            self.calibrate()
        self.configure()

    def calibrate(self) -> None:
        self._expect_connected()
        self._arm.calibrate()

    def configure(self) -> None:
        self._expect_connected()
        self._arm.configure()
        self._arm.write(np.zeros(len(self._names)))

    def get_action(self) -> dict[str, float]:
        """Where the arm is now."""
        self._expect_connected()
        positions = (self._positions() - self._zeros_rad) / self._units_rad
        return {f"{name}.pos": float(position) for name, position in zip(self._names, positions)}

    def send_feedback(self, feedback: Mapping[str, Any]) -> dict[str, float]:
        """A step: reads the arm, bounds the torques and writes them. Other keys, such as of cameras, are passed over.

        Returns the torques that were written, NAME.torque [N m]. ValueError, after zero torques, if `feedback` has none of
        `feedback_features`, or there is no number.
        """
        self._expect_connected()
        asked, refusal = self._asked(feedback)
        stamp_s = self._clock()
        try:
            positions = self._positions()
        except BaseException:
            self.leader.lose(stamp_s)
            self._write(np.zeros(len(self._names)), stamp_s)
            raise
        if asked is not None and self._stiffness_N_m_per_rad is not None:
            asked = self._stiffness_N_m_per_rad * (self._zeros_rad + self._units_rad * asked - positions)
        torques = self._write(self.leader.step(positions, asked, stamp_s), stamp_s)
        if refusal:
            raise ValueError(refusal)
        return {f"{name}.torque": float(torque) for name, torque in zip(self._names, torques)}

    def disconnect(self) -> None:
        """Zero torques, then no connection."""
        self._expect_connected()
        try:
            self._arm.write(np.zeros(len(self._names)))
        finally:
            self._arm.disconnect()

    def _expect_connected(self) -> None:
        if not self.is_connected:
            raise ConnectionError("the leader arm is not connected: call connect() first")

    def _positions(self) -> np.ndarray:
        positions = np.asarray(self._arm.read(), dtype=float)
        if positions.shape != (len(self._names),):
            raise ValueError(f"the arm's read: expected shape ({len(self._names)},), got {positions.shape}")
        return positions

    def _asked(self, feedback: Any) -> tuple[np.ndarray | None, str]:
        """The numbers of the feedback, or none and why."""
        keys = list(self.feedback_features)
        if not isinstance(feedback, Mapping) or not any(key in feedback for key in keys):
            got = ", ".join(map(str, feedback)) if isinstance(feedback, Mapping) else type(feedback).__name__
            return None, f"feedback: expected {', '.join(keys)}, got {got or 'nothing'}"
        try:
            return np.array([float(feedback.get(key, math.nan)) for key in keys]), ""
        except (TypeError, ValueError) as wrong:
            return None, f"feedback: expected a number for each of {', '.join(keys)}: {wrong}"

    def _write(self, torques: np.ndarray, stamp_s: float) -> np.ndarray:
        """Writes what is still in time, else zeros; whatever may not have arrived in time is told the leader."""
        in_time = self._clock() - stamp_s <= self.leader.latency_s_max
        if not in_time:
            torques = np.zeros(len(self._names))
        try:
            self._arm.write(torques)
        except BaseException:
            self.leader.report_failed_write()
            raise
        if not in_time or self._clock() - stamp_s > self.leader.latency_s_max:
            self.leader.report_failed_write()
        return torques
