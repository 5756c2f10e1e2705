#!/usr/bin/python3
"""Draws the collapse of the aluminium bars from the results of a run, and prints what is measured.

    talus run column -o DIR && figure.py DIR            redraws profile.png and sequence.png
    figure.py DIR DIR2 ... --table                      prints one line for each run, draws nothing
"""

import argparse
import pathlib

import numpy as np

from measures import AREA, FOOT, HERE, LINE, STRIP, Results, failure_line, foot, heights, measured, measured_toe, measures

import matplotlib.pyplot as plt  # after measures, which says where the style of the pictures is
import talus_style as style
from matplotlib.colors import ListedColormap
from talus_views import spacing_of
from talus_tiles import Frame, tiles
from talus_units import at_time

RIGHT, TOP = 0.5, 0.107  # of the pictures [m]
TIMES = (0, 0.1, 0.2, 0.3, 0.5, 1.0)  # of the sequence [s]
MOVED, STILL, RED = "#c5dfe4", "#e9ecef", style.LINES[1]
MILLIMETRE = 1e3


def areas(axes, results, snapshot, values, pixels=1500, **colours):
    """Fills the soil with the values of its particles."""
    frame = Frame((0, 0), (RIGHT, TOP), pixels)
    owner = tiles(snapshot.position()[:, :2], spacing_of(results), frame)
    shown = np.ma.array(values[np.maximum(owner, 0)], mask=owner < 0)
    return axes.imshow(shown, origin="lower", extent=frame.extent(), interpolation="nearest", **colours)


def bare(axes, right=RIGHT, top=TOP):
    """Axes of equal scale, in millimetres."""
    axes.set(xlim=(0, right), ylim=(0, top), aspect="equal")
    axes.xaxis.set_major_formatter(lambda x, _: f"{x * MILLIMETRE:.0f}")
    axes.yaxis.set_major_formatter(lambda y, _: f"{y * MILLIMETRE:.0f}")


def draw_profile(results, path):
    """The deposit with the measured surface, and still and moved soil with the measured failure line."""
    last = results.snapshots[-1]
    moved = (last.scalar("displacement")[0] >= 1e-3).astype(float)
    surface, failure, line = measured("surface"), measured("failure"), failure_line(last)
    numbers = measures(last)
    figure, axes = plt.subplots(figsize=(8.6, 2.45))
    figure.subplots_adjust(left=0.065, right=0.985, bottom=0.15, top=0.99)
    bare(axes)
    areas(axes, results, last, moved, cmap=ListedColormap([STILL, MOVED]), vmin=0, vmax=1)
    axes.plot([0, 0.2, 0.2], [0.1, 0.1, 0], color=style.SOFT, lw=0.9, ls=(0, (1, 1.6)))
    axes.annotate("block at the start", (0.2, 0.1), (4, -4), textcoords="offset points", va="top", color=style.SOFT, size=8)
    x, height = heights(last, 2 * STRIP)
    axes.plot(x, height, color=style.ACCENT, lw=1.6, label="Talus: height of the deposit, over 20 mm")
    axes.plot(*line.T, color=style.ACCENT, lw=1.1, ls=(0, (4, 2)), label="Talus: soil below moved less than 1 mm")
    where, dip = foot(line)
    axes.plot([FOOT[0], where], [(where - FOOT[0]) * np.tan(np.radians(dip)), 0], color=style.INK, lw=0.8,
              label="its lower half carried on to the base")
    axes.plot(*surface.T, "o", color=RED, ms=4, mec="white", mew=0.5, label="measured surface (Bui et al. 2008)", clip_on=False)
    axes.plot(*failure.T, "s", color=RED, ms=3.6, mec="white", mew=0.5, label="measured limit of moved bars", clip_on=False)
    axes.set(xlabel="distance from the wall [mm]", ylabel="height [mm]")
    axes.legend(loc="upper right", fontsize=8, handlelength=2.2, bbox_to_anchor=(1.0, 1.02))
    axes.text(0.985, 0.30, f"profile off by {numbers['profile'] * MILLIMETRE:.1f} mm in the mean", transform=axes.transAxes,
              ha="right", color=style.SOFT, size=8)
    style.save(figure, path)


def draw_sequence(results, path):
    """Velocity while the column comes down."""
    figure, grid = plt.subplots(3, 2, figsize=(8.6, 3.5), sharex=True, sharey=True)
    figure.subplots_adjust(left=0.065, right=0.915, bottom=0.12, top=0.95, wspace=0.06, hspace=0.25)
    picture = None
    for axes, time in zip(grid.T.flat, TIMES):
        snapshot = min(results.snapshots, key=lambda each: abs(each.time - time))
        bare(axes)
        axes.set_xticks(np.arange(0, RIGHT, 0.1))
        picture = areas(axes, results, snapshot, snapshot.scalar("velocity")[0], 900, cmap=style.part_of("magma_r", 0.06, 0.9),
                        vmin=0, vmax=0.6)
        axes.set_title(at_time(snapshot.time, 1), loc="left", pad=3)
        if snapshot is results.snapshots[-1]:
            axes.plot(*measured("surface").T, color=style.ACCENT, lw=1.3, label="measured, at rest")
            axes.legend(loc="upper right", fontsize=8)
    for axes in grid[-1]:
        axes.set_xlabel("distance from the wall [mm]")
    grid[1, 0].set_ylabel("height [mm]")
    place = figure.add_axes((0.93, 0.2, 0.014, 0.6))
    figure.colorbar(picture, cax=place, extend="max").outline.set_visible(False)
    place.set_title("|v| [m/s]", size=8.5, loc="left", pad=8)
    style.save(figure, path)


def tell(name, numbers):
    print(f"{name:16s} profile {numbers['profile'] * MILLIMETRE:5.2f} mm  toe {numbers['toe']:.3f} m  "
          f"1.5 mm high at {numbers['thin_end']:.3f} m  foot {numbers['foot']:.4f} m (dip {numbers['dip']:.1f} deg; "
          f"whole line {numbers['foot_whole']:.4f} m)  failure line {numbers['line'] * MILLIMETRE:.1f} mm")


def tell_measured():
    line = measured("failure")
    (lower, dip), (whole, _) = foot(line), foot(line, LINE)
    x, y = measured("surface").T
    area = (np.diff(x) * (y[1:] + y[:-1]) / 2).sum()
    print(f"{'measured':16s} area {area / AREA:.3f} of the block  "
          f"99.5 % of it within {measured_toe():.3f} m  outermost point {measured('surface')[-1, 0]:.3f} m  "
          f"foot {lower:.4f} m (dip {dip:.1f} deg; whole line {whole:.4f} m)")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="DIR", nargs="+", type=pathlib.Path, help="results of a run")
    parser.add_argument("--table", action="store_true", help="print only")
    given = parser.parse_args()
    tell_measured()
    for folder in given.folder:
        tell(folder.resolve().name, measures(Results(folder).snapshots[-1]))
    if not given.table:
        draw_profile(Results(given.folder[0]), HERE / "profile.png")
        draw_sequence(Results(given.folder[0]), HERE / "sequence.png")
