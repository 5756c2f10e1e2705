"""What a report plays: the slide over its frames and the histories, packed into the page for report.js."""

import base64
import json
import pathlib
import zlib

import numpy as np

from talus_colours import Colours
from talus_histories import ELSEWHERE, changes, drawn_energies
from talus_moments import RESET, chosen_snapshots, last_reset, scaled_by
from talus_sliding import sliding
from talus_soils import tints
from talus_units import capital, length, readable_unit, shown, words
from talus_views import spacing_of

FIELDS = ("displacement", "plastic_strain", "velocity", "pore_pressure")
FRAMES = 40
BYTES = 6_000_000  # of particles before they are packed; beyond this some stand for all
ROWS = 20_000  # of a history that are kept
SQUARES = 80  # of the ground along its longer side
NOWHERE = 65535  # place of a particle that is not there in a frame


class Packed:
    """Arrays one behind the other, larger numbers first so that each begins where its type asks for."""

    def __init__(self):
        self._arrays = []

    def add(self, array, kind):
        """Number of the array, by which the page asks for it."""
        self._arrays.append(np.ascontiguousarray(array, kind))
        return len(self._arrays) - 1

    def text(self):
        """(where each array is: [first byte, count, kind], all of them in base 64)"""
        at, parts, where = 0, [], {}
        for number in sorted(range(len(self._arrays)), key=lambda k: -self._arrays[k].itemsize):
            array = self._arrays[number]
            where[number] = [at, array.size, f"{array.dtype.kind}{array.itemsize}"]
            parts.append(array.tobytes())
            at += array.nbytes
        return [where[k] for k in range(len(where))], base64.b64encode(zlib.compress(b"".join(parts), 6)).decode()


def scripts(results):
    """The elements of the page that let it play; it works without them."""
    packed = Packed()
    about = {"slide": slide_over_time(results, packed), "histories": histories(results, packed), "lines": length()}
    about["arrays"], data = packed.text()
    code = (pathlib.Path(__file__).parent / "report.js").read_text()
    text = json.dumps(about, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")
    return f'<script type="application/json" id="about">{text}</script>\n<script type="text/plain" id="data">{data}</script>\n<script>\n{code}</script>\n'


# ---- the slide ----

def frames_of(results):
    """Snapshots with soil, FRAMES at most, evenly in their number."""
    there = [snapshot for snapshot in results.snapshots if len(snapshot.ids())]
    return [there[k] for k in sorted(set(np.linspace(0, len(there) - 1, min(FRAMES, len(there))).round().astype(int).tolist()))] if there else []


def stand_ins(results, frames, each):
    """Numbers of the particles that are shown, all of them or as many as BYTES allow at `each` bytes a frame: of those that slide twice as many as of others."""
    ids = np.union1d(frames[0].ids(), frames[-1].ids())
    most = max(1000, BYTES // (each * len(frames)))
    if len(ids) <= most:
        return ids
    slid = frames[-1].ids()[sliding(frames[-1])]
    others = np.setdiff1d(ids, slid, assume_unique=True)
    share = min(1.0, most / (len(slid) + 0.5 * len(others)))
    chosen = np.random.default_rng(1)
    parts = [of[chosen.random(len(of)) < part] for of, part in ((slid, share), (others, 0.5 * share))]
    return np.sort(np.concatenate(parts))


def rows_of(snapshot, ids):
    """Row of each of these particles in a snapshot, and whether it is there."""
    have = snapshot.ids()
    row = np.minimum(np.searchsorted(have, ids), len(have) - 1)
    return row, have[row] == ids


def slide_over_time(results, packed):
    frames = frames_of(results)
    if len(frames) < 2:
        return None
    fields = [field for field in FIELDS if all(frame.scalar(field) is not None for frame in (frames[0], frames[-1]))]
    size = spacing_of(results)
    some = chosen_snapshots(results)
    colours = {field: Colours(field, scaled_by(results, some, field), spacing=size, shown=some) for field in fields}
    fields = [field for field in fields if field == fields[0] or not colours[field].nothing]
    dimension = frames[0].position().shape[1]
    ids = stand_ins(results, frames, 2 * dimension + len(fields))
    clouds = [frame.position() for frame in frames]
    low, high = np.min([cloud.min(axis=0) for cloud in clouds], axis=0), np.max([cloud.max(axis=0) for cloud in clouds], axis=0)
    place = np.full((len(frames), len(ids), dimension), NOWHERE, np.uint16)
    value = np.zeros((len(fields), len(frames), len(ids)), np.uint8)
    body = np.zeros(len(ids), np.uint8)
    for k, (frame, cloud) in enumerate(zip(frames, clouds)):
        row, there = rows_of(frame, ids)
        row = row[there]
        place[k, there] = np.round((cloud[row] - low) / np.maximum(high - low, 1e-9) * (NOWHERE - 1))
        body[there] = frame.body()[row]
        for number, field in enumerate(fields):
            value[number, k, there] = steps_of(frame.scalar(field)[0][row], colours[field])
    drawn = (len(frames[-1].ids()) / max(1, len(ids))) ** (1 / dimension)
    return {"dimension": dimension, "up": results.up_axis(), "low": low.tolist(), "high": high.tolist(), "count": len(ids), "of": len(frames[-1].ids()),
            "size": size * min(drawn, 3.0), "times": [frame.time for frame in frames], "says": [f"{results.when(frame)}  ·  {frame.stage}" for frame in frames],
            "soils": [words(name) for name in results.bodies], "tints": (255 * tints(results.bodies)).round().astype(int).tolist(),
            "place": packed.add(place, "<u2"), "body": packed.add(body, "u1"), "ground": ground(results, packed) if dimension == 3 else None,
            "fields": [{"name": capital(words(field)), "unit": shown(colours[field].unit), "value": packed.add(value[number], "u1"), **scale(colours[field])}
                       for number, field in enumerate(fields)]}


def steps_of(values, colours):
    """0 where soil has its own colour, else 1 to 255 along the scale."""
    share = np.ma.filled(np.ma.masked_invalid(colours.norm(np.nan_to_num(colours.factor * values))), 0.0)
    return np.where(colours.plain(colours.factor * values), 0, 1 + np.round(254 * np.clip(share, 0, 1))).astype(np.uint8)


def scale(colours):
    """Colours of the steps, and numbers beside them."""
    at = np.linspace(0, 1, 5)
    return {"colours": (255 * np.asarray(colours.map(np.linspace(0, 1, 64)))[:, :3]).round().astype(int).tolist(),
            "marks": [f"{value:.3g}" for value in np.asarray(colours.norm.inverse(at), float)]}


def ground(results, packed):
    """Heights of the mesh's bottom over a level grid; places without any are those beside."""
    node, cell = results.mesh()
    if not len(cell):
        return None
    up = results.up_axis()
    level = [axis for axis in range(3) if axis != up]
    low, extent = node.min(axis=0), np.ptp(node, axis=0)
    wide = max(extent[level].max() / SQUARES, 1.5 * np.median(np.linalg.norm(node[cell[:, 0]] - node[cell[:, 1]], axis=1)))
    shape = np.maximum(2, np.round(extent[level] / wide).astype(int) + 1)
    index = np.round((node[:, level] - low[level]) / extent[level] * (shape - 1)).astype(int)
    height = np.full(shape, np.inf)
    np.minimum.at(height, tuple(index.T), node[:, up])
    while not np.isfinite(height).all():
        edged = np.pad(height, 1, constant_values=np.inf)
        beside = np.min([edged[:-2, 1:-1], edged[2:, 1:-1], edged[1:-1, :-2], edged[1:-1, 2:]], axis=0)
        height = np.where(np.isfinite(height), height, beside)
    return {"heights": packed.add(height, "<f4"), "shape": shape.tolist(), "low": low[level].tolist(), "high": (low + extent)[level].tolist(), "level": level}


# ---- histories ----

def histories(results, packed):
    """The curves of history.csv that vary, in the units of the pictures."""
    history = results.history
    if history is None or len(history.time) < 2:
        return None
    kept = slice(None, None, -(-len(history.time) // ROWS))
    charts, reset = [], last_reset(results)
    for (quantity, unit), lines in history.groups().items():
        if quantity in ELSEWHERE or quantity.startswith("stress_") or quantity.endswith(("_x", "_y", "_z", "_ledger")):
            continue
        if reset and quantity in RESET:  # what is set to 0 begins there
            lines = {name: np.where(history.time > reset[0] * (1 + 1e-9), values, np.nan) for name, values in lines.items()}
        if quantity == "energy":
            lines = drawn_energies(lines)
        lines = {name: values for name, values in lines.items() if changes(values)}
        if lines:
            factor, written = readable_unit(max(np.nanmax(np.abs(values)) for values in lines.values()), unit)
            charts.append({"name": capital(words(quantity)), "unit": shown(written),
                           "lines": [{"name": words(name).replace("\n", " "), "values": packed.add(factor * values[kept], "<f4")} for name, values in lines.items()]})
    return {"time": packed.add(history.time[kept], "<f4"), "charts": charts} if charts else None
