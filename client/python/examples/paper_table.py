#!/usr/bin/python3
"""The paper's experiments [Kim, Baek, Ryu 2015, section VI] with each law, as table and figure. paper_table.py [FIGURE.png]"""
import sys
import matplotlib.pyplot as plt
from forcebound import devices, laws, scenes, simulation
LAWS = {laws.NoLaw: "#c1272d", laws.FbaLess: "#d9730d", laws.FbaMore: "#0b5fa5", laws.FbaExact: "#1a8754"}
SHAPES = {"wall": "kind = 'half_space', through_m = [0], normal = [-1]",
          "circle": "kind = 'cavity', center_m = [0, 0], radius_m = 0.04",
          "sphere": "kind = 'sphere', center_m = [0, 0, 0], radius_m = 0.02"}
#        shape, device and hand; stiffness [N/m], encoder [m], network each way, duration and when it has settled [s]
RUNS = [("wall", "wall-1dof", "press", 50e3, 15e-6, "", 4, 2), ("wall", "wall-1dof", "press", 80e3, 15e-6, "", 4, 2),
        ("wall", "wall-1dof", "press", 150e3, 15e-6, "", 4, 2),
        ("wall", "wall-1dof", "press", 10e3, 15e-6, "delay 50ms", 4, 2),
        ("wall", "wall-1dof", "press", 10e3, 0, "delay 50ms", 4, 2),
        ("circle", "cartesian-2dof", "trace-circle", 10e3, 55e-6, "", 10, 1),
        ("sphere", "cartesian-3dof", "trace-sphere", 10e3, 55e-6, "", 10, 1)]

def experiment(law, shape, device, hand, stiffness_N_per_m, encoder_m, network, duration_s, settle_s):
    device = devices.load(device)
    device = device.with_facts(device.facts.replace(encoder_step=encoder_m))
    scene = scenes.parse(f"""scene = {{ name = '{shape}', description = '', degrees_of_freedom = {device.facts.joints} }}
        [[object]]\nname = 'it'\nshape = {{ {SHAPES[shape]} }}\neffects = ['surface']
        surface = {{ stiffness_N_per_m = {stiffness_N_per_m}, damping_N_s_per_m = 0 }}""")
    return simulation.simulate(duration_s, scene=scene, device=device, hand=hand, law=law, network=network,
                               settle_s=settle_s).summary

print(f"{'experiment':<18} law        least P [mJ]  shown K [N/mm]  mean F [N]  var F [N^2]")
for place, (law, colour) in enumerate(LAWS.items()):
    shown = []  # None: the contact never rests
    for run in RUNS:
        s = experiment(law, *run)
        shown.append((s["displayed_stiffness_N_per_m"]["median"] or float("nan")) / 1e3)
        print("{:<6} {:3g} {:<7} {:<9} {:13.3g} {:15.3g} {:11.3g} {:12.3g}".format(
            run[0], run[3] / 1e3, run[5][6:], law.info.name, 1e3 * s["passivity"]["minimum_J"], shown[-1],
            s["force_N"]["mean"], s["force_N"]["variance"]))
    plt.semilogy([x + 0.15 * (place - 1.5) for x in range(len(RUNS))], shown, "o", color=colour, label=law.info.name)
plt.gca().set(ylabel="displayed stiffness at rest [N/mm]", xlabel="experiment, its stiffness [N/mm], delay each way",
              xticks=range(len(RUNS)), xticklabels=[f"{r[0]} {r[3] / 1e3:g}\n{r[5][6:]}" for r in RUNS])
plt.legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncol=4, frameon=False, title="no mark: never at rest")
plt.savefig(sys.argv[1] if len(sys.argv) > 1 else "paper_table.png", bbox_inches="tight")
