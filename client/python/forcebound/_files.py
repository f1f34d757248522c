"""Names that may be files."""

import os


def readable(name_or_file: str | os.PathLike) -> str:
    """The name, or the path of a file that can be read; OSError, such as FileNotFoundError, if it cannot."""
    text = os.fspath(name_or_file)
    if not isinstance(text, str):
        raise TypeError(f"a name or a path: expected str or os.PathLike, got {type(text).__name__}")
    if "/" in text or text.endswith(".toml"):
        with open(text, "rb"):
            pass
    return text
