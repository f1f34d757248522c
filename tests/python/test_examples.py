"""The examples that ship: each is run, draws its figure, and its numbers are looked at."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest


def folder() -> Path:
    installed = Path("/usr/share/doc/python3-forcebound/examples")
    sources = Path(__file__).parents[2] / "client/python/examples"
    return Path(os.environ.get("FORCEBOUND_EXAMPLES", sources if sources.exists() else installed))


def run(example, *arguments, cwd):
    done = subprocess.run([sys.executable, folder() / example, *arguments], cwd=cwd, capture_output=True, text=True,
                          env={**os.environ, "MPLBACKEND": "Agg"}, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def is_a_figure(file: Path) -> bool:
    """A PNG with more than one colour, none of it beyond the canvas: its edges are white."""
    from matplotlib import pyplot

    pixels = pyplot.imread(file)
    for edge in (pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]):
        assert np.all(edge[..., :3] == 1)
    return len(np.unique(pixels.reshape(-1, pixels.shape[-1]), axis=0)) > 10


def test_every_example_is_run_here():
    assert {file.name for file in folder().glob("*.py")} == {"leader_arm.py", "paper_table.py", "own_law.py",
                                                               "replay_recording.py", "soft_body.py"}


def test_the_papers_table_is_that_of_the_lab(lab, tmp_path):
    printed = run("paper_table.py", "figure.png", cwd=tmp_path)
    assert is_a_figure(tmp_path / "figure.png")
    subprocess.run([lab, "reproduce", "all", "--json", "runs.json"], cwd=tmp_path, check=True, capture_output=True)
    by_lab = json.loads((tmp_path / "runs.json").read_text())
    rows = [line.split() for line in printed.splitlines()[1:]]
    assert len(rows) == len(by_lab) == 28
    # By law here, by experiment there.
    expected = [run for law in ("none", "fba-less", "fba-more", "fba-exact") for run in by_lab if run["law"] == law]
    for row, lab_row in zip(rows, expected):
        *_, law, least_mJ, shown, mean_N, variance = row
        assert law == lab_row["law"]
        assert row[:2] == [lab_row["experiment"].replace("delay", "wall"), f"{lab_row['stiffness_N_per_m'] / 1e3:g}"]
        median = lab_row["displayed_stiffness_N_per_m"]["median"]
        np.testing.assert_allclose(
            [float(least_mJ), float(shown), float(mean_N), float(variance)],
            [lab_row["passivity"]["minimum_J"] * 1e3, np.nan if median is None else median * 1e-3,
             lab_row["force_N"]["mean"], lab_row["force_N"]["variance"]],
            rtol=6e-3, atol=1e-9, err_msg=" ".join(row))


def test_a_leader_arm_rests_with_the_law_and_shakes_without_it(tmp_path):
    rows = [line.split() for line in run("leader_arm.py", cwd=tmp_path).splitlines()[1:]]
    assert [row[:2] for row in rows] == [[rate, law] for rate in ("60", "200", "1000") for law in ("none", "fba-exact")]
    page = folder().parent / "README.md"
    for (rate, _, shaken, lost_J, restless, _), (_, _, shown, least_J, rests, _) in zip(rows[::2], rows[1::2]):
        assert float(lost_J) < -1
        assert float(least_J) >= -1e-9
        assert float(restless) < 20 < 95 < float(rests)
        assert float(shown) > 2
        if page.exists():
            assert f"| {rate} | {shown}, {shaken} | {least_J}, {lost_J} | {rests}, {restless} |" in page.read_text()


def test_the_papers_table_takes_40_lines():
    code = (folder() / "paper_table.py").read_text().splitlines()
    assert len(code) <= 40


def test_a_law_of_ones_own_is_compared_with_fba_exact(tmp_path):
    printed = run("own_law.py", "figure.png", cwd=tmp_path)
    least_mJ = {line.split()[0]: float(line.split()[3]) for line in printed.splitlines()}
    assert least_mJ["none"] < -1
    assert least_mJ["none"] < least_mJ["hesitant"]
    assert least_mJ["fba-exact"] >= -1e-6
    assert is_a_figure(tmp_path / "figure.png")


@pytest.mark.parametrize("given", [False, True], ids=["its own", "a recording"])
def test_a_recording_is_replayed_by_each_law(tmp_path, given):
    arguments = []
    if given:
        from forcebound import simulation

        arguments = ["run.mcap", "figure.png"]
        simulation.simulate(1, scene="sphere", device="cartesian-3dof", hand="trace-sphere",
                            recording=tmp_path / "run.mcap")
    printed = run("replay_recording.py", *arguments, cwd=tmp_path)
    assert [line.split()[0] for line in printed.splitlines()] == ["fba-less", "fba-more", "fba-exact"]
    assert all(float(line.split()[2]) > 0 for line in printed.splitlines())
    assert is_a_figure(tmp_path / ("figure.png" if given else "replay_recording.png"))


@pytest.mark.parametrize("rate", ["60", "200"])
def test_a_soft_body_is_pressed_in(rate):
    from forcebound.client import Client

    with subprocess.Popen([sys.executable, "-u", folder() / "soft_body.py", "--rate", rate, "--listen", "127.0.0.1:0"],
                          stdout=subprocess.PIPE, text=True) as stepping:
        address = re.search(r"times a second at (\S+)$", stepping.stdout.readline().strip())[1]
        with Client(address, device="firm-3dof", hand="press:axis=2,from_m=0.003,to_m=-0.005") as feeling:
            while len(feeling.ticks()) < 300 or np.median(feeling.ticks(-300)["applied_N"][:, 2]) < 1:
                time.sleep(0.01)
        stepping.send_signal(signal.SIGINT)
        said = stepping.stdout.read()
    assert stepping.returncode == 0
    assert float(re.search(r"pressed in by up to (\S+) mm", said)[1]) > 0.5
    assert int(re.search(r"(\d+) reports", said)[1]) > 0


def test_a_soft_body_refuses_in_one_line():
    for arguments, why in ((["--rate", "5"], "--rate must be 20 to 250, got 5"),
                           (["--listen", "0.0.0.0:0"], "'insecure'")):
        run = subprocess.run([sys.executable, folder() / "soft_body.py", *arguments], capture_output=True, text=True,
                             check=False)
        assert run.returncode == 2 and why in run.stderr.splitlines()[-1]
