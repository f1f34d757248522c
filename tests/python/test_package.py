"""The package as such: stubs, documentation, and a module that is for another Python."""

import ast
import inspect
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import forcebound
from forcebound import _native, client, devices, laws, leader, lerobot, recordings, scenes, server, simulation

FOLDER = Path(forcebound.__file__).parent
MODULES = [client, devices, laws, leader, lerobot, recordings, scenes, server, simulation]


def names_in_stub(file):
    """Of each class and of the module: the public names that a stub declares."""
    names = {"": set()}
    for node in ast.parse((FOLDER / file).read_text()).body:
        if isinstance(node, ast.AnnAssign):
            names[""].add(node.target.id)
        elif isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            names[""].add(node.name)
            if isinstance(node, ast.ClassDef):
                members = (m for m in node.body if isinstance(m, (ast.FunctionDef, ast.AnnAssign)))
                names[node.name] = {m.name if isinstance(m, ast.FunctionDef) else m.target.id for m in members}
    return {owner: {n for n in found if not n.startswith("_")} for owner, found in names.items()}


def public(names):
    return {name for name in names if not name.startswith("_")}


def test_the_stub_of_the_extension_module_declares_what_there_is():
    stub = names_in_stub("_native.pyi")
    assert stub[""] == public(dir(_native))
    for name in stub[""]:
        there = getattr(_native, name)
        if isinstance(there, type):
            assert stub[name] == public(vars(there)), name


def test_the_stub_of_the_laws_declares_each_of_them_with_its_parameters():
    tree = {node.name: node for node in ast.parse((FOLDER / "laws.pyi").read_text()).body
            if isinstance(node, ast.ClassDef)}
    assert names_in_stub("laws.pyi")[""] >= set(laws.__all__) - {"Motion", "ServerSideLaw"}
    assert names_in_stub("laws.pyi")["Law"] == public(vars(laws.Law)) | {"info"}
    for law in laws.all_laws():
        (init,) = [m for m in tree[law.__name__].body if isinstance(m, ast.FunctionDef)]
        assert [a.arg for a in init.args.kwonlyargs] == ["memory", *(p.name for p in law.info.parameters)]
        assert [*inspect.signature(law).parameters] == ["facts", "memory", *(p.name for p in law.info.parameters)]


def test_the_package_is_typed():
    assert (FOLDER / "py.typed").exists()


def test_everything_public_is_documented():
    for module in MODULES:
        assert module.__doc__
        for name in module.__all__:
            there = getattr(module, name)
            if inspect.isclass(there) or inspect.isfunction(there):
                assert inspect.getdoc(there), f"{module.__name__}.{name}"


def test_a_module_of_another_python_is_an_import_error_that_says_so(tmp_path):
    other = tmp_path / "forcebound"
    shutil.copytree(FOLDER, other, ignore=shutil.ignore_patterns("_native*.so", "__pycache__"))
    (other / "_native.cpython-39-x86_64-linux-gnu.so").touch()
    run = subprocess.run([sys.executable, "-c", "import forcebound"], cwd=tmp_path, env={"PYTHONPATH": str(tmp_path)},
                         capture_output=True, text=True, check=False)
    assert run.returncode == 1
    last = run.stderr.strip().splitlines()[-1]
    assert last.startswith("ImportError: forcebound._native cannot be imported by cpython-3")
    assert "_native.cpython-39-x86_64-linux-gnu.so" in last


def test_the_version_is_that_of_the_programs():
    from conftest import program

    said = subprocess.run([program("forcebound"), "--version"], capture_output=True, text=True, check=True).stdout
    assert forcebound.__version__ in said


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_no_module_changes_what_another_sees_as_public(module):
    assert [name for name in module.__all__ if not hasattr(module, name)] == []


def pages():
    root = Path(__file__).parents[2]
    found = [file for file in (root / "README.md", root / "client/python/README.md") if file.exists()]
    return found or [None]  # beside an installed package there are none


@pytest.mark.parametrize("page", pages(), ids=lambda page: page.parent.name if page else "none")
def test_the_code_on_the_pages_runs(page, tmp_path, monkeypatch):
    if page is None:
        pytest.skip("the repository's pages are not here")
    monkeypatch.chdir(tmp_path)
    blocks = [block.split("```")[0] for block in page.read_text().split("```python\n")[1:]]
    assert blocks
    exec("\n".join(blocks), {})
