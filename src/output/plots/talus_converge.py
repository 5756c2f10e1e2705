"""Judges the runs of `talus converge`: do cells (or steps, or particles) decide whether a slope fails, at which load, and how far it slides?

Reads DIR/runs.csv, from the coarsest to the finest run, and the results that it names. Writes DIR/converge.csv, DIR/converge.json and
DIR/converge.png, and prints a table and a verdict. Exit status: 0 if the refined quantity decides nothing, 1 if it decides something or a run
broke off, as `talus verify` ends with 1 where a number does not hold.
"""

import talus_interrupt  # noqa: F401  before all that takes time

import argparse
import csv
import pathlib
import sys

from talus_colours import Colours
from talus_outcomes import FAILS, MOVES, STANDS, cell_size, outcome, warnings_in, write_json
from talus_results import Results
from talus_sections import BELOW, BESIDE, HEAD, LEFT, RIGHT, TITLE, WIDTH, Painter, plt
import talus_style as style
from talus_table import folded, lines_of
from talus_units import readable_unit, words

FOOT = 0.5  # room for the labels of the lowest axes [inch]
THINGS = {"cells": "cell size", "steps": "time step", "particles": "number of particles per cell"}
REMEDY = {
    "cells": "Take smaller cells and look again. Until then their scatter is the error of these numbers",
    "steps": "Take smaller steps and look again",
    "particles": "Take more particles per cell and look again",
}


# ---- the verdict ----

# where soil softens, and its cells decide something
SOFTENING = "Look at `talus check` for softening that is too brittle for these cells, and give the soil an averaging_length. "


def percent(difference, values):
    """A difference as a share of the finest run's value, "12 %"; round-off is 0."""
    share = 100 * difference / abs(values[-1]) if values[-1] else 0.0
    return f"{share:.2g} %" if share >= 0.01 else "0 %"


def settles(values, within, least=0.0):
    """Whether refinement still changes a quantity: "equal" if all runs agree, "settles" if the changes decrease by half or more from each
    refinement to the next and the last one is within the tolerance, else "open". Differences up to `least` count as none."""
    allowed = max(within * abs(values[-1]), least)
    if max(values) - min(values) <= allowed:
        return "equal"
    changes = [abs(b - a) for a, b in zip(values, values[1:])]
    shrinking = all(2 * after <= before for before, after in zip(changes, changes[1:]))
    return "settles" if shrinking and changes[-1] <= allowed else "open"


def in_words(row, by):
    return f"{row['value']:g} m" if by == "cells" else f"{row['value']:g}{' ' + row['unit'] if row['unit'] else ''}"


def judge(rows, by, within, softening=False, volumes="m³"):
    """([sentence], whether the refined quantity decides something, [what it does to each quantity]). `rows` from coarse to fine;
    `softening` says that soil softens, and `volumes` is the unit of volumes."""
    thing, judged = THINGS[by], []
    remedy = (SOFTENING if softening and by == "cells" else "") + REMEDY[by] + "."
    broken = [row for row in rows if row["failure"]]
    rows = [row for row in rows if not row["failure"]]
    sentences = [f"The run with {in_words(row, by)} broke off: {row['failure']}." for row in broken]
    if len(rows) < 3:
        return sentences + ["Fewer than three runs came to their end, so that nothing can be said."], True, judged
    cell = max(row["cell_m"] for row in rows)
    verbs = {FAILS: "fails", MOVES: f"moves by less than a cell of {cell:.2g} m", STANDS: "stands"}
    states = {state: [row for row in rows if row["state"] == state] for state in verbs}
    states = {state: some for state, some in states.items() if some}
    if len(states) > 1 and settles([row["largest_displacement_m"] for row in rows], within) != "equal":
        each = [f"{verbs[state]} with {', '.join(in_words(row, by) for row in some)}" for state, some in states.items()]
        sentences.append(f"The slope {', '.join(each[:-1])} and {each[-1]}: the {thing} decides whether it fails.")
        return sentences + [remedy], True, judged
    sentences.append(f"The slope {verbs[next(iter(states))]} in all {len(rows)} runs.")
    points = [key for key in rows[-1] if key.endswith("_displacement_m") and key != "largest_displacement_m"]
    decides = bool(broken)
    asked = [("load_time_of_failure_s", "The load time at failure", "s", 0.0), ("largest_displacement_m", "The largest displacement", "m", 0.0)]
    asked += [(key, f"The displacement of {words(key[: -len('_displacement_m')])}", "m", 0.0) for key in points]
    # rear, front and slip surface are known to a cell
    asked += [("travel_distance_m", "The travel distance, from the rear of the slide to its front,", "m", cell), ("volume_of_slide_m3", "The volume of the slide", volumes, 0.0),
              ("depth_of_slide_m", "The depth of the slip surface", "m", cell)]
    for key, name, unit, least in asked:
        values = [row.get(key) for row in rows]
        if any(value is None for value in values):
            continue
        state = settles(values, within, least)
        judged.append({"quantity": key, "values": values, "state": state})
        factor, unit = readable_unit(max(map(abs, values)), unit)
        known = f" or one cell of {cell:.2g} m" if least and within * abs(values[-1]) < least else ""
        text = (f"{name} is {factor * min(values):.3g} to {factor * max(values):.3g} {unit}, {percent(max(values) - min(values), values)} apart: ")
        if state == "equal":
            text += f"the {thing} does not decide it within {100 * within:g} %{known}."
        elif state == "settles":
            last = abs(values[-1] - values[-2])
            text += f"it settles, and the last refinement changes it by {percent(last, values)}"
            text += f", less than one cell of {cell:.2g} m." if last > within * abs(values[-1]) else "."
        else:
            text += f"the {thing} decides it."
            decides = True
        sentences.append(text)
    return sentences + ([remedy] if decides else []), decides, judged


# ---- tables and picture ----

COLUMNS = (("load_time_of_failure_s", "failure at t [s]"), ("largest_displacement_m", "largest u [m]"), ("travel_distance_m", "travel [m]"),
           ("volume_of_slide_m3", "volume [{}]"), ("depth_of_slide_m", "depth [m]"), ("deepest_at_x_m", "at x [m]"), ("steps", "steps"),
           ("wall_s", "run time [s]"))


def table(rows, by, volumes, width=None):
    """Lines of the table of all runs."""
    texts = []
    for row in rows:
        shown = [f"{row[key]:,d}" if isinstance(row[key], int) else "-" if row[key] is None else f"{row[key]:.4g}" for key, _ in COLUMNS if not row["failure"]]
        texts.append([f"{row['value']:g}"] + ([f"broke off: {row['failure']}"] if row["failure"] else [row["state"], *shown]))
    return lines_of([by, "state", *(heading.format(volumes) for _, heading in COLUMNS)], texts, width=width)


def write_tables(rows, sentences, judged, decides, by, within, folder):
    names = list(dict.fromkeys(key for row in rows for key in row))
    with open(folder / "converge.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, names, restval="")
        writer.writeheader()
        writer.writerows(rows)
    page = {"by": by, "within": within, "decides": decides, "verdict": sentences, "quantities": judged, "warnings": warnings_in(folder), "runs": rows}
    write_json(folder / "converge.json", page)


def draw(results, rows, by, path):
    """Displacement and plastic strain at the end of all runs, side by side on the same scales."""
    painters = [Painter(one, [one.snapshots[-1]]) for one in results]
    lasts = [one.snapshots[-1] for one in results]
    fields = [field for field in ("displacement", "plastic_strain") if all(last.scalar(field) is not None for last in lasts)]
    section = painters[0].section
    low = style.np.min([painter.corners[section][0] for painter in painters], axis=0)
    high = style.np.max([painter.corners[section][1] for painter in painters], axis=0)
    for painter in painters:
        painter.corners[section] = (low, high)
    columns = len(results)
    wide = (WIDTH - LEFT - RIGHT - BESIDE * (columns - 1)) / columns
    tall = wide * (high[1] - low[1]) / (high[0] - low[0])
    height = HEAD + len(fields) * (TITLE + tall + BELOW) - BELOW + FOOT
    figure = plt.figure(figsize=(WIDTH, height))
    for n, field in enumerate(fields):
        colours = Colours(field, lasts)
        top = height - HEAD - TITLE - n * (TITLE + tall + BELOW)
        for k, (painter, last, row) in enumerate(zip(painters, lasts, rows)):
            left = LEFT + k * (wide + BESIDE)
            axes = figure.add_axes([left / WIDTH, (top - tall) / height, wide / WIDTH, tall / height])
            painter._panel(axes, last, field, section, colours)
            load = row["load_time_of_failure_s"]
            how = row["state"] if load is None else f"{row['state']} at t = {load:.3g} s"
            axes.set_title(f"{in_words(row, by)}: {how}" if n == 0 else "", loc="left", pad=5)
            if k == 0:
                axes.set_ylabel(f"{'xyz'[painter.views[section].up]} [m]")
            if n == len(fields) - 1:
                axes.set_xlabel(f"{'xyz'[painter.views[section].across]} [m]")
        bar = colours.bar(figure, [1 - (RIGHT - 0.22) / WIDTH, (top - tall) / height, 0.15 / WIDTH, tall / height])
        bar.set_title(f"{style.SYMBOL[field]} {colours.unit}".strip(), fontsize=9, pad=6)
    figure.text(LEFT / WIDTH, 1 - 0.2 / height, f"At the end, by {THINGS[by]}", fontsize=13, fontweight="bold", va="center")
    figure.text(1 - 0.25 / WIDTH, 1 - 0.2 / height, results[0].title, fontsize=9, color=style.SOFT, va="center", ha="right")
    return style.save(figure, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--by", choices=THINGS, required=True)
    parser.add_argument("--within", type=float, required=True, help="differences up to this share count as none")
    parser.add_argument("--softening", action="store_true", help="soil softens")
    parser.add_argument("--no-plot", action="store_true")
    given = parser.parse_args()
    with open(given.folder / "runs.csv", newline="") as file:
        runs = list(csv.DictReader(file))
    rows, ended = [], []
    for run in runs:
        row = {"value": float(run["value"]), "unit": run["unit"], "overrides": run["overrides"], "wall_s": float(run["wall_s"]),
               "processor_s": float(run["processor_s"]), "failure": run["failure"], "warnings": run["warnings"]}
        if not row["failure"]:
            ended.append(Results(given.folder / run["folder"]))
        rows.append(row)
    largest = max(map(cell_size, ended), default=0.0)
    for row, one in zip([row for row in rows if not row["failure"]], ended):
        row |= outcome(one, largest)
    volumes = ended[0].per_metre("m³") if ended else "m³"
    sentences, decides, judged = judge(rows, given.by, given.within, given.softening, volumes)
    print("\n".join([*table(rows, given.by, volumes), "", *map(folded, sentences)]))
    write_tables(rows, sentences, judged, decides, given.by, given.within, given.folder)
    if ended and not given.no_plot:
        draw(ended, [row for row in rows if not row["failure"]], given.by, given.folder / "converge.png")
    return 1 if decides else 0


if __name__ == "__main__":
    sys.exit(main())
