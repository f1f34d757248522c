#!/usr/bin/python3
"""What each law would have made of a recorded run: every law over all of its ticks, a call each.

    replay_recording.py [RECORDING.mcap [FIGURE.png]]

Without a recording it makes one, in virtual time. The recorded device must be Cartesian, and one that ships. The motion is
the recorded one: under another law the hand would have moved otherwise, so this compares what laws know and allow, not
what is felt.
"""

import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from forcebound import devices, laws, recordings, simulation


def record(file: Path) -> None:
    loop = simulation.ClosedLoop(scene="sphere", device="cartesian-3dof", hand="trace-sphere", law="fba-exact",
                                 network="delay 5ms 2ms", recording=file)
    loop.run(6)
    loop.close()


def main(file: Path, figure: str) -> dict:
    recording = recordings.read(file, partial=True)
    ticks = recording.ticks
    facts = devices.load(recording.info["device"]).facts
    if not facts.cartesian:
        raise SystemExit(f"replay_recording: device '{facts.name}' is not Cartesian: its laws need Jacobians too")
    # A column for each law, below each other force, with the request in grey, and energy.
    figure_, axes = plt.subplots(2, 3, sharex=True, sharey="row", figsize=(10, 5.5), layout="constrained")
    means = {}
    for law, colour, (allowed, ledger) in zip((laws.FbaLess, laws.FbaMore, laws.FbaExact),
                                              ("#d9730d", "#0b5fa5", "#1a8754"), axes.T):
        steps = law(facts).run(ticks["position"], ticks["request_N"], ticks["interval_s"])
        means[law.info.name] = np.linalg.norm(steps.force_N, axis=1).mean()
        allowed.plot(ticks["time_s"], np.linalg.norm(ticks["request_N"], axis=1), color="#b0b0b0", linewidth=2)
        allowed.plot(ticks["time_s"], np.linalg.norm(steps.force_N, axis=1), color=colour, linewidth=1)
        allowed.set_title(f"{law.info.name}: {means[law.info.name]:.3g} N in the mean", color=colour)
        ledger.semilogy(ticks["time_s"], np.maximum(1e3 * steps.energy_J, 1e-6), color=colour, linewidth=1)
        ledger.set_xlabel("time [s]")
        print(f"{law.info.name:<10} allows {means[law.info.name]:.3g} N in the mean")
    axes[0, 0].set_ylim(0, 2 * max(axis.lines[1].get_ydata().max() for axis in axes[0]))
    axes[0, 0].set_ylabel(f"force [N]; grey: asked for,\nup to {np.linalg.norm(ticks['request_N'], axis=1).max():.0f} N")
    axes[1, 0].set_ylabel("energy that may be spent [mJ]")
    figure_.savefig(figure)
    return means


if __name__ == "__main__":
    picture = sys.argv[2] if len(sys.argv) > 2 else "replay_recording.png"
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]), picture)
    else:
        with tempfile.TemporaryDirectory() as folder:
            record(Path(folder) / "run.mcap")
            main(Path(folder) / "run.mcap", picture)
