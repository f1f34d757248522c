"""Networked haptics that stays passive no matter how late the force arrives.

    from forcebound import devices, laws, recordings, simulation

    facts = devices.load("wall-1dof").facts
    law = laws.FbaExact(facts)
    force_N = law.step(position=[0.001], request_N=[-50.0])     # one tick

SI throughout; names carry the unit. Positions are in the scene's frame, z up [m]. Force is the force on the device: a wall
at x >= 0 gives f = -K x. Arrays are numpy's, of float64, with a row for each degree of freedom (dof).

laws         every law: one tick is one call, a recorded sequence is one call; laws of one's own
devices      simulated devices, and the facts of any device that a law relies on
scenes       what the server simulates
simulation   client, network and server in virtual time, with laws, environments and hands in Python if wanted
recordings   MCAP files as numpy's structured arrays
leader       force feedback for leader arms
lerobot      the same in the form of LeRobot's teleoperators
client       a client of a live server, with a simulated device
server       a live server of a simulator of one's own; forcebound.Server and forcebound.Touch are its
"""

try:
    from forcebound._native import version as __version__
except ImportError as error:
    # A module built for another Python is not found, since its name has that Python's tag. Say so.
    import sys
    from pathlib import Path

    found = sorted(file.name for file in Path(__file__).parent.glob("_native*.so"))
    raise ImportError(
        f"forcebound._native cannot be imported by {sys.implementation.cache_tag}: {error}"
        f" (built: {', '.join(found) or 'none'})",
        name="forcebound._native",
    ) from error

from forcebound import client, devices, laws, leader, lerobot, recordings, scenes, server, simulation
from forcebound.server import Server, Touch

__all__ = [
    "Server",
    "Touch",
    "__version__",
    "client",
    "devices",
    "laws",
    "leader",
    "lerobot",
    "recordings",
    "scenes",
    "server",
    "simulation",
]
