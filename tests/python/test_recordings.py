"""forcebound.recordings: whole files, truncated ones and malformed ones."""

import numpy as np
import pytest

from forcebound import recordings, simulation


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    file = tmp_path_factory.mktemp("recorded") / "run.mcap"
    simulation.simulate(6, scene="sphere", device="omni", hand="trace-sphere", recording=file)
    return file


def test_a_recording_says_what_ran(recorded):
    recording = recordings.read(recorded)
    assert recording.info["device"] == "omni"
    assert recording.info["law"] == "fba-exact"
    assert recording.totals is not None and int(recording.totals["sent"]) > 0
    assert recording.summary["ticks"] == len(recording.ticks) == 6000
    assert len(recording.motions) == len(recording.sent) == 0
    assert recording.motions.dtype.names == tuple(recordings.MOTION)
    assert set(recording.sent.dtype.names) < set(recordings.FORCE)


def test_a_truncated_recording_is_an_error_that_has_what_was_read(recorded, tmp_path):
    whole = recordings.read(recorded).ticks
    file = tmp_path / "cut.mcap"
    file.write_bytes(recorded.read_bytes()[: recorded.stat().st_size // 2])
    with pytest.raises(EOFError, match=r"cut\.mcap: .*read: \d+ ticks, \d+ forces") as cut:
        recordings.read(file)
    assert isinstance(cut.value, recordings.TruncatedRecordingError)
    ticks = cut.value.recording.ticks
    assert 0 < len(ticks) < len(whole)
    assert ticks.tobytes() == whole[: len(ticks)].tobytes()
    partial = recordings.read(file, partial=True)
    assert not partial.complete and partial.totals is None
    assert partial.ticks.tobytes() == ticks.tobytes()


def test_a_damaged_recording_lacks_a_second_and_says_so(recorded, tmp_path):
    whole = recordings.read(recorded).ticks
    damaged = bytearray(recorded.read_bytes())
    damaged[len(damaged) // 2] ^= 0xFF
    file = tmp_path / "damaged.mcap"
    file.write_bytes(damaged)
    with pytest.raises(EOFError, match=r"damaged\.mcap: incomplete: 1 damaged record, with .* messages \(at byte \d+: "):
        recordings.read(file)
    partial = recordings.read(file, partial=True)
    assert not partial.complete and "damaged" in partial.flaw
    assert len(whole) - 1010 <= len(partial.ticks) < len(whole)
    assert set(partial.ticks["tick"]) < set(whole["tick"])
    assert partial.totals is not None and recordings.read(recorded).flaw == ""


def test_a_file_that_is_no_recording_is_a_value_error_that_names_the_byte(recorded, tmp_path):
    file = tmp_path / "wrong.mcap"
    file.write_bytes(b"not a recording, but long enough to be looked at")
    with pytest.raises(ValueError, match=r"wrong\.mcap"):
        recordings.read(file)


def test_a_file_that_cannot_be_read_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        recordings.read(tmp_path / "absent.mcap")
    with pytest.raises(IsADirectoryError):
        recordings.read(tmp_path)


def test_the_arrays_outlive_the_recording(recorded):
    ticks = recordings.read(recorded).ticks
    total = ticks["applied_N"].sum()
    for _ in range(3):
        recordings.read(recorded)
    assert ticks["applied_N"].sum() == total
    ticks["applied_N"][:] = 0  # they belong to the caller
    assert not np.any(ticks["applied_N"])
