"""Force feedback for leader arms: torques in the joints that cannot make the arm return more energy than these dissipate.

    from forcebound.leader import SO101, ForceBoundedLeader

    leader = ForceBoundedLeader(SO101, period_s=1 / 60, latency_s_max=0.004, read_s_max=0.002)
    while True:
        time_s = time.monotonic()                                   # the stamp: before the positions are read
        positions = arm.read()                                      # [rad], unwrapped
        feedback = stiffness_N_m_per_rad * (follower - positions)   # or the follower's torques, currents times constant
        arm.write(leader.step(positions, feedback, time_s))         # [N m]

Whatever the feedback is, late, lost or wrong: each joint gets no more back than its damping and friction took, so the arm
does not start to shake by itself. Joints are bounded one by one (fba-exact), any number of them. Compared with one law for
all, energy that one joint saved is not spent by another, and where joints are cut by different shares the force at the tip
turns; but a joint whose reading is lost does not stop the others.

**Late steps.** Up to hold_s_max (two periods and the latency) the promise holds for any jitter. Beyond, it holds if the
servos have a watchdog that ends a torque. Without one, such a step is counted (`counts["late"]`), P may dip below zero by
what the torque returned in the time beyond, and no more torque is given until that is earned again.

**Servos.** The promise is for servos that make the torque they are told, within the bounds of `Servo`:

* torque or current (Dynamixel current mode, Feetech HLS): `damping` is of the gears alone.
* voltage (PWM mode, as of the STS3215): torque = duty * stall torque at standstill; the motor brakes as well, torque
  constant^2 / resistance, which counts as damping while the servo is on. Supply and heat change the torque: say how far.
* goal position and torque limit, written together in one packet: a goal out of reach on the side of the torque, and the
  limit its size. It is a torque then.
* goal positions alone (`goal_stiffness_N_m_per_rad`, then `goals_rad` is what to write): a goal is behind the joint by its
  speed times the latency, so this is sound only where friction holds stiffness * that, and else refused. Nothing is
  promised for servos with an integral part, a profile of speed, a dead zone or a changing supply: they are no springs.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from forcebound import _native
from forcebound.simulation import HandTarget, OwnHand

__all__ = ["SO101", "SO101_INERTIA_KG_M2", "ForceBoundedLeader", "Servo", "SimulatedArm"]


class Servo(NamedTuple):
    """What is known of a joint and its servo, at the joint: bounds, of which the truth is never worse.

    name                        for what is said of it
    damping_N_m_s_per_rad       at least, while the servo is on
    friction_N_m                dry friction, at least
    encoder_step_rad            2 pi / 4096, say
    torque_N_m_max              the most that it may be asked for
    backlash_rad                play between encoder and motor, from stop to stop
    torque_step_N_m             of two neighbouring commands; 0: any
    torque_gain_share           its torque is the command times one constant, 1 and up to so much less or more,
    torque_ripple_share         and off by up to this share, another one at each instant
    speed_rad_per_s_max         never exceeded: a reading beyond is lost, such as an angle that wraps; 0: not known, and
                                then none is
    goal_stiffness_N_m_per_rad  0: it takes torques; else goals, and pulls there as a spring
    goal_rad_least, goal_rad_most  of goals
    """

    name: str
    damping_N_m_s_per_rad: float
    friction_N_m: float
    encoder_step_rad: float
    torque_N_m_max: float
    backlash_rad: float = 0
    torque_step_N_m: float = 0
    torque_gain_share: float = 0
    torque_ripple_share: float = 0
    speed_rad_per_s_max: float = 0
    goal_stiffness_N_m_per_rad: float = 0
    goal_rad_least: float = -math.inf
    goal_rad_most: float = math.inf


def _sts3215(name: str, gear: int, torque_N_m_max: float) -> Servo:
    """An STS3215 at 7.4 V in PWM mode, by its gear.

    Of the gear 345, identified (Rhoban/bam, params/feetech_sts3215_7_4V/m1.json): torque constant 1.2116 N m/A, resistance
    2.676 ohm, friction 0.0524 N m, viscous 0.0591 N m s/rad. Of other gears nothing is published: guessed by the gear's
    square, of friction by the gear. Encoder: its manual. Play: TheRobotStudio/SO-ARM100, Simulation/SO101. Guesses: damping
    down to 0.7 (a warm winding), friction to half, gain, ripple and speed.
    """
    ratio = gear / 345
    return Servo(
        name=name,
        damping_N_m_s_per_rad=0.7 * (0.0591 + 1.2116**2 / 2.676) * ratio**2,
        friction_N_m=0.5 * 0.0524 * ratio,
        encoder_step_rad=2 * math.pi / 4096,
        torque_N_m_max=torque_N_m_max,
        backlash_rad=math.radians(1),
        torque_step_N_m=1e-3 * 7.4 * 1.2116 / 2.676 * ratio,
        torque_gain_share=0.15,
        torque_ripple_share=0.02,
        speed_rad_per_s_max=30,
    )


#: The leader arm of an SO-101, with the gears of LeRobot's page on it. No arm was measured: measure yours.
SO101 = (
    _sts3215("shoulder_pan", 191, 1.0),
    _sts3215("shoulder_lift", 345, 1.0),
    _sts3215("elbow_flex", 191, 1.0),
    _sts3215("wrist_flex", 147, 0.5),
    _sts3215("wrist_roll", 147, 0.5),
    _sts3215("gripper", 147, 0.5),
)

#: Of its joints, for a simulation: the motor's 0.0284 kg m^2 (as above) by the gear's square, and a guess of the links'.
SO101_INERTIA_KG_M2 = (0.0087 + 0.01, 0.0284 + 0.01, 0.0087 + 0.004, 0.0052 + 0.001, 0.0052 + 0.0003, 0.0052 + 0.0001)


class ForceBoundedLeader:
    """Bounds the torques of a leader arm, in a loop of 10 Hz to 10 kHz.

    servos            of each joint
    period_s          nominal, between steps
    latency_s_max     from the stamp of a reading until the torque that is chosen on it acts
    read_s_max        of that, until the servos latch their positions
    hold_s_max        later steps count as late; None: two periods and the latency. Longer allows longer pauses, and behind
                      a long delay rests on stiffer walls; without one they get softer
    watchdog_s_least  0: servos hold a torque until the next one; else they let go by themselves, no sooner than this and
                      no later than hold_s_max
    clock_share       the clock is fast or slow by up to this share
    memory_J          no joint saves more than this for later

    ValueError naming the joint and what would be accepted. For one thread at a time.
    """

    def __init__(
        self,
        servos: Sequence[Servo] = SO101,
        *,
        period_s: float = 1 / 60,
        latency_s_max: float = 0,
        read_s_max: float = 0,
        hold_s_max: float | None = None,
        watchdog_s_least: float = 0,
        clock_share: float = 1e-4,
        memory_J: float = 0.1,
    ) -> None:
        if hold_s_max == 0:
            raise ValueError("leader: hold_s_max must be > 0, or None for two periods and the latency, got 0")
        if not isinstance(servos, Iterable):
            raise TypeError(f"servos: expected a Servo for each joint, got {type(servos).__name__}")
        self.servos = tuple(servos)
        for servo in self.servos:
            if not isinstance(servo, Servo):
                raise TypeError(f"servos: expected a Servo for each joint, got {type(servo).__name__}")
        self.latency_s_max = latency_s_max
        self._loop = {
            "period_s": period_s,
            "latency_s_max": latency_s_max,
            "read_s_max": read_s_max,
            "hold_s_max": hold_s_max or 0,
            "watchdog_s_least": watchdog_s_least,
            "clock_share": clock_share,
            "memory_J": memory_J,
        }
        self._leader = _native.Leader([servo._asdict() for servo in self.servos], **self._loop)
        self._stamp_s: float | None = None
        self._clock: str | None = None

    def step(self, positions, feedback, time_s: float | None = None, *, dt: float | None = None) -> np.ndarray:
        """A step: the torques to command now, (joints,) [N m]; in a servo's own sign, positive as its angle.

        positions  (joints,) [rad], unwrapped. One that is not finite, or further than the joint can be so soon, is lost:
                   its torque is zero, the others are not affected
        feedback   (joints,) [N m], asked for; not finite: zero; None: there is none, or it is too old
        time_s     the stamp of the reading, of a clock that only goes on (time.monotonic()); or
        dt         the time since the step before [s]; TypeError unless all steps have the same of both

        A time that goes back, stands still or is not a number is no exception, since servos hold their torques: torques are
        zero until those before are over, and `fault` says so. ValueError for a wrong shape, TypeError for what are no
        numbers: the readings count as lost then.
        """
        if (time_s is None) == (dt is None):
            raise TypeError("step takes either time_s, the stamp of the reading, or dt, the time since the step before")
        clock = "dt" if time_s is None else "time_s"
        if self._clock not in (None, clock):
            raise TypeError(f"step takes one of time_s and dt in all steps: {self._clock} as before, got {clock}")
        self._clock = clock
        if dt is not None:
            interval_s = float(dt)
        else:
            stamp_s = float(time_s)
            interval_s = 0.0 if self._stamp_s is None else stamp_s - self._stamp_s
            if math.isfinite(stamp_s):
                self._stamp_s = stamp_s
        try:
            return self._leader.step(positions, feedback, interval_s)
        except (TypeError, ValueError):
            self._leader.lose(interval_s)
            raise

    def lose(self, time_s: float | None = None, *, dt: float | None = None) -> None:
        """A step whose readings are lost, all of them."""
        self.step(np.full(len(self.servos), np.nan), None, time_s, dt=dt)

    def report_failed_write(self) -> None:
        """The torques of the last step may not have been written, or not in time: those before may act still."""
        self._leader.report_failed_write()

    @property
    def goals_rad(self) -> np.ndarray:
        """What to write to servos that take goals, (joints,) [rad]; not a number for others, and before a good reading."""
        return self._leader.goals_rad

    @property
    def energy_J(self) -> np.ndarray:
        """What each joint may spend now, (joints,) [J]; below zero while a deficit is repaid."""
        return self._leader.energy_J

    @property
    def counts(self) -> dict[str, int]:
        """What was wrong so far: readings_lost, feedback_not_finite and saturated (asked for more than torque_N_m_max) of
        joints, the others of steps."""
        return self._leader.counts

    @property
    def fault(self) -> str:
        """What was wrong in the last step, in one line; empty: nothing."""
        return self._leader.fault

    @property
    def hold_s_max(self) -> float:
        """As it is in force [s]."""
        return self._leader.hold_s_max


class SimulatedArm:
    """A leader arm in virtual time, within the bounds that a leader was told: it dissipates as little as they allow, and
    the rest is drawn, mostly at their ends. P is exact. Up to 6 joints, all with one gain and ripple.

    leader         whose servos and times it has
    inertia_kg_m2  of each joint
    hand           what holds each joint: an OwnHand, in rad and N m, or its target, time_s -> (joints,) [rad]
    """

    def __init__(
        self,
        leader: ForceBoundedLeader,
        inertia_kg_m2: Sequence[float] = SO101_INERTIA_KG_M2,
        hand: OwnHand | HandTarget | None = None,
        seed: int = 1,
    ) -> None:
        if hand is None:
            hand = OwnHand(lambda time_s: np.zeros(len(leader.servos)), 0.003, 3, 0.1)
        if not isinstance(hand, OwnHand):
            hand = OwnHand(hand, 0.003, 3, 0.1)
        if len(inertia_kg_m2) != len(leader.servos):
            raise ValueError(f"inertia_kg_m2 must have a number for each of {len(leader.servos)} joints, got {len(inertia_kg_m2)}")
        servos = [servo._asdict() for servo in leader.servos]
        self._arm = _native.SimulatedLeader(servos, inertia_kg_m2, hand, seed, **leader._loop)

    def read(self, time_s: float) -> np.ndarray:
        """The encoders, latched within read_s_max of that stamp, (joints,) [rad]."""
        return self._arm.read(time_s)

    def write(self, time_s: float, torques) -> None:
        """Commands torques, (joints,) [N m], on the newest reading."""
        self._arm.write(time_s, torques)

    @property
    def P_J(self) -> float:
        """What its joints dissipated less what its servos returned, now."""
        return self._arm.P_J

    @property
    def least_P_J(self) -> float:
        """The least that this ever was: below zero, not passive."""
        return self._arm.least_P_J

    @property
    def truth(self) -> dict[str, np.ndarray]:
        """Angles and speeds of the joints: joint [rad], joint_velocity [rad/s], (joints,)."""
        return self._arm.truth
