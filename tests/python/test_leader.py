"""forcebound.leader: a step, what is refused, and P of a simulated arm."""

import math

import numpy as np
import pytest

from forcebound import leader, simulation
from forcebound.leader import SO101, ForceBoundedLeader, Servo, SimulatedArm

SERVO = Servo("elbow", 0.15, 0.03, 2 * math.pi / 4096, 1.0)
TIMES_S = {60: (4e-3, 2e-3), 200: (2e-3, 1e-3), 1000: (3e-4, 1e-4)}


def at_200_Hz(servos=(SERVO, SERVO), **others):
    return ForceBoundedLeader(servos, **{"period_s": 0.005, "latency_s_max": 0.001, **others})


def warmed_up(bounded, steps=100, by_dt=False):
    """Moved at 1 rad/s against 1 N m until that is given; the time, and where it is."""
    for n in range(steps):
        torques = bounded.step([0.005 * n] * 2, [-1, -1], **({"dt": 0.005} if by_dt else {"time_s": 0.005 * n}))
    assert torques.tolist() == [-1, -1]
    return 0.005 * (steps - 1), 0.005 * (steps - 1)


@pytest.mark.parametrize("rate_Hz", TIMES_S)
@pytest.mark.parametrize("bounded", [True, False], ids=["bounded", "none"])
def test_an_so101_behind_a_quarter_second_is_passive_at_each_rate_only_with_the_bound(rate_Hz, bounded):
    latency_s, read_s = TIMES_S[rate_Hz]
    bounding = ForceBoundedLeader(period_s=1 / rate_Hz, latency_s_max=latency_s, read_s_max=read_s)
    # It shakes the arm for a second, then only holds it.
    hand = simulation.OwnHand(lambda t: np.full(6, 0.3 * math.sin(15 * t) if t < 1 else 0), 0.003, 3, 0.1)
    arm = SimulatedArm(bounding, hand=hand, seed=rate_Hz)
    jitter = np.random.default_rng(1)
    past, felt, time_s = [], 0.0, 0.0
    while time_s < 4:
        positions = arm.read(time_s)
        past.append(positions)
        feedback = np.clip(20 * (past[-1 - min(len(past) - 1, rate_Hz // 4)] - positions), -0.5, 0.5)
        torques = bounding.step(positions, feedback, time_s) if bounded else feedback
        arm.write(time_s, torques)
        felt = max(felt, np.abs(torques).max())
        time_s += jitter.uniform(1, 1.5) / rate_Hz
    assert felt > 0.1
    assert bounding.counts["late"] == 0
    if bounded:
        assert arm.least_P_J >= -1e-9
        assert arm.P_J > 0
    else:
        assert arm.least_P_J < -0.1


def test_a_time_and_the_time_since_the_step_before_are_the_same():
    by_time, by_dt = at_200_Hz(), at_200_Hz()
    random = np.random.default_rng(1)
    positions, feedback = np.cumsum(random.normal(0, 3e-3, (200, 2)), axis=0), random.normal(0, 0.3, (200, 2))
    felt = 0
    for n in range(200):
        torques = by_time.step(positions[n], feedback[n], 0.25 * n)
        np.testing.assert_array_equal(torques, by_dt.step(positions[n], feedback[n], dt=0.25))
        felt += np.any(torques != 0)
    assert felt > 10
    np.testing.assert_array_equal(by_time.energy_J, by_dt.energy_J)
    for wrong in ({}, {"time_s": 1, "dt": 1}):
        with pytest.raises(TypeError, match="either time_s.* or dt"):
            by_time.step(positions[0], feedback[0], **wrong)
    with pytest.raises(TypeError, match="^step takes one of time_s and dt in all steps: time_s as before, got dt$"):
        by_time.step(positions[0], feedback[0], dt=0.25)
    with pytest.raises(TypeError, match="dt as before, got time_s$"):
        by_dt.step(positions[0], feedback[0], 50.0)
    assert by_time.counts["readings_lost"] == by_dt.counts["readings_lost"] == 0


def test_a_wrong_number_of_joints_is_a_value_error_and_loses_that_reading_alone():
    bounding = at_200_Hz()
    time_s, at = warmed_up(bounding)
    energy_J = bounding.energy_J
    for positions, feedback, shapes in [
        ([at] * 3, [0] * 2, r"positions: expected shape \(2,\), got \(3,\)"),
        ([at] * 2, [0] * 3, r"feedback: expected shape \(2,\), got \(3,\)"),
        ([[at] * 2], [0] * 2, r"positions: expected shape \(2,\), got \(1, 2\)"),
        (at, [0] * 2, r"positions: expected shape \(2,\), got \(\)"),
    ]:
        with pytest.raises(ValueError, match=shapes):
            time_s += 0.005
            bounding.step(positions, feedback, time_s)
    for no_numbers, got in [(["x", "y"], "positions"), (None, "^positions: expected numbers, got None$")]:
        with pytest.raises(TypeError, match=got):
            time_s += 0.005
            bounding.step(no_numbers, [0, 0], time_s)
    assert bounding.counts["readings_lost"] == 12
    assert np.all(bounding.energy_J < energy_J), "what acted meanwhile is paid for"
    assert np.all(bounding.step([at + 0.025] * 2, [-1, -1], time_s + 0.005) < 0)
    assert bounding.counts["intervals_impossible"] == 0


@pytest.mark.parametrize("after_s", [-0.005, 0.0, math.nan])
def test_a_time_that_goes_back_or_stands_still_is_zero_torque_and_in_words(after_s):
    bounding = at_200_Hz()
    time_s, at = warmed_up(bounding, by_dt=True)
    assert bounding.step([at] * 2, [-1, -1], dt=after_s).tolist() == [0, 0]
    assert "none that a clock can have measured" in bounding.fault
    assert "\n" not in bounding.fault
    assert bounding.counts["intervals_impossible"] == 1
    for n in range(20):
        torques = bounding.step([at + 0.005 * n] * 2, [-1, -1], dt=0.005)
    assert np.all(torques < 0)
    assert bounding.fault == ""


def test_a_time_that_is_no_number_costs_its_own_step_alone():
    bounding = at_200_Hz()
    time_s, at = warmed_up(bounding)
    assert bounding.step([at] * 2, [-1, -1], math.nan).tolist() == [0, 0]
    assert "none that a clock can have measured" in bounding.fault
    bounding.step([at] * 2, [-1, -1], time_s + 0.009)
    assert bounding.fault == ""
    assert bounding.counts["intervals_impossible"] == 1


def test_a_step_after_a_second_is_late_unless_a_watchdog_ends_torques():
    for watchdog_s, late in [(0, 1), (0.006, 0)]:
        bounding = at_200_Hz(watchdog_s_least=watchdog_s)
        time_s, at = warmed_up(bounding)
        assert np.all(np.isfinite(bounding.step([at] * 2, [-1, -1], time_s + 1)))
        assert bounding.counts["late"] == late
        assert ("later than hold_s_max" in bounding.fault) == bool(late)


def test_what_is_not_finite_is_zero_torque_of_its_joint():
    bounding = at_200_Hz()
    time_s, at = warmed_up(bounding)
    assert bounding.step([at, math.nan], [-1, -1], time_s + 0.005).tolist() == [-1, 0]
    assert bounding.fault.startswith("joint 'elbow': reading lost")
    assert bounding.step([at, at], [math.inf, -1], time_s + 0.01)[0] == 0
    assert bounding.counts["feedback_not_finite"] == 1
    assert bounding.step([at, at], None, time_s + 0.015).tolist() == [0, 0]
    bounding.lose(time_s + 0.02)
    assert bounding.counts["readings_lost"] == 3
    bounding.report_failed_write()
    assert bounding.counts["writes_failed"] == 1


def test_settings_are_refused_in_one_line_that_names_the_joint():
    for change, refusal in [
        ({"torque_N_m_max": 0}, r"joint 'elbow': torque_N_m_max must be > 0, got 0"),
        ({"damping_N_m_s_per_rad": math.nan}, "damping_N_m_s_per_rad must be > 0, got nan"),
        ({"goal_stiffness_N_m_per_rad": 17.8, "speed_rad_per_s_max": 6},
         r"goal_stiffness_N_m_per_rad must be at most .*, got 17.8"),
    ]:
        with pytest.raises(ValueError, match=refusal):
            at_200_Hz((SERVO._replace(**change),))
    for change, refusal in [
        ({"hold_s_max": 0}, "hold_s_max must be > 0, or None"),
        ({"hold_s_max": 1e-3}, "hold_s_max must be at least period_s and latency_s_max together"),
        ({"period_s": 1}, "period_s must be 0.0001 to 0.1, got 1"),
        ({"read_s_max": 0.01}, "latency_s_max must be at least read_s_max"),
    ]:
        with pytest.raises(ValueError, match=refusal):
            at_200_Hz(**change)
    with pytest.raises(ValueError, match="there must be a joint or more"):
        at_200_Hz(())
    with pytest.raises(TypeError, match="damping_N_m_s_per_rad: expected a number"):
        at_200_Hz((SERVO._replace(damping_N_m_s_per_rad="much"),))
    with pytest.raises(TypeError, match="^servos: expected a Servo for each joint, got NoneType$"):
        at_200_Hz(None)


def test_servos_that_take_goals_get_reading_and_torque_over_stiffness():
    bounding = at_200_Hz((SERVO._replace(goal_stiffness_N_m_per_rad=0.5, speed_rad_per_s_max=30), SERVO))
    for n in range(200):
        position = 0.005 * n
        torques = bounding.step([position] * 2, [-1, -1], dt=0.005)
    assert torques[0] < 0
    assert bounding.goals_rad[0] == pytest.approx(position + torques[0] / 0.5, abs=1e-12)
    assert math.isnan(bounding.goals_rad[1])
    bounding.step([math.nan] * 2, [-1, -1], dt=0.005)
    assert bounding.goals_rad[0] == pytest.approx(position + torques[0] / 0.5, abs=1e-12)


def test_an_arm_may_have_more_joints_than_a_device():
    assert len(at_200_Hz((SERVO,) * 8).step([0] * 8, [1] * 8, 0.0)) == 8


def test_the_so101_has_the_published_numbers():
    pan, lift, *_ = SO101
    assert [servo.name for servo in SO101][:2] == ["shoulder_pan", "shoulder_lift"]
    # Identified: 0.0591 viscous and 1.2116^2/2.676 of the motor; 0.6 in the arm's own model for MuJoCo.
    assert lift.damping_N_m_s_per_rad == pytest.approx(0.7 * 0.6077, rel=1e-3)
    assert pan.damping_N_m_s_per_rad == pytest.approx(lift.damping_N_m_s_per_rad * (191 / 345) ** 2)
    assert len(leader.SO101_INERTIA_KG_M2) == len(SO101)


def test_a_simulated_arm_refuses_what_it_cannot_do():
    bounding = at_200_Hz()
    with pytest.raises(ValueError, match="inertia_kg_m2"):
        SimulatedArm(bounding, [0.01] * 3)
    with pytest.raises(ValueError, match="1 to 6 joints, got 7"):
        SimulatedArm(at_200_Hz((SERVO,) * 7), [0.01] * 7)
    arm = SimulatedArm(bounding, [0.01] * 2)
    arm.read(1.0)
    with pytest.raises(ValueError, match="must not be before"):
        arm.read(0.5)
    with pytest.raises(ValueError, match="finite"):
        arm.write(1.0, [math.nan, 0])

    def broken(time_s):
        raise RuntimeError("no hand")

    with pytest.raises(RuntimeError, match="no hand"):
        SimulatedArm(bounding, [0.01] * 2, broken)
