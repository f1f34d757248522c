#!/usr/bin/python3
"""Draws the pictures of the README's gallery from runs of what they show.

    gallery.py BUILD FOLDER     # where it was built; where simulator.png, ros2.png and leader.png go

deploy/gallery builds what it needs.
"""

import importlib.util
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from forcebound import Server, client, recordings

GREEN, RED, GREY = "#1a8754", "#c1272d", "#8a8a8a"


def example(name):
    file = Path(__file__).parents[2] / "client/python/examples" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(name, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def picture(file, title, x, y):
    figure, axes = plt.subplots(figsize=(4.2, 2.6), dpi=110, layout="constrained")
    axes.set(title=title, xlabel=x, ylabel=y)
    axes.title.set_fontsize(10)
    axes.spines[["top", "right"]].set_visible(False)
    return axes, lambda: figure.savefig(file)


def draw_forces(axes, ticks, time_s):
    for column, colour, word in (("request_N", GREY, "requested"), ("applied_N", GREEN, "applied")):
        axes.plot(time_s, np.linalg.norm(ticks[column], axis=1), color=colour, linewidth=1, label=word)
    axes.legend(frameon=False, fontsize=8)


def draw_simulator(file):
    """A soft block of numpy that steps 60 times a second, pressed through a live server."""
    soft_body = example("soft_body")
    block, ended, steps_s = soft_body.SoftBlock(1 / 60), threading.Event(), []
    with Server("soft-block", listen="127.0.0.1:0", probe_radius_m=0.002) as server:

        def serve():
            next_s = time.monotonic()
            while not ended.is_set():
                soft_body.step(block, server)
                steps_s.append(time.monotonic())
                next_s += 1 / 60
                time.sleep(max(0, next_s - time.monotonic()))

        serving = threading.Thread(target=serve)
        serving.start()
        try:
            with client.Client(server.address, device="firm-3dof", rendering="local", duration_s=4,
                               hand="press:axis=2,from_m=0.01,to_m=-0.006,approach_s=1") as feeling:
                begun_s = time.monotonic()
                feeling.wait()
                ticks = feeling.ticks()
        finally:
            ended.set()
            serving.join()
    time_s = ticks["time_s"] - ticks["time_s"][0]
    touched_s = time_s[np.argmax(np.abs(ticks["request_N"][:, 2]) > 0.3)]
    shown = (time_s > touched_s - 0.1) & (time_s < touched_s + 0.6)
    axes, save = picture(file, "A soft block in numpy, stepped at 60 Hz", "time [s]", "force [N]")
    for step_s in np.array(steps_s) - begun_s:
        if touched_s - 0.1 < step_s < touched_s + 0.6:
            axes.axvline(step_s, color="#dddddd", linewidth=0.8)
    draw_forces(axes, ticks[shown], time_s[shown])
    save()


def draw_ros2(file, build):
    """A publisher of servo_cf falls silent after 2 s."""
    with tempfile.TemporaryDirectory() as folder:
        run = Path(folder) / "run.mcap"
        names = ["--namespace", "/gallery", "--domain", "77"]
        peer = subprocess.Popen([build / "tests/support/ros2/ros2_peer", "bus=fast", "domain=77", "namespace=/gallery", "seconds=6",
                                 "publish=constant", "force=1.5", "hz=1000", "until-s=2"], stdout=subprocess.DEVNULL)
        subprocess.run([build / "bin/forcebound-ros2", *names, "--device", "firm-3dof", "--operator", "trace-sphere",
                        "--duration", "6", "--record", run, "--quiet"], check=True, stdout=subprocess.DEVNULL)
        peer.wait()
        ticks = recordings.read(run).ticks
    axes, save = picture(file, "ROS 2's servo_cf falls silent", "time [s]", "force [N]")
    draw_forces(axes, ticks, ticks["time_s"] - ticks["time_s"][0])
    save()


def draw_leader(file):
    """A leader arm behind 120 ms +- 40 ms, with the bound and without."""
    leader_arm = example("leader_arm")
    axes, save = picture(file, "A leader arm at 60 Hz, follower 120 ms away", "time [s]", "shoulder [rad]")
    for bounded, colour, words in ((False, RED, "no law"), (True, GREEN, "fba-exact")):
        trace = []
        leader_arm.run(60, bounded, trace=trace)
        axes.plot(*np.array(trace).T, color=colour, linewidth=1, label=words)
    axes.axhline(leader_arm.WALL_RAD, color=GREY, linewidth=0.8)
    axes.legend(frameon=False, fontsize=8, loc="upper left")
    save()


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("expected: gallery.py BUILD FOLDER")
    to = Path(sys.argv[2])
    draw_leader(to / "leader.png")
    draw_simulator(to / "simulator.png")
    draw_ros2(to / "ros2.png", Path(sys.argv[1]))
