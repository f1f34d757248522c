"""What deploy/wheel puts into a wheel, and that it names what is missing."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from forcebound import _native

WHEEL = Path(__file__).resolve().parents[2] / "client" / "python" / "wheel"

pytestmark = pytest.mark.skipif(not WHEEL.exists(), reason="not in a clone of Forcebound")


def test_a_library_that_not_every_linux_has_is_named(tmp_path):
    module = Path(_native.__file__)
    wheel = tmp_path / "forcebound.whl"
    with zipfile.ZipFile(wheel, "w") as packed:
        packed.write(module, f"forcebound/{module.name}")
    checked = subprocess.run([sys.executable, WHEEL / "libraries.py", wheel], capture_output=True, text=True)
    assert checked.returncode == 1
    line = f"forcebound/{module.name} needs libprotobuf.so"
    assert any(found.startswith(line) and found.endswith("neither in the wheel nor in every Linux")
               for found in checked.stderr.splitlines()), checked.stderr
    assert "libc.so.6" not in checked.stderr


@pytest.mark.parametrize(("settings", "why"), [
    ({"build-dir": "/nowhere"}, "build-dir=/nowhere: there is no build of Forcebound; cmake --preset release makes one"),
])
def test_what_cannot_be_built_is_refused_in_one_line(tmp_path, settings, why):
    code = f"import backend; backend.build_wheel({str(tmp_path)!r}, {settings!r})"
    ran = subprocess.run([sys.executable, "-B", "-c", code], cwd=WHEEL, capture_output=True, text=True)
    assert (ran.returncode, ran.stderr) == (1, why + "\n")
