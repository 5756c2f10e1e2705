"""report.html: one page that stands alone, with the pictures inside it."""

import base64
import csv
import datetime
import html
import pathlib
import typing

import numpy as np

from talus_factor import MECHANISM_AND_SURFACE, about_water, factor_lines, lost_stages, short
from talus_histories import base_friction
from talus_loads import loads_at
from talus_measures import flow, known
from talus_modelled import stage_rows
from talus_moments import last_reset, moved_before, since
from talus_outcomes import in_words, outcome
from talus_play import ROWS
from talus_results import NOT_ENDED, read_factor
from talus_sliding import SLOW, largest_displacement, sliding, still_moving
from talus_structures import rows as structure_rows
from talus_units import Keys, at_time, brief, capital, text_of, thousands, words
from talus_workbook import write_workbook

LOG_LINES = 25
LEDGERS = ("Particles", "Mass ledger", "Largest plastic strain")  # besides those of the bases
WATER_KEYS = ("porosity", "saturation", "pore_pressure_ratio", "water_table", "permeability", "hydraulic_conductivity", "gas_permeability", "permeability_change",
              "retention", "relative_permeability")  # of soils
WATER_MODES = {"drained": "pore pressure is prescribed", "saturated": "pore water moves", "unsaturated": "pore water moves, gas at rest",
               "three-phase": "pore water and gas move"}
ROUNDED = 5e-12  # relative error of a number with the 12 digits of history.csv
PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
{css}</style>
</head>
<body>
{body}<footer>{foot}</footer>
</body>
</html>
"""


class Drawn(typing.NamedTuple):
    """What a report shows: the `numbers` of its cards, `sections` [(field, large picture, sheet of times or None)], `histories` and `factor` [(quantity, picture)], the picture of the
    `model` or None, and the elements by which the page plays."""

    numbers: list
    sections: list
    histories: list
    factor: list
    model: pathlib.Path | None
    played: str


def write_report(results, model, drawn):
    """The path of the page. `results` are those before the strength is reduced where a factor of safety was asked for."""
    css = (pathlib.Path(__file__).parent / "report.css").read_text()
    found, first, slide = drawn.numbers, first_picture(drawn), slide_of(drawn)
    parts = [
        header(results, model),
        f'<div class="first">{cards([one for one in found if not of_ledgers(one)])}{first}</div>',
        warnings(results),
        section("Factor of safety", factor_block(read_factor(results), [one for one in drawn.factor if one[0] != MECHANISM_AND_SURFACE])),
        section("Before the strength is reduced", slide if first != slide else ""),
        section("Sections", "".join(field_block(*one) for one in drawn.sections)),
        section("Structures", structure_block(results)),
        section("Histories", grid(drawn.histories), "curves"),
        section("Model", model_block(model, drawn.model)),
        summary(results, model),
        section("Ledgers and counts", cards([one for one in found if of_ledgers(one)])),
        folded("Scene as run", results.scene_text),
        folded("Last lines of the log", "\n".join(results.log_lines()[-LOG_LINES:])),
        drawn.played,
    ]
    page = PAGE.format(title=html.escape(results.title), css=css, body="".join(parts), foot=html.escape(results.program))
    path = results.folder / "report.html"
    path.write_text(page)
    write_tables(results, model, found)
    return path


def write_tables(results, model, numbers):
    """report.csv with the numbers of the report, and report.xlsx with these, the stages, soils and boundaries, and the history in its SI units."""
    rows = [("quantity", "value", "note"), *numbers]
    with open(results.folder / "report.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)
    tables, keys = {"Numbers": rows}, model.keys if model else Keys()
    if model:
        tables["Stages"] = stage_rows(model)
    for name, path, kind in (("Soils", "body", "law"), ("Boundaries", "boundary", "kind")):
        given = {one: keys.row(f"{path}.NAME", values, kind) for one, values in results.scene.get(path, {}).items()}
        columns = list(dict.fromkeys(key for row in given.values() for key in row))
        tables[name] = [("name", *columns), *((one, *(row.get(key, "") for key in columns)) for one, row in given.items())]
    if history := results.history:
        kept = slice(None, None, -(-len(history.time) // ROWS))
        tables["History"] = [("time_s", "stage", *history.names()), *zip(history.time[kept].tolist(), history.stage[kept], *(values[kept].tolist() for values in history.columns.values()))]
    write_workbook(results.folder / "report.xlsx", tables)


def header(results, model):
    """What was asked: project, author, date, file and version, and what kind of a run it is."""
    last, output = results.snapshots[-1], results.scene.get("output", {})
    run = results.folder / "run.h5"
    date = f"{datetime.date.fromtimestamp(run.stat().st_mtime):%d %B %Y}".lstrip("0") if run.exists() else ""
    asked = [output.get("project"), output.get("author"), date, model and model.data.get("file"), results.program]
    facts = [results.scene.get("phases", "dry"), f"{results.snapshots[0].position().shape[1]}D", f"{at_time(last.time, last.time)} at the end"]
    cause = results.broke_off()
    ending = f'<p class="ending"><strong>The run {"is incomplete" if cause == NOT_ENDED else "broke off"}:</strong> {html.escape(cause)}</p>' if cause else ""
    said = ["".join(f"<span>{html.escape(str(one))}</span>" for one in line if one) for line in (asked, facts)]
    return (f'<header><p class="kicker">{said[0]}</p><h1>{html.escape(results.title)}</h1><p>{said[1]}</p>{ending}</header>\n')


def first_picture(drawn):
    """The mechanism of a factor of safety in plane strain, else the slide."""
    if drawn.factor and drawn.factor[0][0] == MECHANISM_AND_SURFACE:
        return f'<div class="field">{picture(drawn.factor[0][1], capital(MECHANISM_AND_SURFACE))}</div>'
    return slide_of(drawn)


def slide_of(drawn):
    """The slide, which the scripts play; without them its first field."""
    return f'<div class="field" id="slide">{picture(drawn.sections[0][1], capital(words(drawn.sections[0][0])))}</div>' if drawn.sections else ""


def of_ledgers(card):
    """Is this a number of how the run was computed, which no one asked for first?"""
    return card[0] in LEDGERS or card[0].startswith("Friction on ")


def warnings(results):
    """What the run warned of, each sentence once."""
    found = dict.fromkeys(event["text"] for event in results.events() if event["warning"])
    if cut := results.cut_history():
        found[cut] = None
    return section("Warnings", "".join(f"<p>{html.escape(sentence)}</p>" for sentence in found), "warnings")


def load_at_failure(results, model):
    """[(what, value, note)] of each load that changes with time when the watched point failed."""
    failures = results.events("failure")
    if not failures:
        return []
    time = failures[0]["load_time_s"]
    when = f"the watched point failed under the loads of t = {time:.4g} s"
    found = loads_at(results, model, time) if model else []
    return [(f"At failure: {what}", value, when) for what, value in found] or [("Failure", f"t = {time:.4g} s", when)]


def key_results(results, model=None):
    """[(what, number, note)], what a reader wants first at the beginning."""
    last = results.snapshots[-1]
    factor = read_factor(results)
    found = doubts(results) + ([] if factor is None else [(f"Factor of safety{about_water(factor).rstrip(':')}", short(factor["factor_of_safety"]), ends_of(factor["factor_of_safety"]) + bounds(factor))])
    lost = (factor or {}).get("stages_without_equilibrium", ())
    found += load_at_failure(results, model)
    found.append(("Particles", thousands(len(last.position())), ", ".join(results.bodies)))
    when = "at the end" if factor is None else "before the strength is reduced"
    without = ", without the soil that left the mesh" if results.escaped and len(results.escaped.time) else ""
    if "displacement" in last and len(last.position()):
        vector = last.column("displacement").values
        level, rise = level_and_upright(vector, results.up_axis())
        parts = f"{brief(level, 'm')} level, {brief(rise, 'm')} up or down"
        found.append(("Largest displacement", brief(largest_displacement(last), "m"), f"of 99.9 % of the mass, {since((last_reset(results) or ('', ''))[1])}; of any particle {parts}{without}" + f"; {when}" * (factor is not None)))
        if "volume" in last:
            came_to = outcome(results)
            if lost:
                found.append((f"State {when}", "no equilibrium", f"{lost_stages(factor)}; displacements are those of the last state on the way to its loads"))
            else:
                found.append((f"State {when}", came_to["state"], in_words(came_to, came_to["cell_m"]) + motion_at_end(last)))
            volume = came_to["volume_of_slide_m3"]
            note = "no soil slides" if volume is None else "moved more than a tenth of the largest"
            found.append(("Volume of slide", brief(volume or 0.0, results.per_metre("m³")), note + without))
            if came_to.get("travel_distance_m"):
                found += run_out(came_to)
    depth = flow(results) if "displacement" in last and "volume" in last else None
    if depth:
        typical, most, cell = depth
        thin = ": a flow that is not as deep as a cell is not resolved; take smaller cells on its way" if typical < cell else ""
        found.append(("Depth of the flow", brief(typical, "m"), f"at most {brief(most, 'm')}; median where it left its outline at the start; cells there measure {brief(cell, 'm')}{thin}"))
    speed = top_speed(results)
    if speed:
        found.append(("Largest speed", brief(speed[0], "m/s"), f"{speed[2]}, {at_time(speed[1], last.time)}"))
    found += bases(results)
    if "plastic_strain" in last and np.isfinite(last.scalar("plastic_strain")[0]).any():  # elastic soil has none
        found.append(("Largest plastic strain", f"{known(last, 'plastic_strain').max():.3g}", when))
    mass = results.history.columns.get("mass_kg") if results.history else None
    gone = results.history.columns.get("escaped_mass_kg", 0 * mass) if mass is not None else None
    if mass is not None and len(mass) and mass[0]:
        lost = mass[-1] + gone[-1] - mass[0]
        end = brief(mass[-1] / 1e3, results.per_metre("t"))
        closed = abs(lost) <= ROUNDED * (mass[0] + mass[-1] + gone[-1])
        error = f"{lost:+.1e} {results.per_metre('kg')}"
        share = "" if closed else f"; {abs(lost) / mass[0]:.1e} of the mass at the start has {'appeared' if lost > 0 else 'vanished'}"
        found.append(("Mass ledger", "closed" if closed else error, f"{end} at the end{share}"))
    return found


def run_out(came_to):
    """[(what, number, note)] of how far a slide went."""
    found = [("Travel distance", brief(came_to["travel_distance_m"], "m"), "L, level, from the crown at the start to the front at the end"),
             ("Run-out from the toe", brief(came_to["run_out_from_toe_m"], "m"), "front at the end beyond that at the start"),
             ("Angle of reach", f"{came_to['angle_of_reach_deg']:.1f}°", f"H/L = {came_to['fall_height_m'] / came_to['travel_distance_m']:.3g}, fall H = {brief(came_to['fall_height_m'], 'm')}")]
    return found + ([("Area of the deposit", brief(came_to["area_m2"], "m²"), "as maps outline it")] if came_to["area_m2"] else [])


def doubts(results):
    """What makes the other numbers doubtful: soil that slid before displacements were set to zero, soil that left the mesh, points without soil."""
    last, found = results.snapshots[-1], []
    moved = moved_before(results)
    if moved:
        found.append(("Moved before the start", brief(moved[0], "m"), f"set to zero at the end of stage {moved[1]}: more than elastic soil settles, see the warnings"))
    if results.escaped and len(results.escaped.time):
        note = f"{thousands(len(results.escaped.time))} particles, from {at_time(results.escaped.time[0], last.time)} on{ways_out(results.escaped)}"
        found.append(("Left the mesh", brief(results.escaped.columns["mass_kg"].sum() / 1e3, results.per_metre("t")), note))
    if gone := points_without_soil(results.history):
        found.append(("Points without soil", ", ".join(map(words, gone)), "at the end: what stood there has left the mesh, or no stage has added it"))
    return found


def points_without_soil(history):
    """Names of the points that have no value in the last row."""
    columns = {name: history.columns[f"{name}_x_m"] for name in history.points(0)} if history else {}
    return [name for name, x in columns.items() if len(x) and np.isnan(x[-1])]


def level_and_upright(vectors, up):
    """The largest size of the level parts of vectors [n, 2 or 3], and that of their parts along the axis `up`."""
    return np.linalg.norm(np.delete(vectors, up, axis=1), axis=1).max(), np.abs(vectors[:, up]).max()


def ends_of(bracket):
    return f"equilibrium with strength divided by {bracket['equilibrium']:.4g}, a mechanism with {bracket['mechanism']:.4g}"


def bounds(factor):
    """What psi < phi leaves open, in words; empty where psi = phi, and of the factor without flow of pore water: the bounds are of held pressure."""
    if "own" not in factor["by_flow"] or factor["flow"] == "undrained":
        return ""
    return f"; soil with psi < phi: lower estimate {short(factor['by_flow']['davis'])} (strength of Davis), upper bound {short(factor['by_flow']['associated'])} (psi = phi)"


def motion_at_end(last):
    """Whether the soil that slid has come to rest, in words; empty if it has."""
    moving = still_moving(last, last.ids()[sliding(last)])
    return f"; still moving: {100 * moving[0]:.3g} % of what slid is faster than {brief(SLOW, 'm/s')}, at up to {brief(moving[1], 'm/s')}" if moving else ""


def bases(results):
    """Of each frictional base that soil lies on at the end: its mean friction since the row before, beside tan phi where that is one number, and how
    close the soil is to it."""
    columns, found = results.history.columns if results.history else {}, []
    for name in results.scene.get("boundary", {}):
        friction, clearance = columns.get(f"{name}_friction"), columns.get(f"{name}_clearance_m")
        if friction is None or not len(friction) or not friction[-1] > 0:
            continue
        tan_phi = base_friction(results.scene, f"{name}_friction")
        notes = ["friction over normal force, mean of the last row"]
        if tan_phi is not None:
            notes.append(f"tan φ = {tan_phi:.3g}")
        if clearance is not None and clearance[-1] > 0:
            notes.append(f"lowest particles {brief(clearance[-1], 'm')} above it")
        found.append((f"Friction on {words(name)} at the end", f"{friction[-1]:.3g}", "; ".join(notes)))
    return found


def ways_out(escaped):
    """By which groups of faces the mass left, most of it first, in words; empty where no group is known."""
    mass = {}
    for group, kilograms in zip(escaped.group, escaped.columns["mass_kg"]):
        mass[group] = mass.get(group, 0) + kilograms
    if not any(mass):
        return ""
    groups = sorted(mass, key=mass.get, reverse=True)
    shares = [f" {100 * mass[group] / sum(mass.values()):.3g} %" if len(groups) > 1 else "" for group in groups]
    return "; by " + ", ".join(f"{words(group) or 'faces without a name'}{share}" for group, share in zip(groups, shares))


def top_speed(results):
    """(speed, time, where) of the fastest particle in the snapshots or the fastest named point, whichever is more."""
    best = None
    for snapshot in results.snapshots:
        if "velocity" in snapshot and len(snapshot.position()):
            speed = np.nanmax(snapshot.scalar("velocity")[0])
            best = max(best or (0,), (float(speed), snapshot.time, "of all particles"))
    if results.history:
        for name, values in results.history.groups().get(("velocity", "m/s"), {}).items():
            if np.isfinite(values).any():  # none where the point has no soil
                when = float(results.history.time[np.nanargmax(values)])
                best = max(best or (0,), (float(np.nanmax(values)), when, f"at {words(name)}"))
    return best if best and best[0] > 0 else None


def cards(numbers):
    boxes = "".join(
        f"<div><span>{html.escape(what)}</span><strong>{html.escape(number)}</strong>"
        f"<em>{html.escape(note)}</em></div>"
        for what, number, note in numbers
    )
    return f'<section class="cards">{boxes}</section>\n'


def model_block(model, drawn):
    """What was modelled: its picture, and a table of the stages with what acts in each."""
    if model is None:
        return ""
    return f'<div class="field">{picture(drawn, "Model at the start")}</div><div class="tables">{lined_table("Stages", stage_rows(model))}</div>'


def summary(results, model):
    """Soils, boundaries and water as the scene gives them, with their units."""
    scene, keys = results.scene, model.keys if model else Keys()
    bodies = {name: keys.row("body.NAME", values, "law") for name, values in scene.get("body", {}).items()}
    inside = {words(key) for key in ("retention", "relative_permeability")}
    tables = [table("Soils", [{"body": name, **{key: text for key, text in row.items() if key not in inside}} for name, row in bodies.items()]),
              table("Boundaries", boundary_rows(scene, keys, model)),
              table("Water", water_rows(scene, keys, bodies))]
    functions = [(name, text_of(value, over_time=True)) for name, value in scene.get("functions", {}).items()]
    if functions:
        tables.append(lined_table("Functions of time", [("function", "value")] + functions))
    if model is None:
        tables.insert(1, table("Stages", [keys.row("stage.N", stage) for stage in scene.get("stage", [])]))
    general = keys.row("", {key: scene[key] for key in ("phases", "dimension", "gravity") if key in scene})
    general |= {f"mesh {key}": text for key, text in keys.row("mesh", scene.get("mesh", {})).items() if key != "refine"}
    general |= {f"integrator {key}": text for key, text in keys.row("integrator", scene.get("integrator", {}), "kind").items()}
    entry = "<tr><th>{}</th><td>{}</td></tr>"
    rows = "".join(entry.format(html.escape(key), html.escape(value)) for key, value in general.items())
    if not rows and not any(tables):
        return ""
    general = f"<div><h3>General</h3><table>{rows}</table></div>"
    return section("Scene", f'<div class="tables">{general}{"".join(tables)}</div>')


def boundary_rows(scene, keys, model):
    """The boundaries as the scene gives them, and what the program makes of them at the start."""
    found = {one.name: one for one in model.boundaries} if model else {}
    rows = []
    for name, values in scene.get("boundary", {}).items():
        row = {"boundary": name, "group": name, **keys.row("boundary.NAME", values, "kind")}
        if name in found:
            row["at the start"] = found[name].at_start() or "–"
        rows.append(row)
    return rows


def water_rows(scene, keys, bodies):
    """The pore water: how it is modelled, and what the soils have to do with it."""
    phases = scene.get("phases", "dry")
    if phases == "dry":
        return []
    common = {"water in": "all soils", "mode": f"{phases}: {WATER_MODES[phases]}", **keys.row("water", scene.get("water", {}))}
    wanted = [words(key) for key in WATER_KEYS]
    return [common] + [{"water in": name, **{key: row[key] for key in wanted if key in row}} for name, row in bodies.items()]


def table(name, rows):
    """Rows of dictionaries; a property a line, since soils have more properties than there are soils."""
    if not rows:
        return ""
    keys = list(dict.fromkeys(key for row in rows for key in row))
    lines = []
    for k, key in enumerate(keys):
        tag = "th" if k == 0 else "td"
        cells = "".join(f"<{tag}>{html.escape(row.get(key, '–'))}</{tag}>" for row in rows)
        lines.append(f"<tr><th>{html.escape(key)}</th>{cells}</tr>")
    return f"<div><h3>{name}</h3><table>{''.join(lines)}</table></div>"


def lined_table(name, rows):
    """Rows of texts, the first of them the names of the columns."""
    head, *rest = ["".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in row) for tag, row in [("th", rows[0])] + [("td", row) for row in rows[1:]]]
    return f"<div><h3>{name}</h3><table><tr>{head}</tr>{''.join(f'<tr>{row}</tr>' for row in rest)}</table></div>"


def section(name, content, own=""):
    return f"<section{f' id={chr(34)}{own}{chr(34)}' if own else ''}><h2>{name}</h2>{content}</section>\n" if content else ""


def field_block(field, large, over_time):
    name = capital(words(field))
    return f'<div class="field">{picture(large, name)}{picture(over_time, f"{name} over time") if over_time else ""}</div>'


def structure_block(results):
    """What the structures in the soil bear."""
    rows = structure_rows(results)
    if not rows:
        return ""
    note = "Forces are those of one bar, or of a metre of a geogrid. structure_NAME.csv has them along each structure."
    return f'<div class="tables">{lined_table("What they bear", rows)}</div><p>{note}</p>'


def factor_block(factor, pictures):
    """The factor of safety in sentences, and its pictures."""
    if factor is None:
        return ""
    return "".join(f"<p>{html.escape(line)}</p>" for line in factor_lines(factor)) + grid(pictures)


def grid(histories):
    pictures = [picture(path, capital(words(what))) for what, path in histories]
    return f'<div class="grid">{"".join(pictures)}</div>' if pictures else ""


def picture(path, caption):
    data = base64.b64encode(path.read_bytes()).decode()
    return f'<figure><img alt="{html.escape(caption)}" src="data:image/png;base64,{data}"></figure>'


def folded(name, text):
    if not text:
        return ""
    return f"<details><summary>{name}</summary><pre>{html.escape(text)}</pre></details>\n"
