#!/usr/bin/python3
"""A law and an environment of one's own in the simulated loop, beside fba-exact: who gives energy to the hand?

    own_law.py [FIGURE.png]

The environment is a wall of 3 N/mm behind 20 ms of network. The law of one's own leaves the less of the force, the faster
the device moves along it. Here that gives the hand no energy, but it rattles, and nothing promises it for other hands.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

from forcebound import laws, simulation


class Hesitant(laws.OwnLaw):
    """Divides the force by 1 + speed/v0 while it pushes along the motion."""

    name = "hesitant"
    v0_m_per_s = 0.02

    def begin(self, facts):
        self.before = self.velocity = None

    def credit(self, motion):
        if self.before is not None and motion.interval_s > 0:
            self.velocity = (motion.position - self.before) / motion.interval_s
        self.before = motion.position

    def bound(self, request_N):
        if self.velocity is None or request_N @ self.velocity <= 0:
            return request_N
        return request_N / (1 + np.linalg.norm(self.velocity) / self.v0_m_per_s)


def wall(position, time_s):
    """At x >= 0: force, normal out of the wall, depth."""
    depth_m = position[0]
    if depth_m <= 0:
        return np.zeros(1)
    return np.array([-3000 * depth_m]), np.array([-1.0]), depth_m


def main(figure: str) -> dict:
    # A column for each law, below each other force and energy.
    figure_, axes = plt.subplots(2, 3, sharex=True, sharey="row", figsize=(10, 5.5), layout="constrained")
    least_J = {}
    for law, colour, (force_axes, energy_axes) in zip((laws.NoLaw, Hesitant(), laws.FbaExact),
                                                      ("#c1272d", "#d9730d", "#1a8754"), axes.T):
        run = simulation.simulate(3, environment=wall, device="wall-1dof", hand="press:to_m=0.005", law=law,
                                  network="delay 10ms")
        name = law.name if isinstance(law, laws.OwnLaw) else law.info.name
        least_J[name] = run.ticks["audit_minimum_J"][-1]
        force_axes.plot(run.ticks["time_s"], np.abs(run.ticks["applied_N"][:, 0]), color=colour, linewidth=1)
        force_axes.set_title(name, color=colour)
        energy_axes.plot(run.ticks["time_s"], 1e3 * run.ticks["audit_J"], color=colour, linewidth=1)
        energy_axes.axhline(0, color="#b0b0b0", linewidth=1)
        energy_axes.set(xlabel="time [s]", title=f"least P {1e3 * least_J[name]:.3g} mJ")
        print(f"{name:<10} least P {1e3 * least_J[name]:8.3g} mJ, worst force {np.abs(run.ticks['applied_N']).max():.3g} N")
    axes[0, 0].set_ylabel("force on the device [N]")
    axes[1, 0].set_ylabel("P [mJ]; below 0: not passive")
    figure_.savefig(figure)
    return least_J


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "own_law.png")
