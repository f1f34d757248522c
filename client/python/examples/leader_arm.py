#!/usr/bin/python3
"""A leader arm of the size of an SO-101 feels what its follower meets, 120 ms +- 40 ms away with 1 % loss each way.

    leader_arm.py

The hand moves the shoulder to and fro, then presses it, so that the follower presses a wall; it feels the follower's
torque. Printed for loops of 60, 200 and 1000 Hz, with the bound and without: the least P (below zero, the servos gave
energy to the hand), and while pressing the displayed stiffness (torque over the leader's angle beyond the wall), how
long the arm rests and how fast it gets. Virtual time: the same figures on every machine.
"""

import heapq
import random

import numpy as np

from forcebound.leader import SO101_INERTIA_KG_M2, ForceBoundedLeader, SimulatedArm
from forcebound.simulation import OwnHand

PRESSED, WALL_RAD = 0, 0.3
#: Until torques act, and of that until positions are latched: a bus of hobby servos, up to a fast one. [s]
TIMES_S = {60: (4e-3, 2e-3), 200: (2e-3, 1e-3), 1000: (3e-4, 1e-4)}


class Way:
    """One direction of the network. The newest that came counts."""

    def __init__(self, seed):
        self.random, self.under_way, self.newest = random.Random(seed), [], (-1, np.zeros(6))

    def send(self, time_s, values):
        if self.random.random() >= 0.01:
            heapq.heappush(self.under_way, (time_s + self.random.uniform(0.08, 0.16), time_s, values.tolist()))

    def receive(self, time_s):
        while self.under_way and self.under_way[0][0] <= time_s:
            _, sent_s, values = heapq.heappop(self.under_way)
            if sent_s > self.newest[0]:
                self.newest = sent_s, np.array(values)
        return self.newest[1]


class Follower:
    """Six joints with position servos of gear 345: 17.8 N m/rad, up to 2.9 N m; a wall before one of them."""

    def __init__(self):
        self.at, self.speed, self.torque = np.zeros(6), np.zeros(6), np.zeros(6)

    def move(self, goals, time_s):
        steps = max(1, round(time_s / 5e-4))
        h = time_s / steps
        for _ in range(steps):
            self.torque = np.clip(17.8 * (goals - self.at), -2.94, 2.94)
            pushed = self.torque.copy()
            depth = self.at[PRESSED] - WALL_RAD
            if depth > 0:
                pushed[PRESSED] -= max(0, 400 * depth + self.speed[PRESSED])
            # Damping and dry friction act at the step's end, so that a joint at rest stays there.
            free = self.speed + h * pushed / 0.04
            self.speed = np.sign(free) * np.maximum(np.abs(free) - h * 0.0524 / 0.04, 0) / (1 + h * 0.6 / 0.04)
            self.at = self.at + h * self.speed


def target(time_s):
    angles = np.zeros(6)
    to_and_fro = 0.2 * np.sin(2 * np.pi * 0.8 * time_s) * min(1, time_s, max(0, 4 - time_s))
    into = np.clip((time_s - 4) / 1.5, 0, 1)
    angles[PRESSED] = to_and_fro + 0.55 * into * into * (3 - 2 * into)
    return angles


def run(rate_Hz, bounded, duration_s=12, trace=None):
    """`trace` is appended (time, where the shoulder is)."""
    latency_s, read_s = TIMES_S[rate_Hz]
    # Python may pause for as long as hold_s_max allows, and the promise holds.
    leader = ForceBoundedLeader(period_s=1 / rate_Hz, latency_s_max=latency_s, read_s_max=read_s, hold_s_max=0.1)
    arm = SimulatedArm(leader, SO101_INERTIA_KG_M2, OwnHand(target, 0.003, 3, 0.1))
    limits = np.array([servo.torque_N_m_max for servo in leader.servos])
    up, down, follower, jitter = Way(1), Way(2), Follower(), random.Random(3)
    shown, resting, speeds, time_s, before_s = [], [], [], 0.0, 0.0
    while time_s < duration_s:
        positions = arm.read(time_s)
        feedback = -down.receive(time_s)
        torques = leader.step(positions, feedback, time_s) if bounded else np.clip(feedback, -limits, limits)
        arm.write(time_s + read_s, torques)
        up.send(time_s, positions)
        follower.move(up.receive(time_s), time_s - before_s)
        down.send(time_s, follower.torque)
        if trace is not None:
            trace.append((time_s, arm.truth["joint"][PRESSED]))
        if time_s > 7:
            truth = arm.truth
            speeds.append(abs(truth["joint_velocity"][PRESSED]))
            depth = truth["joint"][PRESSED] - WALL_RAD
            if speeds[-1] < 0.02 and depth > 0:
                shown.append(-torques[PRESSED] / depth)
            resting.append(speeds[-1] < 0.02)
        before_s = time_s
        time_s += jitter.uniform(1, 1.5) / rate_Hz
    stiffness = np.median(shown) if shown else np.nan
    return stiffness, arm.least_P_J, np.mean(resting), max(speeds)


def main():
    print("rate [Hz]  law        stiffness [N m/rad]  least P [J]  rests [%]  fastest [rad/s]")
    for rate_Hz in TIMES_S:
        for bounded in (False, True):
            stiffness, least_J, rests, fastest = run(rate_Hz, bounded)
            law = "fba-exact" if bounded else "none"
            print(f"{rate_Hz:9}  {law:<9}  {stiffness:19.2f}  {least_J:12.3g}  {100 * rests:9.0f}  {fastest:15.2f}")


if __name__ == "__main__":
    main()
