"""Tables, statements and pictures of `talus study` and of its presets `talus compare` and `talus converge`.

Reads DIR/design.json, in which the program says what it ran and what is asked of it, and the results of the runs. Writes DIR/study.csv (a row per run),
DIR/study.json (what follows from them) and the pictures that have something to show. Runs that broke off are rows with their reason. Exit status 1: all
runs of a study broke off, a run of a comparison did, or the refined quantity decides something.

A probability is that of the distributions: lists and choices beside them are cases that someone decides on, and each combination of their values has
a probability, a curve and a fit of its own, whose n is the number of samples.
"""

import talus_interrupt  # noqa: F401  before all that takes time

import argparse
import csv
import functools
import json
import pathlib
import sys
import textwrap

import numpy as np

import talus_style as style
from talus_compare import converge, errors, outcomes
from talus_outcomes import FAILS, MOVES, STANDS, write_json
from talus_runs import Runs, against, charts, factor_of, named, written
from talus_statistics import clopper_pearson
from talus_table import folded
from talus_units import with_unit, words
from talus_workbook import write_workbook

SHOWN = ("factor_of_safety", "load_time_of_failure_s", "travel_distance_m", "largest_displacement_m")  # of a study
MET, NOT_MET, UNKNOWN = 1, 0, -1
MANY = 6  # cases: more have no pictures of their fits


def cases_of(rows, variables):
    """{case: rows} for each combination of the values that make cases, in the order of the runs, such as "rise = 3 m"; it is the `line` of its rows, and empty
    where there is one case. Beside distributions all lists and choices make cases; without, the choices that are no numbers, since a fit has no place for them."""
    sampled = any(v["random"] for v in variables)
    deciding = [v for v in variables if not v["random" if sampled else "numeric"]]
    cases = {}
    for row in rows:
        row["line"] = ", ".join(f"{words(v['name'])} = {written(row[v['name']])} {v['unit']}".rstrip() for v in deciding)
        cases.setdefault(row["line"], []).append(row)
    return cases


def state(row, criterion):
    """Whether a run meets a criterion: MET, NOT_MET, or UNKNOWN where the run broke off, where its factor is a bracket about the limit,
    where the criterion asks whether a slope fails that moved by less than a cell, or where the run has no value."""
    def meets(value):
        return MET if (value < criterion["limit"] if criterion["side"] == "below" else value > criterion["limit"]) else NOT_MET
    outcome = criterion["outcome"]
    if row["failure"] or row.get("state") == MOVES and outcome == "fails":
        return UNKNOWN
    if row.get(outcome) is not None:
        return meets(row[outcome])
    if outcome == "factor_of_safety":
        ends = {meets(row["factor_with_equilibrium"]), meets(row["factor_with_mechanism"])}
        return UNKNOWN if len(ends) > 1 else ends.pop()
    return NOT_MET if outcome == "load_time_of_failure_s" else UNKNOWN  # of a failure that did not happen; others are not known


def probability(rows, criterion, confidence):
    """Share of the runs of one case that meet the criterion, with its interval. Runs of which it is unknown count as not meeting it in the lower limit and as
    meeting it in the upper one."""
    states = [state(row, criterion) for row in rows]
    met, unknown, total = states.count(MET), states.count(UNKNOWN), len(states)
    known = total - unknown
    return {"criterion": criterion["name"], "outcome": criterion["outcome"], criterion["side"]: criterion["limit"], "runs": total, "met": met,
            "unknown": unknown, "probability": met / known if known else None, "confidence": confidence,
            "low": clopper_pearson(met, total, confidence)[0], "high": clopper_pearson(met + unknown, total, confidence)[1]}


def said_of_probability(p):
    side = "below" if "below" in p else "above"
    named_case, known = ", " * bool(p["case"]) + p["case"], "unknown" if p["probability"] is None else f"{p['probability']:.4g}"
    return (f"{p['criterion']}{named_case}: {p['outcome']} {side} {p[side]:g} in {p['met']} of {p['runs'] - p['unknown']} runs, probability {known}, "
            f"{100 * p['confidence']:g} % interval {p['low']:.4g} to {p['high']:.4g}" + (f"; unknown in {p['unknown']} runs" if p["unknown"] else ""))


def sensitivities(rows, variables, outcome):
    """Effect of each numeric variable on an outcome from a linear fit in all of them: change of the outcome from the 10 % to the 90 % quantile of
    the variable, or from the least to the largest of the values that were chosen for it, the others at their means. Means and quantiles are those of the runs with this outcome; too few of them have no bars."""
    known = [row for row in rows if row.get(outcome) is not None]
    y = np.array([float(row[outcome]) for row in known])
    fit = {"outcome": outcome, "runs": len(known), "mean": float(y.mean()) if len(y) else None, "r2": None, "bars": []}
    varies = [v for v in variables if v["numeric"] and len({float(row[v["name"]]) for row in known}) > 1]
    if len(known) < len(varies) + 3 or not varies or np.ptp(y) == 0:
        return fit
    x = np.array([[float(row[v["name"]]) for v in varies] for row in known])
    middle, spread = x.mean(0), x.std(0)
    factors, *_ = np.linalg.lstsq((x - middle) / spread, y - y.mean(), rcond=None)
    ends = np.column_stack([np.quantile(of, [0.1, 0.9]) if v["random"] else (of.min(), of.max()) for v, of in zip(varies, x.T)])  # of the runs with this outcome
    low, high = y.mean() + factors * (ends - middle) / spread
    bars = [{"variable": v["name"], "unit": v["unit"], "quantiles" if v["random"] else "ends": ends[:, k].tolist(), "low": float(low[k]), "high": float(high[k])} for k, v in enumerate(varies)]
    bars.sort(key=lambda bar: abs(bar["high"] - bar["low"]))
    return fit | {"r2": float(1 - np.var(y - y.mean() - (x - middle) / spread @ factors) / np.var(y)), "bars": bars}


def tornado(fits, in_plane):
    """Panels: what each variable does to an outcome, a panel per case. They have the same axis: the distance of their middle lines is what the case does."""
    drawn = []

    def panel(fit, axes):
        factor = factor_of(fit["outcome"], in_plane)
        drawn.append(axes)
        if axes is not drawn[0]:
            axes.sharex(drawn[0])
        for k, bar in enumerate(fit["bars"]):
            labels = ("variable at the 10 % quantile of these runs", "at their 90 % quantile") if "quantiles" in bar else ("variable at its least value", "at its largest value")
            for end, colour, label in zip(("low", "high"), style.LINES, labels):
                axes.barh(k, factor * (bar[end] - fit["mean"]), left=factor * fit["mean"], height=0.62, color=colour, label=label)
        if fit["mean"] is not None:
            axes.axvline(factor * fit["mean"], color=style.INK, lw=0.8)
        ends = [bar.get("quantiles") or bar["ends"] for bar in fit["bars"]]
        axes.set_yticks(range(len(ends)), [f"{words(bar['variable'])}\n{low:.3g} to {high:.3g} {bar['unit']}".rstrip() for bar, (low, high) in zip(fit["bars"], ends)])
        axes.set_xlabel(textwrap.fill(named(fit["outcome"], in_plane), 52))
        said = f"linear fit to {fit['runs']} runs, R² = {fit['r2']:.2f}" if fit["bars"] else f"no fit to {fit['runs']} runs"
        axes.set_title("\n".join(filter(None, (textwrap.fill(fit["case"], 44), said))), loc="right", fontsize=8)
    return [functools.partial(panel, fit) for fit in fits]


def exceedance(cases, outcome, criteria, confidence, in_plane):
    """A panel: probability that an outcome is larger than a value, with its interval, a curve per case."""
    factor = factor_of(outcome, in_plane)
    every = [factor * row[outcome] for rows in cases.values() for row in rows if row.get(outcome) is not None]
    ends = min(every) - 0.03 * np.ptp(every), max(every) + 0.03 * np.ptp(every)

    def panel(axes):
        for colour, (case, rows) in zip(np.resize(style.LINES, len(cases)), cases.items()):
            values = np.sort([factor * row[outcome] for row in rows if row.get(outcome) is not None])
            n = len(values)
            if n == 0:
                continue
            x = np.concatenate([ends[:1], values, ends[1:]])
            above = np.append(np.arange(n, -1, -1), 0)  # of n values, before the first, between them, behind the last
            low, high = np.transpose([clopper_pearson(int(m), n, confidence) for m in above])
            axes.fill_between(x, low, high, step="post", color=colour, alpha=0.15, lw=0, label=f"{100 * confidence:g} % interval")
            runs = f"{n} runs" if n == len(rows) else f"the {n} of {len(rows)} runs with a value"
            axes.step(x, above / n, where="post", lw=1.3, color=colour, label=": ".join(filter(None, (case, runs))))
        for criterion in (one for one in criteria if one["outcome"] == outcome):
            axes.axvline(factor * criterion["limit"], color=style.INK, lw=0.8, ls=":", label=words(criterion["name"]))
        axes.set(xlabel=named(outcome, in_plane), ylabel="probability of a larger value", ylim=(0, 1.02))
    return panel


def study(runs, design):
    """Of `talus study`: lines, what study.json has, {picture: arguments of `charts`}, and whether the status is 1."""
    rows, variables, criteria, confidence = runs.rows, design["variables"], design["criteria"], design["confidence"]
    broken, sampled, cases = [row for row in rows if row["failure"]], any(v["random"] for v in variables), cases_of(rows, variables)
    for row in rows:
        row |= {f"meets_{criterion['name']}": {MET: "yes", NOT_MET: "no", UNKNOWN: ""}[state(row, criterion)] for criterion in criteria}
    states = [row["state"] for row in rows if "state" in row]
    lines = [f"{len(rows)} of {design['planned']} runs, {len(broken)} of which broke off", *(f"  run {row['run']} broke off: {row['failure']}" for row in broken[:5])]
    if states:
        lines.append(f"the slope fails in {states.count(FAILS)} runs, moves by less than a cell in {states.count(MOVES)}, stands in {states.count(STANDS)}")
    estimates = [{"case": case} | probability(of_case, c, confidence) for c in criteria for case, of_case in cases.items()] if sampled else []
    names = dict.fromkeys([*(c["outcome"] for c in criteria), *SHOWN, *runs.measures])
    vary = [name for name in names if len({float(row[name]) for row in rows if row.get(name) is not None}) > 1]
    curves = [outcome for outcome in vary if outcome != "fails"]
    fits = [[{"case": case} | sensitivities(of_case, variables, outcome) for case, of_case in cases.items()] for outcome in curves]
    fits = [of for of in fits if any(fit["bars"] for fit in of)]
    pictures = {}
    if fits and len(cases) <= MANY:
        size = 6.4 if len(cases) == 1 else 4.3, 1.3 + 0.5 * max(len(fit["bars"]) for of in fits for fit in of)
        pictures["tornado"] = "What decides", [tornado(of, runs.in_plane) for of in fits], 3, size
    if vary:
        blocks = [[against(v["name"], with_unit(words(v["name"]), v["unit"]), rows, {"": outcome}, named(outcome, runs.in_plane), list(cases), False,
                           [c["limit"] for c in criteria if c["outcome"] == outcome], factor=factor_of(outcome, runs.in_plane)) for v in variables] for outcome in vary]
        pictures["scatter"] = "Outcomes against the variables", blocks, len(variables), (2.9, 2.7)
    if curves and sampled:
        pictures["exceedance"] = "Probability of exceedance", [[exceedance(cases, outcome, criteria, confidence, runs.in_plane) for outcome in curves]]
    page = {"probabilities": estimates, "sensitivities": [fit for of in fits for fit in of]}
    return lines + [*map(said_of_probability, estimates)], page, pictures, len(broken) == len(rows)


PRESETS = {"study": study, "outcomes": outcomes, "errors": errors, "converge": converge}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--no-plot", action="store_true")
    given = parser.parse_args()
    design = json.loads((given.folder / "design.json").read_text())
    runs = Runs(given.folder, design)
    told, broke_off = runs.told(), len(runs.rows) - len(runs.ended)
    lines, page, pictures, status = PRESETS[runs.preset](runs, design)
    rows = [row | {"overrides": " ".join(row["overrides"]), "warnings": " | ".join(row["warnings"])} for row in runs.rows]
    with open(given.folder / "study.csv", "w", newline="") as file:
        names = dict.fromkeys(name for row in rows for name in row)
        writer = csv.DictWriter(file, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows({name: written(value) for name, value in row.items()} for row in rows)
    write_workbook(given.folder / "study.xlsx", {"Runs": [[*names], *([row.get(name) for name in names] for row in rows)]})
    write_json(given.folder / "study.json", {"title": runs.title, "runs": len(rows), "planned": design["planned"], "broke_off": broke_off, "warnings": runs.warnings()} | page)
    print("\n".join([*lines, *map(folded, told)]), flush=True)
    for name in ("tornado", "scatter", "exceedance", "outcomes", "errors"):
        path = given.folder / f"{name}.png"
        path.unlink(missing_ok=True)  # of an earlier call
        if name in pictures and not given.no_plot:
            what, *panels = pictures[name]
            charts(path, what, runs.title, *panels)
    return int(status)


if __name__ == "__main__":
    sys.exit(main())
