"""forcebound.simulation: the loop in virtual time, with laws, environments and hands in Python."""

import math
import os
import threading
from pathlib import Path

import numpy as np
import pytest

from forcebound import devices, laws, recordings, scenes, simulation
from forcebound.simulation import ClosedLoop, simulate

PRESS = {"scene": "wall", "device": "wall-1dof", "hand": "press"}


def wall_of(stiffness_N_per_m):
    def respond(position, time_s):
        depth_m = position[0]
        if depth_m <= 0:
            return np.zeros(1)
        return np.array([-stiffness_N_per_m * depth_m]), np.array([-1.0]), depth_m

    return respond


class Unbounded(laws.OwnLaw):
    """Does as NoLaw does, and writes down what it is told."""

    name = "unbounded"

    def begin(self, facts):
        self.facts, self.calls, self.motions = facts, [], []

    def credit(self, motion):
        self.calls.append("credit")
        self.motions.append((motion.interval_s, motion.position, motion.joint, motion.jacobian, motion.damping))

    def bound(self, request_N):
        self.calls.append("bound")
        self.energy_J = float(len(self.calls))
        return request_N

    def commit(self, force_N):
        self.calls.append("commit")


def test_a_run_has_a_row_for_each_tick_with_the_documented_columns():
    run = simulate(0.5, **PRESS)
    assert len(run.ticks) == 500
    assert run.ticks.dtype.names == tuple(recordings.TICK)
    assert run.forces.dtype.names == tuple(recordings.FORCE)
    np.testing.assert_array_equal(run.ticks["tick"], np.arange(1, 501))
    np.testing.assert_allclose(run.ticks["time_s"], np.arange(500) * 1e-3, atol=1e-12)
    assert run.ticks["position"].shape == (500, 1)
    assert np.all(run.ticks["state"][10:] == recordings.SessionState.active)
    assert np.isnan(run.ticks["local_N"]).all()
    assert run.summary["ticks"] == 500


def test_the_same_settings_give_the_same_run_and_another_seed_another():
    settings = dict(scene="sphere", device="omni", hand="trace-sphere", network="delay 5ms 2ms loss 5%")
    one, same = simulate(1, seed=7, **settings), simulate(1, seed=7, **settings)
    assert one.ticks.tobytes() == same.ticks.tobytes()
    assert one.ticks.tobytes() != simulate(1, seed=8, **settings).ticks.tobytes()


def test_a_network_is_named_as_the_lab_names_it(tmp_path):
    trace = tmp_path / "recorded.csv"
    trace.write_text("send_time_ms,rtt_ms\n" + "".join(f"{t},40\n" for t in range(0, 2000, 20)))
    recorded = simulate(0.5, network=f"trace:{trace}", **PRESS)
    assert recorded.summary["rtt_us"]["p50"] == pytest.approx(40e3, rel=0.05)
    none, perfect = simulate(0.5, network="none", **PRESS), simulate(0.5, **PRESS)
    np.testing.assert_array_equal(none.ticks["applied_N"], perfect.ticks["applied_N"])
    with pytest.raises(Exception, match="nowhere.csv"):
        simulate(0.1, network="trace:/nowhere.csv", **PRESS)


def test_a_recorded_network_has_the_round_trips_that_were_recorded():
    folder = os.environ.get("FORCEBOUND_DATA")
    if not folder:
        pytest.skip("FORCEBOUND_DATA does not say where the recorded networks are")
    trace = Path(folder) / "network" / "5g-urban-n8.csv"
    times_ms, round_trips_ms = np.loadtxt(trace, delimiter=",", skiprows=1).T
    run = simulate(5, network=f"trace:{trace}", scene="sphere", device="omni", hand="trace-sphere")
    then = round_trips_ms[times_ms - times_ms[0] <= 5000]
    assert 1e3 * then.min() * 0.9 <= run.summary["rtt_us"]["p50"] <= 1e3 * then.max() * 1.1
    assert run.summary["rtt_us"]["p50"] == pytest.approx(1e3 * np.median(then), rel=0.3)
    assert run.summary["passivity"]["minimum_J"] >= 0


def test_a_run_in_parts_is_the_same_run():
    late = dict(late_share=0.3, late_s_max=1e-3, seed=3)
    whole = simulate(1, **PRESS, **late).ticks
    loop = ClosedLoop(**PRESS, **late)
    parts = [loop.run(duration_s)[0] for duration_s in (0.25, 0.0, 0.55, 0.2)]
    for column in recordings.TICK:
        np.testing.assert_array_equal(np.concatenate([part[column] for part in parts]), whole[column], err_msg=column)
    assert loop.time_s == pytest.approx(1)


def test_an_environment_in_python_acts_as_the_same_scene_does():
    scene = scenes.parse("scene = { name = 'wall', description = '', degrees_of_freedom = 'any' }\n"
                         "[[object]]\nname = 'wall'\nshape = { kind = 'half_space', through_m = [0], normal = [-1] }\n"
                         "effects = ['surface']\n[object.surface]\nstiffness_N_per_m = 3000\ndamping_N_s_per_m = 0\n")
    settings = dict(device="wall-1dof", hand="press", network="delay 10ms")
    by_scene = simulate(2, scene=scene, **settings)
    by_function = simulate(2, environment=wall_of(3000), **settings)
    np.testing.assert_allclose(by_function.ticks["applied_N"], by_scene.ticks["applied_N"], atol=1e-9)
    np.testing.assert_allclose(by_function.forces["penetration_m"], by_scene.forces["penetration_m"], atol=1e-12)
    assert by_function.ticks["contact"].any()


def test_a_law_in_python_acts_as_the_same_law_in_cpp():
    own = Unbounded()
    in_python = simulate(1, law=own, network="delay 10ms", **PRESS)
    in_cpp = simulate(1, law=laws.NoLaw, network="delay 10ms", **PRESS)
    np.testing.assert_array_equal(in_python.ticks["applied_N"], in_cpp.ticks["applied_N"])
    assert own.calls == ["credit", "bound", "commit"] * 1000
    assert own.facts.name == "wall-1dof"
    np.testing.assert_array_equal([m[1] for m in own.motions], in_python.ticks["position"])
    assert own.motions[0][0] == 0 and own.motions[5][0] == pytest.approx(1e-3)
    assert own.motions[5][3].tolist() == [[1.0]] and own.motions[5][4].tolist() == [[30.0]]
    assert in_python.ticks["energy_J"][-1] == len(own.calls) - 1
    assert in_python.summary["law"] == "unbounded"


def test_a_law_may_keep_the_motions_that_it_is_told():
    class Keeping(Unbounded):
        def credit(self, motion):
            self.motions.append(motion)

    own = Keeping()
    ticks = simulate(0.2, law=own, **PRESS).ticks
    np.testing.assert_array_equal([m.position for m in own.motions], ticks["position"])
    assert {m.damping[0, 0] for m in own.motions} == {30.0}


PRESS_HAND = dict(mass_kg=0.05, stiffness_N_per_m=1000, damping_N_s_per_m=4)  # of the hand "press"


def sway(time_s):
    return [0.02 * math.sin(6 * time_s)], [0.12 * math.cos(6 * time_s)]


def test_a_hand_in_python_moves_as_the_same_hand_does():
    settings = dict(scene="wall", device="wall-1dof", network="delay 10ms")
    by_words = simulate(2, hand="press:from_m=-0.01,to_m=-0.01", **settings)
    by_function = simulate(2, hand=simulation.OwnHand(lambda time_s: [-0.01], **PRESS_HAND), **settings)
    np.testing.assert_array_equal(by_function.ticks["position"], by_words.ticks["position"])


def test_a_hand_that_gives_no_velocity_moves_straight_to_its_next_target():
    settings = dict(scene="wall", device="wall-1dof")
    with_velocity = simulate(1, hand=sway, **settings).ticks["position"]
    without = simulate(1, hand=lambda time_s: sway(time_s)[0], **settings).ticks["position"]
    assert np.ptp(with_velocity) > 0.01
    np.testing.assert_allclose(without, with_velocity, atol=2e-4)


def test_a_stiffer_hand_presses_deeper():
    settings = dict(scene="wall", device="wall-1dof")
    soft, firm = (
        simulate(2, hand=simulation.OwnHand(lambda time_s: [0.02 * min(time_s, 1)], 0.1, stiffness, 4), **settings)
        for stiffness in (200, 1000)
    )
    assert firm.ticks["position"][-1, 0] > 2 * soft.ticks["position"][-1, 0]
    assert soft.summary["passivity"]["minimum_J"] >= -1e-9


def test_a_hand_in_python_is_refused_with_what_it_may_be():
    settings = dict(scene="wall", device="wall-1dof")
    with pytest.raises(TypeError, match="hand: expected its words, an OwnHand or a function of time_s, got int"):
        simulate(1, hand=3, **settings)
    with pytest.raises(TypeError, match="target: expected a function of time_s, got str"):
        simulate(1, hand=simulation.OwnHand("press"), **settings)
    with pytest.raises(ValueError, match=r"OwnHand: mass_kg must be finite and >= 0, got -1"):
        simulate(1, hand=simulation.OwnHand(sway, mass_kg=-1), **settings)
    with pytest.raises(ValueError, match=r"the position of a hand: expected shape \(1,\), got \(3,\)"):
        simulate(1, hand=lambda time_s: [0, 0, 0], **settings)
    with pytest.raises(ValueError, match="expected position or \\(position, velocity\\), got a tuple of 3"):
        simulate(1, hand=lambda time_s: (0, 0, 0), **settings)
    with pytest.raises(ValueError, match="the position of a hand must be finite"):
        simulate(1, hand=lambda time_s: [math.nan], **settings)
    with pytest.raises(ZeroDivisionError):
        simulate(1, hand=lambda time_s: [1 / (time_s - 0.5)], **settings)


def test_the_truth_of_a_loop_is_not_asked_for_below_its_own_hand():
    loops = []
    loops.append(None)
    loops[0] = ClosedLoop(hand=lambda time_s: loops[0].truth["position"] if loops[0] else [0.0], scene="wall")
    with pytest.raises(RuntimeError, match="runs already"):
        loops[0].run(1)


def test_an_exception_of_a_law_or_environment_ends_the_run_with_it():
    class Failing(Unbounded):
        def commit(self, force_N):
            raise ZeroDivisionError("in the law")

    with pytest.raises(ZeroDivisionError, match="in the law"):
        simulate(1, law=Failing(), **PRESS)
    with pytest.raises(KeyError, match="nowhere"):
        simulate(1, environment=lambda position, time_s: {}["nowhere"])
    with pytest.raises(NotImplementedError, match="has no bound"):
        simulate(1, law=laws.OwnLaw(), **PRESS)


def test_forces_of_the_wrong_shape_are_value_errors_with_both_shapes():
    class Wrong(laws.OwnLaw):
        def bound(self, request_N):
            return np.zeros(3)

    with pytest.raises(ValueError, match=r"own law: expected shape \(1,\), got \(3,\)"):
        simulate(1, law=Wrong(), **PRESS)
    with pytest.raises(ValueError, match=r"environment: expected shape \(1,\), got \(2,\)"):
        simulate(1, environment=lambda position, time_s: [0, 0])
    with pytest.raises(ValueError, match="expected force or \\(force, normal, depth\\), got a tuple of 2"):
        simulate(1, environment=lambda position, time_s: (0, 0))
    with pytest.raises(TypeError, match="complex128"):
        simulate(1, environment=lambda position, time_s: [1j])


def test_a_loop_does_not_run_below_its_own_environment():
    loops = []
    loops.append(ClosedLoop(environment=lambda position, time_s: loops[0].run(1)))
    with pytest.raises(RuntimeError, match="runs already"):
        loops[0].run(1)


def test_a_hostile_environment_gets_energy_from_no_law_and_none_from_fba_exact():
    settings = dict(scene="wall", environment="bang-bang", hand="wave")
    assert "bang-bang" in simulation.hostile_environments()
    assert simulate(2, law="none", **settings).summary["passivity"]["minimum_J"] < -1e-3
    assert simulate(2, law="fba-exact", **settings).summary["passivity"]["minimum_J"] >= -1e-9


def test_local_rendering_is_refused_with_a_law_that_has_a_server_side_law():
    with pytest.raises(ValueError, match="'local': all forces go through the server-side law of 'wave'; accepted is 'remote'"):
        ClosedLoop(scene="wall", law="wave", rendering="local")


def test_local_rendering_shows_a_wall_through_a_delay_as_it_is():
    settings = dict(scene="sphere", device="firm-3dof", hand="trace-sphere", network="delay 50ms", settle_s=1)
    shown = {rendering: simulate(4, rendering=rendering, **settings).summary["displayed_stiffness_N_per_m"]["median"]
             for rendering in ("local", "remote")}
    assert shown["remote"] is None or shown["remote"] < 0.9 * shown["local"]


def test_a_device_that_is_told_otherwise_moves_as_it_truly_does():
    facts = devices.load("wall-1dof").facts
    told = simulate(1, told=facts.replace(damping=15.0), law="none", **PRESS)
    np.testing.assert_array_equal(told.ticks["position"], simulate(1, law="none", **PRESS).ticks["position"])


def test_the_truth_is_within_the_encoders_step_of_the_reading():
    loop = ClosedLoop(**PRESS)
    ticks, _ = loop.run(0.8)
    step_m = devices.load("wall-1dof").facts.encoder_step[0]
    speed = abs(loop.truth["velocity"][0])
    assert abs(loop.truth["position"][0] - ticks["position"][-1, 0]) <= step_m / 2 + 1e-3 * speed + 1e-12


def test_a_recording_has_the_ticks_and_forces_of_the_run(tmp_path):
    file = tmp_path / "run.mcap"
    run = simulate(0.7, scene="sphere", device="omni", hand="trace-sphere", network="delay 5ms", recording=file)
    recording = recordings.read(file)
    assert recording.complete
    for column in recordings.TICK:
        np.testing.assert_array_equal(recording.ticks[column], run.ticks[column], err_msg=column)
    for column in recordings.FORCE:
        np.testing.assert_array_equal(recording.forces[column], run.forces[column], err_msg=column)
    assert recording.summary["passivity"] == run.summary["passivity"]


def test_other_threads_run_beside_a_loop():
    counted = [0]
    over = threading.Event()

    def count():
        while not over.is_set():
            counted[0] += 1

    beside = threading.Thread(target=count)
    loop = ClosedLoop(**PRESS)
    beside.start()
    try:
        before = counted[0]
        for _ in range(1000):  # of 1 s each: until the other thread has done something meanwhile
            loop.run(1)
            if counted[0] > before:
                break
    finally:
        over.set()
        beside.join()
    assert counted[0] > before


def test_a_law_in_c_is_loaded_by_its_path_and_known_by_its_name_then():
    folder = os.environ.get("FORCEBOUND_TEST_LAWS")
    if not folder:
        pytest.skip("FORCEBOUND_TEST_LAWS does not say where the laws in C are")
    library = Path(folder) / "forcebound-law-saver.so"
    settings = dict(network="delay 10ms", **PRESS)
    saver = simulate(2, law=library, **settings).summary
    paper = simulate(2, law="fba-less", **settings).summary
    assert saver["law"] == "saver"
    shown = "displayed_stiffness_N_per_m"
    assert saver[shown]["mean"] == pytest.approx(paper[shown]["mean"], rel=1e-9)
    tenth = simulate(2, law="saver", law_parameters={"share": 0.1}, **settings).summary
    assert tenth[shown]["mean"] < 0.7 * saver[shown]["mean"]
    with pytest.raises(ValueError, match="forcebound-law-newer.so: has interface 99, this program has 1"):
        simulate(1, law=f"{folder}/forcebound-law-newer.so", **PRESS)
    with pytest.raises(ValueError, match="law ./nowhere.so: cannot be loaded: there is no such file"):
        simulate(1, law="./nowhere.so", **PRESS)


def test_settings_that_cannot_be_are_refused_with_what_would_be_accepted():
    with pytest.raises(ValueError, match="unknown law 'fba'.*known: none"):
        ClosedLoop(law="fba", **PRESS)
    with pytest.raises(TypeError, match="law: expected a name, a class of forcebound.laws or an OwnLaw, got int"):
        ClosedLoop(law=3, **PRESS)
    with pytest.raises(ValueError, match="delai"):
        ClosedLoop(network="delai 5ms", **PRESS)
    with pytest.raises(ValueError, match="rendering must be"):
        ClosedLoop(rendering="both", **PRESS)
    with pytest.raises(ValueError, match="unknown environment 'evil'"):
        ClosedLoop(environment="evil", **PRESS)
    with pytest.raises(TypeError, match="needs a scene"):
        ClosedLoop()
    with pytest.raises(ValueError, match="hold"):
        ClosedLoop(hold_s=2, drop_s=1, **PRESS)
    with pytest.raises(ValueError, match="scene 'sphere' is for devices of 3 or 6 degrees of freedom, device 'wall-1dof'"):
        ClosedLoop(scene="sphere")
    with pytest.raises(ValueError, match="3 joints"):
        ClosedLoop(told=devices.load("omni").facts, **PRESS)
    with pytest.raises(ValueError, match="late_share must be 0 to 1, got 2"):
        ClosedLoop(late_share=2, **PRESS)
    with pytest.raises(ValueError, match="late_s_max must be 0 to 1e6 s, got -1"):
        ClosedLoop(late_s_max=-1, **PRESS)
    with pytest.raises(ValueError, match="to_cm"):
        ClosedLoop(scene="wall", hand="press:to_cm=1")
    loop = ClosedLoop(**PRESS)
    for wrong in (float("nan"), -1, 1e300):
        with pytest.raises(ValueError, match="duration_s must be 0 to 1e6 s"):
            loop.run(wrong)
    loop.close()
    with pytest.raises(RuntimeError, match="has ended"):
        loop.run(1)


def test_a_recording_that_cannot_be_written_is_refused_before_the_run(tmp_path):
    with pytest.raises((OSError, RuntimeError), match="absent"):
        ClosedLoop(recording=tmp_path / "absent" / "run.mcap", **PRESS)


@pytest.mark.parametrize("scene", scenes.names())
def test_every_scene_that_ships_runs_on_every_device_that_it_accepts(scene):
    try:
        accepted = scenes.load(scene).degrees_of_freedom
    except ValueError as error:
        assert "MuJoCo" in str(error)
        pytest.skip(str(error))
    ran = 0
    for device in devices.names():
        facts = devices.load(device).facts
        axes = devices.load(device).tip_of([np.zeros(facts.joints)])[0].shape[1]
        hand = "wave:amplitude_m=0.2,frequency_Hz=5" + (",turn_x_rad=0.5,turn_Hz=2" if facts.degrees_of_freedom == 6 else "")
        settings = dict(scene=scene, device=device, hand=hand, network="delay 5ms", rendering="local")
        if accepted in (0, axes):
            run = simulate(0.1, **settings)
            assert run.ticks["position"].shape == (100, axes), device
            assert run.summary["ticks"] == 100, device
            ran += 1
        else:
            with pytest.raises(ValueError, match=f"device '{device}' has {axes}") as refused:
                simulate(0.1, **settings)
            assert "\n" not in str(refused.value)
    assert ran > 0


def test_a_device_of_six_axes_takes_a_hand_of_one_s_own_and_tells_how_its_tip_moves():
    arm = devices.load("arm-6dof")
    loop = ClosedLoop(scene="plane", device=arm, hand=lambda time_s: np.array([0, 0, 0.02 * math.cos(20 * time_s)]))
    ticks, _ = loop.run(0.1)
    assert ticks["position"].shape == (100, 3)
    assert loop.truth["velocity"].shape == (3,)
    assert loop.truth["turning"].shape == (3,)
    positions, jacobians = arm.tip_of([loop.truth["joint"]])
    np.testing.assert_allclose(positions[0], loop.truth["position"], atol=1e-12)
    assert jacobians.shape == (1, 6, 6)
    np.testing.assert_allclose(arm.tip_of([arm.joints_at(positions[0])])[0][0], positions[0], atol=1e-6)
