#!/usr/bin/python3
"""One column of sand in all five phase models, in the plane and in a slice: what each adds to the run-out, and what it costs.

    study.py TALUS                     runs all (minutes), writes models.csv and draws models.png
    study.py --sequence DIR            redraws sequence.png from a run of scene.toml
"""

import argparse
import csv
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))

import matplotlib.pyplot as plt  # noqa: E402
import talus_style as style  # noqa: E402
from talus_results import Results  # noqa: E402
from talus_sections import spacing_of  # noqa: E402
from talus_tiles import Frame, tiles  # noqa: E402

SUCTION = [f"body.sand.retention.{key}" for key in ("curve=van_genuchten", "reference_suction=500", "shape=0.5")] + [
    f"body.sand.relative_permeability.{key}" for key in ("curve=van_genuchten_mualem", "shape=0.5")]
MODELS = {
    "dry": ["phases=dry"],
    "drained": ["phases=drained", "water.table=[[0, 0.1], [0.2, 0], [1, 0]]"],
    "saturated": [],
    "unsaturated": ["phases=unsaturated", "water.stress=bishop", *SUCTION],
    "three-phase": ["phases=three-phase", "water.stress=bishop", *SUCTION],
}
TIMES = (0, 0.1, 0.2, 0.4, 1.0)  # of the sequence [s]


def front(snapshot):
    """Distance from the wall within which 99.5 % of the grains are [m]."""
    return np.quantile(snapshot.position()[:, 0], 0.995)


def scene_of(model):
    """The scene without what a model refuses."""
    text = (HERE / "scene.toml").read_text().replace("../../../", str(HERE.parents[2]) + "/")
    if model == "dry":
        text = text[:text.index("[water]")] + text[text.index("[body.sand]"):]
    return text


def run(talus, model, dimension, folder):
    scene = folder / f"{model}.toml"
    scene.write_text(scene_of(model))
    words = list(MODELS[model])
    if dimension == 3:
        words += ["dimension=3", "mesh.thickness=0.01", "boundary.front.kind=roller", "boundary.back.kind=roller", "output.point.corner.position=[0.2, 0.1, 0]"]
        lateral = '"-9.81 * 990 * (0.1 - y) * 0.3 / 0.7"'
        words.append(f'body.sand.stress=[{lateral}, "-9.81 * 990 * (0.1 - y)", {lateral}, "0 * x", "0 * x", "0 * x"]')
    words += ["mesh.size=0.01"]
    results = folder / f"{model}{dimension}"
    start = time.time()
    subprocess.run([talus, "run", scene, "-o", results, "--no-pictures", *(w for word in words for w in ("--set", word))], capture_output=True)
    seconds = time.time() - start
    snapshots = Results(results).snapshots
    return seconds, [(s.time, front(s)) for s in snapshots], snapshots[-1].step


def study(talus, dimensions):
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for dimension in dimensions:
            for model in MODELS:
                seconds, path, steps = run(talus, model, dimension, pathlib.Path(folder))
                rows += [(dimension, model, steps, f"{seconds:.1f}", f"{t:.4f}", f"{x:.5f}") for t, x in path]
                print(f"{dimension}D {model:12s} front {path[-1][1]:.3f} m, {steps} steps, {seconds:.0f} s", flush=True)
    with open(HERE / "models.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("dimension", "model", "steps", "wall_s", "time_s", "front_m"))
        writer.writerows(rows)


def draw_models():
    with open(HERE / "models.csv") as file:
        rows = list(csv.DictReader(file))
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.0), gridspec_kw={"width_ratios": (1.6, 1)})
    for model, colour in zip(MODELS, ("#8a8f98", *style.LINES)):
        for dimension, line in (("2", "-"), ("3", "--")):
            mine = [r for r in rows if r["model"] == model and r["dimension"] == dimension]
            if not mine:
                continue
            left.plot([float(r["time_s"]) for r in mine], [float(r["front_m"]) for r in mine], line, color=colour, label=model if dimension == "2" else None)
    left.set(xlabel="time [s]", ylabel="99.5 % of the grains within [m]")
    left.legend(fontsize=8)
    for k, dimension in enumerate(sorted({r["dimension"] for r in rows})):
        cost = [next(float(r["wall_s"]) for r in rows if r["model"] == m and r["dimension"] == dimension) for m in MODELS]
        right.barh(np.arange(len(MODELS)) + (0.2 if k else -0.2), cost, 0.38, color=(style.ACCENT, style.SOFT)[k], label=dimension + "D")
    right.set_yticks(range(len(MODELS)), MODELS)
    right.invert_yaxis()
    right.set(xlabel="wall time [s]", xscale="log")
    right.legend(fontsize=8)
    figure.tight_layout()
    style.save(figure, HERE / "models.png")


def draw_sequence(folder):
    results = Results(folder)
    figure, grid = plt.subplots(len(TIMES), 1, figsize=(7.2, 6.4), sharex=True)
    figure.subplots_adjust(left=0.07, right=0.88, bottom=0.07, top=0.97, hspace=0.25)
    frame = Frame((0, 0), (0.5, 0.11), 900)
    for axes, t in zip(grid, TIMES):
        snapshot = min(results.snapshots, key=lambda each: abs(each.time - t))
        owner = tiles(snapshot.position()[:, :2], spacing_of(results), frame)
        values = snapshot.scalar("pore_pressure")[0]
        picture = axes.imshow(np.ma.array(values[np.maximum(owner, 0)], mask=owner < 0), origin="lower", extent=frame.extent(), interpolation="nearest",
                              cmap="RdBu_r", vmin=-1000, vmax=1000)
        axes.set(xlim=(0, 0.5), ylim=(0, 0.11), aspect="equal")
        axes.set_title(style.at_time(snapshot.time, 1), loc="left", pad=3)
    grid[-1].set_xlabel("distance from the wall [m]")
    place = figure.add_axes((0.91, 0.3, 0.016, 0.4))
    figure.colorbar(picture, cax=place, extend="both").outline.set_visible(False)
    place.set_title("p [Pa]", size=8.5, loc="left", pad=8)
    style.save(figure, HERE / "sequence.png")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("talus", nargs="?", help="the program")
    parser.add_argument("--dimensions", type=int, nargs="+", default=(2, 3), choices=(2, 3))
    parser.add_argument("--sequence", metavar="DIR", type=pathlib.Path)
    given = parser.parse_args()
    if given.talus:
        study(given.talus, given.dimensions)
    if given.sequence:
        draw_sequence(given.sequence)
    if (HERE / "models.csv").exists():
        draw_models()
