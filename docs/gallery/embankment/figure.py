#!/usr/bin/python3
"""Draws wetting and sliding of the embankment from a run of its scene, and takes its stress paths:  figure.py DIR
States what the README compares of a run, on triangles or in a slice:                                figure.py DIR --numbers"""

import argparse
import pathlib
import shutil
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))

import matplotlib.pyplot as plt  # noqa: E402
import talus_style as style  # noqa: E402
from talus_paths import draw_stress_paths  # noqa: E402
from talus_results import Results  # noqa: E402
from talus_sections import spacing_of  # noqa: E402
from talus_tiles import Frame, tiles  # noqa: E402

TIMES = (18, 43, 83)  # [s]
PRESSED = (13, 18, 23, 26, 29, 32, 43, 60, 83)  # at which pressures are stated [s]
TOE, MIDDLE = 30, (22.2, 10)  # [m]


def draw(results, path):
    figure, grid = plt.subplots(len(TIMES), 2, figsize=(8.6, 5.7), sharex=True, sharey=True)
    figure.subplots_adjust(left=0.05, right=0.98, bottom=0.16, top=0.95, hspace=0.25, wspace=0.06)
    frame = Frame((0, 0), (45, 16), 900)
    for line, t in zip(grid, TIMES):
        snapshot = min(results.snapshots, key=lambda each: abs(each.time - t))
        owner = tiles(snapshot.position()[:, :2], spacing_of(results), frame)
        for axes, field, colours in zip(line, ("saturation", "displacement"), ({"cmap": "YlGnBu", "vmin": 0.5, "vmax": 1}, {"cmap": "viridis", "vmin": 0, "vmax": 6})):
            values = snapshot.scalar(field)[0]
            picture = axes.imshow(np.ma.array(values[np.maximum(owner, 0)], mask=owner < 0), origin="lower", extent=frame.extent(), interpolation="nearest", **colours)
            axes.set(xlim=(0, 45), ylim=(0, 16), aspect="equal")
            axes.set_title(style.at_time(snapshot.time, TIMES[-1]), loc="left", pad=3)
            if t == TIMES[-1]:
                place = figure.add_axes((axes.get_position().x0 + 0.08, 0.06, 0.3, 0.018))
                figure.colorbar(picture, cax=place, orientation="horizontal", extend="max" if field == "displacement" else "neither").outline.set_visible(False)
                place.set_title("displacement [m]" if field == "displacement" else "degree of saturation", size=8.5, loc="left", pad=4)
    style.save(figure, path)


def state_numbers(results):
    water = results.history.columns["water_error_kg"], results.history.columns["water_kg"]
    print(f"ledger of water: error over water {np.abs(water[0]).max() / water[1][0]:.1e}")
    for t in PRESSED:
        snapshot = min(results.snapshots, key=lambda each: abs(each.time - t))
        p, share = (snapshot.column(name).values[:, 0] for name in ("pore_pressure", "saturation"))
        full = share > 0.999
        print(f"{t} s: mean saturation {share.mean():.4f}; largest pressure {p.max() / 1e3:.0f} kPa, of full cells {p[full].max() / 1e3 if full.any() else 0:.0f} kPa; "
              f"{(p[share < 0.99] > 5e3).sum()} particles above 5 kPa below S = 0.99; largest displacement {snapshot.scalar('displacement')[0].max():.3f} m")
    start, last = results.snapshots[min(3, len(results.snapshots) - 1)].position(), results.snapshots[-1]
    moved, level = last.scalar("displacement")[0], last.column("displacement").values[:, 0]
    middle = np.flatnonzero(np.linalg.norm(start[:, :2] - MIDDLE, axis=1) < 1.2)
    most = middle[moved[middle].argmax()]
    print(f"end: {100 * (moved > 1).mean():.1f} % of the soil moved more than 1 m, to {last.position()[moved > 1, 0].max() - TOE:.1f} m beyond the toe; at mid-height {moved[most]:.1f} m, {level[most]:.1f} m of it level")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="DIR", type=pathlib.Path, help="results of a run")
    parser.add_argument("--numbers", action="store_true", help="print, draw nothing")
    given = parser.parse_args()
    results = Results(given.folder)
    if given.numbers:
        state_numbers(results)
        sys.exit()
    draw(results, HERE / "rain.png")
    plt.rcParams["savefig.dpi"] = 120
    [(_, paths)] = draw_stress_paths(results, results.folder / "pictures")
    shutil.copy(paths, HERE / "paths.png")
