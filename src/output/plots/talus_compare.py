"""`talus compare` and `talus converge`: outcomes against the keys that vary, errors against cost, and what refinement decides."""

import math
import sys

import numpy as np

import talus_style as style
from talus_outcomes import FAILS, MOVES, STANDS
from talus_results import read_events
from talus_runs import OF_SLIDE, against, factor_of, named, spoken, table
from talus_statistics import ORDERS, extrapolate, order_of, rest_of, settles
from talus_units import quantity, readable_unit, with_unit, words

TO_A_CELL = ("travel_distance_m", "depth_of_slide_m")  # rear, front and slip surface are known to a cell
OF_POINTS = ("_displacement_m", "_largest_speed_m_s")  # endings
MOST = 5  # named points that charts and the table show
LEFT_OUT = ("cell_m", "deepest_at_x_m", "run_out_from_toe_m", "fall_height_m", "angle_of_reach_deg", "area_m2", "value", "processor_s", "wall_s", "escaped_mass_kg", "escaped_share")  # numbers that are no outcomes


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
