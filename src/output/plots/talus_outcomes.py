"""What a run came to: whether its soil fails, moves or stands, and the slide. The report and `talus study`, `compare` and `converge` all take it from here.

A run *fails* if the watched point of a stage failed, or if soil moved by more than a cell. It *moves* if soil moved by less than a cell, though by more
than SMALL of one, and slid: the plastic strain in a cell accounts for at least SLID of the displacement. A mesh cannot tell such a motion from the
beginning of a failure. Otherwise the soil *stands*: it moved by a negligible part of a cell, or deformed as a whole, as elastic soil settles. Displacement
is that of the last snapshot, since the start or the last reset.
"""

import json
import math

import numpy as np

from talus_measures import failure, largest_share_displacement, particles, slide, steps
from talus_units import quantity

FAILS, MOVES, STANDS = "fails", "moves", "stands"
# Of the slope of tests/exactness/results/outcomes.py, in cells of 0.77 m, plastic strain times cell is 0.31 to 0.38 of the displacement in runs that slid by
# 0.08 to 3.2 m, and 0.10 to 0.13 of it in those that settled by 0.03 and 0.04 m
SMALL, SLID = 0.1, 0.25
OF_SLIDE = ("travel_distance_m", "volume_of_slide_m3", "depth_of_slide_m", "run_out_from_toe_m", "fall_height_m", "angle_of_reach_deg", "area_m2", "deepest_at_x_m")
SHARE = 0.999  # of the soil: single particles count neither for displacement nor for strain


def cell_size(results):
    """Side of the regular triangle or tetrahedron of the mean size of all cells [m]."""
    node, cell = results.mesh()
    size = np.abs(np.linalg.det(node[cell[:, 1:]] - node[cell[:, :1]])).mean()
    return float((2 * size / 3**0.5) ** 0.5 if cell.shape[1] == 3 else (2**0.5 * size) ** (1 / 3))


def state_of(results, cell, failed, moved):
    """FAILS, MOVES or STANDS; `failed` says whether a watched point failed, `moved` is the largest displacement [m]."""
    if failed or moved > cell:
        return FAILS
    last = results.snapshots[-1]
    if moved <= SMALL * cell:
        return STANDS
    if "plastic_strain" in last and np.quantile(np.nan_to_num(last.scalar("plastic_strain")[0]), SHARE) * cell < SLID * moved:
        return STANDS
    return MOVES


def outcome(results, cell=None):
    """The numbers of one run; None where there is nothing to say, as of the slide of a slope that stands. `fails` is True, False, or None for a slope
    that moves by less than a cell. `cell` [m] is the size of the cells, or the largest of runs that are compared."""
    own = cell_size(results)
    cell = cell or own
    try:
        failed_at = failure(results)[1]
    except LookupError:
        failed_at = None
    moved = largest_share_displacement(results)
    state = state_of(results, cell, failed_at is not None, moved)
    row = {"state": state, "fails": {FAILS: True, MOVES: None, STANDS: False}[state], "load_time_of_failure_s": failed_at, "largest_displacement_m": moved}
    history = results.history
    for name in history.points(0) if history else {}:
        row[f"{name}_displacement_m"] = finite(history.columns[f"{name}_displacement_m"][-1])  # none where the point has no soil
    slid = slide(results) if state != STANDS else None
    row |= dict(zip(OF_SLIDE, (slid.travel, slid.volume, slid.depth, slid.from_toe, slid.fall, slid.reach(), slid.area, slid.deepest) if slid else (None,) * len(OF_SLIDE)))
    return row | {"steps": int(steps(results)), "particles": int(particles(results)), "cell_m": own}


def in_words(row, cell):
    """Why a run has its state, in a few words."""
    small, cell = row["largest_displacement_m"] <= SMALL * cell, quantity(cell, "m", ".2g")
    if row["state"] == FAILS:
        load = row["load_time_of_failure_s"]
        return f"soil moved by more than a cell of {cell}" if load is None else f"the watched point failed under the loads of t = {load:.4g} s"
    if row["state"] == MOVES:
        return f"soil slid by less than a cell of {cell}: smaller cells show whether it fails"
    return f"no soil moved by more than {100 * SMALL:g} % of a cell of {cell}" if small else "soil deformed as a whole, without sliding"


def losses(rows):
    """Further columns of a table of runs, {heading: function of a row}: the soil that left the mesh and the number of warnings, where some run has any.
    `rows` have the columns that the program writes of each run."""
    columns = {"left the mesh": lambda row: f"{100 * float(row.get('escaped_share') or 0):.3g} %", "warnings": lambda row: f"{float(row.get('warning_count') or 0):g}"}
    return {heading: text for heading, text in columns.items() if any(text(row) not in ("0", "0 %") for row in rows)}


def finite(value):
    """A number; None where it is none or infinite."""
    return float(value) if math.isfinite(value) else None


def write_json(path, page):
    """JSON has no NaN: numbers that are none are null."""
    def cleaned(value):
        if isinstance(value, dict):
            return {key: cleaned(one) for key, one in value.items()}
        if isinstance(value, (list, tuple)):
            return [cleaned(one) for one in value]
        return finite(value) if isinstance(value, float) else value
    path.write_text(json.dumps(cleaned(page), indent=1, allow_nan=False) + "\n")
