"""Outcomes of the runs of `talus study`: sensitivities, probability of failure, exceedance curves.

A probability is that of the distributions: lists and choices beside them are cases that someone decides on, and each combination of their values has
a probability, a curve and a fit of its own, whose n is the number of samples.

Reads DIR/runs.csv, DIR/design.json and the results that they name. Writes DIR/study.csv (a row per run), DIR/study.json (probabilities,
sensitivities) and, where they have something to show, DIR/tornado.png, DIR/scatter.png and DIR/exceedance.png. Runs that broke off are rows with
their reason; exit status 1 if all did.
"""

import talus_interrupt  # noqa: F401  before all that takes time

import argparse
import csv
import json
import math
import pathlib
import sys
import textwrap

import numpy as np

import talus_style as style
from talus_outcomes import FAILS, MOVES, STANDS, finite, warnings_in, write_json
from talus_style import plt
from talus_sweep import MARKS, mark, number, outcomes, plane, title_of, title_of_runs
from talus_table import folded, lines_of
from talus_units import with_unit, words

SHOWN = ("factor_of_safety", "load_time_of_failure_s", "travel_distance_m", "largest_displacement_m")
MET, NOT_MET, UNKNOWN = 1, 0, -1
MANY = 6  # cases: more have no pictures of their fits
BANDS = 3  # cases: the intervals of more cover each other
SHAPES = ("o", "s", "^", "D", "v", "P")  # of the dots of each case


# ---- cases ----

def deciding(variables):
    """The variables whose values make cases: beside distributions all lists and choices; without distributions the choices that are no numbers, since a
    fit has no place for them."""
    sampled = any(v["random"] for v in variables)
    return [v for v in variables if not (v["random"] if sampled else v["numeric"])]


def cases_of(rows, variables):
    """[(case, rows)] for each combination of the values of lists and choices, in the order of the runs; a case is {name: value}, empty where nothing
    but distributions varies."""
    names = [v["name"] for v in deciding(variables)]
    cases = {}
    for row in rows:
        cases.setdefault(tuple(row[name] for name in names), []).append(row)
    return [(dict(zip(names, values)), of_case) for values, of_case in cases.items()]


def case_text(case, variables):
    """"rise = 3 m", or nothing where there are no cases."""
    units = {v["name"]: v["unit"] for v in variables}
    return ", ".join(f"{words(name)} = {value} {units[name]}".rstrip() for name, value in case.items())


# ---- probability ----

def binomial_tail(k, n, p):
    """Probability of k or more successes in n trials of probability p."""
    if k <= 0:
        return 1.0
    if p in (0.0, 1.0):
        return p
    terms = [math.lgamma(n + 1) - math.lgamma(i + 1) - math.lgamma(n - i + 1) + i * math.log(p) + (n - i) * math.log1p(-p) for i in range(k, n + 1)]
    return min(1.0, math.fsum(map(math.exp, terms)))


def solve_for_p(function, target):
    """p in (0, 1) at which an increasing function has the value, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(middle) < target else (low, middle)
    return 0.5 * (low + high)


def clopper_pearson(k, n, confidence):
    """Interval of a probability of which k of n independent trials had success (Clopper & Pearson 1934). It covers the probability at least
    with the confidence; for a Latin hypercube, whose estimates scatter less, with more."""
    rest = 0.5 * (1 - confidence)
    low = 0.0 if k == 0 else solve_for_p(lambda p: binomial_tail(k, n, p), rest)
    high = 1.0 if k == n else solve_for_p(lambda p: binomial_tail(k + 1, n, p), 1 - rest)
    return low, high


def state(row, criterion):
    """Whether a run meets a criterion: MET, NOT_MET, or UNKNOWN where the run broke off, where its factor is a bracket about the limit,
    where the criterion asks whether a slope fails that moved by less than a cell, or where the run has no value."""
    if row["failure"]:
        return UNKNOWN
    below, limit = criterion["side"] == "below", criterion["limit"]
    value = row.get(criterion["outcome"])
    if row.get("state") == MOVES and criterion["outcome"] == "fails":
        return UNKNOWN
    if value is None and criterion["outcome"] == "factor_of_safety":
        ends = {(end < limit) == below for end in (row["factor_with_equilibrium"], row["factor_with_mechanism"])}
        return UNKNOWN if len(ends) > 1 else MET if ends.pop() else NOT_MET
    if value is None:  # the load time of a failure that did not happen; of others it is not known
        return NOT_MET if criterion["outcome"] == "load_time_of_failure_s" else UNKNOWN
    return MET if (value < limit if below else value > limit) else NOT_MET


def probability(rows, criterion, confidence):
    """Share of the runs of one case that meet the criterion, with its interval. Runs of which it is unknown count as not meeting it in the lower limit and as
    meeting it in the upper one."""
    states = [state(row, criterion) for row in rows]
    met, unknown, total = states.count(MET), states.count(UNKNOWN), len(states)
    known = total - unknown
    return {"criterion": criterion["name"], "outcome": criterion["outcome"], criterion["side"]: criterion["limit"], "runs": total, "met": met,
            "unknown": unknown, "probability": met / known if known else None, "confidence": confidence,
            "low": clopper_pearson(met, total, confidence)[0], "high": clopper_pearson(met + unknown, total, confidence)[1]}


# ---- sensitivity ----

def sensitivities(rows, variables, outcome):
    """Effect of each numeric variable on an outcome from a linear fit in all of them: change of the outcome from the 10 % to the 90 % quantile of
    the variable, the others at their means. Means and quantiles are those of the runs with this outcome. None where they are too few."""
    variables = [v for v in variables if v["numeric"]]
    known = [row for row in rows if row.get(outcome) is not None]
    x = np.array([[number(row[v["name"]]) for v in variables] for row in known], float).reshape(len(known), len(variables))
    varies = [k for k in range(len(variables)) if len(known) and np.ptp(x[:, k]) > 0]
    y = np.array([float(row[outcome]) for row in known])
    if len(known) < len(varies) + 3 or not varies or np.ptp(y) == 0:
        return None
    x = x[:, varies]
    middle, spread = x.mean(0), x.std(0)
    fit, *_ = np.linalg.lstsq(np.column_stack([np.ones(len(y)), (x - middle) / spread]), y, rcond=None)
    explained = 1 - np.var(y - fit[0] - (x - middle) / spread @ fit[1:]) / np.var(y)
    bars = []
    for k, column in enumerate(varies):
        quantiles = np.quantile(x[:, k], [0.1, 0.9])  # of the runs with this outcome, not of the distribution
        ends = (quantiles - middle[k]) / spread[k]
        bars.append({"variable": variables[column]["name"], "unit": variables[column]["unit"], "quantiles": quantiles.tolist(), "low": float(fit[0] + fit[1 + k] * ends[0]), "high": float(fit[0] + fit[1 + k] * ends[1])})
    bars.sort(key=lambda bar: abs(bar["high"] - bar["low"]))
    return {"outcome": outcome, "runs": len(known), "mean": float(fit[0]), "r2": float(explained), "bars": bars}


# ---- correlation ----

def correlation_lines(pairs, width=None):
    """Lines that compare the correlation of the sample with the one that was asked for, and sentences on pairs where they are far apart."""
    if not pairs:
        return []
    samples = int(pairs[0]["samples"])
    rows = [[" and ".join(pair["between"]), f"{pair['asked']:g}", f"{pair['sample']:.2g}"] for pair in pairs]
    lines = [f"correlation of the normal scores of {samples} samples", *lines_of(["variables", "asked for", "in the sample"], rows, width=width)]
    far = [" and ".join(pair["between"]) for pair in pairs if pair["far"]]
    if far:
        lines.append(folded(f"warning: the sample's correlation of {'; '.join(far)} is farther from the asked one than two standard deviations of chance, about "
                            f"{2 / math.sqrt(samples):.2g} for weak correlations, which one sample in twenty is: take more samples or another seed", width))
    return lines


# ---- pictures ----

def draw_tornado(all_fits, in_plane, path, title="", variables=()):
    """A panel per outcome, or where there are cases one per outcome and case: those of an outcome have the same axis, so that the distance of their middle
    lines shows what the case does. A case whose runs give no fit has a sentence."""
    cases = list(dict.fromkeys(case_text(fit.get("case", {}), variables) for fit in all_fits))
    columns = min(3, len(cases))
    blocks = [[fit for fit in all_fits if fit["outcome"] == outcome] for outcome in dict.fromkeys(fit["outcome"] for fit in all_fits)]
    heights = [max(len(fit["bars"]) for fit in block) for block in blocks for _ in range(0, len(block), columns)]
    figure, axes = plt.subplots(len(heights), columns, figsize=(6.4 if columns == 1 else 4.3 * columns, 0.35 + sum(0.5 * h + 1.3 for h in heights)), squeeze=False,
                                layout="constrained", gridspec_kw={"height_ratios": [h + 2.1 for h in heights]})
    line = 0
    for block in blocks:
        lines = -(-len(block) // columns)
        own = axes[line:line + lines].ravel()
        line += lines
        for one in own[len(block):]:
            one.remove()
        ends = [end for fit in block for bar in fit["bars"] for end in (bar["low"], bar["high"])] + [fit["mean"] for fit in block if fit["mean"] is not None]
        room = 0.06 * (max(ends) - min(ends))
        for one, fit in zip(own, block):
            draw_bars(one, fit, title_of(fit["outcome"], in_plane), case_text(fit.get("case", {}), variables))
            one.set_xlim(min(ends) - room, max(ends) + room)
    style.legend_below(figure, next(handles for handles in (one.get_legend_handles_labels()[0] for one in figure.axes) if handles))
    style.headline(figure, "What decides", title)
    return style.save(figure, path)


def draw_bars(axes, fit, what, case):
    for k, bar in enumerate(fit["bars"]):
        for end, colour, label in ((bar["low"], style.LINES[0], "variable at the 10 % quantile of these runs"), (bar["high"], style.LINES[1], "at their 90 % quantile")):
            axes.barh(k, end - fit["mean"], left=fit["mean"], height=0.62, color=colour, label=label if k == 0 else None)
    if fit["mean"] is not None:
        axes.axvline(fit["mean"], color=style.INK, lw=0.8)
    axes.set_yticks(range(len(fit["bars"])), [f"{words(bar['variable'])}\n{bar['quantiles'][0]:.3g} to {bar['quantiles'][1]:.3g} {bar['unit']}".rstrip()
                                             for bar in fit["bars"]])
    axes.set_xlabel(textwrap.fill(what, 52))
    said = f"linear fit to {fit['runs']} runs, R² = {fit['r2']:.2f}" if fit["bars"] else "no fit: too few runs with a value" if fit["mean"] is None \
        else f"{fit['mean']:.4g} on the average of {fit['runs']} runs: no fit"
    axes.set_title(f"{textwrap.fill(case, 44)}\n{said}" if case else said, loc="right", fontsize=8)


def draw_scatter(rows, variables, shown, criteria, in_plane, path, title=""):
    """A panel per outcome and variable. Runs that broke off have no outcome: a cross at the lower edge marks their value of the variable."""
    cases = cases_of(rows, variables)
    cases = cases if 1 < len(cases) <= len(SHAPES) and any(v["random"] for v in variables) else [({}, rows)]
    broken = [row for row in rows if row["failure"]]
    figure, axes = plt.subplots(len(shown), len(variables), figsize=(max(5.2, 2.9 * len(variables)), 0.3 + 2.7 * len(shown)), squeeze=False, layout="constrained")
    for line, outcome in zip(axes, shown):
        about = [c for c in criteria if c["outcome"] == outcome]
        for one, v in zip(line, variables):
            known = [row for row in rows if row.get(outcome) is not None]
            choices = list(dict.fromkeys(row[v["name"]] for row in known + broken))
            for (_, of_case), shape in zip(cases, SHAPES):
                dots = [row for row in of_case if row.get(outcome) is not None]
                x = [number(row[v["name"]]) if v["numeric"] else choices.index(row[v["name"]]) for row in dots]
                colours = [style.LINES[1] if any(state(row, c) == MET for c in about or criteria) else style.LINES[0] for row in dots]
                one.scatter(x, [float(row[outcome]) for row in dots], s=11, c=colours, marker=shape, alpha=0.75, linewidths=0)
            for criterion in about:
                one.axhline(criterion["limit"], color=style.INK, lw=0.8, ls=":")
            for row in broken:
                mark(one, number(row[v["name"]]) if v["numeric"] else choices.index(row[v["name"]]), 0, None, style.SOFT)
            if not v["numeric"]:
                one.set_xticks(range(len(choices)), choices)
            one.set_xlabel(with_unit(words(v["name"]), v["unit"]))
        line[0].set_ylabel(textwrap.fill(title_of(outcome, in_plane), 28))
    dot = {"ls": "", "ms": 4}
    met = [plt.Line2D([], [], marker="o", color=style.LINES[k], label=text, **dot) for k, text in enumerate(("no criterion is met", "a criterion is met"))] if criteria else []
    which = [plt.Line2D([], [], marker=shape, color=style.SOFT, label=case_text(case, variables), **dot) for (case, _), shape in zip(cases, SHAPES) if case]
    lost = [plt.Line2D([], [], marker=MARKS[None][0], color=style.SOFT, label=f"at the lower edge: {len(broken)} of {len(rows)} runs broke off", ls="", ms=5)] if broken else []
    if met + which + lost:
        style.legend_below(figure, met + which + lost)
    style.headline(figure, "Outcomes against the variables", title)
    return style.save(figure, path)


def draw_exceedance(cases, variables, shown, criteria, confidence, in_plane, path, title=""):
    """A panel per outcome with a curve per case; intervals are drawn as long as they do not cover each other."""
    columns = min(3, len(shown))
    lines = -(-len(shown) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(max(5.2, 4.2 * columns), 0.3 + 3.3 * lines), squeeze=False, layout="constrained")
    for one in axes.flat[len(shown):]:
        one.remove()
    for one, outcome in zip(axes.flat, shown):
        of_cases = [np.sort([float(row[outcome]) for row in rows if row.get(outcome) is not None]) for _, rows in cases]
        every = np.concatenate(of_cases)
        first, last = every.min() - 0.03 * np.ptp(every), every.max() + 0.03 * np.ptp(every)
        for k, ((case, rows), values) in enumerate(zip(cases, of_cases)):
            n = len(values)
            if n == 0:
                continue
            above = np.concatenate([np.arange(n, -1, -1), [0]])  # of n values, before the first, between them, behind the last
            x = np.concatenate([[first], values, [last]])
            low, high = np.transpose([clopper_pearson(int(m), n, confidence) for m in above])
            look = {"color": style.LINES[k % len(style.LINES)], "ls": ("-", "--", ":")[k // len(style.LINES) % 3]}
            if len(cases) <= BANDS:
                one.fill_between(x, low, high, step="post", color=look["color"], alpha=0.2 if len(cases) == 1 else 0.13, lw=0,
                                 label=f"{100 * confidence:g} % interval" if len(cases) == 1 else None)
            runs = f"{n} runs" if n == len(rows) else f"the {n} of {len(rows)} runs with a value"
            one.step(x, above / n, where="post", lw=1.3, label=": ".join(filter(None, (case_text(case, variables), runs))), **look)
        for criterion in criteria:
            if criterion["outcome"] == outcome:
                one.axvline(criterion["limit"], color=style.INK, lw=0.8, ls=":", label=words(criterion["name"]))
        one.set(xlabel=title_of(outcome, in_plane), ylabel="probability of a larger value", ylim=(0, 1.02))
        one.legend(fontsize=7.5, title=f"with {100 * confidence:g} % intervals" if 1 < len(cases) <= BANDS else None, title_fontsize=7.5)
    style.headline(figure, "Probability of exceedance", title)
    return style.save(figure, path)


def fits_of(cases, variables, shown):
    """A linear fit per outcome and case. Where an outcome has a fit in one case, the others have an entry too: their mean, without bars."""
    fits = []
    for name in (name for name in shown if name != "fails"):
        of_cases = [(case, rows, sensitivities(rows, variables, name)) for case, rows in cases]
        for case, rows, fit in of_cases if any(fit for _, _, fit in of_cases) else ():
            known = [float(row[name]) for row in rows if row.get(name) is not None]
            fits.append({"case": case} | (fit or {"outcome": name, "runs": len(known), "mean": float(np.mean(known)) if known else None, "r2": None, "bars": []}))
    return fits


def varying(rows, names):
    """Outcomes that differ between runs."""
    return [name for name in names if len({float(row[name]) for row in rows if row.get(name) is not None}) > 1]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--no-plot", action="store_true")
    given = parser.parse_args()
    design = json.loads((given.folder / "design.json").read_text())
    with open(given.folder / "runs.csv", newline="") as file:
        runs = list(csv.DictReader(file))
    rows, in_plane = outcomes(given.folder, runs), plane(given.folder, runs)
    for row in rows:
        row |= {measure: finite(float(row[measure] or "nan")) for measure in design["measures"]}
        row |= {f"meets_{criterion['name']}": {MET: "yes", NOT_MET: "no", UNKNOWN: ""}[state(row, criterion)] for criterion in design["criteria"]}
    names = list(dict.fromkeys(key for row in rows for key in row))
    with open(given.folder / "study.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, names, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)

    broken = [row for row in rows if row["failure"]]
    states = [row["state"] for row in rows if "state" in row]
    print(f"{len(rows)} of {design['planned']} runs, {len(broken)} of which broke off")
    for row in broken[:5]:
        print(folded(f"  run {row['run']} broke off: {row['failure']}"))
    if states:
        print(folded(f"the slope fails in {states.count(FAILS)} runs, moves by less than a cell in {states.count(MOVES)}, stands in {states.count(STANDS)}"))
    variables, criteria = design["variables"], design["criteria"]
    sampled = any(v["random"] for v in variables)
    pairs = design.get("correlations", [])
    if pairs:
        print("\n".join(correlation_lines(pairs)))
    cases = cases_of(rows, variables)
    estimates = [{"case": case} | probability(of_case, c, design["confidence"]) for c in criteria for case, of_case in cases] if sampled else []
    if estimates and len(cases) > 1:
        print(folded(f"{' and '.join(words(v['name']) for v in deciding(variables))}: values that are chosen and have no probability, so each combination has its own; "
                     f"the {len(cases)} combinations share their samples"))
    for p in estimates:
        side = "below" if "below" in p else "above"
        known = "unknown" if p["probability"] is None else f"{p['probability']:.4g}"
        of_case = case_text(p["case"], variables)
        print(folded(f"{p['criterion']}{f', {of_case}' if of_case else ''}: {p['outcome']} {side} {p[side]:g} in {p['met']} of {p['runs'] - p['unknown']} runs, probability {known}, "
                     f"{100 * p['confidence']:g} % interval {p['low']:.4g} to {p['high']:.4g}" + (f"; unknown in {p['unknown']} runs" if p["unknown"] else "")))
    shown = varying(rows, dict.fromkeys([*(c["outcome"] for c in criteria), *SHOWN, *design["measures"]]))
    fits = fits_of(cases, variables, shown)
    few = len(cases) <= MANY
    if fits and not few and not given.no_plot:
        print(folded(f"tornado.png is not drawn: {len(cases)} combinations of {', '.join(words(v['name']) for v in deciding(variables))} have a fit of their own, see study.json"))
    for measure in design["measures"]:
        if without := [row["run"] for row in rows if not row["failure"] and row[measure] is None]:
            print(folded(f"{measure} has no value in {len(without)} runs, first in run {without[0]}: they ended before that time without coming to rest, or the "
                         "point had no soil"))
    write_json(given.folder / "study.json", {"title": design["title"], "runs": len(rows), "planned": design["planned"], "broke_off": len(broken),
                                             "warnings": warnings_in(given.folder), "correlations": pairs, "probabilities": estimates, "sensitivities": fits})
    curves = [outcome for outcome in shown if outcome != "fails"]
    title = design["title"] or title_of_runs(given.folder, runs)
    for name, wanted, draw in (("tornado", fits and few, lambda path: draw_tornado(fits, in_plane, path, title, variables)),
                               ("scatter", shown, lambda path: draw_scatter(rows, variables, shown, criteria, in_plane, path, title)),
                               ("exceedance", curves and sampled, lambda path: draw_exceedance(cases, variables, curves, criteria, design["confidence"], in_plane, path, title))):
        path = given.folder / f"{name}.png"
        if wanted and not given.no_plot:
            draw(path)
        else:
            path.unlink(missing_ok=True)  # of an earlier call
    return 1 if len(broken) == len(rows) else 0


if __name__ == "__main__":
    sys.exit(main())
