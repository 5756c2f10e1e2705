#!/usr/bin/python3
"""What carries the slide while it creeps at a water level of 60 m, cells of 15 m, and writes damping.csv:  budget.py TALUS
Works of history.csv between the load times 70 and 80 s, over the way of the rock in that time: forces in MN per metre of width."""

import csv
import pathlib
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))
sys.path.insert(0, str(HERE))

import measures  # noqa: E402
import numpy as np  # noqa: E402
from talus_results import Results  # noqa: E402

DAMPING = (0, 0.01, 0.02, 0.05, 0.1)
COLUMNS = ("damping", "way_m", "speed_m_s", "gravity_MN", "water_MN", "base_MN", "rock_MN", "damping_MN", "faster_MN", "unbalanced_MN")


def budget(talus, damping, folder):
    out = pathlib.Path(folder) / str(damping)
    changes = ["mesh.size=15", f"stage.water.damping={damping}", "stage.water.duration=80", "stage.slide.duration=0.01"]
    subprocess.run([talus, "run", HERE / "scene.toml", "-o", out, "--no-pictures", "--set", *changes], stdout=subprocess.DEVNULL, check=True)
    results = Results(out)
    history, columns = results.history, results.history.columns
    rows = np.flatnonzero((np.array(history.stage) == "water") & (columns["load_time_s"] >= 70))[[0, -1]]
    way = np.linalg.norm(measures.way(results, "m10"), axis=0)[rows]
    force = {name[:-2]: np.diff(columns[name][rows])[0] / np.diff(way)[0] / 1e6 for name in columns if name.endswith("_J")}
    row = {"damping": damping, "way_m": f"{way.mean():.1f}", "speed_m_s": f"{np.diff(way)[0] / np.diff(history.time[rows])[0]:.2f}"}
    parts = {"gravity": force["work_gravity"], "water": force["work_imposed"], "base": force["work_bed"], "rock": -force["dissipated"],
             "damping": force["work_damping"], "faster": -force["kinetic"] - force["strain"]}
    unbalanced = f"{-force['work_damping'] / damping:.0f}" if damping else ""
    return row | {f"{name}_MN": f"{value:.1f}" for name, value in parts.items()} | {"unbalanced_MN": unbalanced}


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        rows = list(pool.map(lambda damping: budget(sys.argv[1], damping, folder), DAMPING))
    with open(HERE / "damping.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader(), writer.writerows(rows)
