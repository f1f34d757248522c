"""forcebound.laws: a tick, a sequence, the ledger, and what is refused."""

import threading

import numpy as np
import pytest
from conftest import random_ticks

from forcebound import devices, laws
from forcebound.devices import DeviceFacts

ALL = laws.all_laws()
BY_ONESELF = [law for law in ALL if not law.info.has_server_side]


def made(law, facts):
    """The law on that device, or a skip with its reason where it refuses the device."""
    try:
        return law(facts)
    except ValueError as refused:
        pytest.skip(str(refused))


def test_the_registry_has_a_documented_class_for_each_law():
    assert {"NoLaw", "FbaLess", "FbaMore", "FbaExact"} <= {law.__name__ for law in ALL}
    for law in ALL:
        assert getattr(laws, law.__name__) is law
        assert laws.by_name(law.info.name) is law
        assert law.info.summary in law.__doc__
        for parameter in law.info.parameters:
            assert parameter.name in law.__doc__
    with pytest.raises(ValueError, match="known: none, fba-less"):
        laws.by_name("fba-exakt")
    with pytest.raises(TypeError, match="by_name"):
        laws.Law(DeviceFacts(1.0))


@pytest.mark.parametrize("device", ["wall-1dof", "cartesian-3dof", "omni"])
@pytest.mark.parametrize("law", BY_ONESELF, ids=lambda law: law.__name__)
def test_a_sequence_gives_the_same_numbers_as_its_ticks(law, device):
    device = devices.load(device)
    positions, requests_N = random_ticks(device.facts, 300)
    joints = np.array([device.joints_at(position) for position in positions])
    positions, jacobians = device.tip_of(joints)
    together = made(law, device.facts).run(positions, requests_N, joints=joints, jacobians=jacobians)
    one_by_one = law(device.facts)
    for i in range(len(positions)):
        force_N = one_by_one.step(positions[i], requests_N[i], joint=joints[i], jacobian=jacobians[i])
        np.testing.assert_array_equal(force_N, together.force_N[i])
        assert one_by_one.energy_J == together.energy_J[i]
        assert one_by_one.xi == together.xi[i]
    assert np.any(together.force_N != 0)


def test_the_less_conservative_law_follows_its_recursion():
    # E_n = E_{n-1} + d'B d - f_{n-1}'d with B = b/T, and |f| <= sqrt(4 E B) [Kim 2015, eq. 17, 21].
    damping, period_s = 30.0, 1e-3
    facts = DeviceFacts(damping, period_s=period_s)
    positions, requests_N = random_ticks(facts, 500)
    energy_J, held_N, before, expected = 0.0, 0.0, positions[0, 0], []
    for x, request_N in zip(positions[:, 0], requests_N[:, 0]):
        moved = x - before
        energy_J += damping / period_s * moved**2 - held_N * moved
        most_N = np.sqrt(4 * max(energy_J, 0) * damping / period_s)
        held_N = np.clip(request_N, -most_N, most_N)
        before = x
        expected.append((held_N, energy_J))
    steps = laws.FbaLess(facts).run(positions, requests_N)
    np.testing.assert_allclose(steps.force_N[:, 0], [e[0] for e in expected], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(steps.energy_J, [e[1] for e in expected], rtol=1e-9, atol=1e-12)


def test_no_law_applies_what_is_asked_for(wall_facts):
    positions, requests_N = random_ticks(wall_facts, 100)
    requests_N = np.clip(requests_N, -1, 1)
    np.testing.assert_array_equal(laws.NoLaw(wall_facts).run(positions, requests_N).force_N, requests_N)


def test_columns_of_a_recording_are_read_where_they_lie(wall_facts):
    positions, requests_N = random_ticks(wall_facts, 50)
    ticks = np.zeros(100, dtype=[("odd", "u1"), ("position", "f8", (1,)), ("request_N", "f8", (1,))])
    ticks["position"][::2], ticks["request_N"][::2] = positions, requests_N
    every_second = ticks[::2]
    strided = laws.FbaExact(wall_facts).run(every_second["position"], every_second["request_N"])
    np.testing.assert_array_equal(strided.force_N, laws.FbaExact(wall_facts).run(positions, requests_N).force_N)


def test_integers_and_lists_count_as_numbers_and_a_plain_number_as_one_axis(wall_facts):
    law, other = laws.NoLaw(wall_facts), laws.NoLaw(wall_facts)
    assert law.step([0], [1]).tolist() == [1.0]
    assert law.step(0.001, 1).tolist() == [1.0]
    assert other.step(np.float32(0), np.array([1], dtype=np.int16)).tolist() == [1.0]


def test_without_an_answer_of_the_environment_the_force_is_zero(wall_facts):
    law = laws.NoLaw(wall_facts)
    law.step([0.0], [1.0])
    assert law.step([0.0], None).tolist() == [0.0]


def test_what_is_not_finite_is_zero_force_and_counted(wall_facts):
    law = laws.FbaExact(wall_facts)
    law.step([0.0], [0.0])
    assert law.step([np.nan], [1.0]).tolist() == [0.0]
    assert law.step([0.0], [np.inf]).tolist() == [0.0]
    assert law.counts["readings_not_finite"] == 1
    assert law.counts["requests_not_finite"] == 1


def test_wrong_shapes_are_value_errors_with_both_shapes():
    facts = devices.load("cartesian-3dof").facts
    law = laws.FbaExact(facts)
    with pytest.raises(ValueError, match=r"position: expected shape \(3,\), got \(2,\)"):
        law.step([0, 0], [0, 0, 0])
    with pytest.raises(ValueError, match=r"request_N: expected shape \(3,\), got \(3, 1\)"):
        law.step(np.zeros(3), np.zeros((3, 1)))
    with pytest.raises(ValueError, match=r"positions: expected shape \(n, 3\), got \(10,\)"):
        law.run(np.zeros(10), np.zeros((10, 3)))
    with pytest.raises(ValueError, match="requests_N: expected 10 rows, as of positions, got 9"):
        law.run(np.zeros((10, 3)), np.zeros((9, 3)))
    with pytest.raises(ValueError, match=r"intervals_s: expected shape \(n,\), got \(10, 1\)"):
        law.run(np.zeros((10, 3)), np.zeros((10, 3)), np.zeros((10, 1)))
    # The law is as before.
    assert law.step(np.zeros(3), np.zeros(3)).tolist() == [0, 0, 0]


def test_wrong_dtypes_are_type_errors_that_name_them(wall_facts):
    law = laws.FbaExact(wall_facts)
    for wrong, name in [([1j], "complex128"), (["x"], "<U1"), ([True], "bool"), ([None], "object")]:
        with pytest.raises(TypeError, match=f"position: .*{name}"):
            law.step(wrong, [0])
    with pytest.raises(ValueError):  # numpy's own, of a ragged list
        law.run([[0.0], [0.0, 1.0]], [[0.0], [0.0]])
    with pytest.raises(TypeError, match="interval_s: expected a number"):
        law.step([0], [0], interval_s="1 ms")


def test_a_device_that_is_not_cartesian_needs_joints_and_jacobian():
    law = laws.FbaExact(devices.load("omni").facts)
    with pytest.raises(ValueError, match="joint and jacobian: expected both"):
        law.step(np.zeros(3), np.zeros(3))
    with pytest.raises(ValueError, match="joints and jacobians: expected both"):
        law.run(np.zeros((4, 3)), np.zeros((4, 3)))


def test_parameters_are_those_of_the_registry(wall_facts):
    law = laws.Vc(wall_facts)
    name, standard = next(iter(law.parameters.items()))
    assert laws.Vc(wall_facts, **{name: standard / 2}).parameters[name] == standard / 2
    with pytest.raises(ValueError, match="no parameter 'stifness'"):
        laws.Vc(wall_facts, stifness=1.0)
    with pytest.raises(ValueError, match="memory must be 'capped' or 'full', got 'half'"):
        laws.FbaExact(wall_facts, memory="half")
    assert laws.FbaExact(wall_facts, memory="full").memory == "full"


def test_a_law_and_its_server_side_talk_to_each_other(wall_facts):
    with_server = [law for law in ALL if law.info.has_server_side]
    assert with_server
    for kind in with_server:
        law = kind(wall_facts)
        side = law.server_side()
        requested = np.zeros(1)
        felt = 0.0
        for i in range(200):
            x = np.array([1e-5 * i])
            place = side.place(x, law.outgoing(), wall_facts.period_s)
            requested, numbers = side.answer(np.minimum(0, -1000 * place))
            law.hear(numbers)
            felt = max(felt, abs(law.step(x, requested)[0]))
        assert felt > 0, kind
    with pytest.raises(ValueError, match="has no server-side law"):
        laws.FbaExact(wall_facts).server_side()


def test_times_that_cannot_be_are_refused_before_the_law_sees_them(wall_facts):
    law = laws.FbaExact(wall_facts)
    for name, wrong in [("latency_s", np.nan), ("latency_s_max", -1), ("effect_s", np.nan), ("held_s", np.inf)]:
        with pytest.raises(ValueError, match=f"{name} must be"):
            law.step([0], [0], **{name: wrong})
    with pytest.raises(ValueError, match="latencies_s must be .* in row 1"):
        law.run([[0.0], [0.0]], [[0.0], [0.0]], latencies_s=[0, np.nan])
    with pytest.raises(ValueError, match="force_N must be finite"):
        law.confirm([np.nan], 0)
    # A clock that cannot have measured an interval is the law's own matter: it credits nothing.
    law.step([0], [0])
    law.step([0], [0], interval_s=-1)
    law.step([0], [0], interval_s=np.nan)
    assert law.counts["intervals_impossible"] == 2
    with pytest.raises(ValueError, match="finite"):
        laws.by_name("wave")(wall_facts).server_side().place([np.nan], [], 0.001)


@pytest.mark.parametrize("use_law", [
    lambda law: law.step([0.0], [0.0]),
    lambda law: law.energy_J,
    lambda law: law.xi,
    lambda law: law.counts,
    lambda law: law.outgoing(),
    lambda law: law.begin_server_side(),
], ids=["step", "energy_J", "xi", "counts", "outgoing", "begin_server_side"])
def test_a_law_has_one_owner(wall_facts, use_law):
    law = laws.FbaExact(wall_facts)
    positions, requests_N = random_ticks(wall_facts, 200_000)
    over = threading.Event()

    def use():
        while not over.is_set():
            law.run(positions, requests_N)

    user = threading.Thread(target=use)
    user.start()
    try:
        with pytest.raises(RuntimeError, match="another thread"):
            while True:  # until it comes while the other thread runs the sequence
                use_law(law)
    finally:
        over.set()
        user.join()
