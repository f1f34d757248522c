#!/usr/bin/env python3
"""The shared libraries of a wheel: which are in it, and whether these are all that not every Linux has.

    libraries.py WHEEL       names what a wheel's libraries need beyond it and manylinux; status 1 if there is any
"""

import hashlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

#: What the policies of manylinux (PEP 599, PEP 600) let a wheel expect of every Linux, as far as Debian's smallest has it.
EVERYWHERE = re.compile(r"(lib(c|m|dl|rt|util|pthread|resolv)\.so\.\d+|libgcc_s\.so\.1|libstdc\+\+\.so\.6|ld-linux.*\.so\.\d+)")

#: Beside the module.
FOLDER = "libraries"


def _output(*command):
    if shutil.which(command[0]) is None:
        raise SystemExit(f"{command[0]} is not installed: deploy/setup --wheel installs what a wheel is built with")
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def needed(library):
    """The names of the libraries that it links itself."""
    return re.findall(r"\(NEEDED\).*\[(.+)\]", _output("readelf", "--dynamic", "--wide", library))


def _where(library):
    """Of all libraries that it needs, directly or not, the names and files."""
    found = dict(re.findall(r"^\s*(\S+) => (/\S+)", _output("ldd", library), re.MULTILINE))
    return {name: Path(file) for name, file in found.items() if not EVERYWHERE.fullmatch(name)}


def bundle(module):
    """Puts beside a module the libraries that it needs and not every Linux has, under names that no others have.

    Returns the licences of the packages that these are from, by the names that files of them may have.
    """
    files = _where(module)
    folder = module.parent / FOLDER
    folder.mkdir()
    names = {name: _own_name(name, file) for name, file in files.items()}
    for name, file in files.items():
        shutil.copyfile(file, folder / names[name])
    for library in [module, *folder.iterdir()]:
        # One change at a time: Debian 12's patchelf mixes up the names of several.
        for name in needed(library):
            if name in names:
                _output("patchelf", "--replace-needed", name, names[name], library)
        if library.parent == folder:
            _output("patchelf", "--set-soname", library.name, library)
        _output("patchelf", "--set-rpath", "$ORIGIN" if library.parent == folder else f"$ORIGIN/{FOLDER}", library)
    return _licences(files.values())


def _own_name(name, file):
    """Another module of the process may have another library of that name."""
    stem, rest = name.split(".so", 1)
    return f"{stem}-{hashlib.sha256(file.read_bytes()).hexdigest()[:8]}.so{rest}"


def _licences(files):
    licences = {}
    if shutil.which("dpkg-query") is None:
        return licences
    for file in files:
        # Packages name a file as it was before / and /usr were one.
        for path in {file, file.resolve(), Path("/usr") / file.resolve().relative_to("/")}:
            owner = subprocess.run(["dpkg-query", "--search", path], capture_output=True, text=True).stdout.split(":")[0]
            copyright_file = Path("/usr/share/doc") / owner / "copyright"
            if owner and copyright_file.exists():
                licences[owner] = copyright_file
                break
    return licences


def missing(wheel):
    """A line for each library that is needed, and neither in the wheel nor in every Linux."""
    lines = []
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(wheel) as packed:
        packed.extractall(folder)
        libraries = [file for file in Path(folder).rglob("*") if re.search(r"\.so(\.|$)", file.name)]
        inside = {file.name for file in libraries}
        for library in libraries:
            for name in needed(library):
                if name in inside or EVERYWHERE.fullmatch(name):
                    continue
                place = library.relative_to(folder)
                lines.append(f"{place} needs {name}, which is neither in the wheel nor in every Linux")
    return sorted(lines)


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        sys.exit(0 if len(sys.argv) == 2 else 2)
    if lines := missing(sys.argv[1]):
        sys.exit("\n".join(lines))
