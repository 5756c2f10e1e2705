#!/usr/bin/python3
"""Draws wetting and sliding of the embankment from a run of its scene, and takes its stress paths:  figure.py DIR"""

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


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", metavar="DIR", type=pathlib.Path, help="results of a run")
    results = Results(parser.parse_args().folder)
    draw(results, HERE / "rain.png")
    plt.rcParams["savefig.dpi"] = 120
    [(_, paths)] = draw_stress_paths(results, results.folder / "pictures")
    shutil.copy(paths, HERE / "paths.png")
