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
import math
import pathlib
import re
import sys
import textwrap

import numpy as np

import talus_style as style
from talus_outcomes import FAILS, MOVES, STANDS, cell_size, finite, losses, outcome, write_json
from talus_results import History, Results, read_events
from talus_statistics import ORDERS, clopper_pearson, extrapolate, order_of, rest_of, settles
from talus_style import plt
from talus_table import folded, lines_of
from talus_units import in_use, of_column, quantity, readable_unit, use, with_unit, words
from talus_workbook import write_workbook

SHOWN = ("factor_of_safety", "load_time_of_failure_s", "travel_distance_m", "largest_displacement_m")  # of a study
OF_SLIDE = ("travel_distance_m", "volume_of_slide_m3", "depth_of_slide_m")  # 0 where the slope stands
TO_A_CELL = ("travel_distance_m", "depth_of_slide_m")  # rear, front and slip surface are known to a cell
OF_POINTS = ("_displacement_m", "_largest_speed_m_s")  # endings
MOST = 5  # named points that charts and the table show
LEFT_OUT = ("cell_m", "deepest_at_x_m", "run_out_from_toe_m", "fall_height_m", "angle_of_reach_deg", "area_m2", "value", "processor_s", "wall_s", "escaped_mass_kg", "escaped_share")  # numbers that are no outcomes
MET, NOT_MET, UNKNOWN = 1, 0, -1
MANY = 6  # cases: more have no pictures of their fits
# marker, how it is filled, and what it says
MARKS = {FAILS: ("o", "full", "the slope fails"), MOVES: ("s", "left", "it moves by less than a cell"), STANDS: ("o", "none", "it stands"), "": ("o", "full", None),
         "broke off": ("X", "full", "at the lower edge: the run broke off"), "never": ("o", "none", "at the upper edge: it did not fail by the end")}


# ---- rows ----

def written(value):
    """A value as tables and names of cases have it."""
    return f"{value:.10g}" if isinstance(value, float) else "" if value is None else str(value)


def asked_of(measure):
    """(column, time or None, whether the largest value counts) of a measure: COLUMN, COLUMN@TIME or max:COLUMN."""
    column, _, time = measure.removeprefix("max:").partition("@")
    return column, float(time) if time else None, measure.startswith("max:")


def spoken(outcome, in_plane=False):
    """An outcome or a measure in words, its SI unit, and its time in words."""
    column, time, largest = asked_of(outcome)
    text, unit = of_column(column)
    return "largest " * largest + text, unit + "/m" * (in_plane and unit == "m³"), f" at {time:g} s" if time is not None else ""


def named(outcome, in_plane=False):
    """The same with the unit in which charts and tables write it: 'max:crest_displacement_m' is 'largest crest displacement [m]'."""
    text, unit, when = spoken(outcome, in_plane)
    return with_unit(text, in_use(unit)[1]) + when


def factor_of(outcome, in_plane=False):
    """From SI to that unit."""
    return in_use(spoken(outcome, in_plane)[1])[0]


def measured(history, folder, measure):
    """A measure of the history of the run in a folder, linear between its rows; None where it has no such column. At a time after the end of a run that came
    to rest before, the last row counts; after another end there is no value."""
    column, time, largest = asked_of(measure)
    values, end = (history.columns | {"time_s": history.time, "step": history.step}).get(column), history.time[-1]
    if values is None or not np.isfinite(values).any():
        return None
    if largest or time is None:
        return finite(np.nanmax(values) if largest else values[-1])
    if time <= end * (1 + 1e-9):
        return finite(np.interp(time, history.time, values))
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
    return row | (dict.fromkeys(OF_SLIDE, 0.0) if row["state"] == STANDS and cell is None else {})


class Runs:
    """What a sweep ran: `rows` in the order of the runs, those that `ended` without breaking off and their `folders`, `title`, and whether they are sections
    `in_plane` strain, whose volumes are those of a metre."""

    def __init__(self, folder, design):
        self.folder, self.preset, self.measures = folder, design["preset"], design["measures"]
        self.folders = [folder / run["folder"] for run in design["runs"] if not run["failure"]]
        known = next((Results(one) for one in self.folders if (one / "run.h5").exists()), None)
        use(known.scene if known else {})
        self.title = design.get("title") or (known.title if known else "")
        self.in_plane = known is not None and known.per_metre("") == "/m"
        cell = max((cell_size(Results(one)) for one in self.folders), default=None) if self.preset == "converge" else None
        self.rows = [self.row_of(run, folder / run["folder"], cell) for run in design["runs"]]
        self.ended = [row for row in self.rows if not row["failure"]]

    def row_of(self, run, folder, cell):
        history = History(folder / "history.csv") if (folder / "history.csv").exists() else None
        row = run | dict.fromkeys(self.measures) | troubles(history, folder)
        if run["failure"]:
            return row
        return row | {measure: measured(history, folder, measure) for measure in self.measures} | (outcome_of(folder, cell) if self.preset != "errors" else {})

    def warnings(self):
        """What runs warned of, one sentence for all that differ in their numbers alone."""
        found = {}
        for row in self.rows:
            for sentence in row["warnings"]:
                found.setdefault(re.sub(r"-?[0-9][0-9.]*(e[-+]?[0-9]+)?", "#", sentence), (sentence, {}))[1][row["folder"]] = True
        return [{"warning": sentence, "runs": len(runs), "first_run": next(iter(runs))} for sentence, runs in found.values()]

    def told(self):
        """Sentences about all runs: measures without a value, how many runs lost soil and have warnings, and each warning once."""
        without = {measure: [row["run"] for row in self.ended if row[measure] is None] for measure in self.measures}
        lines = [f"{measure} has no value in {len(runs)} runs, first in run {runs[0]}: they ended before that time without coming to rest, or the point had no soil"
                 for measure, runs in without.items() if runs]
        lost = [row for row in self.rows if (row["escaped_share"] or 0) > 0]
        most = max(lost, key=lambda row: row["escaped_share"], default=None)
        lines.append(f"soil left the mesh in {len(lost)} of {len(self.rows)} runs" + (f" (at most {100 * most['escaped_share']:.4g} % of it, {most['folder']})" if lost else "")
                     + f", and {sum(row['warning_count'] > 0 for row in self.rows)} have warnings")
        return lines + [f"warning in {one['runs']} of {len(self.rows)} runs, first in {one['first_run']}: {one['warning']}" for one in self.warnings()]


def table(rows, columns, in_plane=False, width=None, like=None):
    """Lines of a table of runs: their `line` and value, and `columns` {outcome: format}; a run that broke off has its reason. Columns have the units of
    those that they are `like`."""
    def text(row, column, form):
        value = row.get(column)
        return "-" if value is None else format(value * factor_of((like or {}).get(column, column), in_plane), form) if isinstance(value, float) else str(value)
    value = words(with_unit(rows[0]["key"], rows[0]["unit"]).rpartition(".")[2]) if len({row["key"] for row in rows}) == 1 else "value"
    lost = losses(rows)
    texts = [[row["line"], written(row["value"])] + ([f"broke off: {row['failure']}"] if row["failure"] else
             [text(row, *column) for column in columns.items()] + [one(row) for one in lost.values()]) for row in rows]
    return lines_of(["series", value, *(named(column, in_plane) for column in columns), *lost], texts, 2, width)


# ---- pictures ----

def charts(path, what, title, blocks, columns=3, size=(3.9, 3.1)):
    """A picture of panels, each a function that draws into axes of `size` [inch]; each of the `blocks` of panels begins in a line of its own. Below them is one
    legend of all that has a label in the panels, each label once."""
    columns = min(columns, max(map(len, blocks)))
    panels = [panel for block in blocks for panel in [*block, *[None] * (-len(block) % columns)]]
    lines = len(panels) // columns
    figure, axes = plt.subplots(lines, columns, figsize=(max(5.2, size[0] * columns), 0.4 + size[1] * lines), squeeze=False, layout="constrained")
    for one, panel in zip(axes.ravel(), panels):
        panel(one) if panel else one.remove()
    style.few_log_ticks(*figure.axes)
    labels = {label: handle for one in figure.axes for handle, label in zip(*one.get_legend_handles_labels())}
    if labels:
        style.legend_below(figure, labels.values(), max(1, min(len(labels), int(figure.get_figwidth() / (0.075 * max(map(len, labels)) + 0.5)))))
    style.headline(figure, what, title)
    return style.save(figure, path)


def against(key, label, rows, outcomes, title, lines, joined=True, limits=(), log=False, factor=1.0):
    """A panel: outcomes {name: column} of runs against their `key`, a colour for each outcome or else for each of the `lines` to which runs belong, `joined` or
    not, with a mark for what came of each run. `limits` are values to see; `log` is for an ordinate of powers of ten; `factor` is that of the unit in the `title`."""
    values = list(dict.fromkeys(row[key] for row in rows))
    numeric = all(isinstance(value, (int, float)) for value in values)
    at = {value: value if numeric else k for k, value in enumerate(values)}
    several = len(outcomes) > 1

    def draw(axes, own, column, colour, **look):
        known = sorted((at[row[key]], factor * row[column]) for row in own if row.get(column) is not None)
        if known:
            axes.plot(*np.transpose(known), color=colour, lw=1.1, **(look if joined else look | {"ls": "", "marker": "o", "ms": 4}))
        marks = {}
        for row in own:
            late = column == "load_time_of_failure_s" and row.get(column) is None
            value = row.get(column)
            state, y = ("broke off", 0) if row["failure"] else ("never", 1) if late else (row.get("state", ""), None if value is None else factor * value)
            if y is not None:
                marks.setdefault(state, []).append((at[row[key]], y))
        for state, points in marks.items():
            shape, fill, said = MARKS[state]
            axes.plot(*np.transpose(points), shape, color=colour, ms=4.5, fillstyle=fill, mfc="white" if fill == "none" else None, markerfacecoloralt="white", label=said,
                      zorder=3, clip_on=False, transform=axes.get_xaxis_transform() if state in ("broke off", "never") else axes.transData)

    def panel(axes):
        axes.plot(list(at.values()), [0] * len(at), ls="", transform=axes.get_xaxis_transform())  # all outcomes have the same range, also those of few runs
        for n, line in enumerate(lines):
            for k, (name, column) in enumerate(outcomes.items()):
                draw(axes, [row for row in rows if row.get("line", "") == line], column, style.LINES[(k if several else n) % len(style.LINES)],
                     ls=("-", "--", ":", "-.")[n % 4 if several else 0], label=", ".join(filter(None, (name, line if len(lines) > 1 else ""))) or None)
        for limit in limits:
            axes.axhline(factor * limit, color=style.INK, lw=0.8, ls=":")
        axes.set(xlabel=textwrap.fill(label, 38, break_on_hyphens=False), ylabel=textwrap.fill(title, 34), yscale="log" if log else "linear")
        if not numeric:
            axes.set_xticks(list(at.values()), [textwrap.fill(written(value), 14) for value in values])
        elif min(values) > 0 and max(values) > 20 * min(values):
            axes.set_xscale("log")
    return panel


# ---- studies: cases, probabilities, sensitivities ----

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


# ---- comparisons ----

def lines_in(rows):
    """Gives each row the `line` of the chart to which it belongs: its series and, where that varies further keys than the last one, their values. Returns all."""
    for row in rows:
        own, *others = (" ".join(one["overrides"][:-1]) for one in (row, *rows) if one["series"] == row["series"])
        row["line"] = f"{row['series']}, {own}" if any(other != own for other in others) else row["series"]
    return list(dict.fromkeys(row["line"] for row in rows))


def charted(rows, in_plane=False):
    """The outcomes of runs: {title: {"": column}}, or for those of points {title: {name: column}} of the first MOST of them."""
    found = {}
    for column in dict.fromkeys(key for row in rows for key in row):
        if column in LEFT_OUT or not any(isinstance(row.get(column), float) for row in rows):
            continue
        ending = next((ending for ending in OF_POINTS if column.endswith(ending) and column != "largest_displacement_m"), "")
        of = found.setdefault(named(ending[1:] or column, in_plane), {})
        if len(of) < MOST:
            of[words(column.removesuffix(ending)) if ending else ""] = column
    return {f"{next(iter(of))} {title}".strip() if len(of) == 1 else title: of for title, of in found.items()}


def outcomes(runs, _):
    """Of `talus compare` without a measure."""
    rows, lines = runs.rows, lines_in(runs.rows)
    columns = {"state": ""} | {column: ".4g" for of in charted(rows).values() for column in of.values()}
    parts = [[row for row in rows if row["key"] == key] for key in dict.fromkeys(row["key"] for row in rows)]
    blocks = [[against("value", with_unit(part[0]["key"], part[0]["unit"]), part, of, title, lines, limits=[0], factor=factor_of(next(iter(of.values())), runs.in_plane))
               for title, of in charted(part, runs.in_plane).items()] for part in parts]
    keys = ", ".join(filter(None, (words(part[0]["key"].rpartition(".")[2]) for part in parts)))
    pictures = {"outcomes": (f"Outcomes against {keys or 'the series'}", [*filter(None, blocks)])} if any(blocks) else {}
    return table(rows, columns, runs.in_plane), {}, pictures, len(runs.ended) < len(rows)


def reference_of(rows, measure):
    """The limit of the line that converges best."""
    ends = [(line, *extrapolate([(row["value"], row[measure]) for row in rows if row["line"] == line and not row["failure"] and isinstance(row["value"], float)]))
            for line in dict.fromkeys(row["line"] for row in rows)]
    line, value, uncertainty, origin = min(ends, key=lambda end: end[2])
    return value, uncertainty, f"{line}: {origin}"


def chart_of_errors(rows, reference):
    """Error against processor time and against the refined key, and the values themselves; each key that some series refine has its own panels."""
    measure, text, factor = reference["measure"], named(reference["measure"]), factor_of(reference["measure"])
    uncertainty = factor * reference["uncertainty"]
    known = [row for row in rows if not row["failure"] and row[measure] is not None]
    lines, errors = list(dict.fromkeys(row["line"] for row in known)), [row for row in known if row["error"]]
    cost = against("processor_s", "processor time [s]", errors, {"": "error"}, "error of " + text, lines, log=True, factor=factor)

    def costs(axes):
        cost(axes)
        if best := sorted((row["processor_s"], factor * row["error"]) for row in errors if row["pareto"]):
            axes.step(*np.transpose(best), where="post", color=style.INK, lw=0.8, ls=":", label="Pareto front")
        if 0 < uncertainty < math.inf:  # as far down as the errors go
            axes.axhspan(min(axes.get_ylim()[0], uncertainty / 2), uncertainty, color=style.FAINT, alpha=0.4, label="reference uncertain")
    blocks = []
    for key, unit in dict.fromkeys((row["key"], row["unit"]) for row in errors):
        blocks.append([None if blocks else costs,
                       against("value", with_unit(key, unit), [row for row in errors if row["key"] == key], {"": "error"}, "error of " + text, lines, log=True, factor=factor),
                       against("value", with_unit(key, unit), [row for row in known if row["key"] == key], {"": measure}, text, lines, limits=[reference["value"]], factor=factor)])
    return f"Error of {text.partition(' [')[0]} against cost and refinement", blocks, 3, (3.5, 3.4)


def errors(runs, design):
    """Of `talus compare` with a measure."""
    [measure] = runs.measures
    truth = [row for row in runs.rows if row["run"] == design.get("reference")]
    if any(row["failure"] for row in truth):
        sys.exit(f"talus: the run of --reference failed: {truth[0]['failure']}")
    rows = [row for row in runs.rows if row not in truth]
    lines_in(rows)
    value, uncertainty, origin = ((design["exact"], 0.0, "given as exact") if "exact" in design else (truth[0][measure], 0.0, truth[0]["series"]) if truth else
                                  (None, 0.0, "its run is missing") if "reference" in design else reference_of(rows, measure))
    value = math.nan if value is None else value
    for row in rows:
        counts = ([event["values"] for event in read_events(runs.folder / row["folder"], "steps")] or [{}])[-1]
        row |= {name: int(counts.get(name, 0)) for name in ("steps", "evaluations", "rejections")}
        row["error"] = None if row[measure] is None or math.isnan(value) else abs(row[measure] - value)
    known = [row for row in rows if row["error"] is not None]
    for row in rows:  # does no other run take less time and have a smaller error?
        row["pareto"] = int(row in known and not any(other["processor_s"] < row["processor_s"] and other["error"] < row["error"] for other in known))
    reference = {"measure": measure, "value": value, "uncertainty": uncertainty, "origin": origin}
    columns = {measure: ".8g", "error": ".2e", "processor_s": ".3g", "steps": "", "evaluations": "", "rejections": ""}
    lines = [f"{measure}; reference {value:.8g} +- {uncertainty:.2g} ({origin})", "", *table(rows, columns, like={"error": measure})]
    status, runs.rows = len(runs.ended) < len(runs.rows), rows
    return lines, {"reference": reference}, {"errors": chart_of_errors(rows, reference)} if any(row["error"] for row in known) else {}, status


# ---- convergence ----

THINGS = {"cells": "cell size", "steps": "time step", "particles": "number of particles per cell"}
VERDICTS = {"missing": "the {thing} decides it", "equal": "the {thing} does not decide it within {allowed}", "swings": "it swings, and the {thing} decides it",
            "settles": "it settles, to {limit} by extrapolation at the order {order}, and the last refinement changes it by {last}, within {allowed}",
            "near": "the last refinement changes it by {last}, a tenth or less of {allowed}, and the {thing} does not decide it",
            "open": "it does not settle, and the {thing} decides it"}


def refined(row):
    return f"{row['value']:g} {row['unit']}".rstrip()


def percent(difference, values):
    """A difference as a share of the finest run's value, "12 %"; round-off is 0."""
    share = 100 * difference / abs(values[-1]) if values[-1] else 0.0
    return f"{share:.2g} %" if share >= 0.01 else "0 %"


def said_of_quantity(one, rows, thing, in_plane):
    """A sentence on what refinement does to a quantity."""
    name, unit, _ = spoken(one["quantity"], in_plane)
    values = [value for value in one["values"] if value is not None]
    factor, unit = readable_unit(max(map(abs, values)), unit)
    text = f"The {name} is {factor * min(values):.3g} to {factor * max(values):.3g} {unit}, {percent(max(values) - min(values), values)} apart"
    if one["state"] == "missing":
        text += f" and missing with {', '.join(refined(row) for row, value in zip(rows, one['values']) if value is None)}"
    numbers = {"last": percent(abs(values[-1] - values[-2]), values)} if len(values) > 1 else {}
    if one["order"]:
        numbers |= {"limit": f"{factor * one['limit']:.3g} {unit}", "order": f"{one['order']:.2g}"}
    return f"{text}: {VERDICTS[one['state']].format(thing=thing, allowed=one['allowed'], **numbers)}."


def judge(rows, by, within, in_plane=False):
    """([sentence], whether the refined quantity decides something, [what it does to each quantity]). `rows` from coarse to fine."""
    thing = THINGS[by]
    sentences, judged = [f"The run with {refined(row)} broke off: {row['failure']}." for row in rows if row["failure"]], []
    decides, rows = bool(sentences), [row for row in rows if not row["failure"]]
    if len(rows) < 3:
        return sentences + ["Fewer than three runs came to their end, so that nothing can be said."], True, judged
    cell, sizes = max(row["cell_m"] for row in rows), [1 / row["value"] if by == "particles" else row["value"] for row in rows]
    states = {state: with_state for state in (FAILS, MOVES, STANDS) if (with_state := [refined(row) for row in rows if row["state"] == state])}
    if len(states) > 1 and settles(sizes, [row["largest_displacement_m"] for row in rows], within) != "equal":
        each = " and ".join(f"{state} with {', '.join(some)}" for state, some in states.items())
        return [*sentences, f"The slope {each}: the {thing} decides whether it fails."], True, judged
    sentences.append(f"The slope {next(iter(states))} in all {len(rows)} runs.")
    points = [key for key in rows[-1] if key.endswith("_displacement_m") and key != "largest_displacement_m"]
    for key in ("load_time_of_failure_s", "largest_displacement_m", *points, *OF_SLIDE):
        values = [row.get(key) for row in rows]
        if any(value is not None for value in values):
            verdict = settles(sizes, values, within, cell if key in TO_A_CELL else 0.0)
            order = order_of(sizes[-3:], values[-3:], ORDERS) if verdict == "settles" else None
            of_cell = key in TO_A_CELL and cell > within * abs(values[-1] or 0)
            judged.append({"quantity": key, "values": values, "state": verdict, "allowed": f"one cell of {quantity(cell, 'm', '.2g')}" if of_cell else f"{100 * within:g} %", "order": order, "limit": order and values[-1] + rest_of(sizes, values, order)})
            sentences.append(said_of_quantity(judged[-1], rows, thing, in_plane))
            decides |= verdict not in ("equal", "settles", "near")
    return sentences + [f"Until another {thing} no longer changes these numbers, their scatter is their error."] * decides, decides, judged


def converge(runs, design):
    """Of `talus converge`: a comparison whose key is refined, and the verdict."""
    by, within = design["by"], design["within"]
    lines, _, pictures, _ = outcomes(runs, design)
    sentences, decides, judged = judge(runs.rows, by, within, runs.in_plane)
    page = {"by": by, "within": within, "decides": decides, "verdict": sentences, "quantities": judged}
    return [*lines, "", *sentences], page, pictures, decides


# ---- all ----

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
