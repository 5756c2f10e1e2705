"""The pictures of this page, from runs of the scene: rain.png is figure 29 of the paper, points.png figures 30, 31, 33 and 34, paths.png figure 32."""

import pathlib
import shutil
import subprocess
import tempfile

import numpy as np

import measures
import talus_style as style
from talus_paths import draw_stress_paths
from talus_results import Results
from talus_style import plt
from talus_tiles import Frame, tiles
from talus_units import at_time
from talus_views import spacing_of

HERE = pathlib.Path(__file__).resolve().parent
COARSE = ("--set", "mesh.size=1.4", "--set", "stage.rain.duration=60", "--no-pictures")  # of storage.png
FILM = ("--set", "output.interval=0.25", "--set", "stage.rain.duration=32", "--no-pictures")  # until the first slide is at rest
TIMES = (24, 30, 116)  # [s]
RIGHT, TOP = 48, 16  # [m]
POINTS = ("S1", "D1", "S2", "D2")
SOLID, WATER, GAS, POROSITY = 9.8e6, 100e6, 1e4, 0.35  # bulk moduli of skeleton, water and gas [Pa] of Table 3, for figure 34


def draw_section(results, path):
    figure, grid = plt.subplots(len(TIMES), 2, figsize=(9.6, 6.0), sharex=True, sharey=True)
    figure.subplots_adjust(left=0.06, right=0.985, bottom=0.2, top=0.95, hspace=0.22, wspace=0.06)
    frame = Frame((0, 0), (RIGHT, TOP), 900)
    fields = (("suction", 1e-3, {"cmap": "YlOrBr", "vmin": 0, "vmax": 100}), ("displacement", 1, {"cmap": "viridis", "vmin": 0, "vmax": 8}))
    for line, t in zip(grid, TIMES):
        snapshot = min(results.snapshots, key=lambda each: abs(each.time - t))
        owner = tiles(snapshot.position()[:, :2], spacing_of(results), frame)
        for axes, (field, factor, colours) in zip(line, fields):
            values = factor * snapshot.scalar(field)[0]
            picture = axes.imshow(np.ma.array(values[np.maximum(owner, 0)], mask=owner < 0), origin="lower", extent=frame.extent(), interpolation="nearest", **colours)
            axes.set(xlim=(0, RIGHT), ylim=(0, TOP), aspect="equal", xticks=range(0, RIGHT + 1, 10), yticks=range(0, TOP, 5))
            since = snapshot.time - measures.start_of_rain(results)
            axes.set_title(f"{field}, {at_time(snapshot.time, TIMES[-1])}, {since:.0f} s of rain", loc="left", pad=3)
            if axes is line[0]:
                axes.set_ylabel("elevation [m]")
            if t == TIMES[-1]:
                axes.set_xlabel("x [m]")
                at = axes.get_position()
                place = figure.add_axes((at.x0, 0.055, 0.8 * at.width, 0.018))
                figure.colorbar(picture, cax=place, orientation="horizontal", extend="max").outline.set_visible(False)
                place.set_title("displacement [m]" if field == "displacement" else "suction [kPa]", size=8.5, loc="left", pad=4)
    style.save(figure, path)


def draw_points(results, path):
    columns, time = results.history.columns, results.history.time
    panels = (("suction_Pa", 1e-3, "suction [kPa] (30)"), ("saturation", 1, "degree of saturation (30, 33b)"), ("displacement_m", 1, "displacement [m] (31)"),
              ("velocity_m_s", 1, "velocity [m/s] (31)"), ("acceleration_m_s2", 1, "acceleration [m/s²] (31)"), ("deviator_Pa", 1e-3, "deviator q [kPa] (33a)"))
    figure, grid = plt.subplots(4, 2, figsize=(8.6, 9.2))
    for axes, (quantity, factor, title) in zip(grid.flat, panels):
        for colour, point in zip(style.LINES, POINTS):
            axes.plot(time, factor * columns[f"{point}_{quantity}"], lw=1.0, color=colour, label=point)
        axes.set(xlim=(time[0], time[-1]), ylim=(0, None), xlabel="time [s]")
        axes.set_title(title, loc="left")
    grid.flat[0].legend(fontsize=8)
    wet = np.linspace(0.9, 1, 2001)
    grid.flat[6].semilogy(wet, (SOLID + 1 / (POROSITY * wet / WATER + POROSITY * (1 - wet) / GAS)) / 1e6, color=style.INK)
    grid.flat[6].set(xlim=(0.9, 1), xlabel="degree of saturation")
    grid.flat[6].set_title("bulk modulus by (21) and Table 3 of the paper [MPa] (34)", loc="left")
    full = [columns[f"{point}_saturation"] > 0.99 for point in POINTS]
    for colour, point, near in zip(style.LINES, POINTS, full):
        grid.flat[7].plot(time[near], 1e-3 * columns[f"{point}_pore_pressure_Pa"][near], ".", ms=2.5, color=colour)
    grid.flat[7].set(xlim=(time[0], time[-1]), xlabel="time [s]")
    grid.flat[7].set_title("pore pressure where S > 0.99 [kPa]", loc="left")
    figure.tight_layout()
    style.save(figure, path)


def draw_storage(mass, rate, path):
    """Deviator of the four points with storage of the water by masses and in rate form; dotted: S = 0.99 with masses."""
    figure, grid = plt.subplots(2, 2, figsize=(8.6, 4.6), sharex=True)
    for axes, point in zip(grid.flat, POINTS):
        for results, name, colour, width in ((rate, "rate form", style.LINES[1], 0.6), (mass, "masses", style.LINES[0], 1.2)):
            history = results.history
            axes.plot(history.time, 1e-3 * history.columns[f"{point}_deviator_Pa"], lw=width, color=colour, label=name)
        history = mass.history
        full = history.time[(history.columns[f"{point}_saturation"] > 0.99) & (history.time > measures.start_of_rain(mass))]
        if len(full):
            axes.axvline(full[0], color=style.INK, lw=0.7, ls=":")
        axes.set_title(f"{point}: deviator q [kPa]", loc="left")
        axes.set_ylim(0, 1e-3 * 1.3 * mass.history.columns[f"{point}_deviator_Pa"].max())
        axes.set_xlim(0, mass.history.time[-1])
    for axes in grid[1]:
        axes.set_xlabel("time [s]")
    grid.flat[0].legend(fontsize=8)
    figure.tight_layout()
    style.save(figure, path)


def draw(talus, folder=None):
    """Runs the scene, or reads the results in `folder`, and draws all; the film is of a run with more snapshots."""
    with tempfile.TemporaryDirectory() as made:
        if folder is None:
            folder = f"{made}/scene"
            subprocess.run([talus, "run", HERE / "scene.toml", "-o", folder, "--force"], check=True)
        for storage in ("mass", "rate"):
            subprocess.run([talus, "run", HERE / "scene.toml", "-o", f"{made}/{storage}", *COARSE, "--set", f"water.storage={storage}"], check=True)
        draw_storage(Results(f"{made}/mass"), Results(f"{made}/rate"), HERE / "storage.png")
        subprocess.run([talus, "run", HERE / "scene.toml", "-o", f"{made}/film", *FILM], check=True)
        subprocess.run([talus, "plot", f"{made}/film", "--movie", "--fields", "displacement"], check=True)
        shutil.copy(f"{made}/film/pictures/movie_displacement.gif", HERE / "slide.gif")
        results = Results(folder)
        draw_section(results, HERE / "rain.png")
        draw_points(results, HERE / "points.png")
        [(_, paths)] = draw_stress_paths(results, results.folder / "pictures")
        shutil.copy(paths, HERE / "paths.png")
