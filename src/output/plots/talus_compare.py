"""Of the DIR/compare.csv of `talus compare`: prints the table, and draws DIR/compare.png, error against processor time and against the refined key, and
the values themselves; one line a series."""

import talus_interrupt  # noqa: F401  before all that takes time

import argparse
import csv
import pathlib
import re

from talus_outcomes import losses
from talus_results import Results
from talus_style import FAINT, INK, LINES, few_log_ticks, headline, np, plt, save
from talus_sweep import named
from talus_table import lines_of
from talus_units import with_unit

COLUMNS = (("value", "value", ".8g"), ("error", "error", ".2e"), ("processor_s", "processor time [s]", ".3g"), ("steps", "steps", ".0f"),
           ("evaluations", "evaluations", ".0f"), ("rejections", "attempts rejected", ".0f"))


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def scale_of(values):
    """Logarithmic, but where all values lie within a decade, whose numbers would overlap."""
    values = [value for value in values if value > 0]
    return "log" if values and max(values) > 9.99 * min(values) else "linear"


def in_words(measure):
    """'max:crest_displacement_m' -> 'largest crest displacement [m]', 'crest_x_m@30' -> 'crest x [m] at 30 s'."""
    column, _, time = measure.removeprefix("max:").partition("@")
    return "largest " * measure.startswith("max:") + named(column, False) + (f" at {time} s" if time else "")


def draw(rows, reference, path, title=""):
    """Each key that some series refine has its own charts against it."""
    rows = [r for r in rows if not r["failure"]]
    uncertainty, measure = float(reference["uncertainty"]), in_words(reference["measure"])
    keys = list(dict.fromkeys(r["key"] for r in rows))
    figure = plt.figure(figsize=(10.6, 3.4 * len(keys)), layout="constrained")
    grid = figure.add_gridspec(len(keys), 3)
    cost = figure.add_subplot(grid[:, 0])
    colours = {name: LINES[k % len(LINES)] for k, name in enumerate(dict.fromkeys(r["series"] for r in rows))}
    for n, key in enumerate(keys):
        order, values = figure.add_subplot(grid[n, 1]), figure.add_subplot(grid[n, 2])
        mine = [r for r in rows if r["key"] == key]
        around = np.median([float(r["value"]) for r in mine])
        spread = 5 * np.median([abs(float(r["value"]) - around) for r in mine])
        for name in dict.fromkeys(r["series"] for r in mine):
            x, y, h, v = (np.array([float(r[c]) for r in mine if r["series"] == name]) for c in ("processor_s", "error", "parameter", "value"))
            seen = y > 0
            cost.plot(x[seen], y[seen], "o-", color=colours[name], label=name, markersize=4, linewidth=1)
            order.plot(h[seen], y[seen], "o-", color=colours[name], markersize=4, linewidth=1)
            values.plot(h, v, "o-", color=colours[name], markersize=4, linewidth=1)
        refined = with_unit(key, mine[0]["unit"])
        values.axhline(float(reference["value"]), color=INK, linewidth=0.8, linestyle=":")
        xscale, yscale = scale_of(float(r["parameter"]) for r in mine), scale_of(float(r["error"]) for r in mine)
        order.set(xscale=xscale, yscale=yscale, xlabel=refined, ylabel="error of " + measure)
        values.set(xscale=xscale, xlabel=refined, ylabel=measure)
        low, high = values.get_ylim()
        if spread > 0:  # a series that misses by far would flatten the others
            values.set_ylim(max(low, around - spread), min(high, around + spread))
    best = sorted(((float(r["processor_s"]), float(r["error"])) for r in rows if r["pareto"] == "1"))
    best = [(x, y) for x, y in best if y > 0]
    if best:
        cost.step(*zip(*best), where="post", color=INK, linewidth=0.8, linestyle=":", label="Pareto front")
    cost.set(xscale=scale_of(float(r["processor_s"]) for r in rows), yscale=scale_of(float(r["error"]) for r in rows), xlabel="processor time [s]", ylabel="error of " + measure)
    if np.isfinite(uncertainty) and uncertainty > 0:  # as far down as the errors go
        low, high = cost.get_ylim()
        low, high = (min(low, uncertainty / 2), max(high, 1.2 * uncertainty)) if cost.get_yscale() == "log" else (min(low, 0), max(high, 1.2 * uncertainty))
        cost.axhspan(low, uncertainty, color=FAINT, alpha=0.4, label="reference uncertain")
        cost.set_ylim(low, high)
    cost.legend(fontsize=7.5)
    few_log_ticks(*figure.axes)
    headline(figure, f"Error of {measure.partition(' [')[0]} against cost and refinement", title)
    save(figure, path)


def varied(row, series):
    """What a run sets that other runs of its series set otherwise, with the last words of the keys."""
    own, *others = (re.split(r" (?=[\w.]+=)", each["overrides"]) for each in (row, *series))
    return ", ".join(word.split("=")[0].rpartition(".")[2] + "=" + word.partition("=")[2] for word in own if not all(word in other for other in others))


def table(rows, width=None):
    """Lines of the table of all runs."""
    texts, more = [], losses(rows)
    for row in rows:
        keys = [row["series"], varied(row, [other for other in rows if other["series"] == row["series"]])]
        texts.append(keys + ([f"broke off: {row['failure']}"] if row["failure"] else [*(format(float(row[key]), digits) for key, _, digits in COLUMNS), *(text(row) for text in more.values())]))
    return lines_of(["series", "varied", *(heading for _, heading, _ in COLUMNS), *more], texts, keys=2, width=width)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("dir", type=pathlib.Path)
    parser.add_argument("--no-plot", action="store_true")
    given = parser.parse_args()
    runs, reference = read(given.dir / "compare.csv"), read(given.dir / "reference.csv")[0]
    print(f"{reference['measure']}; reference {float(reference['value']):.8g} +- {float(reference['uncertainty']):.2g} ({reference['origin']})\n")
    print("\n".join(table(runs)))
    if without := sum(not run["failure"] and not np.isfinite(float(run["value"])) for run in runs):
        print(f"{without} of {len(runs)} runs have no value: they ended before that time without coming to rest, or the point had no soil")
    if not given.no_plot:
        first = next(iter(sorted(given.dir.glob("run*/run.h5"))), None)
        draw(runs, reference, given.dir / "compare.png", Results(first.parent).title if first else "")
