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
from talus_outcomes import FAILS, MOVES, STANDS, cell_size, losses, outcome, warnings_in, write_json
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


ORDERS = (0.5, 3.0)  # of convergence: errors of cells and steps have 1 or 2; beyond 3 two values are near by chance
MISSING = "missing"  # a quantity that only some of the runs have


def order_of(sizes, values):
    """The order p in ORDERS with which three values, from coarse to fine, go one way to a limit: value = limit + C size**p. None where there is none: their
    changes grow, or shrink too little or too much."""
    before, last = values[1] - values[0], values[2] - values[1]
    if last == 0:
        return None
    def ratio(p):  # of the changes; it grows with p
        return (sizes[0] ** p - sizes[1] ** p) / (sizes[1] ** p - sizes[2] ** p)
    low, high = ORDERS
    if not ratio(low) <= before / last <= ratio(high):
        return None
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if ratio(middle) < before / last else (low, middle)
    return low


def settles(sizes, values, within, least=0.0):
    """What refinement does to a quantity, whose `sizes` and `values` go from coarse to fine. Allowed is a share `within` of the finest value, or `least`.
    "equal": all values differ by no more than what is allowed.
    "settles": the values go one way to a limit, and every three of them as if their error was a power of the size between the ORDERS; neither the last change
    nor the rest up to that limit is more than what is allowed.
    "swings": the values go to and fro.
    "open": all else."""
    allowed = max(within * abs(values[-1]), least)
    if max(values) - min(values) <= allowed:
        return "equal"
    changes = [after - before for before, after in zip(values, values[1:])]
    if min(changes) < 0 < max(changes):
        return "swings"
    orders = [order_of(sizes[k:k + 3], values[k:k + 3]) for k in range(len(values) - 2)]
    if None in orders:
        return "open"
    rest = abs(changes[-1]) / ((sizes[-2] / sizes[-1]) ** orders[-1] - 1)
    return "settles" if max(abs(changes[-1]), rest) <= allowed else "open"


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
    sizes = [1 / row["value"] if by == "particles" else row["value"] for row in rows]
    verbs = {FAILS: "fails", MOVES: f"moves by less than a cell of {cell:.2g} m", STANDS: "stands"}
    states = {state: [row for row in rows if row["state"] == state] for state in verbs}
    states = {state: some for state, some in states.items() if some}
    if len(states) > 1 and settles(sizes, [row["largest_displacement_m"] for row in rows], within) != "equal":
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
        without = [in_words(row, by) for row, value in zip(rows, values) if value is None]
        if len(without) == len(rows):
            continue
        if without:
            judged.append({"quantity": key, "values": values, "state": MISSING})
            known = ", ".join(f"{value:.4g} {unit} with {in_words(row, by)}" for row, value in zip(rows, values) if value is not None)
            sentences.append(f"{name} is missing with {', '.join(without)}, and {known}: the {thing} decides it.")
            decides = True
            continue
        state = settles(sizes, values, within, least)
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
            text += f"it {'swings' if state == 'swings' else 'does not settle'}, and the {thing} decides it."
            decides = True
        sentences.append(text)
    return sentences + ([remedy] if decides else []), decides, judged


# ---- tables and picture ----

COLUMNS = (("load_time_of_failure_s", "failure at t [s]"), ("largest_displacement_m", "largest u [m]"), ("travel_distance_m", "travel [m]"),
           ("volume_of_slide_m3", "volume [{}]"), ("depth_of_slide_m", "depth [m]"), ("deepest_at_x_m", "at x [m]"), ("steps", "steps"),
           ("wall_s", "run time [s]"))


def table(rows, by, volumes, width=None):
    """Lines of the table of all runs."""
    texts, more = [], losses(rows)
    for row in rows:
        shown = [f"{row[key]:,d}" if isinstance(row[key], int) else "none" if row[key] is None else f"{row[key]:.4g}" for key, _ in COLUMNS if not row["failure"]]
        shown += [text(row) for text in more.values()]
        texts.append([f"{row['value']:g}"] + ([f"broke off: {row['failure']}"] if row["failure"] else [row["state"], *shown]))
    return lines_of([by, "state", *(heading.format(volumes) for _, heading in COLUMNS), *more], texts, width=width)


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
        row = {key: text for key, text in run.items() if key != "folder"}
        row |= {key: float(run[key]) if run[key] else None for key in ("value", "wall_s", "processor_s", "escaped_mass_kg", "escaped_share")}
        row["warning_count"] = int(run["warning_count"])
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
