#!/usr/bin/python3
"""Where the scheme for pore water holds: stable, oscillating or failed, over permeability, stiffness of the water and particles per cell.

    study.py TALUS        runs all (minutes), writes map.csv and wetting.csv and draws map.png and wetting.png

The scene is tests/verification/terzaghi: a saturated layer under a load whose undrained pressures are given at the start, run for 400 steps at 0.6 of the critical
step. Noise is the rms difference of the pore pressure of a cell from the median of its row, over the load's pressure: the exact solution has none. The second
study wets the column of tests/verification/srivastava_yeh from the top until it is saturated.
"""

import argparse
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path.insert(0, str(ROOT / "src/output/plots"))

import matplotlib.pyplot as plt  # noqa: E402
import talus_style as style  # noqa: E402
from talus_results import Results  # noqa: E402

PERMEABILITY = [1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-14, 1e-17]
STIFFNESS = [20e3, 1e6, 20e6, 200e6, 2.2e9]
PARTICLES = [1, 3, 6, 12]
NOISY = 0.05  # of the pressure: more is called oscillating


def run(talus, scene, words, folder):
    """Results, or None when the run failed."""
    end = subprocess.run([talus, "run", ROOT / f"tests/verification/{scene}/scene.toml", "-o", folder, "--no-pictures", *(w for word in words for w in ("--set", word))],
                         capture_output=True, text=True)
    return (Results(folder) if end.returncode == 0 else None), end.stdout + end.stderr


def critical_step(talus, words):
    """What `check` states [s]."""
    end = subprocess.run([talus, "check", ROOT / "tests/verification/terzaghi/scene.toml", *(w for word in words for w in ("--set", word))], capture_output=True, text=True)
    return float(re.search(r"critical ([0-9.e+-]+) s", end.stdout).group(1))


def noise(snapshot, rows=20):
    """Scatter of the pressure along rows of cells [Pa]: the solution depends on y alone, so a parabola over y is taken off each band of rows."""
    p, y = snapshot.column("pore_pressure").values[:, 0], snapshot.position()[:, 1]
    if not np.isfinite(p).all():
        return np.inf
    band, rest = np.minimum((y * rows / y.max()).astype(int), rows - 1), []
    for k in range(rows):
        inside = band == k
        if inside.sum() > 6:
            rest.append(p[inside] - np.polyval(np.polyfit(y[inside], p[inside], 2), y[inside]))
    return np.sqrt((np.concatenate(rest) ** 2).mean())


def map_of(talus):
    rows = []
    for smoothing in ("none", "nodal"):
        for stiffness in STIFFNESS:
            for particles in PARTICLES if stiffness == 20e6 else [3]:
                for k in PERMEABILITY:
                    n, modulus, load = 0.3, 10e6, 1e3
                    share = (stiffness / n) / (modulus + stiffness / n)  # of the load that the water bears
                    words = [f"transfer.pore_smoothing={smoothing}", f"water.bulk_modulus={stiffness}", "water.compression=exponential", f"body.soil.permeability={k}", f"body.soil.particles_per_cell={particles}",
                             f"water.excess={load * share}", f'body.soil.stress=["0", "{-load * (1 - share)}", "0", "0"]', "mesh.size=0.075"]
                    step = critical_step(talus, words)
                    with tempfile.TemporaryDirectory() as folder:
                        results, _ = run(talus, "terzaghi", [*words, f"stage.0.duration={240 * step}", f"output.history_interval={100 * step}"], folder)
                        worst = noise(results.snapshots[-1]) / (load * share) if results else np.inf
                    state = "failed" if not worst < 10 else "oscillating" if worst > NOISY else "stable"
                    rows.append((smoothing, particles, f"{stiffness:g}", f"{k:g}", f"{step:.4g}", f"{worst:.3g}", state))
                    print(*rows[-1], flush=True)
    write("map.csv", ("smoothing", "particles", "K_l_Pa", "k_m2", "critical_step_s", "noise", "state"), rows)


def wetting(talus):
    rows = []
    for smoothing in ("none", "nodal"):
        with tempfile.TemporaryDirectory() as folder:
            results, said = run(talus, "srivastava_yeh", [f"transfer.pore_smoothing={smoothing}", "boundary.rain.kind=rainfall", "boundary.rain.intensity=0.03", "boundary.table.kind=impermeable", "stage.0.duration=8",
                                                          "output.interval=0.1", "mesh.size=0.02", "water.suction=2000"], folder)
            if not results:
                print(smoothing, "failed:", said.strip().splitlines()[-1])
                results = Results(folder)
            for s in results.snapshots:
                rows.append((smoothing, f"{s.time:.3f}", f"{s.column('saturation').values.mean():.5f}", f"{noise(s, 25):.5g}"))
    write("wetting.csv", ("smoothing", "time_s", "saturation", "noise_Pa"), rows)


def write(name, head, rows):
    with open(HERE / name, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)


def read(name):
    with open(HERE / name) as file:
        return list(csv.DictReader(file))


def draw():
    colour = {"stable": style.LINES[3], "oscillating": style.LINES[5], "failed": style.LINES[4]}
    rows = read("map.csv")
    figure, grid = plt.subplots(2, 2, figsize=(8.6, 4.6), sharex=True)
    for line, (key, choices, label) in zip(grid, (("K_l_Pa", STIFFNESS, "K_l [Pa]"), ("particles", PARTICLES, "particles a cell"))):
        for axes, smoothing in zip(line, ("none", "nodal")):
            for row in rows:
                if row["smoothing"] != smoothing or (key == "K_l_Pa" and row["particles"] != "3") or (key == "particles" and float(row["K_l_Pa"]) != 20e6):
                    continue
                x, y = PERMEABILITY.index(float(row["k_m2"])), choices.index(float(row[key]))
                axes.scatter(x, y, s=260, marker="s", color=colour[row["state"]], lw=0)
                axes.text(x, y, row["noise"] if row["state"] != "failed" else "x", ha="center", va="center", size=5.5, color="white")
            axes.set_yticks(range(len(choices)), [f"{c:g}" for c in choices])
            axes.set_xticks(range(len(PERMEABILITY)), [f"{k:g}" for k in PERMEABILITY])
            axes.set(ylabel=label, xlim=(-0.6, len(PERMEABILITY) - 0.4), ylim=(-0.7, len(choices) - 0.3))
            if line is grid[0]:
                axes.set_title("pressures as they are" if smoothing == "none" else "smoothed (the default)", loc="left")
            else:
                axes.set_xlabel("permeability [m²]")
    for state in colour:
        grid[0, 1].scatter([], [], marker="s", color=colour[state], label=state)
    figure.legend(loc="upper right", ncols=3, fontsize=8)
    figure.tight_layout(rect=(0, 0, 1, 0.96))
    style.save(figure, HERE / "map.png")
    figure, axes = plt.subplots(figsize=(6, 2.8))
    for smoothing, label in (("none", "pressures as they are"), ("nodal", "smoothed (the default)")):
        mine = [r for r in read("wetting.csv") if r["smoothing"] == smoothing]
        axes.semilogy([float(r["saturation"]) for r in mine], [max(float(r["noise_Pa"]), 1e-3) for r in mine], label=label)
    axes.set(xlabel="mean degree of saturation of the column", ylabel="scatter of pressure [Pa]")
    axes.legend(fontsize=8)
    figure.tight_layout()
    style.save(figure, HERE / "wetting.png")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("talus", nargs="?", help="the program")
    given = parser.parse_args()
    if given.talus:
        map_of(given.talus)
        wetting(given.talus)
    draw()
