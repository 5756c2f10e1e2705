"""The pictures and the film of this page, from runs of the scene with a base of 0 and of 5 degrees."""

import pathlib
import shutil
import subprocess
import tempfile

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

import measures
import talus_style as style
from talus_results import Results
from talus_tiles import Frame, tiles
from talus_views import spacing_of

HERE = pathlib.Path(__file__).resolve().parent

BASE = np.array([(-150, 1149), (0, 1040), (550.6, 640), (1255, 640), (1755, 1030)])
SOFTER = "functions.phi_b=[[0, 12], [150, 12], [151, 5]]"  # the base keeps 5 degrees
FLUENT = "output.interval=0.5"  # for the film
FILM = "plastic_strain"
PER_SECOND = 4  # rows of the history
LOADS = (20, 40, 60, 150, 158, 166, 174, 182)  # load times of the frames [s]
FAST_LOADS = (158, 166, 174, 182)  # of those after the base has lost its friction [s]
STRAINS, INTACT = (1e-3, 3), "#dfe3e8"  # ends of the scale of plastic strain, and the colour of rock with less
KINKS = ((550.6, "^", "kink below the slope"), (1255, "o", "kink at the far bank"))  # of the base, which points pass [m]
SPANS = ((0, 10), (10, 20), (20, 30), (30, 40), (40, 50), (50, 60), (60, 70), (70, 80))  # load times between which the plane is looked for [s]


def level_at(results, t):
    return np.interp(t, *np.array(results.scene["functions"]["hw"], float).T)


def draw_frames(results, loads, path):
    (left, right), (low, high) = (-150, 1755), (600, 1150)
    wide, beside, title, width = 4.35, 0.25, 0.42, 9.8  # of a frame, between frames, above each, of the picture [inch]
    tall = wide * (high - low) / (right - left)
    height = 0.05 + len(loads) // 2 * (tall + title) + 1.15
    figure = plt.figure(figsize=(width, height))
    frame, colours = Frame((left, low), (right, high), 900), {"cmap": style.colours_of("plastic_strain").with_extremes(under=INTACT), "norm": LogNorm(*STRAINS)}
    for k, t in enumerate(loads):
        row, column = divmod(k, 2)
        axes = figure.add_axes(((0.62 + column * (wide + beside)) / width, 1 - (0.05 + (row + 1) * (tall + title)) / height, wide / width, tall / height))
        snapshot = measures.at_load(results, t)
        owner = tiles(snapshot.position()[:, :2], spacing_of(results), frame)
        values = np.maximum(snapshot.scalar("plastic_strain")[0], 1e-12)
        picture = axes.imshow(np.ma.array(values[np.maximum(owner, 0)], mask=owner < 0), origin="lower", extent=frame.extent(), interpolation="nearest", **colours)
        axes.plot(*BASE.T, color=style.INK, linewidth=1)
        axes.set(xlim=(left, right), ylim=(low, high), xticks=range(0, 1751, 250), yticks=range(600, 1101, 100))
        axes.tick_params(labelleft=column == 0, labelbottom=row == len(loads) // 2 - 1)
        if column == 0:
            axes.set_ylabel("elevation [m]")
        if row == len(loads) // 2 - 1:
            axes.set_xlabel("x [m]")
        base = np.interp(t, *np.array(results.scene["functions"]["phi_b"], float).T)
        axes.set_title(f"t = {t} s, water {level_at(results, t):.0f} m, base {base:.0f}°", loc="left", pad=3, size=8.5)
    bar = figure.add_axes((0.62 / width, 0.3 / height, wide / width, 0.12 / height))
    figure.colorbar(picture, cax=bar, orientation="horizontal", extend="both").outline.set_visible(False)
    bar.set_xticks([1e-3, 1e-2, 0.1, 1], ["0.001", "0.01", "0.1", "1"], size=8)
    bar.set_title("plastic strain, the same scale in all frames; grey: less", size=8.5, loc="left", pad=4)
    style.save(figure, path)


def draw_motion(results, softer, path):
    figure, (rise, slow, slide) = plt.subplots(1, 3, figsize=(13.2, 3.4))
    figure.subplots_adjust(left=0.05, right=0.99, bottom=0.15, top=0.9, wspace=0.2)
    wet = np.array(results.history.stage) == "water"
    load = results.history.columns["load_time_s"][wet]
    for point, label, line in (("m9", "middle of the lower part (9)", "-"), ("P0", "P0, at the edge of the front", ":")):
        moved = np.linalg.norm(measures.way(results, point), axis=0)[wet]
        rise.plot(load, moved, line, label=label)
        slow.plot(moved, measures.mean_speed(results, point)[wet], line, label=label)
    rise.plot([np.interp(53, *np.array(results.scene["functions"]["hw"], float).T[::-1])], [8.5], "o", color="black", label="Alonso, Yerro & Pinyol (2015)")
    rise.set(xlabel="load time [s]", ylabel="displacement [m]", xlim=(0, load[-1]))
    rise.legend(frameon=False, loc="lower right", fontsize=8)
    for level in (30, 53, 57, 60):
        t = np.interp(level, *np.array(results.scene["functions"]["hw"], float).T[::-1])
        rise.axvline(t, color="grey", linewidth=0.7, linestyle=":")
        rise.annotate(f"{level}", (t, 1.01), xycoords=("data", "axes fraction"), ha="center", va="bottom", size=8)
    rise.annotate("m of water", (70, 1.01), xycoords=("data", "axes fraction"), va="bottom", size=8)
    slow.axhline(0.5, color="black", linewidth=0.7, linestyle=":")
    slow.annotate("paper, fig. 22: 0.5 m/s", (0.82, 0.5), xycoords=("axes fraction", "data"), ha="right", va="bottom", size=8.5)
    slow.set(xlabel="displacement [m]", ylabel="speed, mean over 2 s [m/s]", xlim=(0, None), ylim=(0, None), title="base 12°, up to 60 m of water")
    slow.title.set(size=9)
    for run, label, colour in ((results, "base 0°", "C0"), (softer, "base 5°", "C1")):
        if run is None:
            continue
        rows = np.array(run.history.stage) == "slide"
        slide.plot(measures.way(run, "m9")[0, rows], measures.mean_speed(run, "m9")[rows], color=colour, label=label + ", middle")
        slide.plot(measures.way(run, "P0")[0, rows], run.history.columns["P0_velocity_m_s"][rows], color=colour, linestyle=":", label=label + ", P0")
    slide.plot([490], [0], "o", color="black"), slide.plot([225, 560], [25, 25], color="black", linewidth=0.7, linestyle=":")
    slide.annotate("paper, base 0°: 25 m/s, 490 m", (490, 25), ha="right", va="bottom", size=8.5)
    slide.set(xlabel="horizontal displacement [m]", ylabel="speed [m/s]", xlim=(0, 560), ylim=(0, 28))
    slide.legend(frameon=False, loc="upper left", fontsize=7.5)
    style.save(figure, path)


def along_plane(results, snapshot, angle, height, half_width=15.0):
    """Mobilised friction along a plane through the kink [deg]: the mean over the rock within `half_width` of it, in steps of its length [m]."""
    direction = np.array([-np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    away = snapshot.position()[:, :2] - measures.KINK
    near = np.abs(away @ [direction[1], -direction[0]]) < half_width
    step = np.digitize((away @ direction)[near], height) - 1
    friction, volume = snapshot.scalar("mobilised_friction")[0][near], snapshot.column("volume").values[near, 0]
    return [np.average(friction[step == k], weights=volume[step == k]) if (step == k).any() else np.nan for k in range(len(height) - 1)]


def draw_plane(results, path):
    """Mobilised friction along the plane over load time, and how the plane turns."""
    figure, (map_, turn) = plt.subplots(1, 2, figsize=(9.6, 4.0), width_ratios=(1.2, 1))
    figure.subplots_adjust(left=0.065, right=0.985, bottom=0.125, top=0.9, wspace=0.22)
    loads, height = np.arange(0, 81, 2.0), np.arange(0, 246, 17.5)
    middle, turned = [sum(span) / 2 for span in SPANS], [measures.plane_of_motion(results, *span) for span in SPANS]
    friction = np.array([along_plane(results, measures.at_load(results, t), np.interp(t, middle, turned), height) for t in loads]).T
    picture = map_.pcolormesh(np.append(loads - 1, loads[-1] + 1), height, friction, cmap="viridis", vmin=20, vmax=42)
    for level in (30, 53, 57, 60):
        t = np.interp(level, *np.array(results.scene["functions"]["hw"], float).T[::-1])
        map_.axvline(t, color="white", linewidth=0.7, linestyle=":")
        map_.annotate(f"{level}", (t, 247), ha="center", va="bottom", size=8, annotation_clip=False)
    map_.annotate("m of water", (64, 247), va="bottom", size=8, annotation_clip=False)
    map_.set(xlabel="load time [s]", ylabel="distance from the kink along the plane [m]", xlim=(0, 80), ylim=(0, 245))
    figure.colorbar(picture, ax=map_, extend="both", label="mobilised friction [deg]").outline.set_visible(False)
    turn.plot(middle, turned, "o-")
    turn.axhline(108, color="black", linewidth=0.7, linestyle=":"), turn.annotate("bisector", (79, 108.3), ha="right", size=8.5)
    turn.axhline(90, color="grey", linewidth=0.7, linestyle=":"), turn.annotate("vertical", (79, 90.3), ha="right", size=8.5, color="grey")
    turn.set(xlabel="load time [s]", ylabel="inclination of the plane from the uphill level [deg]", xlim=(0, 80), ylim=(70, 118))
    style.save(figure, path)


def draw_gravity(results, path):
    """Plastic strain after gravity around the kink."""
    start, (low, high) = measures.at_load(results, 0), ((330, 640), (770, 960))
    frame = Frame(low, high, 800)
    owner = tiles(start.position()[:, :2], spacing_of(results), frame)
    values = np.maximum(start.scalar("plastic_strain")[0], 1e-12)
    figure, axes = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
    picture = axes.imshow(np.ma.array(values[np.maximum(owner, 0)], mask=owner < 0), origin="lower", extent=frame.extent(), interpolation="nearest",
                          cmap=style.colours_of("plastic_strain").with_extremes(under=INTACT), norm=LogNorm(1e-5, 1e-2))
    axes.plot(*BASE.T, color=style.INK, linewidth=1)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1] - 5, high[1]), xlabel="x [m]", ylabel="elevation [m]")
    figure.colorbar(picture, ax=axes, extend="both", label="plastic strain after gravity; grey: less").outline.set_visible(False)
    style.save(figure, path)


def draw_points(results, path):
    """Mobilised friction of thirteen points in the slide over time, a row for each, with the times at which they pass a kink of the base."""
    figure, points = plt.subplots(figsize=(9.6, 4.0))
    figure.subplots_adjust(left=0.055, right=1.06, bottom=0.125, top=0.92)
    history = results.history
    moving = np.array(history.stage) == "slide"
    time = (history.time[moving] - history.time[moving][0])[PER_SECOND - 1:]
    mean = lambda column: np.convolve(column, np.ones(PER_SECOND) / PER_SECOND, "valid")
    friction = np.array([mean(np.nan_to_num(history.columns[f"m{k}_mobilised_friction_deg"][moving])) for k in range(1, 14)])
    step = time[1] - time[0]
    picture = points.pcolormesh(np.append(time - step / 2, time[-1] + step / 2), np.arange(0.5, 14), friction, cmap="viridis", vmin=0, vmax=42)
    for edge in np.arange(1.5, 13):
        points.axhline(edge, color="white", linewidth=1.2)
    for k in range(1, 14):
        x = results.scene["output"]["point"][f"m{k}"]["position"][0] + history.columns[f"m{k}_displacement_x_m"][moving]
        for kink, marker, label in KINKS:
            passed = np.flatnonzero((x[:-1] < kink) & (x[1:] >= kink))
            points.plot((history.time[moving] - history.time[moving][0])[passed[:1]], [k] * len(passed[:1]), marker, color="white", markeredgecolor=style.INK,
                        markersize=6, linestyle="none", clip_on=False, zorder=4)
    points.set(xlabel="time since the base lost its friction [s]", ylabel="point, from the scarp to the toe", yticks=range(1, 14), xlim=(time[0] - step / 2, time[-1] + step / 2))
    points.invert_yaxis()
    figure.colorbar(picture, ax=points, pad=0.02, aspect=24, label="mobilised friction [deg]", ticks=(0, 10, 20, 30, 36, 42)).outline.set_visible(False)
    marks = [plt.Line2D([], [], marker=marker, color="white", markeredgecolor=style.INK, markersize=6, linestyle="none", label=f"passes the {label}") for _, marker, label in KINKS]
    points.legend(handles=marks, frameon=False, loc="lower left", bbox_to_anchor=(-0.01, 1.0), borderaxespad=0.2, ncols=2, fontsize=8)
    style.save(figure, path)


def draw(talus, folder=None, softer=None):
    """Runs the scene with both bases, or reads the results in `folder` and `softer`, and draws all."""
    with tempfile.TemporaryDirectory() as made:
        if folder is None:
            folder = f"{made}/0"
            subprocess.run([talus, "run", HERE / "scene.toml", "-o", folder, "--no-pictures", "--set", FLUENT], check=True)
        if softer is None:
            softer = f"{made}/5"
            subprocess.run([talus, "run", HERE / "scene.toml", "-o", softer, "--no-pictures", "--set", SOFTER], check=True)
        subprocess.run([talus, "plot", folder, "--movie", "--fields", FILM], check=True)
        shutil.copy(f"{folder}/pictures/movie_{FILM}.gif", HERE / "slide.gif")
        results, slower = Results(folder), Results(softer)
        draw_frames(results, LOADS, HERE / "frames.png")
        draw_frames(slower, FAST_LOADS, HERE / "frames_5.png")
        draw_motion(results, slower, HERE / "motion.png")
        draw_plane(results, HERE / "plane.png")
        draw_gravity(results, HERE / "gravity.png")
        draw_points(results, HERE / "friction.png")
