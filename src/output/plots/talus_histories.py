"""Curves over time: named points, energies, whatever else history.csv holds."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FixedLocator, MaxNLocator

import talus_style as style
from talus_modelled import read_model
from talus_moments import RESET, after, last_reset
from talus_results import together
from talus_units import at_time, capital, clock, readable_unit, with_unit, words

# coordinates, stress and state of points: sections and stress paths show them better; the clock of the loads says nothing as a curve
ELSEWHERE = ("load_time", "x", "y", "z", "mean_pressure", "deviator", "mobilised_friction", "state")
GROUND = "ground_acceleration"  # its velocity and displacement are columns of history.csv, and no pictures
BESIDE_GROUND = ("displacement", "velocity")  # drawn below the acceleration of the ground
OF_ALL_SOIL = ("J", "W", "N", "kg", "kg m/s")


def draw_histories(results, folder):
    """history_QUANTITY.png of each group of columns that varies, and energy.png. Returns [(quantity, path)]."""
    whole = results.history
    if whole is None or len(whole.time) < 2:
        return []
    pictures, reset = [], last_reset(results)
    since = whole.rows(after(reset, whole.time)) if reset else whole
    same = {names[0]: names for names in together({name: whole.way(name) for name in whole.points(0.0)})}
    others = {name for names in same.values() for name in names[1:]}
    for (quantity, unit), lines in whole.groups().items():
        history = since if quantity in RESET else whole  # what is set to 0 begins there, so that the settlement before does not set the scale
        lines = {", ".join(same.get(name, [name])): values for name, values in history.groups()[quantity, unit].items() if name not in others}
        lines = {name: values for name, values in lines.items() if np.isfinite(values).any()}  # others are points that have had no soil
        if quantity in ELSEWHERE or quantity.startswith(("stress_", "ground_")) or quantity.endswith(("_x", "_y", "_z")) or not any(changes(values) for values in lines.values()):
            continue
        if quantity == "energy":
            if "potential" in lines:
                lines = lines | {"potential": lines["potential"] + potential_that_left(results, history.time)}
            pictures.append((quantity, draw_energy(history, lines, results.title, results.per_metre(""), folder / "energy.png")))
        elif quantity.endswith("_ledger"):
            begin, ramp = end_of_dry_ramp(results.scene, history)
            shown = history.rows(range(begin, len(history.time)))
            pictures.append((quantity, draw_ledger(shown, quantity, {name: values[begin:] for name, values in lines.items()}, results.title,
                                                   results.per_metre(""), folder / f"{quantity}.png", ramp)))
        else:
            path = folder / f"history_{quantity}.png"
            pictures.append((quantity, draw_curves(history, quantity, unit, lines, results.title, results.per_metre(""), path, base_friction(results.scene, quantity),
                                                  reset[1] if reset and history.time[0] > reset[0] else "", ground_of(history) if quantity in BESIDE_GROUND else {})))
    return pictures


def ground_of(history):
    """The components of the acceleration of the ground that vary [m/s2]."""
    of_ground = [lines for (quantity, _), lines in history.groups().items() if quantity == GROUND]
    return {axis: values for lines in of_ground for axis, values in lines.items() if changes(values)}


def changes(values):
    """Does a column vary? What is not known counts as nothing."""
    known = values[np.isfinite(values)]
    return known.size > 0 and np.ptp(known) > 1e-9 * np.abs(known).max()


def base_friction(scene, quantity):
    """tan phi of the base NAME whose history is NAME_friction, if its friction angle is a constant and it has no adhesion; else None."""
    name, _, what = quantity.rpartition("_")
    base = scene.get("boundary", {}).get(name, {})
    angle = base.get("friction_angle") if what == "friction" and not base.get("adhesion") else None
    try:
        return float(np.tan(np.radians(float(angle.removesuffix("deg") if isinstance(angle, str) else angle))))
    except (TypeError, ValueError):
        return None


def draw_curves(history, quantity, unit, lines, title, per, path, tan_phi=None, reset="", ground=None):
    """`reset` is the stage at whose end the quantity was last set to 0, `ground` the acceleration of the ground [m/s2], which is drawn above."""
    if ground:
        figure, (above, axes) = plt.subplots(2, 1, sharex=True, figsize=(7.6, 5.1), gridspec_kw={"height_ratios": [1, 2.2]})
        plot_lines(above, history, ground, "m/s²", "ground", per, style.INK if len(ground) == 1 else None)
    else:
        figure, axes = plt.subplots(figsize=(7.6, 3.7))
    plot_lines(axes, history, lines, unit, words(quantity), per)
    if tan_phi is not None:
        axes.axhline(tan_phi, color=style.SOFT, lw=0.9, ls=(0, (4, 2)), zorder=1)
        axes.annotate(f"tan φ = {tan_phi:.3g}", (1.01, tan_phi), xycoords=("axes fraction", "data"), fontsize=8, color=style.SOFT, va="center")
    if reset:
        figure.text(0.985, 0.1 / figure.get_figheight(), f"since the end of stage {reset}", fontsize=7.5, color=style.SOFT, ha="right")
    return finish(figure, [above, axes] if ground else [axes], history, capital(words(quantity)), title, path)


def draw_energy(history, lines, title, per, path):
    """All energies that vary, and below them the kinetic one alone: it is the smallest and tells most."""
    lines = drawn_energies(lines)
    kinetic = {name: values for name, values in lines.items() if "kinetic" in name}
    if not kinetic or len(lines) == len(kinetic):
        return draw_curves(history, "energy", "J", lines, title, per, path)
    shape = {"figsize": (7.6, 4.9), "gridspec_kw": {"height_ratios": [3, 1.4]}}
    figure, (upper, lower) = plt.subplots(2, 1, sharex=True, **shape)
    plot_lines(upper, history, lines, "J", "energy", per)
    colour = style.LINES[list(lines).index(next(iter(kinetic))) % len(style.LINES)]
    plot_lines(lower, history, kinetic, "J", "kinetic", per, colour)
    return finish(figure, [upper, lower], history, "Energy", title, path)


def potential_that_left(results, times):
    """Potential energy [J] that particles had where they left the mesh, of those gone by each time: without it the curve falls by their weight times their
    height above wherever the axes begin."""
    model = results.escaped and read_model(results.folder)
    if not model:
        return np.zeros(len(times))
    escaped, gravity = results.escaped, np.array(model.data["gravity"])
    mass = sum(values for name, values in escaped.columns.items() if name.endswith("_kg"))
    energies = np.append(0, np.cumsum(-mass * (escaped.position @ gravity[:escaped.position.shape[1]])))
    return energies[np.searchsorted(escaped.time, times, side="right")]


def drawn_energies(lines):
    """The energies that vary. Of the potential energy it is the change since the start: its zero is where the axes happen to begin, and the
    weight of all soil times its height would flatten all other curves."""
    lines = {name: values for name, values in lines.items() if changes(values)}
    names = {"potential": "Δ potential", "dissipated": "dissipated\n(remainder)"}  # what the balance leaves, theory (6.6)
    return {names.get(name, name): values - values[0] if name == "potential" else values for name, values in lines.items()}


def end_of_dry_ramp(scene, history):
    """Row and name of the stage in which gravity grew while no water flowed; 0 and "" without one. Suction grows with gravity there, theory (5.3), so that the
    pores begin full, and the water that the ramp takes from them would be larger than all that comes in later."""
    ramps = [stage.get("name") for stage in scene.get("stage", []) if stage.get("gravity_ramp") and not stage.get("pore_flow", True)]
    rows = [k for k, name in enumerate(history.stage) if name in ramps]
    return (rows[-1], history.stage[rows[-1]]) if rows and rows[-1] < len(history.time) - 2 else (0, "")


def draw_ledger(history, quantity, lines, title, per, path, ramp=""):
    """What has been gained, what has come in through boundaries and what was given, since the first row, and below the error of the sum. `ramp` is the stage
    that ends with this row."""
    since = {name: values - values[0] for name, values in lines.items()}
    gains = {"gained": since["stored"], "came in": -since["out"], "was given": since["given"]}
    if "escaped" in lines:
        gains["left with soil"] = since["escaped"]
    gains = {name: values for name, values in gains.items() if np.ptp(values) > 0}
    figure, (upper, lower) = plt.subplots(2, 1, sharex=True, figsize=(7.6, 4.9), gridspec_kw={"height_ratios": [3, 1.4]})
    plot_lines(upper, history, gains or {"gained": 0 * history.time}, "kg", "mass", per)
    plot_lines(lower, history, {"error": lines["error"]}, "kg", "error", per, style.INK)
    if ramp:
        figure.text(0.985, 0.1 / figure.get_figheight(), f"since the end of stage {ramp}", fontsize=7.5, color=style.SOFT, ha="right")
    return finish(figure, [upper, lower], history, capital(words(quantity)), title, path)


def plot_lines(axes, history, lines, unit, what, per, colour=None):
    """`per` is "/m" in plane strain, where forces, energies and masses are those of a metre of the slope."""
    largest = max(np.nanmax(np.abs(values)) for values in lines.values())
    factor, shown = readable_unit(largest, unit + per if unit in OF_ALL_SOIL else unit)
    for k, (name, values) in enumerate(lines.items()):
        axes.plot(history.time, factor * values, linewidth=1.5, color=colour or style.LINES[k % len(style.LINES)],
                  linestyle=("-", "--", ":")[k // len(style.LINES) % 3], label=words(name))
    axes.set_ylabel(with_unit(what, shown))
    axes.grid(axis="y", color=style.FAINT, linewidth=0.5)
    axes.set_axisbelow(True)
    axes.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
    axes.margins(x=0.01)
    if colour is None and any(lines):
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), fontsize=8, handlelength=1.6)


def time_axis(axes, last, first=0.0):
    """Names the axis of time, and counts it in days for a run of days; of its last seconds, from `first` on, in seconds since then. Curves are drawn over
    seconds."""
    size, name = clock(last)
    short = last - first < size
    axes.set_xlabel(f"time since {at_time(first, last)} [s]" if short and size != 1 else f"time [{name}]")
    if size != 1:
        start, size = (first, 1.0) if short else (0.0, size)
        axes.xaxis.set_major_locator(FixedLocator(start + size * MaxNLocator(8, steps=[1, 2, 5, 10]).tick_values((first - start) / size, (last - start) / size)))
        axes.xaxis.set_major_formatter(lambda time, _: f"{(time - start) / size:g}")


def mark_stages(axes, history, named):
    """Bands for the stages, with their names above the uppermost axes."""
    starts = history.stage_starts()
    ends = [time for time, _ in starts[1:]] + [history.time[-1]]
    whole = ends[-1] - starts[0][0]
    for k, ((start, name), end) in enumerate(zip(starts, ends)):
        if k % 2:
            axes.axvspan(start, end, color="#f1f3f5", zorder=0, linewidth=0)
        if k:
            axes.axvline(start, color=style.FAINT, linewidth=0.8, zorder=0.5)
        if named and end - start > 0.06 * whole:
            axes.annotate(name, ((start + end) / 2, 1.02), xycoords=("data", "axes fraction"), ha="center", va="bottom",
                          fontsize=8, color=style.SOFT)


def finish(figure, axes, history, headline, title, path):
    for k, one in enumerate(axes):
        mark_stages(one, history, named=k == 0)
    time_axis(axes[-1], history.time[-1], history.time[0])
    height = figure.get_figheight()
    figure.subplots_adjust(left=0.1, right=0.82, bottom=0.48 / height, top=1 - 0.72 / height, hspace=0.12)
    figure.text(0.1, 1 - 0.24 / height, headline, fontsize=12, fontweight="bold", va="center")
    figure.text(0.985, 1 - 0.24 / height, title, fontsize=8, color=style.SOFT, va="center", ha="right")
    return style.save(figure, path)
