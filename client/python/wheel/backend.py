"""Makes a wheel of what CMake installs of the Python package: a build backend, as PEP 517 has it, for pip and build.

Config settings (pip's --config-settings KEY=VALUE):

build-dir   a build folder of Forcebound, used as it is configured; else build/release, configured if it is not there
"""

import base64
import hashlib
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

import libraries

PACKAGE = Path(__file__).resolve().parent.parent
ROOT = PACKAGE.parent.parent
TARGET = "forcebound_python_package"
DATE = (1980, 1, 1, 0, 0, 0)  # the same files make the same wheel


class UnsupportedOperation(Exception):
    """A hook of PEP 517 that is not served."""


def build_sdist(sdist_directory, config_settings=None):
    raise UnsupportedOperation("the whole repository is what the package is built from: make a wheel (build --wheel)")


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    build = _built((config_settings or {}).get("build-dir"))
    with tempfile.TemporaryDirectory() as folder:
        _run("cmake", "--install", build, "--component", "python", "--strip", "--prefix", folder)
        (tree,) = Path(folder).glob("lib/python3*/dist-packages")
        module = _module_for_this_python(tree / "forcebound", build)
        licences = libraries.bundle(module)
        (facts,) = tree.glob("forcebound-*.dist-info")
        tag = f"{_python_tag()}-{_python_tag()}-{_platform_tag()}"
        (facts / "WHEEL").write_text(
            f"Wheel-Version: 1.0\nGenerator: forcebound\nRoot-Is-Purelib: false\nTag: {tag}\n")
        (facts / "licenses").mkdir()
        shutil.copyfile(ROOT / "LICENSE", facts / "licenses" / "LICENSE")
        for name, file in licences.items():
            shutil.copyfile(file, facts / "licenses" / name)
        wheel = f"{facts.name.removesuffix('.dist-info')}-{tag}.whl"
        _pack(tree, facts.name + "/RECORD", Path(wheel_directory) / wheel)
    return wheel


def _run(*command, **options):
    words = [os.fspath(word) for word in command]
    if shutil.which(words[0]) is None:
        raise SystemExit(f"{words[0]} is not installed: deploy/setup --wheel installs what a wheel is built with")
    if (status := subprocess.run(words, **options).returncode) != 0:
        raise SystemExit(f"{' '.join(words)}: failed with {status}, see above")


def _built(given):
    """The build folder, with the package in it."""
    build = Path(given).resolve() if given else ROOT / "build" / "release"
    if not (ROOT / "CMakePresets.json").exists():
        raise SystemExit(f"{PACKAGE} is not in a clone of Forcebound: its sources are what is built")
    if not (build / "CMakeCache.txt").exists():
        if given:
            raise SystemExit(f"build-dir={given}: there is no build of Forcebound; cmake --preset release makes one")
        _run("cmake", "--preset", "release", "-DBUILD_TESTING=OFF", "-DFORCEBOUND_PYTHON=ON", cwd=ROOT)
    _run("cmake", "--build", build, "--target", TARGET)
    return build


def _module_for_this_python(package, build):
    wanted = package / f"_native{sysconfig.get_config_var('EXT_SUFFIX')}"
    if not wanted.exists():
        found = ", ".join(file.name for file in package.glob("_native*"))
        raise SystemExit(f"{build} is for another Python, as {found} shows, and this one wants {wanted.name}: configure a"
                         f" folder with -DPython3_EXECUTABLE={sys.executable}, and name it by build-dir")
    return wanted


def _python_tag():
    return f"cp{sys.version_info.major}{sys.version_info.minor}"


def _platform_tag():
    """Of machines whose C library is no older than this one's, against which all of it was linked."""
    major, minor = os.confstr("CS_GNU_LIBC_VERSION").split()[1].split(".")[:2]
    return f"manylinux_{major}_{minor}_{os.uname().machine}"


def _pack(tree, record, wheel):
    rows = []
    wheel.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as packed:

        def add(name, content, mode):
            entry = zipfile.ZipInfo(name, DATE)
            entry.external_attr = mode << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            packed.writestr(entry, content)

        for file in sorted(path for path in tree.rglob("*") if path.is_file()):
            content = file.read_bytes()
            name = file.relative_to(tree).as_posix()
            add(name, content, 0o100755 if file.suffix == ".so" else 0o100644)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            rows.append(f"{name},sha256={digest},{len(content)}\n")
        add(record, "".join(rows) + f"{record},,\n", 0o100644)
