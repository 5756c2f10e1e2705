#!/usr/bin/python3
"""Slides through run-out under `arkode`: column collapse and Selborne, triangles, slice and free tetrahedra, on two ranks.

    slides.py TALUS [NAME ...]

Writes slides.csv beside this file: one line a run, out of the events of the run; a run that is there already is kept, unless it is named.
"""
import csv
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))

from talus_results import read_events  # noqa: E402

RUNS = HERE.parents[2] / "results/integrators/slides"
COUNTS = {"steps": "steps", "shortest_s": "shortest_step_s", "longest_s": "longest_step_s", "evaluations": "evaluations", "rejected": "rejections", "by_error": "by_error",
          "by_stability": "by_stability", "by_output": "by_outputs"}
SIDES = ["boundary.front.kind=roller", "boundary.back.kind=roller"]
SIDE, TOP = '"-9.81 * 2650 * (0.1 - y) * 0.3 / 0.7"', '"-9.81 * 2650 * (0.1 - y)"'
COLUMN3D = ["dimension=3", *SIDES, "output.point.corner.position=[0.2, 0.1, 0]", f'body.bars.stress=[{SIDE}, {TOP}, {SIDE}, "0 * x", "0 * x", "0 * x"]']
GROUND = "(2200 - 1000) * 9.81 * ((x < 18 ? 15 : x < 36 ? 15 - (x - 18) / 2 : 6) - y)"
SELBORNE3D = ["dimension=3", *SIDES, *(f'body.{b}.stress=["-{GROUND}", "-{GROUND}", "-{GROUND}", "0", "0", "0"]' for b in ("weathered", "unweathered")),
              *(f"output.point.{name}.position=[{x}, {y}, 0]" for name, x, y in (("crest", 18, 15), ("middle", 24, 12), ("toe", 35, 6.5), ("behind", 12, 14)))]


def arkode(order):
    return ["integrator.kind=arkode", f"integrator.order={order}"]


CASES = {
    "column 2D, euler": ("column", 1, ["mesh.size=0.01"]),
    **{f"column 2D, arkode {k}": ("column", 2, ["mesh.size=0.01", *arkode(k)]) for k in (2, 3, 4, 5)},
    "column slice, arkode 3": ("column", 2, ["mesh.size=0.01", *COLUMN3D, *arkode(3)]),
    "column 3D, euler": ("column", 2, ["mesh.size=0.02", "mesh.layers=0", "mesh.thickness=0.06", *COLUMN3D]),
    **{f"column 3D, arkode {k}": ("column", 2, ["mesh.size=0.02", "mesh.layers=0", "mesh.thickness=0.06", *COLUMN3D, *arkode(k)]) for k in (3, 4)},
    "Selborne 2D, euler": ("selborne_hydrostatic", 2, ["mesh.size=0.9"]),
    **{f"Selborne 2D, arkode {k}": ("selborne_hydrostatic", 2, ["mesh.size=0.9", *arkode(k)]) for k in (2, 3, 4, 5)},
    "Selborne slice, euler": ("selborne_hydrostatic", 2, ["mesh.size=0.9", *SELBORNE3D]),
    "Selborne slice, arkode 4": ("selborne_hydrostatic", 2, ["mesh.size=0.9", *SELBORNE3D, *arkode(4)]),
}


def run(talus, name):
    scene, ranks, overrides = CASES[name]
    folder = RUNS / name.replace(", ", "_").replace(" ", "_")
    words = ["mpiexec", "--allow-run-as-root", "-n", ranks, talus, "run", HERE.parent / scene / "scene.toml", "-o", folder, "--no-pictures", "--force", "--set",
             "output.interval=0", *overrides]
    start = time.time()
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    wall = time.time() - start
    events = {event["kind"]: event for event in read_events(folder)}
    steps = {key: f"{events['steps']['values'][name]:.3g}" if name.endswith("_s") else round(events["steps"]["values"][name]) for key, name in COUNTS.items()}
    last = list(csv.DictReader(open(folder / "history.csv")))[-1]
    end = "failed: " + done.stderr.strip().splitlines()[-1] if done.returncode else "at rest" if events.keys() & {"rest", "slow"} else f"{float(last['time_s']):.3g} s"
    moved = last["corner_x_m" if scene == "column" else "crest_displacement_m"]
    return {"run": name, "ranks": ranks, "particles": int(float(last["particles"])), "end": end, "failure_load_time_s": f"{events['failure']['load_time_s']:.8g}" if "failure" in events else "",
            "front_or_crest_m": round(float(moved), 4),
            **steps, "wall_s": round(wall, 1)}


if __name__ == "__main__":
    path = HERE / "slides.csv"
    rows = {r["run"]: r for r in csv.DictReader(open(path))} if path.exists() else {}
    for name in sys.argv[2:] or [n for n in CASES if n not in rows]:
        rows[name] = run(sys.argv[1], name)
        print(rows[name], flush=True)
        with open(path, "w", newline="") as file:
            writer = csv.DictWriter(file, next(iter(rows.values())).keys())
            writer.writeheader()
            writer.writerows(rows[n] for n in CASES if n in rows)
