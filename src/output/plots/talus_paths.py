"""Stress paths of the named points, with the strength of the soil they are in."""

import csv

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patheffects import withStroke

import talus_style as style
from talus_histories import time_axis
from talus_measures import failure
from talus_results import together
from talus_units import at_time, readable_unit, words

ENVELOPES = 4  # suctions for which the strength is drawn
LINE = 0.055  # height of a line of small letters over that of the chart of paths


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


def name_of_mean_stress(results):
    """What the mean stress of the history is. By theory (2.10) it is net stress where the pores have suction, unless the scene asks for Bishop's."""
    suction = any(name.endswith("_suction_Pa") for name in results.history.columns)
    net = suction and results.scene.get("water", {}).get("stress", "net") == "net"
    return "mean stress p', effective, and net where there is suction" if net else "mean effective stress p'"


def label_of(name, time, known):
    """The name of a point, with the time from which on there is no soil at it, if its path ends before the run."""
    last = np.flatnonzero(np.isfinite(known))[-1]
    return words(name) if last == len(known) - 1 else f"{words(name)}, no stress after {at_time(time[last], time[-1])}"


def grouped(lines, near):
    """Lines (start of the label, its end, height, slope) that are nearer to each other than `near` at the place of their labels have one label, above the
    highest of them. Returns [(text, number of the highest)]."""
    order, groups = sorted(range(len(lines)), key=lambda k: -lines[k][2]), []
    for k in order:
        if groups and lines[groups[-1][-1]][2] - lines[k][2] < near:
            groups[-1].append(k)
        else:
            groups.append([k])
    found = []
    for group in groups:
        ends = {}
        for k in reversed(group):
            ends.setdefault(lines[k][0], []).append(lines[k][1])
        found.append(("; ".join(", ".join(filter(None, [start, ", ".join(filter(None, several))])) for start, several in ends.items()) or "strength", group[0]))
    return found


def name_envelopes(axes, lines):
    """Names of the envelopes along them, at the end where they leave the chart: (start of the label, its end, slope, intercept) each."""
    (left, right), (_, top) = axes.get_xlim(), axes.get_ylim()
    least = min((0.97 * top - intercept) / slope if slope > 0 else right for _, _, slope, intercept in lines)
    where = float(np.clip(least, left + 0.3 * (right - left), right))  # at which all are seen, as far as they are
    sizes = [(start, end, slope * where + intercept, slope) for start, end, slope, intercept in lines]
    for text, k in grouped(sizes, LINE * top):
        _, _, slope, intercept = lines[k]
        at = min(right - 0.01 * (right - left), (0.97 * top - intercept) / slope if slope > 0 else right)
        axes.text(at, slope * at + intercept, text, rotation=np.degrees(np.arctan(slope)), rotation_mode="anchor", transform_rotates_text=True, fontsize=7,
                  color=style.SOFT, ha="right", va="bottom", zorder=4, path_effects=[withStroke(linewidth=2, foreground="white")])


def draw_stress_paths(results, folder):
    """stress_paths.png: deviator over mean effective or net stress with the strength in triaxial compression, and mobilised friction over time.
    Returns [("stress paths", path)]; nothing without named points or with fewer than three rows of the history."""
    paths = paths_of(results.history)
    if not paths:
        return []
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.4, 4.4), layout="constrained")
    time, failed = results.history.time, time_of_failure(results)
    largest = max(np.nanmax(np.abs([path["p"], path["q"]])) for path in paths.values())
    factor, unit = readable_unit(largest, "Pa")
    lowest, highest = 0.0, 0.0
    same = together({name: results.history.way(name) for name in paths})
    for k, names in enumerate(same):
        path = paths[names[0]]
        p, q = factor * path["p"], factor * path["q"]
        line = {"color": style.LINES[k % len(style.LINES)], "ls": ("-", "--", ":")[k // len(style.LINES) % 3], "label": label_of(", ".join(names), time, q)}
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
            start = ", ".join([body] * (len(results.bodies) > 1) + [state] * (len({line[0] for line in lines}) > 1))
            labels.append((start, f"s = {size * suction:g} {of}" if len({line[1] for line in lines}) > 1 else "", slope, factor * intercept))
    left.set(xlabel=f"{name_of_mean_stress(results)} [{unit}]", ylabel=f"q [{unit}]", xlim=reach, ylim=(0, 1.35 * top))
    if labels:
        name_envelopes(left, labels)
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
    right.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1), ncols=1 + len(same) // 20)
    style.headline(figure, "Stress paths of the named points", results.title)
    return [("stress paths", style.save(figure, folder / "stress_paths.png"))]
