#!/usr/bin/python3
"""One column of sand in all five phase models, in the plane and in a slice: what each adds to the run-out, and what it costs.

    study.py TALUS                     runs all (minutes), writes models.csv and draws models.png
    study.py --sequence DIR            redraws sequence.png from a run of scene.toml
    study.py TALUS --block DIR         runs a block 0.1 m thick that may fall two ways, on tetrahedra, into DIR (minutes) and draws block.png
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
from talus_views import spacing_of  # noqa: E402
from talus_tiles import Frame, tiles  # noqa: E402
from talus_units import at_time  # noqa: E402

SUCTION = [f"body.sand.retention.{key}" for key in ("curve=van_genuchten", "reference_suction=500", "shape=0.5")] + [
    f"body.sand.relative_permeability.{key}" for key in ("curve=van_genuchten_mualem", "shape=0.5")]
MODELS = {
    "dry": ["phases=dry"],
    "drained": ["phases=drained", "water.table=[[0, 0.1], [0.2, 0], [1, 0]]"],
    "saturated": [],
    "unsaturated": ["phases=unsaturated", "water.stress=bishop", *SUCTION],
    "three-phase": ["phases=three-phase", "water.stress=bishop", *SUCTION],
}
LATERAL = "-9.81 * 990 * (0.1 - y) * 0.3 / 0.7"  # of the scene, in six components
PARTICLES = "body.sand.particles_per_cell=8"  # in a tetrahedron
STRESS = f'body.sand.stress=["{LATERAL}", "-9.81 * 990 * (0.1 - y)", "{LATERAL}", "0 * x", "0 * x", "0 * x"]'
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
        words += ["dimension=3", PARTICLES, "mesh.thickness=0.01", "boundary.front.kind=roller", "boundary.back.kind=roller",
                  "output.point.corner.position=[0.2, 0.1, 0]"]
        words.append(STRESS)
    words += ["mesh.size=0.01"]
    results = folder / f"{model}{dimension}"
    start = time.time()
    subprocess.run([talus, "run", scene, "-o", results, "--no-pictures", "--force", *(w for word in words for w in ("--set", word))], capture_output=True)
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


BLOCK = ["dimension=3", "mesh.size=0.016", "mesh.thickness=0.3", "mesh.layers=0", "mesh.cuts=[0.1]", "body.sand.region=bars_1", "boundary.front.kind=roller", "boundary.back.kind=roller",
         "output.point.corner.position=[0.2, 0.1, 0.1]", PARTICLES, STRESS]


def block(talus, folder):
    scene = folder.parent / "block.toml"
    scene.write_text(scene_of("saturated"))
    subprocess.run([talus, "run", scene, "-o", folder, "--no-pictures", "--force", *(w for word in BLOCK for w in ("--set", word))], check=True)
    draw_block(folder)


def on_top(position, along, aside, up, spacing):
    """Which particles have no other above them."""
    column = np.floor(position[:, [along, aside]] / spacing).astype(int)
    _, number = np.unique(column, axis=0, return_inverse=True)
    number = number.reshape(-1)
    highest = np.full(number.max(initial=-1) + 1, -np.inf)
    np.maximum.at(highest, number, position[:, up])
    return position[:, up] > highest[number] - 0.9 * spacing


def draw_block(folder):
    """The block from above, and its section along the wall at z = 0, at three times."""
    results = Results(folder)
    spacing, times = spacing_of(results), (0.1, 0.3, 1.0)
    figure, grid = plt.subplots(2, len(times), figsize=(10, 3.9), gridspec_kw={"height_ratios": (0.26, 0.12)})
    figure.subplots_adjust(left=0.06, right=0.9, bottom=0.1, top=0.94, hspace=0.3, wspace=0.12)
    for (above, section), t in zip(grid.T, times):
        snapshot = min(results.snapshots, key=lambda each: abs(each.time - t))
        position, values = snapshot.position(), snapshot.scalar("pore_pressure")[0]
        for axes, up, rows, high in ((above, 2, np.flatnonzero(on_top(position, 0, 2, 1, spacing)), 0.26), (section, 1, np.flatnonzero(position[:, 2] < 1.5 * spacing), 0.12)):
            frame = Frame((0, 0), (0.34, high), 360)
            owner = tiles(position[rows][:, [0, up]], spacing, frame)
            shown = values[rows] if up == 1 else 1e3 * position[rows, 1]
            picture = axes.imshow(np.ma.array(shown[np.maximum(owner, 0)], mask=owner < 0), origin="lower", extent=frame.extent(), interpolation="nearest",
                                  **({"cmap": "RdBu_r", "vmin": -1000, "vmax": 1000} if up == 1 else {"cmap": "viridis", "vmin": 0, "vmax": 100}))
            axes.set(xlim=(0, 0.34), ylim=(0, high), aspect="equal", ylabel=("height [m]" if up == 1 else "z [m]") if t == times[0] else "")
            if up == 2:
                axes.plot([0, 0.2, 0.2], [0.1, 0.1, 0], color=style.INK, lw=0.8, ls=":")
                axes.set_title(at_time(snapshot.time, 1), loc="left", pad=3)
            if t == times[-1]:
                box = axes.get_position()
                place = figure.add_axes((0.92, box.y0, 0.012, box.height))
                figure.colorbar(picture, cax=place, extend="both" if up == 1 else "neither").outline.set_visible(False)
                place.set_title("p [Pa]" if up == 1 else "height [mm]", size=8, loc="left", pad=6)
    style.save(figure, HERE / "block.png")


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
    snapshots = [min(results.snapshots, key=lambda each: abs(each.time - t)) for t in TIMES]
    right = 0.05 * np.ceil(max(each.position()[:, 0].max() for each in snapshots) / 0.05)  # the farthest grain is seen
    frame = Frame((0, 0), (right, 0.11), 900)
    for axes, snapshot in zip(grid, snapshots):
        owner = tiles(snapshot.position()[:, :2], spacing_of(results), frame)
        values = snapshot.scalar("pore_pressure")[0]
        picture = axes.imshow(np.ma.array(values[np.maximum(owner, 0)], mask=owner < 0), origin="lower", extent=frame.extent(), interpolation="nearest",
                              cmap="RdBu_r", vmin=-1000, vmax=1000)
        axes.set(xlim=(0, right), ylim=(0, 0.11), aspect="equal")
        axes.set_title(at_time(snapshot.time, 1), loc="left", pad=3)
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
    parser.add_argument("--block", metavar="DIR", type=pathlib.Path)
    given = parser.parse_args()
    if given.talus and given.block:
        block(given.talus, given.block)
    elif given.talus:
        study(given.talus, given.dimensions)
    if given.sequence:
        draw_sequence(given.sequence)
    if (HERE / "models.csv").exists():
        draw_models()
