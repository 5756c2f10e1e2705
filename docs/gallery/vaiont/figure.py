#!/usr/bin/python3
"""Draws the Vaiont slide from a run of its scene:  figure.py DIR [DIR_OF_5_DEGREES]"""

import argparse
import csv
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))
sys.path.insert(0, str(HERE))

import matplotlib.pyplot as plt  # noqa: E402
import talus_style as style  # noqa: E402
from measures import levels  # noqa: E402
from talus_results import Results  # noqa: E402
from talus_sections import spacing_of  # noqa: E402
from talus_tiles import Frame, tiles  # noqa: E402

BASE = np.array([(-150, 1149), (0, 1040), (550.6, 640), (1255, 640), (1755, 1030)])
PER_SECOND = 4  # rows of the history
LOADS = (0, 40, 50, 60, 80, 85, 90, 95, 100, 110)  # load times of the frames [s]


def at_load(results, t):
    """The snapshot of a load time; the last of the gravity stage for 0."""
    rows = np.array(results.history.stage) == "water"
    begin = results.history.time[rows][0] - results.history.columns["load_time_s"][rows][0]
    return min(results.snapshots, key=lambda each: abs(each.time - begin - t))


def draw_frames(results, path):
    figure, grid = plt.subplots(len(LOADS) // 2, 2, figsize=(9.2, 10), sharex=True, sharey=True)
    figure.subplots_adjust(left=0.06, right=0.98, bottom=0.09, top=0.97, hspace=0.22, wspace=0.05)
    frame = Frame((-150, 600), (1755, 1150), 900)
    for axes, t in zip(grid.flat, LOADS):
        snapshot = at_load(results, t)
        owner = tiles(snapshot.position()[:, :2], spacing_of(results), frame)
        values = snapshot.scalar("plastic_strain")[0]
        picture = axes.imshow(np.ma.array(values[np.maximum(owner, 0)], mask=owner < 0), origin="lower", extent=frame.extent(),
                              interpolation="nearest", cmap="viridis", vmin=0, vmax=0.05 if t <= 60 else 1)
        axes.plot(*BASE.T, color="black", linewidth=1)
        axes.set(xlim=(-150, 1755), ylim=(600, 1150), aspect="equal")
        level = np.interp(t, *np.array(results.scene["functions"]["hw"], float).T)
        base = np.interp(t, *np.array(results.scene["functions"]["phi_b"], float).T)
        axes.set_title(f"t = {t} s, water {level:.0f} m, base {base:.0f}°", loc="left", pad=3, size=8.5)
        if t in (60, 110):
            place = figure.add_axes((0.1 if t == 60 else 0.58, 0.045, 0.34, 0.01))
            figure.colorbar(picture, cax=place, orientation="horizontal", extend="max").outline.set_visible(False)
            place.set_title(f"plastic strain, t {'up to' if t == 60 else 'beyond'} 60 s", size=8.5, loc="left", pad=4)
    style.save(figure, path)


def draw_motion(results, softer, path):
    figure, (rise, slide) = plt.subplots(1, 2, figsize=(9.2, 3.4))
    figure.subplots_adjust(left=0.07, right=0.98, bottom=0.15, top=0.93, wspace=0.22)
    history = results.history
    stage, way, speed = np.array(history.stage), history.columns["P0_displacement_x_m"], history.columns["P0_velocity_m_s"]
    wet = stage == "water"
    rise.plot(levels(results)[wet], way[wet], label="Talus")
    rise.plot([53], [8.5], "o", color="black", label="Alonso, Yerro & Pinyol (2015)")
    rise.set(xlabel="water above the horizontal plane [m]", ylabel="horizontal displacement of P0 [m]")
    rise.legend(frameon=False)
    for run, label, colour in ((results, "base 0°", "C0"), (softer, "base 5°", "C1")):
        if run is None:
            continue
        rows = np.array(run.history.stage) == "slide"
        slide.plot(run.history.columns["P0_displacement_x_m"][rows], run.history.columns["P0_velocity_m_s"][rows], color=colour, label=label)
    slide.plot([490], [0], "o", color="black"), slide.axhline(25, color="black", linewidth=0.7, linestyle=":")
    slide.annotate("paper, base 0°: 25 m/s, 490 m", (490, 25), ha="right", va="bottom", size=8.5)
    slide.set(xlabel="horizontal displacement of P0 [m]", ylabel="speed of P0 [m/s]", xlim=(0, 510), ylim=(0, 28))
    slide.legend(frameon=False, loc="lower center")
    style.save(figure, path)


def draw_friction(results, path):
    figure, (along, points) = plt.subplots(1, 2, figsize=(9.2, 3.6))
    figure.subplots_adjust(left=0.07, right=0.9, bottom=0.15, top=0.93, wspace=0.22)
    with open(results.folder / "line_plane.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    times = np.array([float(row["time_s"]) for row in rows])
    begin = results.history.time[np.array(results.history.stage) == "gravity"][-1]
    for t, colour in zip((0, 20, 40, 50, 60, 80), plt.get_cmap("viridis")(np.linspace(0, 0.9, 6))):
        nearest = times[np.abs(times - begin - t).argmin()]
        now = [row for row in rows if float(row["time_s"]) == nearest]
        along.plot([float(row["mobilised_friction_deg"]) for row in now], [float(row["distance_m"]) for row in now], color=colour,
                   label=f"{np.interp(t, *np.array(results.scene['functions']['hw'], float).T):.0f} m" + (" later" if t == 80 else ""))
    along.set(xlabel="mobilised friction [deg]", ylabel="distance from the kink [m]", xlim=(0, 45))
    along.legend(frameon=False, title="water")
    history = results.history
    moving = np.array(history.stage) == "slide"
    for k in range(1, 14):
        angle = np.nan_to_num(history.columns[f"m{k}_mobilised_friction_deg"][moving])
        points.plot((history.time[moving] - history.time[moving][0])[PER_SECOND - 1:], np.convolve(angle, np.ones(PER_SECOND) / PER_SECOND, "valid"),
                    color=plt.get_cmap("turbo")(k / 14), linewidth=1.1, label=str(k))
    points.set(xlabel="time since the base lost its friction [s]", ylabel="mobilised friction of 13 points [deg]", ylim=(0, 45))
    points.legend(frameon=False, loc="center left", bbox_to_anchor=(1, 0.5), fontsize=8)
    for axes in (along, points):
        for angle in (36, 42):
            (axes.axvline if axes is along else axes.axhline)(angle, color="grey", linewidth=0.6, linestyle=":")
    style.save(figure, path)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", help="folder of a run of scene.toml")
    parser.add_argument("softer", nargs="?", help="folder of a run with a base of 5 degrees")
    arguments = parser.parse_args()
    run, softer = Results(arguments.run), Results(arguments.softer) if arguments.softer else None
    draw_frames(run, HERE / "frames.png")
    draw_motion(run, softer, HERE / "motion.png")
    draw_friction(run, HERE / "friction.png")
