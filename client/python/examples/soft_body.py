#!/usr/bin/python3
"""A soft block in numpy that steps slowly, and is felt at the device's rate.

    soft_body.py [--rate 60] [--listen 127.0.0.1:47800] [--insecure] [--duration 600]
    forcebound-client --server 127.0.0.1:47800 --device firm-3dof --operator press:axis=2,from_m=0.01,to_m=-0.006

5 x 5 x 4 masses of 4 g on springs to all their neighbours, 60 x 60 x 36 mm, which stand on the floor; the top is at
z = 0. Each step is one of implicit Euler, of small displacements. Hands press the top, as many as come.
"""

import argparse
import time

import numpy as np

from forcebound import Server, Touch

COUNTS = np.array([5, 5, 4])
SPACING_M = np.array([0.015, 0.015, 0.012])
MASS_KG, SPRING_N_PER_M, DAMPING_S = 0.004, 100, 0.01  # of a node, of a spring; damping over stiffness


class SoftBlock:
    """M x'' = f - K (x + DAMPING_S x'), x being how far each node has moved."""

    def __init__(self, step_s):
        self.step_s = step_s
        cells = np.stack(np.meshgrid(*map(range, COUNTS), indexing="ij"), axis=-1).reshape(-1, 3)
        places_m = (cells - (COUNTS - 1) * [0.5, 0.5, 1]) * SPACING_M
        count = len(cells)
        stiffness = np.zeros((count, 3, count, 3))
        for i in range(count):
            for j in range(i):
                if np.abs(cells[i] - cells[j]).max() > 1:
                    continue
                along = (places_m[i] - places_m[j]) / np.linalg.norm(places_m[i] - places_m[j])
                for a, b, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
                    stiffness[a, :, b] += sign * SPRING_N_PER_M * np.outer(along, along)
        free = np.flatnonzero(cells[:, 2] > 0)  # the others are the floor's
        size = 3 * len(free)
        self.stiffness = stiffness[free][:, :, free].reshape(size, size)
        self.compliance = np.linalg.inv(self.stiffness)
        self.solver = np.linalg.inv(MASS_KG * np.eye(size) + step_s * (DAMPING_S + step_s) * self.stiffness)
        self.moved_m, self.velocity_m_per_s, self.force_N = np.zeros(size), np.zeros(size), np.zeros(size)
        top = np.flatnonzero(cells[free, 2] == COUNTS[2] - 1)
        self.top = top.reshape(*COUNTS[:2])  # numbers of its nodes
        self.places_m = places_m[free]

    def push(self, place_m, impulse_Ns):
        """In the coming step."""
        at = self.share_of(place_m)
        if at is not None:
            self.force_N += at[0].T @ impulse_Ns / self.step_s

    def step(self):
        moved_m = self.moved_m + (self.step_s + DAMPING_S) * self.velocity_m_per_s
        self.velocity_m_per_s += self.step_s * self.solver @ (self.force_N - self.stiffness @ moved_m)
        self.moved_m += self.step_s * self.velocity_m_per_s
        self.force_N[:] = 0

    def share_of(self, place_m):
        """(3, size): how far the top moves at a place that each node moves by 1; and its slopes. None: it is beyond.
        Of the nine nodes around, by quadratic B-splines, so that it feels even between nodes."""
        at = place_m[:2] / SPACING_M[:2] + (COUNTS[:2] - 1) / 2
        if np.any(at < 0) or np.any(at > COUNTS[:2] - 1):
            return None
        middle = np.clip(np.round(at).astype(int), 1, COUNTS[:2] - 2)
        u = at - middle
        values = np.array([(0.5 - u) ** 2 / 2, 0.75 - u ** 2, (0.5 + u) ** 2 / 2])
        slopes = np.array([u - 0.5, -2 * u, u + 0.5])
        nodes = self.top[middle[0] - 1:middle[0] + 2, middle[1] - 1:middle[1] + 2]
        shares = []
        for along_x, along_y in ((values, values), (slopes, values), (values, slopes)):
            of_nodes = np.zeros(len(self.places_m))
            of_nodes[nodes] = np.outer(along_x[:, 0], along_y[:, 1])
            shares.append(np.kron(of_nodes, np.eye(3)))
        return shares

    def touch(self, place_m):
        """What a probe there meets: the top, and all that gives way with it when it is pushed slowly."""
        at = self.share_of(place_m)
        if at is None:
            return None
        share, slope_x, slope_y = at
        response = self.compliance @ share.T  # to a force there
        there_N_per_m = np.linalg.inv(share @ response)
        shape = response @ there_N_per_m
        whole_m = self.places_m.ravel() + self.moved_m
        normal = np.cross(slope_x @ whole_m, slope_y @ whole_m)
        return Touch(
            place_m=share @ whole_m,
            normal=normal / np.linalg.norm(normal),
            velocity_m_per_s=share @ self.velocity_m_per_s,
            mobility_per_kg=np.linalg.inv(MASS_KG * shape.T @ shape),
            others_N=-there_N_per_m @ share @ self.moved_m,
            spring_N_per_m=there_N_per_m[2, 2],
            damper_N_s_per_m=DAMPING_S * there_N_per_m[2, 2],
            friction=0.4,
        )


def step(block, server):
    """A step of the block, between what the hands did and what they meet now."""
    probes = server.ask()
    for push in (push for probe in probes for push in probe.pushes):
        block.push(push.place_m, push.impulse_Ns)
    block.step()
    for probe in probes:
        touch = block.touch(probe.place_m)
        server.report(probe.client, [touch] if touch else [])


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--rate", type=float, default=60, help="steps a second, 20 to 250")
    options.add_argument("--listen", default="127.0.0.1:47800", help="HOST:PORT; port 0: a free one")
    options.add_argument("--insecure", action="store_true", help="serve other machines too, not encrypted")
    options.add_argument("--duration", type=float, default=600, help="s; Ctrl-C ends it too")
    given = options.parse_args()
    if not 20 <= given.rate <= 250:
        options.error(f"--rate must be 20 to 250, got {given.rate:g}")
    block = SoftBlock(1 / given.rate)
    try:
        server = Server("soft-block", listen=given.listen, insecure=given.insecure, probe_radius_m=0.002)
    except (RuntimeError, ValueError) as refused:
        options.error(str(refused))
    deepest_m = 0
    with server:
        print(f"a block of {len(block.places_m)} masses steps {given.rate:g} times a second at {server.address}", flush=True)
        begun = time.monotonic()
        try:
            for steps in range(1, int(given.duration * given.rate) + 1):
                step(block, server)
                deepest_m = max(deepest_m, -block.moved_m[2::3].min())
                time.sleep(max(0, begun + steps / given.rate - time.monotonic()))
        except KeyboardInterrupt:
            pass
        counts = server.summary
    print(f"{counts['reports']} reports, {counts['silences']} silences, pressed in by up to {1e3 * deepest_m:.1f} mm")


if __name__ == "__main__":
    main()
