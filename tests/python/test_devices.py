"""forcebound.devices and forcebound.scenes: facts, files, and what is refused."""

import numpy as np
import pytest

from forcebound import devices, scenes
from forcebound.devices import DeviceFacts, Uncertainty


def test_every_device_that_ships_is_there():
    assert "omni" in devices.names()
    for name in devices.names():
        device = devices.load(name)
        assert device.name == name
        assert device.facts.damping.shape == (device.facts.joints, device.facts.joints)
        assert device.inertia.shape == device.facts.damping.shape


def test_facts_come_from_a_file(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text("kind = 'cartesian'\ndegrees_of_freedom = 2\nmass_kg = 0.1\ndamping_N_s_per_m = [3, 4]\n"
                    "force_N_max = 5\nlatency_s = 1e-4\n[uncertainty]\ndamping_share = 0.1\n")
    facts = devices.load(file).facts
    assert facts.damping.tolist() == [[3, 0], [0, 4]]
    assert (facts.name, facts.force_N_max, facts.latency_s) == ("mine", 5, 1e-4)
    assert facts.uncertainty == Uncertainty(damping_share=0.1)


def test_a_file_that_is_refused_is_named_with_its_line(tmp_path):
    file = tmp_path / "wrong.toml"
    file.write_text("kind = 'cartesian'\ndegrees_of_freedom = 2\nmass_kg = -1\n")
    with pytest.raises(ValueError, match=r"wrong\.toml:3: .*mass_kg"):
        devices.load(file)
    with pytest.raises(FileNotFoundError):
        devices.load(tmp_path / "absent.toml")
    with pytest.raises(ValueError, match="omni"):
        devices.load("omnii")
    with pytest.raises(TypeError):
        devices.load(3)


def test_facts_are_numbers_for_all_joints_or_for_each():
    facts = DeviceFacts([1, 2, 3], encoder_step=1e-5, friction=[0.1, 0.2, 0.3], name="mine")
    assert facts.damping.tolist() == np.diag([1.0, 2, 3]).tolist()
    assert facts.encoder_step.tolist() == [1e-5] * 3
    assert facts.friction.tolist() == [0.1, 0.2, 0.3]
    assert facts.speed_max is None
    assert np.isinf(facts.force_N_max)


def test_facts_do_not_change_but_have_changed_copies():
    facts = DeviceFacts(30.0)
    with pytest.raises(ValueError, match="read-only"):
        facts.damping[0, 0] = 1
    with pytest.raises(AttributeError):
        facts.period_s = 1
    changed = facts.replace(period_s=5e-4, speed_max=2)
    assert (facts.period_s, changed.period_s, changed.speed_max.tolist()) == (1e-3, 5e-4, [2.0])


def test_facts_that_cannot_be_are_refused():
    with pytest.raises(ValueError, match=r"damping: expected shape \(2, 2\), got \(2, 3\)"):
        DeviceFacts(np.ones((2, 3)))
    with pytest.raises(ValueError, match="positive definite"):
        DeviceFacts(-1.0)
    with pytest.raises(ValueError, match=r"friction: expected shape \(2,\), got \(3,\)"):
        DeviceFacts([1, 1], friction=[0, 0, 0])
    with pytest.raises(TypeError, match="no 'dampin' .*known: name, damping"):
        DeviceFacts(1.0, dampin=3)
    with pytest.raises(ValueError, match=r"latency_s: expected shape \(2,\)"):
        Uncertainty(latency_s=[1, 2, 3])
    with pytest.raises(ValueError, match="1 to 6 rows, got 7"):
        DeviceFacts(np.eye(7))
    with pytest.raises(ValueError, match="1 to 6 numbers"):
        DeviceFacts(np.ones(7))


@pytest.mark.parametrize("field, value", [
    ("period_s", 0), ("period_s", np.nan), ("latency_s", -1e-3), ("hold_s_max", 0), ("force_N_max", -1),
    ("force_N_max", np.nan), ("friction", -1), ("encoder_step", np.inf), ("actuator_step", np.nan), ("tip_axes", 2),
    ("release_share", 2), ("speed_max", -1), ("uncertainty", Uncertainty(damping_share=1)),
    ("uncertainty", Uncertainty(stamp_s=(1e-3, 0)))])
def test_numbers_out_of_their_range_are_refused_by_name(field, value):
    name = "damping_share|stamp_s" if field == "uncertainty" else field
    with pytest.raises(ValueError, match=f"({name}).* must be .*, got "):
        DeviceFacts(1.0).replace(**{field: value})


def test_more_joints_need_more_of_all_that_is_per_joint():
    facts = DeviceFacts(1.0, friction=0.1)
    with pytest.raises(ValueError, match=r"friction must be of shape \(2,\), as damping has, got \(1,\)"):
        facts.replace(damping=[1, 2])
    changed = facts.replace(friction=[0.1, 0.2], encoder_step=0, actuator_step=0, damping=[1, 2])
    assert changed.friction.tolist() == [0.1, 0.2]


def test_a_device_keeps_its_mechanism():
    wall, omni = devices.load("wall-1dof"), devices.load("omni")
    assert wall.with_facts(wall.facts.replace(damping=15)).facts.damping.tolist() == [[15]]
    with pytest.raises(ValueError, match="the facts must be those of a device of 3 joints, .*not Cartesian, got 1 joints"):
        omni.with_facts(wall.facts)


def test_the_tip_of_an_arm_is_where_its_joints_bring_it():
    omni = devices.load("omni")
    place = np.array([0.01, -0.02, 0.03])
    joints = omni.joints_at(place)
    positions, jacobians = omni.tip_of([joints, joints + 1e-6])
    np.testing.assert_allclose(positions[0], place, atol=1e-9)
    np.testing.assert_allclose(positions[1] - positions[0], jacobians[0] @ np.full(3, 1e-6), atol=1e-11)


def test_scenes_are_found_by_name_file_and_text(tmp_path):
    assert "sphere" in scenes.names()
    sphere = scenes.load("sphere")
    assert (sphere.name, sphere.degrees_of_freedom) == ("sphere", 3)
    device, hand = sphere.suggested
    assert device in devices.names() and hand
    text = "scene = { name = 'nothing', description = 'free space', degrees_of_freedom = 'any' }\n"
    file = tmp_path / "nothing.toml"
    file.write_text(text)
    assert scenes.load(file).name == scenes.parse(text).name == "nothing"
    with pytest.raises(ValueError, match=r"mine\.toml:1"):
        scenes.parse("scene = { nam = 'x' }", "mine.toml")
    with pytest.raises(FileNotFoundError):
        scenes.load(tmp_path / "absent.toml")
    with pytest.raises(ValueError, match="sphere"):
        scenes.load("spere")
