#!/usr/bin/python3
"""Draws ground water over three months and the slide from a run of the scene:  figure.py DIR"""

import argparse
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))

import matplotlib.pyplot as plt  # noqa: E402
import talus_style as style  # noqa: E402
from talus_results import Results  # noqa: E402
from talus_views import spacing_of  # noqa: E402
from talus_tiles import Frame, tiles  # noqa: E402

DAY = 86400
PANELS = (("pore_pressure", 1, "autumn"), ("pore_pressure", 61, "after two months"), ("pore_pressure", 91, "after three months"), ("plastic_strain", None, "at rest after the slide"))


def draw(results, path):
    figure, grid = plt.subplots(2, 2, figsize=(8.6, 4.6), sharex=True, sharey=True)
    figure.subplots_adjust(left=0.05, right=0.98, bottom=0.2, top=0.94, hspace=0.22, wspace=0.06)
    frame = Frame((0, 0), (50, 15), 900)
    for axes, (field, day, title) in zip(grid.flat, PANELS):
        snapshot = results.snapshots[-1] if day is None else min(results.snapshots, key=lambda each: abs(each.time - day * DAY))
        owner = tiles(snapshot.position()[:, :2], spacing_of(results), frame)
        values = snapshot.scalar(field)[0]
        water = field == "pore_pressure"
        colours = {"cmap": "Blues", "vmin": 0, "vmax": 100} if water else {"cmap": "viridis", "vmin": 0, "vmax": 1}
        picture = axes.imshow(np.ma.array((values / 1e3 if water else values)[np.maximum(owner, 0)], mask=owner < 0), origin="lower", extent=frame.extent(), interpolation="nearest", **colours)
        axes.set(xlim=(0, 50), ylim=(0, 15), aspect="equal")
        axes.set_title(title, loc="left", pad=3)
        if title.startswith("after three") or day is None:
            place = figure.add_axes((axes.get_position().x0 + 0.08, 0.08, 0.3, 0.02))
            figure.colorbar(picture, cax=place, orientation="horizontal", extend="max").outline.set_visible(False)
            place.set_title("pore pressure [kPa]" if water else "plastic strain", size=8.5, loc="left", pad=4)
    style.save(figure, path)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", metavar="DIR", type=pathlib.Path, help="results of a run")
    draw(Results(parser.parse_args().folder), HERE / "season.png")
