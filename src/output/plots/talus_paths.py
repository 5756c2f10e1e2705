"""Stress paths of the named points, with the strength of the soil they are in."""

import csv

import matplotlib.pyplot as plt
import numpy as np

import talus_style as style
from talus_results import invariants, mobilised_friction

MOST = 8  # points in a picture
ENVELOPES = 4  # suctions for which the strength is drawn


def strength_of(folder):
    """{body: [(state, suction, slope, intercept)]} of strength.csv, which the program writes; empty without it."""
    path, lines = folder / "strength.csv", {}
    if path.exists():
        with open(path, newline="") as file:
            for row in csv.DictReader(file):
                lines.setdefault(row["body"], []).append((row["state"], *(float(row[key]) for key in ("suction_Pa", "slope", "intercept_Pa"))))
    return lines


def paths_of(results):
    """{point: (body, times, stress [times, components], suction [times])} of the snapshots that have the point's particle."""
    first = results.snapshots[0]
    if results.history is None or "stress" not in first or not len(first.position()):
        return {}
    position, paths = first.position(), {}
    for name, place in list(results.history.points(first.time).items())[:MOST]:
        followed = first.ids()[np.linalg.norm(position - place, axis=1).argmin()]
        body, times, stress, suction = None, [], [], []
        for snapshot in results.snapshots:
            row = np.searchsorted(snapshot.ids(), followed)
            if row == len(snapshot.ids()) or snapshot.ids()[row] != followed:
                continue
            body = results.bodies[snapshot.body()[row]]
            times.append(snapshot.time)
            stress.append(snapshot.column("stress").values[row])
            suction.append(snapshot.column("suction").values[row, 0] if "suction" in snapshot else 0.0)
        paths[name] = (body, np.array(times), np.array(stress), np.array(suction))
    return paths


def nearest_lines(lines, suctions):
    """Of the lines of a soil those at some suctions between the least and the largest that its points had."""
    known = np.array(sorted({suction for _, suction, _, _ in lines}))
    wanted = np.linspace(suctions.min(), suctions.max(), ENVELOPES)
    chosen = {known[np.abs(known - suction).argmin()] for suction in (0, *wanted)}
    return [line for line in lines if line[1] in chosen]


def draw_stress_paths(results, folder):
    """stress_paths.png: deviator over mean effective stress with the strength in triaxial compression, and mobilised friction over time.
    Returns [("stress paths", path)]; nothing without named points or with fewer than three snapshots."""
    paths = paths_of(results)
    if not paths or max(len(times) for _, times, _, _ in paths.values()) < 3:
        return []
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.4, 4.4))
    tops = [np.abs(np.concatenate(invariants(stress))).max() for _, _, stress, _ in paths.values()]
    factor, unit = style.readable_unit(max(tops), "Pa")
    lowest, highest = 0.0, 0.0
    for k, (name, (_, times, stress, _)) in enumerate(paths.items()):
        p, q = (factor * values for values in invariants(stress))
        colour = style.LINES[k % len(style.LINES)]
        left.plot(p, q, color=colour, lw=1.1, label=style.words(name))
        left.plot(p[0], q[0], "o", color=colour, ms=4.5, mfc="white")
        left.plot(p[-1], q[-1], "o", color=colour, ms=4.5)
        right.plot(times, mobilised_friction(stress), color=colour, lw=1.3, label=style.words(name))
        lowest, highest = min(lowest, p.min()), max(highest, p.max())
    reach = np.array([lowest, 1.08 * highest + 1e-9])
    top = left.get_ylim()[1]
    for body, lines in strength_of(folder).items():
        mine = [suction for owner, _, _, suction in paths.values() if owner == body]
        for state, suction, slope, intercept in nearest_lines(lines, np.concatenate(mine)) if mine else ():
            height = slope * reach + factor * intercept
            if height[0] > 1.3 * top:
                continue  # above all that is shown
            left.plot(reach, height, color=style.SOFT, lw=0.8, ls="-" if state == "peak" else ":")
            size, of = style.readable_unit(suction, "Pa")
            words = [body] * (len(results.bodies) > 1) + [state] * (len({line[0] for line in lines}) > 1) + [f"s = {size * suction:g} {of}"] * (len({line[1] for line in lines}) > 1)
            at = reach[1] if height[1] < 1.3 * top else np.interp(1.25 * top, height, reach)
            left.annotate(", ".join(words) or "strength", (at, slope * at + factor * intercept), fontsize=7, color=style.SOFT, ha="right", va="bottom")
    left.set(xlabel=f"mean effective stress p' [{unit}]", ylabel=f"q [{unit}]", xlim=reach, ylim=(0, 1.35 * top))
    left.set_title("open: first, full: last snapshot; grey: strength in triaxial compression", loc="left", fontsize=7.5, color=style.SOFT)
    right.set(xlabel="time [s]", ylabel="mobilised friction angle [deg]", ylim=(0, 92))
    right.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1))
    figure.suptitle("Stress paths of the named points", x=0.06, ha="left", fontsize=12, fontweight="bold")
    figure.tight_layout()
    return [("stress paths", style.save(figure, folder / "stress_paths.png"))]
