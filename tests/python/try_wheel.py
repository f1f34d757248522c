"""In an environment in which the wheel is installed, with numpy beside it: what is imported is the wheel's, and works."""

import importlib.metadata
import importlib.util
import os
import sys
from pathlib import Path

import forcebound
from forcebound import laws, simulation

site = Path(sys.prefix)
assert site in Path(forcebound.__file__).parents, forcebound.__file__
assert importlib.metadata.version("forcebound") == forcebound.__version__
assert importlib.util.find_spec("matplotlib") is None, "the environment is to have numpy alone"

settings = dict(scene="sphere", device="omni", hand="trace-sphere", network="delay 20ms loss 5%")
exact = simulation.simulate(2, law=laws.FbaExact, **settings).summary
none = simulation.simulate(2, law="none", **settings).summary
assert exact["passivity"]["minimum_J"] >= 0, exact["passivity"]
assert none["passivity"]["minimum_J"] < -1e-3, none["passivity"]

# The library that other modules of a process most often have in another version is the wheel's, and no other.
mapped = {line.split(maxsplit=5)[5] for line in Path("/proc/self/maps").read_text().splitlines() if "libprotobuf" in line}
assert len(mapped) == 1 and site in Path(*mapped).parents, mapped
print(f"forcebound {forcebound.__version__}: least P {exact['passivity']['minimum_J']} J, without a law "
      f"{none['passivity']['minimum_J']:.3g} J; {os.path.relpath(forcebound.__file__, site)}")
