"""Scenes: what the server simulates."""

import os

from forcebound import _native
from forcebound._files import readable
from forcebound._native import Scene

__all__ = ["Scene", "load", "names", "parse"]


def names() -> list[str]:
    """The scenes that ship."""
    return _native.scene_names()


def load(name_or_file: str | os.PathLike) -> Scene:
    """A scene that ships by its name, or any other by its TOML file.

    OSError if there is no such file; ValueError for an unknown name, or with the line of the file that is refused.
    """
    return _native.load_scene(readable(name_or_file))


def parse(toml_text: str, place: str = "scene.toml") -> Scene:
    """A scene from the text of such a file. `place` is what errors call it."""
    return _native.parse_scene(toml_text, place)


def scene_from(scene: "str | os.PathLike | Scene") -> Scene:
    """A scene that is there or, by its name or file, is loaded."""
    return scene if isinstance(scene, Scene) else load(scene)
