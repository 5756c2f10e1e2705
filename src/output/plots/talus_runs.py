"""What a sweep of runs came to: a row a run, its outcomes in words with their units, and tables and charts of them."""

import json
import math
import re
import textwrap

import numpy as np

import talus_style as style
from talus_outcomes import FAILS, MOVES, STANDS, cell_size, finite, losses, outcome
from talus_results import History, Results, read_events
from talus_style import plt
from talus_table import lines_of
from talus_units import in_use, of_column, use, with_unit, words

OF_SLIDE = ("travel_distance_m", "volume_of_slide_m3", "depth_of_slide_m")  # 0 where the slope stands
# marker, how it is filled, and what it says
MARKS = {FAILS: ("o", "full", "the slope fails"), MOVES: ("s", "left", "it moves by less than a cell"), STANDS: ("o", "none", "it stands"), "": ("o", "full", None),
         "broke off": ("X", "full", "at the lower edge: the run broke off"), "never": ("o", "none", "at the upper edge: it did not fail by the end")}


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
