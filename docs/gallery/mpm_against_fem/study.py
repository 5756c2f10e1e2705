#!/usr/bin/python3
"""The material point method against finite elements: a slope at rest under its weight, elastic and partly yielding.

    study.py TALUS [runs|figure ...]

TALUS is the program (build/release/bin/talus). `runs` writes errors.csv beside this file, `figure` draws errors.png from it.
"""
import csv
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))

SOILS = {
    "elastic": [],
    "plastic": ["body.soil.law=mohr_coulomb", "body.soil.cohesion=5500", "body.soil.friction_angle=20", "body.soil.dilation_angle=20"],
}
MOTION = ["stage.0.kind=dynamic", "stage.0.until=equilibrium", "stage.0.damping=0.7", "stage.0.gravity_ramp=0.5", "stage.0.force_ratio=1e-4",
          "stage.0.energy_ratio=1e-9"]
CURES = {
    "all cures": [],
    "no patches": ["transfer.locking=none"],
    "particle integration": ["transfer.integration=particle"],
    "stress per particle": ["transfer.average_stress=false"],
    "no cure": ["transfer.locking=none", "transfer.integration=particle", "transfer.average_stress=false"],
}
SIZES = (1.0, 0.5, 0.25)
REFERENCE = {"elastic": 0.15, "plastic": 0.2}
POINTS = {"crest": (5.5, 5.5), "face": (8.5, 4), "toe": (11.5, 1.8)}


def run(talus, command, overrides):
    """Last snapshot: undeformed place, displacement, stress, mass; seconds."""
    from talus_results import Results
    with tempfile.TemporaryDirectory() as folder:
        start = time.time()
        done = subprocess.run([talus, command, HERE / "scene.toml", "--no-pictures", "--force", "-o", folder, "--set", *overrides], capture_output=True, text=True)
        if done.returncode:
            return None
        results = Results(folder)
        last = results.snapshots[-1]
        u = last.column("displacement").values
        place = last.position() - (u if command == "run" else 0)
        return place, u, last.column("stress").values, last.column("mass").values[:, 0], time.time() - start


def at_points(state):
    """Size of the displacement at the named points [m], linear between the particles or Gauss points around them."""
    from scipy.interpolate import LinearNDInterpolator
    return np.linalg.norm(LinearNDInterpolator(state[0], state[1])(list(POINTS.values())), axis=1)


def difference(state, reference):
    """Relative L2 norms of the difference in displacement and in stress, over the section."""
    from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator
    place, u, stress, mass = state[:4]
    norms = []
    for mine, theirs in ((u, reference[1]), (stress, reference[2])):
        exact = LinearNDInterpolator(reference[0], theirs)(place)
        outside = np.isnan(exact[:, 0])
        exact[outside] = NearestNDInterpolator(reference[0], theirs)(place[outside])
        weight = np.ones(mine.shape[1])
        if mine.shape[1] == 4:
            weight[3] = 2  # xy stands for two components
        norms.append(np.sqrt((mass[:, None] * weight * (mine - exact) ** 2).sum() / (mass[:, None] * weight * exact**2).sum()))
    return norms


def runs(talus):
    rows = []
    for soil, parameters in SOILS.items():
        reference = run(talus, "solve", parameters + [f"mesh.size={REFERENCE[soil]}"])
        cases = [(f"finite elements, {elements}", "solve", [f"quasi_static.elements={elements}"]) for elements in ("quadratic", "patches", "linear")]
        cases += [(name, "run", MOTION + more) for name, more in CURES.items()]
        for size in SIZES:
            for name, command, more in cases:
                state = run(talus, command, parameters + more + [f"mesh.size={size}"])
                row = {"soil": soil, "method": name, "size_m": size}
                if state is None:
                    row |= {"displacement": "nan", "stress": "nan", "crest": "nan", "face": "nan", "toe": "nan", "wall_s": "nan"}
                else:
                    displacement, stress = difference(state, reference)
                    row |= {"displacement": f"{displacement:.5f}", "stress": f"{stress:.5f}"}
                    row |= {point: f"{mine / theirs - 1:+.4f}" for point, mine, theirs in zip(POINTS, at_points(state), at_points(reference))}
                    row |= {"wall_s": f"{state[4]:.1f}"}
                rows.append(row)
                print(row, flush=True)
                with open(HERE / "errors.csv", "w", newline="") as out:
                    writer = csv.DictWriter(out, rows[0].keys())
                    writer.writeheader()
                    writer.writerows(rows)


def figure(_):
    from talus_style import LINES, plt, save
    rows = list(csv.DictReader(open(HERE / "errors.csv")))
    fig, axes = plt.subplots(2, 2, figsize=(8, 6), sharex=True)
    for column, soil in enumerate(SOILS):
        for line, quantity in enumerate(("displacement", "stress")):
            ax = axes[line, column]
            methods = list(dict.fromkeys(row["method"] for row in rows))
            for k, method in enumerate(methods):
                mine = [row for row in rows if row["soil"] == soil and row["method"] == method]
                ax.loglog([float(r["size_m"]) for r in mine], [100 * float(r[quantity]) for r in mine], marker="o", ms=3, lw=1.1, color=LINES[k % len(LINES)],
                          ls="--" if method.startswith("finite") else "-", label=method)
            ax.set_title(f"{soil}: {quantity}", loc="left")
            ax.set_ylabel("difference from the reference, %")
            ax.set_xticks(SIZES, [str(s) for s in SIZES]), ax.minorticks_off()
    for ax in axes[1]:
        ax.set_xlabel("cell size, m")
    fig.tight_layout(rect=(0, 0.07, 1, 1))
    fig.legend(*axes[0, 0].get_legend_handles_labels(), loc="lower center", ncols=4, fontsize=7.5)
    save(fig, HERE / "errors.png", dpi=110)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for study in sys.argv[2:] or ["runs", "figure"]:
        {"runs": runs, "figure": figure}[study](sys.argv[1])
