"""Haptic devices: what a law may rely on (DeviceFacts), and simulated devices (Device)."""

import os

from forcebound import _native
from forcebound._files import readable
from forcebound._native import Device, DeviceFacts, Uncertainty

__all__ = ["Device", "DeviceFacts", "Uncertainty", "hands", "load", "names", "parse"]


def names() -> list[str]:
    """The devices that ship."""
    return _native.device_names()


def load(name_or_file: str | os.PathLike) -> Device:
    """A device that ships by its name, or any other by its TOML file.

    OSError if there is no such file; ValueError for an unknown name, or with the line of the file that is refused.
    """
    return _native.load_device(readable(name_or_file))


def parse(toml_text: str, place: str = "device.toml") -> Device:
    """A device from the text of such a file. `place` is what errors call it."""
    return _native.parse_device(toml_text, place)


def hands() -> str:
    """The simulated hands with all their keys, in words: what `hand` may be in a simulation."""
    return _native.hands_help()


def device_from(device: "str | os.PathLike | Device") -> Device:
    """A device that is there or, by its name or file, is loaded."""
    return device if isinstance(device, Device) else load(device)
