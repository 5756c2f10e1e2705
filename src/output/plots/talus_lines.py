"""Lines that were followed with the soil, line_NAME.csv: what they show at some times, and their average strength over time."""

import csv

import matplotlib.pyplot as plt
import numpy as np

import talus_style as style
from talus_histories import time_axis
from talus_measures import failure
from talus_moments import after, last_reset, since
from talus_units import at_time, capital, of_length, readable_unit, with_unit, words

COUNT = 6  # times that a picture shows
UPRIGHT = 0.2  # a line whose width is less than this share of its height is drawn over elevation, as inclinometers are
SPAN = plt.get_cmap("viridis")


def means(line):
    """Averages along the line over time, and the shares of its places that are in each state."""
    found = {"displacement_m": mean(line["displacement_m"])}
    for name in ("mobilised_friction_deg", "mean_pressure_Pa", "deviator_Pa", "pore_pressure_Pa", "plastic_strain"):
        if name in line.columns:
            found["mean_" + name] = mean(line[name])
    if "state" in line.columns:
        for number, state in enumerate(style.STATES):
            found[f"share_{state}"] = np.mean(line["state"] == number, axis=1)
    return found


def mean(values):
    """Mean over the places that have a value; NaN where none has."""
    known = np.isfinite(values)
    return np.where(known.any(axis=1), np.where(known, values, 0).sum(axis=1) / np.maximum(known.sum(axis=1), 1), np.nan)


def dimensionless(results, times):
    """t* = t / T of Alonso, Yerro & Pinyol (2015): time since the stage that failed began over the time until it failed; None if none did."""
    try:
        failed = failure(results)[0]
    except LookupError:
        return None
    history = results.history
    first = [k for k, name in enumerate(history.stage) if k and name != history.stage[k - 1] and history.time[k - 1] < failed]
    begin = history.time[first[-1] - 1] if first else 0.0  # the last row of the stage before is that of its end
    return (times - begin) / (failed - begin)


def chosen(line, times=None, reset=None):
    """Rows that are shown: those nearest to `times`, else first, last and some between, half by time and half by how far the line moved. Of a line whose
    displacement was reset at a time those after it."""
    if times:
        return sorted({int(np.abs(line.time - time).argmin()) for time in times})
    later = after(reset, line.time)
    time, moved = line.time[later], means(line)["displacement_m"][later]
    travel = np.concatenate([[0], np.abs(np.diff(moved)).cumsum()])
    pace = sum((part / part[-1] for part in (time - time[0], travel) if part[-1] > 0), np.zeros(len(time)))
    return sorted({int(later[np.abs(pace - share).argmin()]) for share in np.linspace(0, pace[-1], COUNT)})


def under_stress(line, rows):
    """Of these rows those from the end of the first stage on, in which gravity grows from 0: before it there is no stress whose friction could be mobilised.
    At least the last one; without further stages those in which some is."""
    stages = [name for name in line.stage if name != "start"]
    first = [k for k, name in enumerate(line.stage) if stages and name == stages[0]][-1:]
    if first and first[0] < len(line.time) - 1:
        return [row for row in rows if row >= first[0]] or rows[-1:]
    return [row for row in rows if np.any(np.nan_to_num(line.columns["mobilised_friction_deg"][row]))]


def draw_lines(results, folder, times=None):
    """line_NAME.png and NAME's averages, line_NAME_mean.csv, of each followed line. Returns [("line NAME", path)]."""
    pictures = []
    for line in results.lines().values():
        if len(line.time) < 2:
            continue
        folder.mkdir(exist_ok=True)
        write_means(results, line, folder / f"line_{line.name}_mean.csv")
        pictures.append((f"line {line.name}", draw_line(results, line, folder / f"line_{line.name}.png", times)))
    return pictures


def write_means(results, line, path):
    columns = {"time_s": line.time} | means(line)
    relative = dimensionless(results, line.time)
    if relative is not None:
        columns["time_over_time_to_failure"] = relative
    with open(path, "w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(columns)
        rows.writerows([f"{value:.7g}" for value in row] for row in zip(*columns.values()))


def draw_line(results, line, path, times):
    reset = last_reset(results)
    rows = chosen(line, times, reset)
    later = [bool(reset) and line.time[row] > reset[0] for row in rows]
    mixed = any(later[k] != later[0] for k in range(len(rows)) if rows[k] > 0)
    frictional = "mobilised_friction_deg" in line.columns and np.isfinite(line.columns["mobilised_friction_deg"]).any()
    figure, axes = plt.subplots(1, 3 if frictional else 1, figsize=(13.2 if frictional else 6.0, 4.3), squeeze=False, layout="constrained")
    moved, start = line.moved(), [line.columns[f"{axis}_m"][0] for axis in "xyz" if f"{axis}_m" in line.columns]
    up = results.up_axis()
    level = np.linalg.norm([np.ptp(x) for axis, x in enumerate(start) if axis != up])
    upright = level < UPRIGHT * np.ptp(start[up])
    where = start[up] if upright else line.columns["distance_m"][0]
    size = np.linalg.norm(np.delete(moved, up, axis=2) if upright else moved, axis=2)
    factor, unit = readable_unit(np.nanmax(size[rows]), "m")
    stressed = under_stress(line, rows) if frictional else []
    for k, row in enumerate(rows):
        colour = SPAN(k / max(1, len(rows) - 1) * 0.92)
        label = f"{at_time(line.time[row], line.time[-1])}  {line.stage[row]}" + mixed * f", {since(reset[1] if later[k] else '')}"
        show(axes[0, 0], where, factor * size[row], upright, color=colour, lw=1.4, label=label)
        if frictional and row in stressed:
            show(axes[0, 1], where, line.columns["mobilised_friction_deg"][row], upright, color=colour, lw=1.0)
            mark_states(axes[0, 1], where, line, row, upright)
    along = of_length("elevation" if upright else "distance along the line")
    name(axes[0, 0], along, with_unit("size of level displacement" if upright else "displacement", unit), upright)
    for panel in axes[0, :2]:
        style.places(panel.yaxis if upright else panel.xaxis)
    if later[-1] and not mixed:
        axes[0, 0].set_title(f"since the end of stage {reset[1]}", loc="left", fontsize=7.5, color=style.SOFT)
    if frictional:
        name(axes[0, 1], along, "mobilised friction angle [deg]", upright)
        axes[0, 1].set_title("white elastic, yellow peak, orange softening, red residual", loc="left", fontsize=7.5, color=style.SOFT)
        draw_mean(results, line, axes[0, 2], after(None if times else reset, line.time))
    style.headline(figure, capital(words(line.name)), results.title)
    style.legend_below(figure, axes[0, 0].get_legend_handles_labels()[0], None if frictional else 3)  # beside curves that may run anywhere
    return style.save(figure, path)


def show(axes, where, values, upright, **options):
    axes.plot(*((values, where) if upright else (where, values)), **options)


def mark_states(axes, where, line, row, upright):
    state = line.columns["state"][row]
    known = np.isfinite(state)
    colours = [("white", *style.STATE_COLOURS[1:])[int(number)] for number in state[known]]
    x, y = where[known], line.columns["mobilised_friction_deg"][row][known]
    axes.scatter(*((y, x) if upright else (x, y)), c=colours, s=14, edgecolors=style.INK, linewidths=0.4, zorder=3)


def name(axes, along, what, upright):
    axes.set(xlabel=what, ylabel=along) if upright else axes.set(xlabel=along, ylabel=what)


def draw_mean(results, line, axes, rows):
    """Average mobilised friction over the times of these rows, with t* above it where something failed."""
    relative = dimensionless(results, line.time)
    axes.plot(line.time[rows], means(line)["mean_mobilised_friction_deg"][rows], color=style.ACCENT, lw=1.4)
    time_axis(axes, line.time[-1], line.time[rows[0]] if rows[0] else 0.0)
    axes.set(ylabel="mean mobilised friction angle [deg]")
    axes.set_ylim(bottom=0)
    if relative is not None:
        start, scale = np.interp(0, relative, line.time), np.ptp(line.time) / np.ptp(relative)
        above = axes.secondary_xaxis("top", functions=(lambda t: (t - start) / scale, lambda r: start + scale * r))
        above.set_xlabel("t* = time / time to failure", fontsize=8)
