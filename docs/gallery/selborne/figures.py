"""The pictures of this page, from runs of the scene and of slice.toml."""
import csv
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import talus_style as style
from talus_lines import dimensionless, means
from talus_results import Results
from talus_style import plt

HERE = Path(__file__).resolve().parent
COPIED = {"plastic_strain_large": "slide"}
POINTS = ("crest", "upper", "lower", "toe")
FROM_FIRST_YIELD = (0.6, 1.06)  # t* that the states of the slip surface are shown for
FROM_START = (0, 1.06)  # and its mean friction
PLACES = (5, 12, 19)  # distances along the slip surface of the places that stand for the paper's P1, P5 and P7 [m]


def draw(talus, folder=None, wet=None):
    """Runs both scenes, or reads the results in `folder` and `wet`, and draws all."""
    with tempfile.TemporaryDirectory() as made:
        if folder is None:
            folder = made
            subprocess.run([talus, "run", HERE / "scene.toml", "-o", folder, "--force"], check=True)
        if wet is None:
            wet = f"{made}/slice"
            subprocess.run([talus, "run", HERE / "slice.toml", "-o", wet, "--force", "--no-pictures"], check=True)
        draw_pressures(*history_of(wet))
        results = Results(folder)
        for source, name in COPIED.items():
            shutil.copy(f"{folder}/pictures/{source}.png", HERE / f"{name}.png")
        history, relative = history_of(folder)
        draw_motion(history, relative)
        draw_strength(results.lines()["contact"], results)
        draw_paths(history, relative)
        draw_inclinometers([line for name, line in results.lines().items() if name.startswith("I")], results)


def history_of(folder):
    """Columns of history.csv, and t* of its rows."""
    rows = list(csv.DictReader(open(f"{folder}/history.csv")))
    history = {name: np.array([float(row[name]) for row in rows]) for name in rows[0] if name != "stage"}
    return history, dimensionless(Results(folder), history["time_s"])


def save(figure, name):
    """Writes a picture of the page, with some paper around its charts."""
    figure.get_layout_engine().set(w_pad=0.09, h_pad=0.09, wspace=0.02, hspace=0.03)
    style.save(figure, HERE / f"{name}.png", dpi=130)


def draw_pressures(history, relative):
    figure, axis = plt.subplots(figsize=(7.5, 3.6), layout="constrained")
    for point, name, colour in (("base", "at the base, (10, 0)", 0), ("P2", "P2, 1 m above the contact (17, 8.5)", 1),
                                ("below_toe", "below the toe (36, 2)", 2)):
        axis.plot(relative, history[f"{point}_pore_pressure_Pa"] / 1e3, color=style.LINES[colour], lw=1.1, label=name)
    axis.axvline(1, color="0.6", lw=1, ls=":")
    axis.set(xlabel="t* = t / time of failure", title="pore pressure where water moves [kPa] (paper's fig. 6)", xlim=(0, None))
    axis.legend(fontsize=8, loc="upper left")
    save(figure, "pressures")


def draw_motion(history, relative):
    figure, axes = plt.subplots(1, 3, figsize=(11.5, 3.4), layout="constrained")
    for point, colour in zip(POINTS, style.LINES):
        for axis, (name, factor) in zip(axes, (("displacement_m", 1), ("velocity_m_s", 1), ("acceleration_m_s2", 1 / 9.81))):
            axis.plot(relative, factor * history[f"{point}_{name}"], color=colour, lw=1.2, label=point)
    for axis, title in zip(axes, ("displacement [m]", "speed [m/s]", "acceleration [g]")):
        axis.set(xlabel="t* = t / time of failure", title=title, xlim=(0.97, 1.2), ylim=(0, None))
    axes[2].set_ylim(0, 0.1)
    axes[0].legend(fontsize=8)
    save(figure, "motion")


def draw_strength(line, results):
    relative, mean = dimensionless(results, line.time), means(line)
    figure, ((left, path), (friction, shares), (three, moved)) = plt.subplots(3, 2, figsize=(11.5, 11.2), layout="constrained")
    draw_along(left, line, relative)
    draw_mean_path(path, relative, mean)
    friction.plot(relative, mean["mean_mobilised_friction_deg"], color=style.INK, lw=1.4)
    friction.set(xlabel="t* = t / time of failure", ylabel="mean mobilised friction φ' [deg]", title="mean along the slip surface (paper's fig. 12)",
                 xlim=FROM_START, ylim=(0, 20))
    for state, colour in zip(style.STATES[1:], ("#f2b705", *style.STATE_COLOURS[2:])):  # the yellow of a thin line is darker
        shares.plot(relative, 100 * mean[f"share_{state}"], color=colour, lw=1.6, label=state)
    shares.set(xlabel="t* = t / time of failure", ylabel="share of the slip surface [%]", title="states of its soil", xlim=FROM_FIRST_YIELD, ylim=(-1, 100))
    shares.legend(fontsize=8, loc="center right")
    draw_places(three, moved, line, relative)
    for axes in (friction, shares, three, moved):
        axes.axvline(1, color=style.FAINT, lw=0.9, zorder=0.5)
        axes.annotate("failure", (1, 0.985), xycoords=("data", "axes fraction"), xytext=(3, 0), textcoords="offset points", va="top", fontsize=7.5, color=style.SOFT)
    save(figure, "strength")


def draw_along(axis, line, relative):
    """Mobilised friction along the slip surface at some times, with the states of its soil."""
    along = line.columns["distance_m"][0]
    for k, t in enumerate((0.02, 0.65, 0.75, 0.95, 1.0, 1.02)):
        row = int(np.nanargmin(np.abs(relative - t)))
        mobilised = np.sin(np.radians(line.columns["mobilised_friction_deg"][row]))
        axis.plot(along, mobilised, color=plt.get_cmap("viridis")(k / 5.5), lw=1.3, label=f"t* = {relative[row]:.3f}")
        axis.scatter(along, mobilised, s=16, edgecolors=style.INK, linewidths=0.4, zorder=3,
                     c=[("white", *style.STATE_COLOURS[1:])[int(state)] if np.isfinite(state) else "white" for state in line.columns["state"][row]])
    axis.set(xlabel="distance along the slip surface, from its rear [m]", ylabel="mobilised friction sin φ' [-]", title="along the slip surface (paper's fig. 11)",
             xlim=(0, along[-1] + 1), ylim=(0, 0.6))
    states = [plt.Line2D([], [], ls="", marker="o", ms=4.5, mfc=colour, mec=style.INK, mew=0.4, label=state)
              for state, colour in zip(style.STATES, ("white", *style.STATE_COLOURS[1:]))]
    axis.add_artist(axis.legend(handles=states, fontsize=8, loc="upper left", ncols=2))
    axis.legend(fontsize=8, loc="upper right", ncols=2)


def draw_mean_path(axis, relative, mean):
    """The mean effective stress of the slip surface, with three moments of its failure."""
    p, q = mean["mean_mean_pressure_Pa"] / 1e3, mean["mean_deviator_Pa"] / 1e3
    shown = (relative >= 0) & (relative <= 1.02)
    axis.plot(p[shown], q[shown], color=style.INK, lw=1.1)
    largest = int(np.nanargmax(np.where(relative <= 1, mean["mean_mobilised_friction_deg"], np.nan)))
    for label, row in (("start", np.flatnonzero(shown)[0]), ("largest friction", largest), ("failure", int(np.nanargmin(np.abs(relative - 1)))),
                       ("least friction", int(np.nanargmin(np.where(shown, mean["mean_mobilised_friction_deg"], np.nan))))):
        axis.plot(p[row], q[row], "o", ms=5, label=f"{label}, t* = {relative[row]:.2f}")
    axis.set(xlabel="mean effective stress p' of the slip surface [kPa]", ylabel="mean deviator q [kPa]", title="mean stress up to t* = 1.02 (paper's fig. 12b)")
    axis.legend(fontsize=8, loc="center", bbox_to_anchor=(0.5, 0.58))


def draw_places(friction, moved, line, relative):
    """Mobilised friction of three places of the slip surface, and how far they have moved."""
    for name, distance, colour in zip(("rear", "middle", "front"), PLACES, style.LINES):
        place = int(np.abs(line.columns["distance_m"][0] - distance).argmin())
        friction.plot(relative, line.columns["mobilised_friction_deg"][:, place], color=colour, lw=1.3, label=f"{name}, {distance} m from the rear end")
        moved.plot(relative, line.columns["displacement_m"][:, place], color=colour, lw=1.3, label=name)
    friction.set(xlabel="t* = t / time of failure", ylabel="mobilised friction φ' [deg]", title="three places of the slip surface (paper's fig. 14)", xlim=(0.6, 1.2),
                 ylim=(0, None))
    moved.set(xlabel="t* = t / time of failure", ylabel="displacement [m]", title="displacement of the three places", xlim=(0.6, 1.2), ylim=(0, None))
    friction.legend(fontsize=8, loc="lower right")
    moved.legend(fontsize=8, loc="upper left", bbox_to_anchor=(0.0, 0.9))


def draw_paths(history, relative):
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 3.8), layout="constrained")
    shown = relative >= 0
    for axis, point in zip(axes, ("P2", "below_toe")):
        p, q = (history[f"{point}_{name}_Pa"][shown] / 1e3 for name in ("mean_pressure", "deviator"))
        failed = relative[shown] >= 1
        axis.plot(p[~failed], q[~failed], color=style.LINES[0], lw=1.3, label="before failure")
        axis.plot(p[failed], q[failed], color=style.LINES[1], lw=0.9, label="slide")
        for letter, k in (("A", 0), ("B", int(np.argmax(failed))), ("C", -1)):
            axis.annotate(letter, (p[k], q[k]), xytext=(4, 4), textcoords="offset points", fontweight="bold")
        for strength, angle, cohesion, dash in (("peak", 24.5, 13, "--"), ("residual", 13.5, 4.7, ":")) if point == "P2" else (("peak", 26, 25, "--"), ("residual", 15, 1, ":")):
            s, c = np.sin(np.radians(angle)), np.cos(np.radians(angle))
            along = np.linspace(0, max(1, p.max()), 2)
            axis.plot(along, 6 * (s * along + cohesion * c) / (3 - s), dash, color=style.SOFT, lw=0.9, label=f"{strength}, triaxial compression")
        axis.set(xlabel="mean effective stress p' [kPa]", ylabel="deviator q [kPa]", title=point.replace("_", " "), ylim=(0, None))
    axes[0].legend(fontsize=7.5)
    save(figure, "paths")


def draw_inclinometers(lines, results):
    """Level displacement since the end of gravity, at which it is set to 0: as it is in the file, since the row at t* = 0, written before that, still has
    what gravity moved."""
    figure, axes = plt.subplots(1, len(lines), figsize=(11.5, 3.8), layout="constrained", sharex=True, sharey=True)
    for axis, line in zip(axes, lines):
        relative = dimensionless(results, line.time)
        for t, colour in ((0.65, style.LINES[0]), (0.95, style.LINES[4]), (1, style.LINES[1])):
            row = int(np.nanargmin(np.abs(relative - t)))
            axis.plot(1e3 * line.columns["displacement_x_m"][row], line.columns["y_m"][0], color=colour, lw=1.3, label=f"t* = {relative[row]:.3f}")
        axis.set(title=f"{line.name}, x = {line.columns['x_m'][0].mean():.0f} m", xlabel="level displacement since gravity [mm]")
    axes[0].set(ylabel="elevation [m]", xlim=(0, None))
    axes[-1].legend(fontsize=8, loc="upper right")
    save(figure, "inclinometers")
