#!/usr/bin/python3
"""Factors of safety of the published slopes, by finite elements with strength reduction.

    study.py TALUS [slopes|figure ...]

TALUS is the program (build/release/bin/talus). `slopes` writes factors.csv beside this file, `figure` draws mechanism.png.
"""
import csv
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))

GRAVITY = 9.81
POISSON = 0.4  # so that elastic ground, at rest with nu / (1 - nu), does not yield everywhere: sin(phi) > 1 - 2 nu at the reduced strength too
# section, c [kPa], phi [deg], gamma [kN/m3], cell sizes [m], published factor; sources in README.md
SLOPES = {
    "ACADS-1a": ("acads_1a.csv", 3, 19.6, 20, (1.5, 0.75), 0.99),
    "AT-1": ("arai_tagyo.csv", 41.65, 15, 18.82, (2, 1), 1.41),
    "GL-1": ("griffiths_lane_1.csv", 14.9626, 20, 19.6359, (1.5, 0.75), 1.38),
    "GL-2": ("griffiths_lane_2.csv", 14.9626, 20, 19.6359, (2, 1), 1.38),
}


def factor(talus, name, size, associated):
    """(lower, upper, seconds, points) of one slope: the bracket, and position, shear strain of the Gauss points of the last stable state."""
    from talus_results import Results
    section, cohesion, phi, gamma, _, _ = SLOPES[name]
    overrides = [f"mesh.section={section}", f"mesh.size={size}", f"body.soil.density={1000 * gamma / GRAVITY}", f"body.soil.cohesion={1000 * cohesion}",
                 f"body.soil.friction_angle={phi}", f"body.soil.dilation_angle={phi if associated else 0}", f"body.soil.poisson_ratio={POISSON}"]
    if name != "GL-1":
        overrides += ["boundary.right.kind=roller"]
    with tempfile.TemporaryDirectory() as folder:
        start = time.time()
        done = subprocess.run([talus, "solve", HERE / "scene.toml", "--factor-of-safety", "--no-pictures", "-o", folder, "--set", *overrides],
                              capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"{name}: {done.stderr}")
        lower, upper = (float(x) for x in re.search(r"divided by (\S+), none by (\S+)", done.stdout).groups())
        last = Results(folder).snapshots[-1]
        return lower, upper, time.time() - start, last.position(), last.column("shear_strain").values[:, 0]


def slopes(talus):
    rows = []
    cases = [(name, associated, size) for k in (0, 1) for name in SLOPES for associated in (True, False) for size in SLOPES[name][4][k:k + 1]]
    for name, associated, size in cases:
        published = SLOPES[name][5]
        lower, upper, seconds, _, _ = factor(talus, name, size, associated)
        rows.append({"slope": name, "psi": "phi" if associated else "0", "size_m": size, "lower": f"{lower:.4g}", "upper": f"{upper:.4g}",
                     "factor": f"{(lower + upper) / 2:.3f}", "published": published, "difference": f"{(lower + upper) / 2 - published:+.3f}",
                     "wall_s": f"{seconds:.1f}"})
        print(rows[-1], flush=True)
        with open(HERE / "factors.csv", "w", newline="") as out:
            writer = csv.DictWriter(out, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)


def figure(talus):
    from talus_style import MAPS, plt, save
    lower, _, _, position, strain = factor(talus, "GL-1", 0.75, True)
    fig, ax = plt.subplots(figsize=(6.4, 2.6))
    dots = ax.scatter(*position.T, c=strain / np.quantile(strain, 0.995), s=3, linewidths=0, cmap=MAPS["plastic_strain"], vmin=0, vmax=1)
    ax.set_aspect("equal")
    ax.set_title(f"GL-1, psi = phi, cells of 0.75 m: strength divided by {lower:.3f}", loc="left")
    ax.set_xlabel("x, m"), ax.set_ylabel("y, m")
    fig.colorbar(dots, ax=ax, label="shear strain over its 99.5 % quantile", shrink=0.9)
    fig.tight_layout()
    save(fig, HERE / "mechanism.png", dpi=110)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for study in sys.argv[2:] or ["slopes", "figure"]:
        {"slopes": slopes, "figure": figure}[study](sys.argv[1])
