"""Stress paths of the named points, with the strength of the soil they are in."""

import csv

import matplotlib.pyplot as plt
import numpy as np

import talus_style as style
from talus_histories import time_axis
from talus_measures import failure
from talus_units import at_time, readable_unit, words

ENVELOPES = 4  # suctions for which the strength is drawn


def strength_of(folder):
    """{body: [(state, suction, slope, intercept)]} of strength.csv, which the program writes; empty without it."""
    path, lines = folder / "strength.csv", {}
    if path.exists():
        with open(path, newline="") as file:
            for row in csv.DictReader(file):
                lines.setdefault(row["body"], []).append((row["state"], *(float(row[key]) for key in ("suction_Pa", "slope", "intercept_Pa"))))
    return lines


def paths_of(history):
    """{point: {quantity: values over time}} of the points in history.csv whose stress is known."""
    quantities = {"p": "mean_pressure_Pa", "q": "deviator_Pa", "suction": "suction_Pa", "friction": "mobilised_friction_deg"}
    points = [name[: -len("_deviator_Pa")] for name in history.columns if name.endswith("_deviator_Pa")] if history else []
    paths = {point: {key: history.columns.get(f"{point}_{column}", 0 * history.time) for key, column in quantities.items()} for point in points}
    return {point: path for point, path in paths.items() if np.isfinite(path["q"]).sum() > 2}


def bodies_of(results, points):
    """{point: name of the soil that it is in}, that of the nearest particle at the start."""
    first = results.snapshots[0]
    position, places = first.position(), results.history.points(first.time)
    return {point: results.bodies[first.body()[np.linalg.norm(position - places[point], axis=1).argmin()]] for point in points if len(position)}


def nearest_lines(lines, suctions):
    """Of the lines of a soil those at some suctions between the least and the largest that its points had."""
    known = np.array(sorted({suction for _, suction, _, _ in lines}))
    wanted = np.linspace(np.nanmin(suctions), np.nanmax(suctions), ENVELOPES)
    chosen = {known[np.abs(known - suction).argmin()] for suction in (0, *wanted)}
    return [line for line in lines if line[1] in chosen]


def time_of_failure(results):
    """When the watched point failed [s]; infinite where none did."""
    try:
        return failure(results)[0]
    except (LookupError, OSError):
        return np.inf


def label_of(name, time, known):
    """The name of a point, with the time from which on there is no soil at it, if its path ends before the run."""
    last = np.flatnonzero(np.isfinite(known))[-1]
    return words(name) if last == len(known) - 1 else f"{words(name)}, no stress after {at_time(time[last], time[-1])}"


def spread(heights, gap, top):
    """Heights of labels in the order of those of their lines, apart by `gap` at least and none above `top`."""
    placed = np.sort(np.minimum(heights, top))
    for k in range(1, len(placed)):
        placed[k] = max(placed[k], placed[k - 1] + gap)
    for k in range(len(placed) - 1, -1, -1):
        placed[k] = min(placed[k], top if k == len(placed) - 1 else placed[k + 1] - gap)
    found = np.empty(len(placed))
    found[np.argsort(heights, kind="stable")] = placed
    return found


def label_place(at, height, slope, y):
    """Where the lower right corner of a label stands that shall be at the height `y`, of a line through (at, height): on the line, which rises to the right
    and so leaves the label alone, and never below it."""
    if slope <= 0:
        return at, max(y, height)
    return (at, height) if y > height else (at - (height - y) / slope, y)


def draw_stress_paths(results, folder):
    """stress_paths.png: deviator over mean effective stress with the strength in triaxial compression, and mobilised friction over time.
    Returns [("stress paths", path)]; nothing without named points or with fewer than three rows of the history."""
    paths = paths_of(results.history)
    if not paths:
        return []
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.4, 4.4), layout="constrained")
    time, failed = results.history.time, time_of_failure(results)
    largest = max(np.nanmax(np.abs([path["p"], path["q"]])) for path in paths.values())
    factor, unit = readable_unit(largest, "Pa")
    lowest, highest = 0.0, 0.0
    for k, (name, path) in enumerate(paths.items()):
        p, q = factor * path["p"], factor * path["q"]
        line = {"color": style.LINES[k % len(style.LINES)], "ls": ("-", "--", ":")[k // len(style.LINES) % 3], "label": label_of(name, time, q)}
        known = np.flatnonzero(np.isfinite(q))
        after = time > failed
        left.plot(p[~after], q[~after], lw=1.2, **line)
        left.plot(p[known[0]], q[known[0]], "o", color=line["color"], ms=4.5, mfc="white", clip_on=False, zorder=3)
        if after[known].any():  # in motion the stress jumps from row to row
            first = max(int(after.argmax()) - 1, 0)
            left.plot(p[first:], q[first:], lw=0.6, alpha=0.5, **line)
            left.plot(p[first], q[first], "D", color=line["color"], ms=4.5)
        left.plot(p[known[-1]], q[known[-1]], "o", color=line["color"], ms=4.5, clip_on=False, zorder=3)
        right.plot(time, path["friction"], lw=1.1, **line)
        lowest, highest = min(lowest, np.nanmin(p)), max(highest, np.nanmax(p))
    reach = np.array([lowest, 1.08 * highest + 1e-9])
    top = left.get_ylim()[1]
    bodies, labels = bodies_of(results, paths), []
    for body, lines in strength_of(folder).items():
        mine = [path["suction"] for name, path in paths.items() if bodies.get(name) == body]
        for state, suction, slope, intercept in nearest_lines(lines, np.concatenate(mine)) if mine else ():
            height = slope * reach + factor * intercept
            if height[0] > 1.3 * top:
                continue  # above all that is shown
            left.plot(reach, height, color=style.SOFT, lw=0.8, ls="-" if state == "peak" else ":")
            size, of = readable_unit(suction, "Pa")
            parts = [body] * (len(results.bodies) > 1) + [state] * (len({line[0] for line in lines}) > 1) + [f"s = {size * suction:g} {of}"] * (len({line[1] for line in lines}) > 1)
            at = reach[1] if height[1] < 1.3 * top else np.interp(1.25 * top, height, reach)
            labels.append((", ".join(parts) or "strength", at, slope * at + factor * intercept, slope))
    for (text, at, height, slope), y in zip(labels, spread(np.array([height for _, _, height, _ in labels]), 0.055 * top, 1.27 * top)):
        x, y = label_place(at, height, slope, y)
        leader = {"arrowstyle": "-", "lw": 0.4, "color": style.SOFT, "shrinkA": 0, "shrinkB": 0} if slope <= 0 and y - height > 0.02 * top else None
        left.annotate(text, (at, height), (x - 0.012 * np.ptp(reach), y + 0.012 * top), fontsize=7, color=style.SOFT, ha="right", va="bottom",
                      arrowprops=leader, bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.3})
    left.set(xlabel=f"mean effective stress p' [{unit}]", ylabel=f"q [{unit}]", xlim=reach, ylim=(0, 1.35 * top))
    said = ["open: start", "full: end", "diamond: failure, thin after it" * np.isfinite(failed), "grey: strength in triaxial compression" * bool(labels)]
    left.set_title("; ".join(filter(None, said)), loc="left", fontsize=7.5, color=style.SOFT)
    time_axis(right, time[-1])
    right.set(ylabel="mobilised friction angle [deg]", xlim=(time[0], time[-1]))
    if np.isfinite(failed):
        right.axvline(failed, color=style.FAINT, lw=0.8, zorder=0.5)
        right.annotate("failure", (failed, 1.01), xycoords=("data", "axes fraction"), ha="center", fontsize=7.5, color=style.SOFT)
    if not any(np.isfinite(path["friction"]).any() for path in paths.values()):
        right.text(0.5, 0.5, "without a friction angle none is mobilised", transform=right.transAxes, ha="center", color=style.SOFT)
    right.set_ylim(bottom=0)
    right.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1), ncols=1 + len(paths) // 20)
    style.headline(figure, "Stress paths of the named points", results.title)
    return [("stress paths", style.save(figure, folder / "stress_paths.png"))]
