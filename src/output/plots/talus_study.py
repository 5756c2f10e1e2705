"""Tables, statements and pictures of `talus study` and of its presets `talus compare` and `talus converge`.

Reads DIR/design.json, in which the program says what it ran and what is asked of it, and the results of the runs. Writes DIR/study.csv (a row per run),
DIR/study.json (what follows from them) and the pictures that have something to show. Runs that broke off are rows with their reason. Exit status 1: all
runs of a study broke off, a run of a comparison did, or the refined quantity decides something, as `talus verify` ends with 1 where a number does not hold.

A probability is that of the distributions: lists and choices beside them are cases that someone decides on, and each combination of their values has
a probability, a curve and a fit of its own, whose n is the number of samples.
"""

import talus_interrupt  # noqa: F401  before all that takes time

import argparse
import csv
import json
import math
import pathlib
import re
import sys
import textwrap

import numpy as np

import talus_style as style
from talus_colours import Colours
from talus_outcomes import FAILS, MOVES, STANDS, cell_size, finite, losses, outcome, write_json
from talus_results import History, Results, read_events
from talus_sections import BELOW, BESIDE, HEAD, LEFT, RIGHT, TITLE, WIDTH, Painter
from talus_statistics import clopper_pearson, correlations, extrapolate, settles
from talus_style import plt
from talus_table import folded, lines_of
from talus_units import readable_unit, with_unit, words

SHOWN = ("factor_of_safety", "load_time_of_failure_s", "travel_distance_m", "largest_displacement_m")  # of a study
NO_SLIDE = ("travel_distance_m", "volume_of_slide_m3", "depth_of_slide_m")  # 0 where the slope stands
OF_POINTS = {"displacement at the end [m]": "_displacement_m", "largest speed [m/s]": "_largest_speed_m_s"}
LEFT_OUT = ("cell_m", "deepest_at_x_m", "value", "processor_s", "wall_s", "escaped_mass_kg", "escaped_share")  # numbers that no chart of outcomes shows
UNITS = {"_kg_m_s": "kg m/s", "_m_s2": "m/s²", "_m3_s": "m³/s", "_m_s": "m/s", "_m3": "m³", "_m": "m", "_J": "J", "_Pa": "Pa", "_N": "N", "_kg": "kg", "_K": "K", "_s": "s",
         "_deg": "deg"}  # by the endings of outcomes
TITLES = {"load_time_of_failure_s": "time t of the loads at failure [s]", "travel_distance_m": "travel distance, from the rear of the slide to its front [m]",
          "volume_of_slide_m3": "volume of the slide [m³]", "moving_volume_m3": "volume that moves [m³]", "depth_of_slide_m": "depth of the slip surface [m]"}
MET, NOT_MET, UNKNOWN = 1, 0, -1
MANY = 6  # cases: more have no pictures of their fits
BANDS = 3  # cases: the intervals of more cover each other
SHAPES = ("o", "s", "^", "D", "v", "P")  # of the dots of each case
MOST = 5  # named points that charts and the table show
INSIDE = 6  # lines whose names have room in their chart
FOOT = 0.5  # room for the labels of the lowest axes of sections [inch]


# ---- rows ----

def written(value):
    """A value as tables and names of cases have it."""
    return f"{value:.10g}" if isinstance(value, float) else "" if value is None else str(value)


def asked_of(measure):
    """(column, time or None, whether the largest value counts) of a measure: COLUMN, COLUMN@TIME or max:COLUMN."""
    column, _, time = measure.removeprefix("max:").partition("@")
    return column, float(time) if time else None, measure.startswith("max:")


def history_of(folder):
    """The history of a run; None where it has none."""
    try:
        return History(folder / "history.csv")
    except OSError:
        return None


def measured(history, folder, measure):
    """A measure of the history of the run in a folder, linear between its rows. At a time after the end of a run that came to rest before, the last row
    counts; after another end there is no value."""
    column, time, largest = asked_of(measure)
    values, end = (history.columns | {"time_s": history.time, "step": history.step})[column], history.time[-1]
    if largest:
        return finite(np.nanmax(values)) if np.isfinite(values).any() else None
    if time is None or time <= end * (1 + 1e-9):
        return finite(values[-1] if time is None else np.interp(time, history.time, values))
    rests = any(event["stage"] == history.stage[-1] and event["kind"] in ("rest", "slow", "equilibrium") for event in read_events(folder))
    return finite(values[-1]) if rests else None


def troubles(history, folder):
    """Columns for the soil that left the mesh by the end of a run, and for what it warned of."""
    told = list(dict.fromkeys(event["text"] for event in read_events(folder) if event["warning"]))
    gone, left = (history.columns.get(name, [math.nan])[-1] if history else math.nan for name in ("escaped_mass_kg", "mass_kg"))
    return {"escaped_mass_kg": finite(gone), "escaped_share": finite(gone / (gone + left)) if gone + left else None, "warning_count": len(told), "warnings": told}


def outcome_of(folder, cell=None):
    """What a run came to; a slope that stands has a slide of size 0, but none where runs with cells of other sizes, the largest of which is `cell`, are judged."""
    factor = folder / "factor_of_safety.json"
    if factor.exists():
        solved = json.loads(factor.read_text())
        of = solved["factor_of_safety"]  # known only as a wide bracket: none
        return {"factor_of_safety": of["value"], "factor_with_equilibrium": of["equilibrium"], "factor_with_mechanism": of["mechanism"],
                "moving_volume_m3": solved["mechanisms"][0]["moving_volume_m3"]}
    results = Results(folder)
    row = outcome(results, cell)
    for name, speed in (results.history.groups().get(("velocity", "m/s"), {}) if results.history else {}).items():
        row[f"{name}_largest_speed_m_s"] = float(np.nanmax(speed)) if np.isfinite(speed).any() else None
    return row | (dict.fromkeys(NO_SLIDE, 0.0) if row["state"] == STANDS and cell is None else {})


class Runs:
    """What a sweep ran: `rows` in the order of the runs, those of the `table`, those that `ended` without breaking off and their `folders`, `title`, and
    whether they are sections `in_plane` strain, whose volumes are those of a metre."""

    def __init__(self, folder, design):
        self.folder, self.rows = folder, []
        self.preset, self.measures = design["preset"], design["measures"]
        runs = design["runs"]
        self.folders = [folder / run["folder"] for run in runs if not run["failure"]]
        known = [one for one in (folder / run["folder"] for run in runs) if (one / "run.h5").exists()]
        self.title = design.get("title") or (Results(known[0]).title if known else "")
        self.in_plane = self.preset != "errors" and any(Results(one).per_metre("") == "/m" for one in self.folders[:1])
        cell = max((cell_size(Results(one)) for one in self.folders), default=None) if self.preset == "converge" else None
        for run in runs:
            of = folder / run["folder"]
            history = history_of(of)
            row = run | dict.fromkeys(self.measures) | troubles(history, of)
            if not run["failure"]:
                row |= {measure: measured(history, of, measure) for measure in self.measures}
                row |= outcome_of(of, cell) if self.preset != "errors" else {}
            self.rows.append(row)
        self.table = self.rows
        self.ended = [row for row in self.rows if not row["failure"]]

    def warnings(self):
        """What runs warned of, one sentence for all that differ in their numbers alone."""
        found = {}
        for row in self.rows:
            for sentence in row["warnings"]:
                found.setdefault(re.sub(r"-?[0-9][0-9.]*(e[-+]?[0-9]+)?", "#", sentence), (sentence, {}))[1][row["folder"]] = True
        return [{"warning": sentence, "runs": len(runs), "first_run": next(iter(runs))} for sentence, runs in found.values()]

    def said_of_troubles(self):
        """How many runs lost soil and have warnings, and each warning once."""
        lost = [row for row in self.rows if (row["escaped_share"] or 0) > 0]
        most = max(lost, key=lambda row: row["escaped_share"], default=None)
        lines = [f"soil left the mesh in {len(lost)} of {len(self.rows)} runs" + (f" (at most {100 * most['escaped_share']:.4g} % of it, {most['folder']})" if lost else "")
                 + f", and {sum(row['warning_count'] > 0 for row in self.rows)} have warnings"]
        return lines + [f"warning in {one['runs']} of {len(self.rows)} runs, first in {one['first_run']}: {one['warning']}" for one in self.warnings()]

    def said_of_measures(self):
        """Sentences about measures that some runs have not."""
        without = {measure: [row["run"] for row in self.ended if row[measure] is None] for measure in self.measures}
        return [f"{measure} has no value in {len(runs)} runs, first in run {runs[0]}: they ended before that time without coming to rest, or the point had no soil"
                for measure, runs in without.items() if runs]


def title_of(outcome, in_plane):
    """An outcome in words, with its unit."""
    title = TITLES.get(outcome)
    return named(outcome, in_plane) if title is None else title.replace("[m³]", "[m³/m]") if in_plane else title


def named(outcome, in_plane=False):
    """The name of an outcome as its column has it, in words, with its unit."""
    ending = next((ending for ending in UNITS if outcome.endswith(ending)), "")
    title = with_unit(words(outcome.removesuffix(ending)), UNITS[ending]) if ending else words(outcome)
    return title.replace("[m³]", "[m³/m]") if in_plane else title


def in_words(measure):
    """'max:crest_displacement_m' -> 'largest crest displacement [m]', 'crest_x_m@30' -> 'crest x [m] at 30 s'."""
    column, time, largest = asked_of(measure)
    return "largest " * largest + named(column) + (f" at {time:g} s" if time is not None else "")


def table(rows, keys, columns, width=None):
    """Lines of a table of runs: `keys` and `columns` are {heading: text of a row}; a run that broke off has its keys and the reason."""
    columns = columns | losses(rows)
    texts = [[key(row) for key in keys.values()] + ([f"broke off: {row['failure']}"] if row["failure"] else [text(row) for text in columns.values()]) for row in rows]
    return lines_of([*keys, *columns], texts, len(keys), width)


def digits(column, form=".4g", without="-"):
    return lambda row: without if row.get(column) is None else format(row[column], form)


# ---- studies: cases, probabilities, sensitivities ----

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
    return ", ".join(f"{words(name)} = {written(value)} {units[name]}".rstrip() for name, value in case.items())


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


def said_of_probability(p, of_case):
    side = "below" if "below" in p else "above"
    known = "unknown" if p["probability"] is None else f"{p['probability']:.4g}"
    return (f"{p['criterion']}{f', {of_case}' if of_case else ''}: {p['outcome']} {side} {p[side]:g} in {p['met']} of {p['runs'] - p['unknown']} runs, probability {known}, "
            f"{100 * p['confidence']:g} % interval {p['low']:.4g} to {p['high']:.4g}" + (f"; unknown in {p['unknown']} runs" if p["unknown"] else ""))


def sensitivities(rows, variables, outcome):
    """Effect of each numeric variable on an outcome from a linear fit in all of them: change of the outcome from the 10 % to the 90 % quantile of
    the variable, the others at their means. Means and quantiles are those of the runs with this outcome. None where they are too few."""
    known = [row for row in rows if row.get(outcome) is not None]
    values = {v["name"]: np.array([float(row[v["name"]]) for row in known]) for v in variables if v["numeric"]}
    varies = [v for v in variables if v["numeric"] and len(known) and np.ptp(values[v["name"]]) > 0]
    y = np.array([float(row[outcome]) for row in known])
    if len(known) < len(varies) + 3 or not varies or np.ptp(y) == 0:
        return None
    x = np.column_stack([values[v["name"]] for v in varies])
    middle, spread = x.mean(0), x.std(0)
    fit, *_ = np.linalg.lstsq(np.column_stack([np.ones(len(y)), (x - middle) / spread]), y, rcond=None)
    explained = 1 - np.var(y - fit[0] - (x - middle) / spread @ fit[1:]) / np.var(y)
    quantiles = np.quantile(x, [0.1, 0.9], axis=0)  # of the runs with this outcome, not of the distribution
    low, high = fit[0] + fit[1:] * (quantiles - middle) / spread
    bars = [{"variable": v["name"], "unit": v["unit"], "quantiles": quantiles[:, k].tolist(), "low": float(low[k]), "high": float(high[k])} for k, v in enumerate(varies)]
    bars.sort(key=lambda bar: abs(bar["high"] - bar["low"]))
    return {"outcome": outcome, "runs": len(known), "mean": float(fit[0]), "r2": float(explained), "bars": bars}


def fits_of(cases, variables, shown):
    """A linear fit per outcome and case. Where an outcome has a fit in one case, the others have an entry too: their mean, without bars."""
    fits = []
    for name in (name for name in shown if name != "fails"):
        of_cases = [(case, rows, sensitivities(rows, variables, name)) for case, rows in cases]
        for case, rows, fit in of_cases if any(fit for _, _, fit in of_cases) else ():
            known = [float(row[name]) for row in rows if row.get(name) is not None]
            fits.append({"case": case} | (fit or {"outcome": name, "runs": len(known), "mean": float(np.mean(known)) if known else None, "r2": None, "bars": []}))
    return fits


def correlation_lines(pairs, width=None):
    """Lines that compare the correlation of the sample with the one that was asked for, and sentences on pairs where they are far apart."""
    if not pairs:
        return []
    samples = pairs[0]["samples"]
    rows = [[" and ".join(pair["between"]), f"{pair['asked']:g}", f"{pair['sample']:.2g}"] for pair in pairs]
    lines = [f"correlation of the normal scores of {samples} samples", *lines_of(["variables", "asked for", "in the sample"], rows, width=width)]
    far = [" and ".join(pair["between"]) for pair in pairs if pair["far"]]
    if far:
        lines.append(folded(f"warning: the sample's correlation of {'; '.join(far)} is farther from the asked one than two standard deviations of chance, about "
                            f"{2 / math.sqrt(samples):.2g} for weak correlations, which one sample in twenty is: take more samples or another seed", width))
    return lines


def draw_tornado(all_fits, in_plane, path, title="", variables=()):
    """A panel per outcome, or where there are cases one per outcome and case: those of an outcome have the same axis, so that the distance of their middle
    lines shows what the case does. A case whose runs give no fit has a sentence."""
    columns = min(3, len({case_text(fit.get("case", {}), variables) for fit in all_fits}))
    blocks = [[fit for fit in all_fits if fit["outcome"] == outcome] for outcome in dict.fromkeys(fit["outcome"] for fit in all_fits)]
    heights = [max(len(fit["bars"]) for fit in block) for block in blocks for _ in range(0, len(block), columns)]
    figure, panels = panels_of(len(heights), columns, [len(block) for block in blocks], (6.4 if columns == 1 else 4.3 * columns, 0.35 + sum(0.5 * h + 1.3 for h in heights)),
                               gridspec_kw={"height_ratios": [h + 2.1 for h in heights]})
    for block, own in zip(blocks, panels):
        ends = [end for fit in block for bar in fit["bars"] for end in (bar["low"], bar["high"])] + [fit["mean"] for fit in block if fit["mean"] is not None]
        room = 0.06 * (max(ends) - min(ends))
        for one, fit in zip(own, block):
            draw_bars(one, fit, title_of(fit["outcome"], in_plane), case_text(fit.get("case", {}), variables))
            one.set_xlim(min(ends) - room, max(ends) + room)
    style.legend_below(figure, next(handles for handles in (one.get_legend_handles_labels()[0] for one in figure.axes) if handles))
    style.headline(figure, "What decides", title)
    return style.save(figure, path)


def panels_of(lines, columns, counts, size, **options):
    """A figure, and for each count so many axes, which begin in a line of their own."""
    figure, axes = plt.subplots(lines, columns, figsize=size, squeeze=False, layout="constrained", **options)
    panels, line = [], 0
    for count in counts:
        own = axes[line:line - (-count // columns)].ravel()
        line -= -count // columns
        for one in own[count:]:
            one.remove()
        panels.append(own[:count])
    return figure, panels


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
        known = [row for row in rows if row.get(outcome) is not None]
        for one, v in zip(line, variables):
            choices = list(dict.fromkeys(row[v["name"]] for row in known + broken))
            place = (lambda row, v=v: float(row[v["name"]])) if v["numeric"] else lambda row, v=v, choices=choices: choices.index(row[v["name"]])
            for (_, of_case), shape in zip(cases, SHAPES):
                dots = [row for row in of_case if row.get(outcome) is not None]
                colours = [style.LINES[1] if any(state(row, c) == MET for c in about or criteria) else style.LINES[0] for row in dots]
                one.scatter(list(map(place, dots)), [float(row[outcome]) for row in dots], s=11, c=colours, marker=shape, alpha=0.75, linewidths=0)
            for criterion in about:
                one.axhline(criterion["limit"], color=style.INK, lw=0.8, ls=":")
            for row in broken:
                mark(one, place(row), 0, None, style.SOFT)
            if not v["numeric"]:
                one.set_xticks(range(len(choices)), choices)
            one.set_xlabel(with_unit(words(v["name"]), v["unit"]))
        line[0].set_ylabel(textwrap.fill(title_of(outcome, in_plane), 28))
    dot = {"ls": "", "ms": 4}
    handles = [plt.Line2D([], [], marker="o", color=style.LINES[k], label=text, **dot) for k, text in enumerate(("no criterion is met", "a criterion is met"))] if criteria else []
    handles += [plt.Line2D([], [], marker=shape, color=style.SOFT, label=case_text(case, variables), **dot) for (case, _), shape in zip(cases, SHAPES) if case]
    if broken:
        handles.append(plt.Line2D([], [], marker=MARKS[None][0], color=style.SOFT, label=f"at the lower edge: {len(broken)} of {len(rows)} runs broke off", ls="", ms=5))
    if handles:
        style.legend_below(figure, handles)
    style.headline(figure, "Outcomes against the variables", title)
    return style.save(figure, path)


def draw_exceedance(cases, variables, shown, criteria, confidence, in_plane, path, title=""):
    """A panel per outcome with a curve per case; intervals are drawn as long as they do not cover each other."""
    columns = min(3, len(shown))
    lines = -(-len(shown) // columns)
    figure, (axes,) = panels_of(lines, columns, [len(shown)], (max(5.2, 4.2 * columns), 0.3 + 3.3 * lines))
    for one, outcome in zip(axes, shown):
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


def study(runs, design):
    """Of `talus study`: lines, what study.json has, pictures, and whether the status is 1."""
    rows, variables, criteria, confidence = runs.rows, design["variables"], design["criteria"], design["confidence"]
    for row in rows:
        row |= {f"meets_{criterion['name']}": {MET: "yes", NOT_MET: "no", UNKNOWN: ""}[state(row, criterion)] for criterion in criteria}
    broken, sampled, cases = [row for row in rows if row["failure"]], any(v["random"] for v in variables), cases_of(rows, variables)
    lines = [f"{len(rows)} of {design['planned']} runs, {len(broken)} of which broke off", *(folded(f"  run {row['run']} broke off: {row['failure']}") for row in broken[:5])]
    states = [row["state"] for row in rows if "state" in row]
    if states:
        lines.append(folded(f"the slope fails in {states.count(FAILS)} runs, moves by less than a cell in {states.count(MOVES)}, stands in {states.count(STANDS)}"))
    pairs = correlations([v["name"] for v in variables if v["random"]], design["asked"], design["scores"])
    lines += correlation_lines(pairs)
    estimates = [{"case": case} | probability(of_case, c, confidence) for c in criteria for case, of_case in cases] if sampled else []
    chosen = [words(v["name"]) for v in deciding(variables)]
    if estimates and len(cases) > 1:
        lines.append(folded(f"{' and '.join(chosen)}: values that are chosen and have no probability, so each combination has its own; "
                            f"the {len(cases)} combinations share their samples"))
    lines += [folded(said_of_probability(p, case_text(p["case"], variables))) for p in estimates]
    names = dict.fromkeys([*(c["outcome"] for c in criteria), *SHOWN, *runs.measures])
    shown = [name for name in names if len({float(row[name]) for row in rows if row.get(name) is not None}) > 1]
    fits, few, curves = fits_of(cases, variables, shown), len(cases) <= MANY, [outcome for outcome in shown if outcome != "fails"]
    if fits and not few:
        lines.append(folded(f"tornado.png is not drawn: {len(cases)} combinations of {', '.join(chosen)} have a fit of their own, see study.json"))
    lines += map(folded, runs.said_of_measures())
    title, in_plane = runs.title, runs.in_plane
    pictures = {"tornado": fits and few and (lambda path: draw_tornado(fits, in_plane, path, title, variables)),
                "scatter": shown and (lambda path: draw_scatter(rows, variables, shown, criteria, in_plane, path, title)),
                "exceedance": curves and sampled and (lambda path: draw_exceedance(cases, variables, curves, criteria, confidence, in_plane, path, title))}
    return lines, {"correlations": pairs, "probabilities": estimates, "sensitivities": fits}, pictures, len(broken) == len(rows)


# ---- comparisons: outcomes against a key ----

def name_lines(rows):
    """Gives each row the `line` of the chart to which it belongs: its series and, where that varies further keys than the last one, their values."""
    for row in rows:
        own, *others = (" ".join(one["overrides"][:-1]) for one in (row, *rows) if one["series"] == row["series"])
        row["line"] = f"{row['series']}, {own}" if any(other != own for other in others) else row["series"]


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
    return f"Of {len(names)} named points {len(shown)} are shown, evenly from the one that moved farthest to the one that moved least; study.csv has all"


def charted(rows, in_plane=False):
    """The outcomes of runs, those of the same kind together: [(title, {label: column})]."""
    known, shown = points_of(rows)
    hidden = {name + ending for name in set(known) - set(shown) for ending in OF_POINTS.values()}
    charts = {}
    for name in dict.fromkeys(key for row in rows for key in row):
        if name in LEFT_OUT or name in hidden or not any(isinstance(row.get(name), float) for row in rows):
            continue
        kind, ending = next(((title, ending) for title, ending in OF_POINTS.items() if name.endswith(ending)), (None, ""))
        charts.setdefault(kind or title_of(name, in_plane), {})[words(name.removesuffix(ending)) if kind else ""] = name
    return list(charts.items())


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
    choices = list(dict.fromkeys(row["value"] for row in rows))
    numeric = all(isinstance(choice, float) for choice in choices)
    place = [row["value"] if numeric else choices.index(row["value"]) for row in rows]
    series = list(dict.fromkeys(row["line"] for row in rows))
    labels = list(dict.fromkeys(label for _, of in charts if len(of) > 1 for label in of))  # one colour in all charts
    outside = []
    for one, (title, of) in zip(axes, charts):
        for label, column in of.items():
            for n, name in enumerate(series):
                known = sorted((x, row[column], row["state"]) for x, row in zip(place, rows) if row["line"] == name and row.get(column) is not None)
                if not known:
                    continue
                x, y, _ = zip(*known)
                colour = style.LINES[(labels.index(label) if len(of) > 1 else n) % len(style.LINES)]
                legend = ", ".join(filter(None, (label, name if len(series) > 1 else "")))
                one.plot(x, y, ("-", "--", ":", "-.")[n % 4 if len(of) > 1 else 0], color=colour, lw=1.1, label=legend)
                for a, b, state in known:
                    mark(one, a, b, state, colour)
        for x, row in zip(place, rows):
            if row["failure"]:
                mark(one, x, 0, None, style.SOFT)
            elif "load_time_of_failure_s" in of.values() and row in never_failed(rows, charts):
                mark(one, x, 1, row["state"], style.LINES[series.index(row["line"]) % len(style.LINES)], never=True)
        if any(any(each) for each in (of, series[1:])):
            if len(one.get_legend_handles_labels()[0]) > INSIDE:
                outside += one.get_legend_handles_labels()[0]
            else:
                one.legend(fontsize=7.5)
        one.set_xlabel(textwrap.fill(with_unit(rows[0]["key"], rows[0]["unit"]), 38, break_on_hyphens=False))
        one.set_ylabel(textwrap.fill(title, 34))
        low, high = one.get_ylim()
        one.set_ylim(min(0, low), high + 0.06 * (high - min(0, low)))
        least, most = min(place), max(place)
        if not numeric:
            one.set_xlim(-0.05 * most - 0.05, 1.05 * most + 0.05)
            one.set_xticks(range(len(choices)), [textwrap.fill(written(choice), 14) for choice in choices])
        elif least > 0 and most > 20 * least:
            one.set_xscale("log")
            one.set_xlim(least ** 1.05 / most ** 0.05, most ** 1.05 / least ** 0.05)
            style.few_log_ticks(one)
        elif most > least:  # the same for all outcomes, also where few runs have a value
            one.set_xlim(least - 0.05 * (most - least), most + 0.05 * (most - least))
    return outside


def draw_outcomes(rows, path, in_plane=False, title=""):
    """Charts of all outcomes, one row of them or more for each key that is varied. Runs that broke off have no outcome: a cross at the lower
    edge marks their value of the key."""
    parts = [[row for row in rows if row["key"] == key] for key in dict.fromkeys(row["key"] for row in rows)]
    parts = [(part, charts) for part, charts in ((part, charted(part, in_plane)) for part in parts) if charts]
    columns = min(3, max(len(charts) for _, charts in parts))
    lines = sum(-(-len(charts) // columns) for _, charts in parts)
    figure, panels = panels_of(lines, columns, [len(charts) for _, charts in parts], (3.9 * columns, 3.1 * lines))
    outside = [line for own, (part, charts) in zip(panels, parts) for line in draw_charts(own, part, charts)]
    states = {row.get("state") for row in rows}
    handles = [plt.Line2D([], [], marker=MARKS[state][0], color=style.SOFT, ls="", ms=5, fillstyle=MARKS[state][1], markerfacecoloralt="white",
                          mfc="white" if MARKS[state][1] == "none" else None, label=LEGEND[state]) for state in MARKS if state in states]
    if any(never_failed(part, charts) for part, charts in parts):
        handles.append(plt.Line2D([], [], ls="", label=NEVER))
    if said := said_of_points(rows):
        handles.append(plt.Line2D([], [], ls="", label=said.partition(",")[0]))
    handles += {(one.get_label(), one.get_color(), one.get_linestyle()): one for one in outside}.values()
    keys = dict.fromkeys(words(row["key"].rpartition(".")[2]) for row in rows)
    style.headline(figure, f"Outcomes against {', '.join(filter(None, keys)) or 'the series'}", title)
    style.legend_below(figure, handles, min(len(handles), 2 * columns + 1) if outside else None)
    return style.save(figure, path)


def table_of_outcomes(rows, in_plane=False, width=None):
    """Lines of the table of all runs."""
    value = words(with_unit(rows[0]["key"], rows[0]["unit"]).rpartition(".")[2]) if len({row["key"] for row in rows}) == 1 else "value"
    return table(rows, {"series": lambda row: row["line"], value: lambda row: written(row["value"])},
                 {"state": lambda row: row.get("state", "")} | {named(column, in_plane): digits(column) for _, of in charted(rows) for column in of.values()}, width)


def outcomes(runs, _):
    """Of `talus compare` without a measure."""
    rows = runs.rows
    name_lines(rows)
    lines = table_of_outcomes(rows, runs.in_plane) + [folded(said) for said in [said_of_points(rows)] if said]
    pictures = {"sweep": runs.ended and charted(rows) and (lambda path: draw_outcomes(rows, path, runs.in_plane, runs.title))}
    return lines, {}, pictures, len(runs.ended) < len(rows)


# ---- comparisons: errors ----

def reference_of(rows, measure):
    """The limit of the line that converges best."""
    ends = [(line, *extrapolate([(row["value"], row[measure]) for row in rows if row["line"] == line and not row["failure"] and isinstance(row["value"], float)]))
            for line in dict.fromkeys(row["line"] for row in rows)]
    line, value, uncertainty, origin = min(ends, key=lambda end: end[2])
    if math.isinf(uncertainty):
        print("no series has two runs that differ by their last key: without --exact or --reference there is nothing to measure errors against", file=sys.stderr)
        return math.nan, math.inf, "none"
    return value, uncertainty, f"{line}: {origin}"


def scale_of(values):
    """Logarithmic, but where all values lie within a decade, whose numbers would overlap."""
    values = [value for value in values if value is not None and value > 0]
    return "log" if values and max(values) > 9.99 * min(values) else "linear"


def draw_errors(rows, reference, path, title=""):
    """Error against processor time and against the refined key, and the values themselves, a line per series; each key that some series refine has its own charts
    against it."""
    measure, uncertainty = reference["measure"], reference["uncertainty"]
    rows = [row for row in rows if not row["failure"] and row[measure] is not None]
    name, keys = in_words(measure), list(dict.fromkeys(row["key"] for row in rows))
    figure = plt.figure(figsize=(10.6, 3.4 * len(keys)), layout="constrained")
    grid = figure.add_gridspec(len(keys), 3)
    cost = figure.add_subplot(grid[:, 0])
    colours = {line: style.LINES[k % len(style.LINES)] for k, line in enumerate(dict.fromkeys(row["line"] for row in rows))}
    for n, key in enumerate(keys):
        order, values = figure.add_subplot(grid[n, 1]), figure.add_subplot(grid[n, 2])
        mine = [row for row in rows if row["key"] == key]
        around = np.median([row[measure] for row in mine])
        spread = 5 * np.median([abs(row[measure] - around) for row in mine])
        for line in dict.fromkeys(row["line"] for row in mine):
            h, v, x, y = (np.array([row[column] if isinstance(row[column], (int, float)) else math.nan for row in mine if row["line"] == line])
                          for column in ("value", measure, "processor_s", "error"))
            look = {"color": colours[line], "markersize": 4, "linewidth": 1}
            cost.plot(x[y > 0], y[y > 0], "o-", label=line, **look)
            order.plot(h[y > 0], y[y > 0], "o-", **look)
            values.plot(h, v, "o-", **look)
        refined = with_unit(key, mine[0]["unit"])
        values.axhline(reference["value"], color=style.INK, linewidth=0.8, linestyle=":")
        xscale = scale_of(row["value"] for row in mine if isinstance(row["value"], float))
        order.set(xscale=xscale, yscale=scale_of(row["error"] for row in mine), xlabel=refined, ylabel="error of " + name)
        values.set(xscale=xscale, xlabel=refined, ylabel=name)
        low, high = values.get_ylim()
        if spread > 0:  # a series that misses by far would flatten the others
            values.set_ylim(max(low, around - spread), min(high, around + spread))
    best = sorted((row["processor_s"], row["error"]) for row in rows if row["pareto"] and row["error"])
    if best:
        cost.step(*zip(*best), where="post", color=style.INK, linewidth=0.8, linestyle=":", label="Pareto front")
    cost.set(xscale=scale_of(row["processor_s"] for row in rows), yscale=scale_of(row["error"] for row in rows), xlabel="processor time [s]", ylabel="error of " + name)
    if 0 < uncertainty < math.inf:  # as far down as the errors go
        low, high = cost.get_ylim()
        low, high = (min(low, uncertainty / 2), max(high, 1.2 * uncertainty)) if cost.get_yscale() == "log" else (min(low, 0), max(high, 1.2 * uncertainty))
        cost.axhspan(low, uncertainty, color=style.FAINT, alpha=0.4, label="reference uncertain")
        cost.set_ylim(low, high)
    cost.legend(fontsize=7.5)
    style.few_log_ticks(*figure.axes)
    style.headline(figure, f"Error of {name.partition(' [')[0]} against cost and refinement", title)
    return style.save(figure, path)


def varied(row, rows):
    """What a run sets that other runs of its series set otherwise, with the last words of the keys."""
    others = [one["overrides"] for one in rows if one["series"] == row["series"]]
    own = [word.partition("=") for word in row["overrides"] if not all(word in other for other in others)]
    return ", ".join(key.rpartition(".")[2] + "=" + value for key, _, value in own)


def table_of_errors(rows, measure, width=None):
    """Lines of the table of all runs."""
    return table(rows, {"series": lambda row: row["series"], "varied": lambda row: varied(row, rows)},
                 {"value": digits(measure, ".8g"), "error": digits("error", ".2e"), "processor time [s]": digits("processor_s", ".3g"),
                  "steps": digits("steps", ".0f"), "evaluations": digits("evaluations", ".0f"), "attempts rejected": digits("rejections", ".0f")}, width)


def errors(runs, design):
    """Of `talus compare` with a measure."""
    [measure] = runs.measures
    truth = [row for row in runs.rows if row["run"] == design.get("reference")]
    if any(row["failure"] for row in truth):
        sys.exit(f"talus: the run of --reference failed: {truth[0]['failure']}")
    rows = runs.table = [row for row in runs.rows if row not in truth]
    name_lines(rows)
    if "exact" in design:
        value, uncertainty, origin = design["exact"], 0.0, "given as exact"
    elif "reference" in design:
        value, uncertainty, origin = truth[0][measure] if truth else None, 0.0, truth[0]["series"] if truth else "its run is missing"
    else:
        value, uncertainty, origin = reference_of(rows, measure)
    value = math.nan if value is None else value
    for row in rows:
        counts = ([event["values"] for event in read_events(runs.folder / row["folder"], "steps")] or [{}])[-1]
        row |= {name: int(counts.get(name, 0)) for name in ("steps", "evaluations", "rejections")}
        row["error"] = None if row[measure] is None or math.isnan(value) else abs(row[measure] - value)
    known = [row for row in rows if row["error"] is not None]
    for row in rows:  # does no other run take less time and have a smaller error?
        row["pareto"] = int(row in known and not any(other["processor_s"] < row["processor_s"] and other["error"] < row["error"] for other in known))
    reference = {"measure": measure, "value": value, "uncertainty": uncertainty, "origin": origin}
    lines = [f"{measure}; reference {value:.8g} +- {uncertainty:.2g} ({origin})", "", *table_of_errors(rows, measure), *map(folded, runs.said_of_measures())]
    return lines, {"reference": reference}, {"compare": any(row[measure] is not None for row in rows) and (lambda path: draw_errors(rows, reference, path, runs.title))}, len(runs.ended) < len(runs.rows)


# ---- convergence ----

THINGS = {"cells": "cell size", "steps": "time step", "particles": "number of particles per cell"}
REMEDY = {
    "cells": "Take smaller cells and look again. Until then their scatter is the error of these numbers",
    "steps": "Take smaller steps and look again",
    "particles": "Take more particles per cell and look again",
}
# where soil softens, and its cells decide something
SOFTENING = "Look at `talus check` for softening that is too brittle for these cells, and give the soil an averaging_length. "
JUDGED = (("load_time_of_failure_s", "The load time at failure", "s"), ("largest_displacement_m", "The largest displacement", "m"),
          ("travel_distance_m", "The travel distance, from the rear of the slide to its front,", "m"), ("volume_of_slide_m3", "The volume of the slide", "m³"),
          ("depth_of_slide_m", "The depth of the slip surface", "m"))
TO_A_CELL = ("travel_distance_m", "depth_of_slide_m")  # rear, front and slip surface are known to a cell
RESULTS = {"failure at t [s]": "load_time_of_failure_s", "largest u [m]": "largest_displacement_m", "travel [m]": "travel_distance_m", "volume [m³]": "volume_of_slide_m3",
           "depth [m]": "depth_of_slide_m", "at x [m]": "deepest_at_x_m", "steps": "steps", "run time [s]": "wall_s"}


def percent(difference, values):
    """A difference as a share of the finest run's value, "12 %"; round-off is 0."""
    share = 100 * difference / abs(values[-1]) if values[-1] else 0.0
    return f"{share:.2g} %" if share >= 0.01 else "0 %"


def refined(row, by):
    return f"{row['value']:g} m" if by == "cells" else f"{row['value']:g} {row['unit']}".rstrip()


def said_of_quantity(name, unit, rows, values, verdict, by, within, least, cell):
    """A sentence on what refinement does to a quantity."""
    if verdict == "missing":
        without = ", ".join(refined(row, by) for row, value in zip(rows, values) if value is None)
        known = ", ".join(f"{value:.4g} {unit} with {refined(row, by)}" for row, value in zip(rows, values) if value is not None)
        return f"{name} is missing with {without}, and {known}: the {THINGS[by]} decides it."
    factor, unit = readable_unit(max(map(abs, values)), unit)
    text = f"{name} is {factor * min(values):.3g} to {factor * max(values):.3g} {unit}, {percent(max(values) - min(values), values)} apart: "
    if verdict == "equal":
        return text + f"the {THINGS[by]} does not decide it within {100 * within:g} %" + (f" or one cell of {cell:.2g} m." if within * abs(values[-1]) < least else ".")
    if verdict == "settles":
        last = abs(values[-1] - values[-2])
        return text + f"it settles, and the last refinement changes it by {percent(last, values)}" + (f", less than one cell of {cell:.2g} m." if last > within * abs(values[-1]) else ".")
    return text + f"it {'swings' if verdict == 'swings' else 'does not settle'}, and the {THINGS[by]} decides it."


def judge(rows, by, within, softening=False, in_plane=False):
    """([sentence], whether the refined quantity decides something, [what it does to each quantity]). `rows` from coarse to fine;
    `softening` says that soil softens."""
    remedy = (SOFTENING if softening and by == "cells" else "") + REMEDY[by] + "."
    sentences = [f"The run with {refined(row, by)} broke off: {row['failure']}." for row in rows if row["failure"]]
    decides, judged, rows = bool(sentences), [], [row for row in rows if not row["failure"]]
    if len(rows) < 3:
        return sentences + ["Fewer than three runs came to their end, so that nothing can be said."], True, judged
    cell = max(row["cell_m"] for row in rows)
    sizes = [1 / row["value"] if by == "particles" else row["value"] for row in rows]
    verbs = {FAILS: "fails", MOVES: f"moves by less than a cell of {cell:.2g} m", STANDS: "stands"}
    states = {state: some for state in verbs if (some := [refined(row, by) for row in rows if row["state"] == state])}
    if len(states) > 1 and settles(sizes, [row["largest_displacement_m"] for row in rows], within) != "equal":
        each = [f"{verbs[state]} with {', '.join(some)}" for state, some in states.items()]
        sentences.append(f"The slope {', '.join(each[:-1])} and {each[-1]}: the {THINGS[by]} decides whether it fails.")
        return sentences + [remedy], True, judged
    sentences.append(f"The slope {verbs[next(iter(states))]} in all {len(rows)} runs.")
    points = [(key, f"The displacement of {words(key.removesuffix('_displacement_m'))}", "m") for key in rows[-1]
              if key.endswith("_displacement_m") and key != "largest_displacement_m"]
    for key, name, unit in (*JUDGED[:2], *points, *JUDGED[2:]):
        values, least = [row.get(key) for row in rows], cell if key in TO_A_CELL else 0.0
        if not any(value is not None for value in values):
            continue
        verdict = settles(sizes, values, within, least)
        judged.append({"quantity": key, "values": values, "state": verdict})
        sentences.append(said_of_quantity(name, unit + "/m" * (in_plane and unit == "m³"), rows, values, verdict, by, within, least, cell))
        decides |= verdict not in ("equal", "settles")
    return sentences + [remedy] * decides, decides, judged


def table_of_refinement(rows, by, in_plane, width=None):
    """Lines of the table of all runs."""
    columns = {heading.replace("m³", "m³/m") if in_plane else heading: digits(key, ",d" if key == "steps" else ".4g", "none") for heading, key in RESULTS.items()}
    return table(rows, {by: lambda row: f"{row['value']:g}"}, {"state": lambda row: row["state"]} | columns, width)


def draw_sections(results, rows, by, path):
    """Displacement and plastic strain at the end of all runs, side by side on the same scales."""
    lasts = [one.snapshots[-1] for one in results]
    painters = [Painter(one, [last]) for one, last in zip(results, lasts)]
    fields = [field for field in ("displacement", "plastic_strain") if all(last.scalar(field) is not None for last in lasts)]
    section = painters[0].section
    low = np.min([painter.corners[section][0] for painter in painters], axis=0)
    high = np.max([painter.corners[section][1] for painter in painters], axis=0)
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
            axes.set_title(f"{refined(row, by)}: {how}" if n == 0 else "", loc="left", pad=5)
            if k == 0:
                axes.set_ylabel(f"{'xyz'[painter.views[section].up]} [m]")
            if n == len(fields) - 1:
                axes.set_xlabel(f"{'xyz'[painter.views[section].across]} [m]")
        bar = colours.bar(figure, [1 - (RIGHT - 0.22) / WIDTH, (top - tall) / height, 0.15 / WIDTH, tall / height])
        bar.set_title(f"{style.SYMBOL[field]} {colours.unit}".strip(), fontsize=9, pad=6)
    figure.text(LEFT / WIDTH, 1 - 0.2 / height, f"At the end, by {THINGS[by]}", fontsize=13, fontweight="bold", va="center")
    figure.text(1 - 0.25 / WIDTH, 1 - 0.2 / height, results[0].title, fontsize=9, color=style.SOFT, va="center", ha="right")
    return style.save(figure, path)


def converge(runs, design):
    """Of `talus converge`."""
    by, within = design["by"], design["within"]
    sentences, decides, judged = judge(runs.rows, by, within, design["softening"], runs.in_plane)
    lines = [*table_of_refinement(runs.rows, by, runs.in_plane), "", *map(folded, sentences)]
    page = {"by": by, "within": within, "decides": decides, "verdict": sentences, "quantities": judged}
    return lines, page, {"converge": runs.ended and (lambda path: draw_sections([Results(one) for one in runs.folders], runs.ended, by, path))}, decides


# ---- all ----

PRESETS = {"study": study, "outcomes": outcomes, "errors": errors, "converge": converge}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--no-plot", action="store_true")
    given = parser.parse_args()
    design = json.loads((given.folder / "design.json").read_text())
    runs = Runs(given.folder, design)
    lines, page, pictures, status = PRESETS[runs.preset](runs, design)
    with open(given.folder / "study.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        names = list(dict.fromkeys(name for row in runs.table for name in row))
        lists = {"overrides": " ", "warnings": " | "}
        writer.writerows([names, *([lists[name].join(row[name]) if name in lists else written(row.get(name)) for name in names] for row in runs.table)])
    write_json(given.folder / "study.json", {"title": runs.title, "runs": len(runs.rows), "planned": design["planned"], "broke_off": len(runs.rows) - len(runs.ended),
                                             "warnings": runs.warnings()} | page)
    print("\n".join([*lines, *runs.said_of_troubles()]), flush=True)
    for name, draw in pictures.items():
        path = given.folder / f"{name}.png"
        if draw and not given.no_plot:
            draw(path)
        else:
            path.unlink(missing_ok=True)  # of an earlier call
    return int(status)


if __name__ == "__main__":
    sys.exit(main())
