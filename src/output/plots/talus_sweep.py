"""Outcomes of the runs of `talus compare` against the key that it varies: does the slope fail, under which load, how far and how fast does it move?

Reads DIR/runs.csv and the results that it names. Writes DIR/sweep.csv and DIR/sweep.png and prints the table. Exit status: 1 if a run broke off.
"""

import talus_interrupt  # noqa: F401  before all that takes time

import argparse
import csv
import json
import pathlib
import sys
import textwrap

import numpy as np

from talus_outcomes import FAILS, MOVES, STANDS, losses, outcome
from talus_results import Results
import talus_style as style
from talus_style import plt
from talus_table import folded, lines_of
from talus_units import with_unit, words

NO_SLIDE = ("travel_distance_m", "volume_of_slide_m3", "depth_of_slide_m")  # 0 where the slope stands
LEFT_OUT = ("cell_m", "deepest_at_x_m")  # outcomes that no chart shows
UNITS = {"_kg_m_s": "kg m/s", "_m_s2": "m/s²", "_m3_s": "m³/s", "_m_s": "m/s", "_m3": "m³", "_m": "m", "_J": "J", "_Pa": "Pa", "_N": "N", "_kg": "kg", "_K": "K", "_s": "s",
         "_deg": "deg"}  # by the endings of outcomes
MOST = 5  # named points that charts and the table show
INSIDE = 6  # lines whose names have room in their chart
TITLES = {"load_time_of_failure_s": "time t of the loads at failure [s]", "travel_distance_m": "travel distance, from the rear of the slide to its front [m]",
          "volume_of_slide_m3": "volume of the slide [m³]", "moving_volume_m3": "volume that moves [m³]", "depth_of_slide_m": "depth of the slip surface [m]"}


def number(text):
    """The number of a value such as "4.7 kPa"; None of a word."""
    try:
        return float(text.split()[0])
    except (ValueError, IndexError):
        return None


def factor_file(folder, run):
    return folder / run["folder"] / "factor_of_safety.json"


def factor_outcome(path):
    """Of `talus solve --factor-of-safety`. A factor known only as a wide bracket is None."""
    with open(path) as file:
        solved = json.load(file)
    factor = solved["factor_of_safety"]
    return {"factor_of_safety": factor["value"], "factor_with_equilibrium": factor["equilibrium"], "factor_with_mechanism": factor["mechanism"],
            "moving_volume_m3": solved["mechanisms"][0]["moving_volume_m3"]}


def plane(folder, runs):
    """Are the runs sections in plane strain, whose volumes are those of a metre? Of those that have not broken off."""
    ended = next((run for run in runs if not run["failure"]), None)
    return bool(ended) and Results(folder / ended["folder"]).per_metre("") == "/m"


def title_of(outcome, in_plane):
    """An outcome in words, with its unit."""
    title = TITLES.get(outcome)
    return named(outcome, in_plane) if title is None else title.replace("[m³]", "[m³/m]") if in_plane else title


def named(outcome, in_plane):
    """The name of an outcome as its column has it, in words, with its unit."""
    ending = next((ending for ending in UNITS if outcome.endswith(ending)), "")
    title = with_unit(words(outcome.removesuffix(ending)), UNITS[ending]) if ending else words(outcome)
    return title.replace("[m³]", "[m³/m]") if in_plane else title


def outcomes(folder, runs):
    """The runs with what they came to; a run that broke off has none, and a slope that stands a slide of size 0. `runs` are the rows of runs.csv; all their columns but the folder are kept."""
    ended = {run["folder"]: Results(folder / run["folder"]) for run in runs if not run["failure"] and not factor_file(folder, run).exists()}
    rows = []
    for run in runs:
        row = {key: value for key, value in run.items() if key != "folder"}
        if factor_file(folder, run).exists():
            if not run["failure"]:
                row |= factor_outcome(factor_file(folder, run))
        elif run["folder"] in ended:
            results = ended[run["folder"]]
            row |= {key: value for key, value in outcome(results).items() if key != "cell_m"}
            for name, speed in (results.history.groups().get(("velocity", "m/s"), {}) if results.history else {}).items():
                row[f"{name}_largest_speed_m_s"] = float(np.nanmax(speed)) if np.isfinite(speed).any() else None
            if row["state"] == STANDS:
                row |= {name: 0.0 for name in NO_SLIDE}
        rows.append(row)
    return rows


def series_lines(rows):
    """The line to which each row belongs: its series and, where that varies further keys than the last one, their values."""
    further = [row["overrides"].rsplit(f"{row['key']}=", 1)[0].strip() for row in rows]
    several = {row["series"] for row, text in zip(rows, further) if any(one["series"] == row["series"] and other != text for one, other in zip(rows, further))}
    return [f"{row['series']}, {text}" if row["series"] in several else row["series"] for row, text in zip(rows, further)]


def points_of(rows):
    """Names of the points of these runs, and of those MOST that are shown if there are more: evenly from the one that moved farthest to the one that moved
    least."""
    moved = {}
    for row in rows:
        for key, value in row.items():
            if key.endswith("_displacement_m") and key != "largest_displacement_m" and isinstance(value, float):
                name = key[: -len("_displacement_m")]
                moved[name] = max(moved.get(name, 0.0), value)
    order = sorted(moved, key=lambda name: -moved[name])
    shown = {order[k] for k in np.linspace(0, len(order) - 1, MOST).round().astype(int)} if len(order) > MOST else set(order)
    return list(moved), [name for name in moved if name in shown]


def said_of_points(rows):
    """A sentence about points that are left out; empty if there are none."""
    names, shown = points_of(rows)
    if len(shown) == len(names):
        return ""
    return f"Of {len(names)} named points {len(shown)} are shown, evenly from the one that moved farthest to the one that moved least; sweep.csv has all"


def charted(rows, in_plane=False):
    """The outcomes that differ between runs, those of the same kind together: [(title, {label: column})]."""
    points = {"displacement at the end [m]": "_displacement_m", "largest speed [m/s]": "_largest_speed_m_s"}
    known, shown = points_of(rows)
    hidden = {name + ending for name in set(known) - set(shown) for ending in points.values()}
    names = [key for key in dict.fromkeys(key for row in rows for key in row)
             if key not in LEFT_OUT and key not in hidden and any(isinstance(row.get(key), float) for row in rows)]
    charts = []
    for name in names:
        kind = next((title for title, ending in points.items() if name.endswith(ending)), None)
        if kind is None:
            charts.append((title_of(name, in_plane), {"": name}))
        elif any(title == kind for title, _ in charts):
            next(lines for title, lines in charts if title == kind)[words(name[: -len(points[kind])])] = name
        else:
            charts.append((kind, {words(name[: -len(points[kind])]): name}))
    return charts


MARKS = {FAILS: ("o", "full"), MOVES: ("s", "left"), STANDS: ("o", "none"), None: ("X", "full")}  # marker and how it is filled; None: the run broke off
LEGEND = {FAILS: "the slope fails", MOVES: "it moves by less than a cell", STANDS: "it stands", None: "the run broke off"}
NEVER = "at the upper edge: it did not fail by the end"


def mark(axes, x, y, state, colour, never=False):
    """`never`: at the upper edge, whatever y."""
    shape, fill = MARKS[state]
    broken = state is None
    axes.plot(x, y, shape, color=style.SOFT if broken else colour, ms=6 if broken else 4.5, fillstyle=fill, mfc=None if fill != "none" else "white",
              markerfacecoloralt="white", ls="", clip_on=False, zorder=3, transform=axes.get_xaxis_transform() if broken or never else axes.transData)


def never_failed(rows, charts):
    """Runs that have ended without the failure whose load time a chart shows, while others have it."""
    shown = any("load_time_of_failure_s" in of.values() for _, of in charts)
    return [row for row in rows if shown and not row["failure"] and row.get("load_time_of_failure_s") is None and "state" in row]


def draw_charts(axes, rows, charts):
    """The outcomes against the one key that these runs vary. Returns the lines of charts that have no room for their names."""
    numbers = [number(row["value"]) for row in rows]
    choices = list(dict.fromkeys(row["value"] for row in rows))
    numeric = None not in numbers
    place = numbers if numeric else [choices.index(row["value"]) for row in rows]
    line = series_lines(rows)
    series = list(dict.fromkeys(line))
    labels = list(dict.fromkeys(label for _, of in charts if len(of) > 1 for label in of))  # one colour in all charts
    outside = []
    for one, (title, of) in zip(axes, charts):
        for label, column in of.items():
            for n, name in enumerate(series):
                known = sorted((place[i], row[column], row["state"]) for i, row in enumerate(rows) if line[i] == name and row.get(column) is not None)
                if not known:
                    continue
                x, y, _ = zip(*known)
                colour = style.LINES[(labels.index(label) if len(of) > 1 else n) % len(style.LINES)]
                legend = ", ".join(filter(None, (label, name if len(series) > 1 else "")))
                one.plot(x, y, ("-", "--", ":", "-.")[n % 4 if len(of) > 1 else 0], color=colour, lw=1.1, label=legend)
                for a, b, state in known:
                    mark(one, a, b, state, colour)
        for i, (x, row) in enumerate(zip(place, rows)):
            if row["failure"]:
                mark(one, x, 0, None, style.SOFT)
            elif "load_time_of_failure_s" in of.values() and row in never_failed(rows, charts):
                mark(one, x, 1, row["state"], style.LINES[series.index(line[i]) % len(style.LINES)], never=True)
        if any(any(each) for each in (of, series[1:])):
            if len(one.get_legend_handles_labels()[0]) > INSIDE:
                outside += one.get_legend_handles_labels()[0]
            else:
                one.legend(fontsize=7.5)
        one.set_xlabel(textwrap.fill(axis_title(rows), 38, break_on_hyphens=False))
        one.set_ylabel(textwrap.fill(title, 34))
        low, high = one.get_ylim()
        one.set_ylim(min(0, low), high + 0.06 * (high - min(0, low)))
        if numeric and min(place) > 0 and max(place) > 20 * min(place):
            one.set_xscale("log")
            one.set_xlim(min(place) ** 1.05 / max(place) ** 0.05, max(place) ** 1.05 / min(place) ** 0.05)
            style.few_log_ticks(one)
        elif numeric and max(place) > min(place):  # the same for all outcomes, also where few runs have a value
            one.set_xlim(min(place) - 0.05 * (max(place) - min(place)), max(place) + 0.05 * (max(place) - min(place)))
        if not numeric:
            one.set_xlim(-0.05 * (len(choices) - 1) - 0.05, 1.05 * (len(choices) - 1) + 0.05)
            one.set_xticks(range(len(choices)), [textwrap.fill(choice, 14) for choice in choices])
    return outside


def title_of_runs(folder, runs):
    """The title of the scene that all runs vary, of the first of them that left results."""
    return next((Results(folder / run["folder"]).title for run in runs if (folder / run["folder"] / "run.h5").exists()), "")


def draw(rows, path, in_plane=False, title=""):
    """Charts of all outcomes that differ, one row of them or more for each key that is varied. Runs that broke off have no outcome: a cross at the lower
    edge marks their value of the key."""
    parts = [[row for row in rows if row["key"] == key] for key in dict.fromkeys(row["key"] for row in rows)]
    parts = [(part, charted(part, in_plane)) for part in parts]
    parts = [(part, charts) for part, charts in parts if charts]
    columns = min(3, max(len(charts) for _, charts in parts))
    lines = [-(-len(charts) // columns) for _, charts in parts]
    figure, axes = plt.subplots(sum(lines), columns, figsize=(3.9 * columns, 3.1 * sum(lines)), squeeze=False, layout="constrained")
    outside = []
    for n, (part, charts) in enumerate(parts):
        own = axes[sum(lines[:n]):sum(lines[: n + 1])].ravel()
        for one in own[len(charts):]:
            one.remove()
        outside += draw_charts(own, part, charts)
    states = {row.get("state") for row in rows}
    handles = [plt.Line2D([], [], marker=MARKS[state][0], color=style.SOFT, ls="", ms=5, fillstyle=MARKS[state][1], markerfacecoloralt="white",
                          mfc="white" if MARKS[state][1] == "none" else None, label=LEGEND[state]) for state in MARKS if state in states]
    if any(never_failed(part, charts) for part, charts in parts):
        handles.append(plt.Line2D([], [], ls="", label=NEVER))
    keys = dict.fromkeys(words(row["key"].rpartition(".")[2]) for row in rows)
    style.headline(figure, f"Outcomes against {', '.join(filter(None, keys)) or 'the series'}", title)
    if said := said_of_points(rows):
        handles.append(plt.Line2D([], [], ls="", label=said.partition(",")[0]))
    handles += {(one.get_label(), one.get_color(), one.get_linestyle()): one for one in outside}.values()
    style.legend_below(figure, handles, min(len(handles), 2 * columns + 1) if outside else None)
    return style.save(figure, path)


def axis_title(rows):
    """Of runs that vary the same key."""
    units = {" ".join(row["value"].split()[1:]) or row["unit"] for row in rows}
    return with_unit(rows[0]["key"], units.pop() if len(units) == 1 else "")


def table(rows, in_plane=False, width=None):
    """Lines of the table of all runs."""
    columns = [(named(column, in_plane), column) for _, of in charted(rows) for column in of.values()]
    texts, more = [], losses(rows)
    for line, row in zip(series_lines(rows), rows):
        keys = [line, row["value"]]
        texts.append(keys + ([f"broke off: {row['failure']}"] if row["failure"] else
                             [row["state"] if "state" in row else "", *("-" if row.get(column) is None else f"{row[column]:.4g}" for _, column in columns),
                              *(text(row) for text in more.values())]))
    value = words(axis_title(rows).rpartition(".")[2]) if len({row["key"] for row in rows}) == 1 else "value"
    return lines_of(["series", value, "state", *(name for name, _ in columns), *more], texts, 2, width)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--no-plot", action="store_true")
    given = parser.parse_args()
    with open(given.folder / "runs.csv", newline="") as file:
        runs = list(csv.DictReader(file))
    rows, in_plane = outcomes(given.folder, runs), plane(given.folder, runs)
    print("\n".join(table(rows, in_plane)))
    if said := said_of_points(rows):
        print(folded(said))
    names = list(dict.fromkeys(key for row in rows for key in row))
    with open(given.folder / "sweep.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, names, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    ended = [row for row in rows if not row["failure"]]
    if ended and charted(rows) and not given.no_plot:
        draw(rows, given.folder / "sweep.png", in_plane, title_of_runs(given.folder, runs))
    else:
        (given.folder / "sweep.png").unlink(missing_ok=True)  # of an earlier call
    return 1 if len(ended) < len(rows) else 0


if __name__ == "__main__":
    sys.exit(main())
