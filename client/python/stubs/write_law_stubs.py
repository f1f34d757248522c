"""Writes laws.pyi: the types of forcebound.laws, with a class for each law there is.

    write_law_stubs.py FILE
"""

import sys
from pathlib import Path

from forcebound import laws

COMMON = Path(__file__).with_name("laws_common.pyi")


def stub_of(law: type[laws.Law]) -> str:
    parameters = "".join(f", {p.name}: float | None = None" for p in law.info.parameters)
    arguments = f'self, facts: DeviceFacts, *, memory: str = "capped"{parameters}'
    return f"\nclass {law.__name__}(Law):\n    def __init__({arguments}) -> None: ...\n"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(COMMON.read_text() + "".join(stub_of(law) for law in laws.all_laws()))
